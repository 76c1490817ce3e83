"""Curved meshes of high order from an exact map: the nodes of every cell are equispaced in the parameters, and lie on the body."""

import itertools

import numpy as np

import forms

KINDS = {2: "quadrilateral", 3: "hexahedron"}


class Lattice:
    """A grid of cells with given breakpoints per parameter, mapped by `point`: parameters (d, n) -> places (d, n).

    msh: the mesh of dolfinx; cell(i): number of the cell of multi-index i, first index fastest.
    """

    def __init__(self, order, breakpoints, point):
        self.breakpoints = [np.asarray(b, float) for b in breakpoints]
        self.counts = [len(b) - 1 for b in self.breakpoints]
        d = len(self.counts)
        # nodes along each parameter, those that neighbours share once
        along = [np.append((b[:-1, None] + np.diff(b)[:, None] * np.arange(order) / order).ravel(), b[-1]) for b in self.breakpoints]
        grid = np.meshgrid(*along[::-1], indexing="ij")[::-1]
        points = np.array(point(np.array([g.ravel() for g in grid]))).T
        stride = np.cumprod([1] + [len(a) for a in along[:-1]])
        local = [i[::-1] for i in itertools.product(range(order + 1), repeat=d)]
        cells = [[sum((order * c + i) * s for c, i, s in zip(cell[::-1], node, stride)) for node in local]
                 for cell in itertools.product(*[range(n) for n in self.counts[::-1]])]
        self.msh = forms.mesh_of(KINDS[d], order, points, np.array(cells), np.array(local) / order)

    def cell(self, index):
        return int(sum(i * s for i, s in zip(index, np.cumprod([1] + self.counts[:-1]))))

    def at(self, expression, parameters):
        """The value at a point of the body, one-sided from the last of its cells when it lies between several."""
        index, reference = [], []
        for t, b in zip(parameters, self.breakpoints):
            i = min(int(np.searchsorted(b, t + 1e-12, side="right")) - 1, len(b) - 2)
            index.append(i)
            reference.append((t - b[i]) / (b[i + 1] - b[i]))
        return forms.at_all(expression, self.msh, [(self.cell(index), reference)])[0]
