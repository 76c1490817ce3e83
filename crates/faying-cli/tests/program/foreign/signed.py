"""Signed measures of mesh files by the program each is for: .msh by Gmsh, .mesh by PyMFEM, .vtu by VTK's own shape functions.

Prints one JSON list: per file [sum, least of the cells], or null where the program is not installed.
"""
import json
import sys


def by_gmsh(path):
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    mesh = gmsh.model.mesh
    dimension, found = gmsh.model.getDimension(), []
    for kind in mesh.getElementTypes(dimension):
        points, weights = mesh.getIntegrationPoints(kind, "Gauss12")
        _, determinants, _ = mesh.getJacobians(kind, points)
        found += list(determinants.reshape(-1, len(weights)) @ weights)
    gmsh.finalize()
    return [float(sum(found)), float(min(found))]


def by_mfem(path):
    import mfem.ser as mfem

    # as it stands in the file: MFEM would turn straight cells around
    mesh = mfem.Mesh(path, 1, 0, False)
    found = []
    for k in range(mesh.GetNE()):
        map_ = mesh.GetElementTransformation(k)
        # rules of high order on simplices have weights of both signs
        kind = mesh.GetElementBaseGeometry(k)
        rule = mfem.IntRules.Get(kind, 8 if kind in (mfem.Geometry.TRIANGLE, mfem.Geometry.TETRAHEDRON) else 40)
        total = 0.0
        for q in range(rule.GetNPoints()):
            point = rule.IntPoint(q)
            map_.SetIntPoint(point)
            total += map_.Weight() * point.weight
        found.append(total)
    return [float(sum(found)), float(min(found))]


def one(path):
    try:
        return by_gmsh(path) if path.endswith(".msh") else by_mfem(path)
    except ImportError:
        return None


print(json.dumps([one(path) for path in sys.argv[1:]]))
