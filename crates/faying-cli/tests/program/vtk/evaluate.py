"""Prints what VTK finds in a .vtu file: for every cell and local point the position and the point data, one line each.

Arguments: the file, then local points as r,s. Output lines: cell r s x y z NAME value ... NAME value ...
"""
import sys

from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
points = [[float(v) for v in word.split(",")] for word in sys.argv[2:]]
data = grid.GetPointData()
names = [data.GetArrayName(i) for i in range(data.GetNumberOfArrays()) if data.GetArrayName(i) != "RationalWeights"]
print("cells", grid.GetNumberOfCells())
for c in range(grid.GetNumberOfCells()):
    for r, s in points:
        cell = grid.GetCell(c)
        n = cell.GetNumberOfPoints()
        x, weights = [0.0] * 3, [0.0] * n
        cell.EvaluateLocation(reference(0), [r, s, 0.0], x, weights)
        cell.InterpolateFunctions([r, s, 0.0], weights)
        line = [str(c), repr(r), repr(s)] + [repr(v) for v in x]
        for name in names:
            array = data.GetArray(name)
            values = [0.0] * array.GetNumberOfComponents()
            for a in range(n):
                tuple_ = array.GetTuple(cell.GetPointId(a))
                for k, v in enumerate(tuple_):
                    values[k] += weights[a] * v
            line += [name] + [repr(v) for v in values]
        print(" ".join(line))
