"""Writes the VTU files of this folder by VTK (9.1) and meshio (5.3.5): one grid in every encoding that they have.

The grid: two pixels beside a quadrilateral, a triangle and a triangle of order 2, in the plane; in `solid`, a voxel, a hexahedron, a tetrahedron,
a wedge, a pyramid. Point data `T` = x + 2 y + 4 z and `v` = (x, y, z), cell data `number` = 0, 1, .., each with the range that VTK notes beside it.

    /usr/bin/python3 make.py vtk && target/python/bin/python3 make.py meshio
"""
import sys

PLANE = (
    [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0), (3, 0, 0), (3, 1, 0), (4, 0, 0), (5, 0, 0), (4, 1, 0), (4.5, 0, 0), (4.5, 0.5, 0), (4, 0.5, 0)],
    [(8, (0, 1, 3, 4)), (8, (1, 2, 4, 5)), (9, (2, 6, 7, 5)), (5, (6, 8, 7)), (22, (8, 9, 10, 11, 12, 13))],
)
SOLID = (
    [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)] + [(3, 0, 0), (3, 1, 0), (3, 0, 1), (0.5, 0.5, 2), (1, 0, 3), (3, 1, 1)],
    [
        (11, (0, 1, 3, 4, 6, 7, 9, 10)),
        (12, (1, 2, 5, 4, 7, 8, 11, 10)),
        (13, (2, 12, 5, 8, 14, 11)),
        (14, (6, 7, 10, 9, 15)),
        (10, (6, 7, 15, 16)),
    ],
)


def by_vtk():
    import vtkmodules.vtkCommonCore as core
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    def grid(points, cells):
        made, places = vtkUnstructuredGrid(), core.vtkPoints()
        places.SetDataTypeToDouble()
        arrays = [core.vtkDoubleArray(), core.vtkFloatArray(), core.vtkIdTypeArray()]
        for array, (name, width) in zip(arrays, [("T", 1), ("v", 3), ("number", 1)]):
            array.SetName(name)
            array.SetNumberOfComponents(width)
        for x in points:
            places.InsertNextPoint(x)
            arrays[0].InsertNextValue(x[0] + 2 * x[1] + 4 * x[2])
            arrays[1].InsertNextTuple(x)
        for k, (kind, nodes) in enumerate(cells):
            made.InsertNextCell(kind, len(nodes), nodes)
            arrays[2].InsertNextValue(k)
        made.SetPoints(places)
        made.GetPointData().AddArray(arrays[0])
        made.GetPointData().AddArray(arrays[1])
        made.GetCellData().AddArray(arrays[2])
        for array in [places.GetData(), *arrays]:
            array.GetRange(-1)
            array.GetFiniteRange(-1)
        return made

    modes = {"ascii": lambda w: w.SetDataModeToAscii(), "inline": lambda w: w.SetDataModeToBinary(), "raw": lambda w: w.EncodeAppendedDataOff(), "base64": lambda w: None}
    packs = {"none": "SetCompressorTypeToNone", "zlib": "SetCompressorTypeToZLib", "lz4": "SetCompressorTypeToLZ4", "lzma": "SetCompressorTypeToLZMA"}
    for name, model in [("plane", PLANE), ("solid", SOLID)]:
        for mode, choose in modes.items():
            for pack, method in packs.items():
                if mode == "ascii" and pack != "none" or name == "solid" and (mode, pack) != ("base64", "zlib"):
                    continue
                writer = vtkXMLUnstructuredGridWriter()
                writer.SetInputData(grid(*model))
                choose(writer)
                getattr(writer, method)()
                # several blocks each
                writer.SetBlockSize(128)
                writer.SetFileName(f"{name}_{mode}_{pack}.vtu")
                writer.Write()
    # with nothing chosen, with numbers of 64 bits ahead of arrays, with the highest byte first
    for name, choose in [("default", lambda w: None), ("wide", lambda w: w.SetHeaderTypeToUInt64()), ("big", lambda w: w.SetByteOrderToBigEndian())]:
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(grid(*PLANE))
        choose(writer)
        writer.SetFileName(f"plane_{name}.vtu")
        writer.Write()


def by_meshio():
    import meshio
    import numpy as np

    x, cells = np.array(PLANE[0], dtype=float), PLANE[1]
    # it has no pixels
    quads = [[a, b, d, c] for _, (a, b, c, d) in cells[:2]] + [cells[2][1]]
    blocks = [("quad", quads), ("triangle", [cells[3][1]]), ("triangle6", [cells[4][1]])]
    numbers = [np.array([0, 1, 2]), np.array([3]), np.array([4])]
    mesh = meshio.Mesh(x, blocks, point_data={"T": x @ [1.0, 2.0, 4.0], "v": x.astype(np.float32)}, cell_data={"number": numbers})
    meshio.vtu.write("plane_meshio_ascii.vtu", mesh, binary=False)
    meshio.write("plane_meshio_default.vtu", mesh)
    for compression in [None, "lzma"]:
        meshio.vtu.write(f"plane_meshio_{compression or 'none'}.vtu", mesh, compression=compression)


{"vtk": by_vtk, "meshio": by_meshio}[sys.argv[1]]()
