"""Quadrilaterals that shrink geometrically towards corners, the same in both directions: rings of two trapezoids.

Stretched cells (a product of two graded grids) lose digits by round-off; these do not.
"""

import numpy as np

import forms
import record

REFERENCE = [(0, 0), (1, 0), (1, 1), (0, 1)]  # our order of a cell's vertices: once around


class Blocks:
    """Quadrilaterals by their four vertices, cut into rings towards one of them or not at all.

    The two sides of a block at its graded corner are cut, the two others are not: a neighbour there must fit.
    """

    def __init__(self, factor):
        self.factor, self.number, self.points, self.cells = factor, {}, [], []

    def point(self, x):
        """The number of a point: blocks that meet compute the same digits there."""
        key = tuple(float(c) + 0.0 for c in x)
        if key not in self.number:
            self.number[key] = len(self.points)
            self.points.append(np.array(x, float))
        return self.number[key]

    def add(self, vertices, rings):
        """A block with its vertices once around; `rings`: how many there are around a vertex that is a graded corner."""
        corner = [k for k, x in enumerate(vertices) if tuple(x) in rings]
        assert len(corner) <= 1, "a block is graded towards one corner"
        first = (corner + [0])[0]
        v = np.array(vertices[first:] + vertices[:first], float)

        def place(s, t):  # from the graded corner; the vertices themselves to the last digit
            if s in (0, 1) and t in (0, 1):
                return v[[[0, 3], [1, 2]][s == 1][t == 1]]
            return v[0] + s * (v[1] - v[0]) + t * (v[3] - v[0]) + s * t * (v[0] - v[1] + v[2] - v[3])

        outer = 1.0
        for _ in range(rings[tuple(v[0])] if corner else 0):
            inner = outer * self.factor
            self.cell(place, (inner, 0), (outer, 0), (outer, outer), (inner, inner))
            self.cell(place, (0, inner), (inner, inner), (outer, outer), (0, outer))
            outer = inner
        self.cell(place, (0, 0), (outer, 0), (outer, outer), (0, outer))

    def cell(self, place, *corners):
        self.cells.append([self.point(place(*c)) for c in corners])

    def mesh(self):
        return forms.mesh_of("quadrilateral", 1, np.array(self.points), np.array(self.cells), REFERENCE)

    def locate(self, x):
        """A cell that holds a point, and the point's reference coordinates there."""
        for k, cell in enumerate(self.cells):
            v = np.array([self.points[i] for i in cell])
            if (v == x).all(1).any():  # the smallest cells have too few digits for a search
                return k, np.array(REFERENCE[int(np.argmax((v == x).all(1)))], float)
            s = np.array([0.5, 0.5])
            for _ in range(30):
                a, b = s
                at = (1 - a) * (1 - b) * v[0] + a * (1 - b) * v[1] + a * b * v[2] + (1 - a) * b * v[3]
                d = np.stack([(1 - b) * (v[1] - v[0]) + b * (v[2] - v[3]), (1 - a) * (v[3] - v[0]) + a * (v[2] - v[1])], 1)
                step = np.linalg.solve(d, np.asarray(x) - at)
                s = np.clip(s + step, -0.5, 1.5)
            if np.abs(step).max() < 1e-9 and (np.abs(s - 0.5) <= 0.5 + 1e-9).all():
                return k, np.clip(s, 0.0, 1.0)
        raise ValueError(f"no cell holds {x}")

    def table(self, expression, msh, components, points):
        """Named components of an expression at points of the mesh: pairs of a quantity's text and its value."""
        values = forms.at_all(expression, msh, [self.locate(x) for x in points])
        return [(f"{name} at [{x[0]}, {x[1]}]", v[k]) for name, k in components for x, v in zip(points, values)]


def compared(coarse, fine, least):
    """Quantities with the difference of two runs as their error, by kind; round-off is `least` of a kind's largest value."""
    made = {}
    for (kind, coarser), (_, finer) in zip(coarse, fine):
        scale = least * max(abs(value) for _, value in finer)
        made[kind] = [{"quantity": text, **record.estimated(a, b, scale)} for (text, b), (_, a) in zip(finer, coarser)]
    return made
