"""Prints the signed measure that VTK's own maps give every cell of a .vtu file, and the least Jacobian determinant that was met.

Argument: the file. Output lines: cell measure least. Positions are those of EvaluateLocation on Gauss points of the unit cube (collapsed
to the simplex), differentiated as the polynomials through them: exact for polynomial cells, to rounding for rational ones of a small part of a turn.
"""
import math
import sys

from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

SIMPLICES = {5, 10, 69, 71, 76, 78}
RATIONAL = 9


def gauss(n):
    nodes, weights = [], []
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        for _ in range(50):
            p, q = 1.0, 0.0
            for k in range(n):
                p, q = ((2 * k + 1) * x * p - k * q) / (k + 1), p
            slope = n * (x * p - q) / (x * x - 1)
            x -= p / slope
        nodes.append(0.5 - 0.5 * x)
        weights.append(1 / ((1 - x * x) * slope * slope))
    return nodes, weights


def derivatives(nodes):
    n = len(nodes)
    scale = [math.prod(nodes[i] - nodes[k] for k in range(n) if k != i) for i in range(n)]
    matrix = [[scale[i] / scale[j] / (nodes[i] - nodes[j]) if i != j else 0.0 for j in range(n)] for i in range(n)]
    for i in range(n):
        matrix[i][i] = -sum(matrix[i])
    return matrix


def determinant(a):
    if len(a) == 2:
        return a[0][0] * a[1][1] - a[0][1] * a[1][0]
    return sum(a[0][k] * (a[1][(k + 1) % 3] * a[2][(k + 2) % 3] - a[1][(k + 2) % 3] * a[2][(k + 1) % 3]) for k in range(3))


def measured(cell, degrees, rational):
    d = cell.GetCellDimension()
    simplex = cell.GetCellType() in SIMPLICES
    most = [max(degrees)] * d if simplex else degrees[:d]
    counts = [RATIONAL if rational else int(p) + 1 for p in most]
    axes = [gauss(n) for n in counts]
    slopes = [derivatives(nodes) for nodes, _ in axes]
    weights, x = [0.0] * cell.GetNumberOfPoints(), {}
    places = [()]
    for n in counts:
        places = [a + (i,) for a in places for i in range(n)]
    for a in places:
        point, left = [0.0] * 3, 1.0
        for k in range(d):
            point[k] = axes[k][0][a[k]] * left
            left *= 1 - axes[k][0][a[k]] if simplex else 1.0
        found = [0.0] * 3
        cell.EvaluateLocation(reference(0), point, found, weights)
        x[a] = found
    total, least = 0.0, math.inf
    for a in places:
        jacobian = []
        for k in range(d):
            row = slopes[k][a[k]]
            line = [x[a[:k] + (i,) + a[k + 1:]] for i in range(counts[k])]
            jacobian.append([sum(w * y[c] for w, y in zip(row, line)) for c in range(d)])
        det = determinant(jacobian)
        total += det * math.prod(axes[k][1][a[k]] for k in range(d))
        least = min(least, det)
    return total, least


reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
order = grid.GetCellData().GetArray("HigherOrderDegrees")
weights = grid.GetPointData().GetArray("RationalWeights")
for c in range(grid.GetNumberOfCells()):
    cell = grid.GetCell(c)
    high = cell.GetCellType() >= 68
    degrees = [p for p in order.GetTuple(c)] if high else [1, 1, 1]
    own = [weights.GetValue(cell.GetPointId(a)) for a in range(cell.GetNumberOfPoints())] if weights else [1.0]
    print(c, *map(repr, measured(cell, degrees, max(own) - min(own) > 1e-13 * max(own))))
