"""Contact as bounds on single unknowns: PETSc's SNES vinewtonrsls, and the meshes and sides that contact problems share."""

import forms
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as direct
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.spatial import cKDTree

# A node is on its bound or off it: the smaller of its gap and its force, as shares of the largest ones, is round-off. Were the larger
# one as small, another machine could decide otherwise; scripts assert that it is above this, so that active sets are no matter of luck.
MARGIN = 1e-9
# Residuals that are round-off, as a share of the forces of the start.
RESIDUAL = 1e-12
NONE = -1e30  # no bound
SQUARE = np.array([[0, 0], [1, 0], [0, 1], [1, 1]], float)


def stiffness(msh, degree, young, poisson):
    """The matrix of plane strain as scipy has it, the space, and the places of its nodes; moduli are numbers or functions."""
    space = forms.space(msh, degree, 2)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    lam, mu = forms.lame(young, poisson)
    measure = ufl.dx(metadata={"quadrature_degree": 2 * degree})
    matrix = fem.petsc.assemble_matrix(fem.form(ufl.inner(forms.stress(u, lam, mu), forms.eps(v)) * measure))
    matrix.assemble()
    rows, columns, values = matrix.getValuesCSR()
    return sp.csr_matrix((values, columns, rows)), space, space.tabulate_dof_coordinates()[:, :2]


def grid(xs, ys):
    """Points and cells of a grid of rectangles, points of a cell as SQUARE has them."""
    x, y = np.meshgrid(xs, ys)
    i, j = np.meshgrid(np.arange(len(xs) - 1), np.arange(len(ys) - 1))
    first = (j * len(xs) + i).ravel()
    return np.c_[x.ravel(), y.ravel()], np.c_[first, first + 1, first + len(xs), first + len(xs) + 1]


def sized(low, high, at, least, most, growth):
    """Breakpoints of [low, high], one of them at `at`, whose distances are growth times that from `at`, between least and most."""

    def outward(length):
        if length <= 0:
            return np.zeros(1)
        t = np.linspace(0, length, 4001)
        density = 1 / np.clip(growth * t, least, most)
        count = np.r_[0, np.cumsum(np.diff(t) * (density[1:] + density[:-1]) / 2)]
        n = int(np.ceil(round(count[-1], 6)))  # a whole number is not one more by round-off
        return np.interp(np.arange(n + 1) * count[-1] / n, count, t)

    breaks = np.r_[at - outward(at - low)[:0:-1], at + outward(high - at)]
    breaks[0], breaks[-1] = low, high
    return breaks


def halved(breaks):
    return np.sort(np.r_[breaks, (breaks[1:] + breaks[:-1]) / 2])


def petsc(K):
    pointers = tuple(part.astype(np.int32) for part in (K.indptr, K.indices))
    return PETSc.Mat().createAIJ(size=K.shape, csr=(*pointers, K.data), comm=MPI.COMM_SELF)


def vector(values):
    return PETSc.Vec().createWithArray(np.array(values, float), comm=MPI.COMM_SELF)


def mumps(ksp):
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    ksp.getPC().setFactorSolverType("mumps")
    return ksp


def solved(K, f):
    """The solution of K z = f."""
    ksp, z = mumps(PETSc.KSP().create(MPI.COMM_SELF)), vector(f)
    ksp.setOperators(petsc(K))
    ksp.solve(vector(f), z)
    return z.array.copy()


def bounded(K, f, low, start, on):
    """The z >= low with K z - f >= 0 where it is on its bound and 0 elsewhere; `on` guesses where, `start` is z there.

    K is symmetric. Gives z and the forces K z - f, after it has asserted that no unknown hangs between both states."""
    z = np.array(start, float)
    z[~on] = solved(K[~on][:, ~on].tocsr(), f[~on] - K[~on][:, on] @ z[on])
    z = np.maximum(z, low)
    matrix, load, lower, x = petsc(K), vector(f), vector(low), vector(z)
    upper = lower.duplicate()
    upper.set(PETSc.INFINITY)

    def function(_, at, value):
        matrix.mult(at, value)
        value.axpy(-1, load)

    snes = PETSc.SNES().create(MPI.COMM_SELF)
    snes.setType("vinewtonrsls")
    snes.setFunction(function, load.duplicate())
    snes.setJacobian(lambda *_: None, matrix)
    snes.setVariableBounds(lower, upper)
    largest = max(np.abs(K @ z - f).max(), np.abs(f).max())
    snes.setTolerances(rtol=0, atol=RESIDUAL * largest, stol=0, max_it=100)
    mumps(snes.getKSP())
    snes.solve(None, x)
    assert snes.getConvergedReason() > 0, f"SNES ends with reason {snes.getConvergedReason()}"
    z = x.array.copy()
    force, bound = K @ z - f, low > NONE
    assert np.abs(force[~bound]).max() < 100 * RESIDUAL * largest
    gap = (z - low)[bound]
    both = np.maximum(force[bound] / force[bound].max(), gap / max(gap.max(), 1e-300))
    assert both.min() > MARGIN, f"a node is between contact and separation: {both.min():.1e}"
    return z, force


def nodes_of(breaks, degree):
    """Nodes of a side with these breakpoints: equispaced in each element."""
    inside = [breaks[:-1] + np.diff(breaks) * k / degree for k in range(degree)]
    return np.r_[np.stack(inside, 1).ravel(), breaks[-1]]


def lagrange(degree, t):
    """Values at t of the Lagrange functions of [0, 1], (degree + 1, points)."""
    nodes = np.arange(degree + 1) / degree
    others = [np.delete(nodes, i) for i in range(degree + 1)]
    return np.array([np.prod([(t - o) / (nodes[i] - o) for o in others[i]], axis=0) for i in range(degree + 1)])


def mass(breaks, degree):
    """The integrals of products of two Lagrange functions of a side."""
    t, weights = gauss(degree + 1)
    values = lagrange(degree, t)
    local = values * weights @ values.T
    n = len(breaks) - 1
    index = degree * np.arange(n)[:, None] + np.arange(degree + 1)
    data = np.diff(breaks)[:, None, None] * local
    rows, columns = np.broadcast_arrays(index[:, :, None], index[:, None, :])
    return sp.csc_matrix((data.ravel(), (rows.ravel(), columns.ravel())))


def gauss(points):
    """Points and weights on [0, 1]."""
    t, weights = np.polynomial.legendre.leggauss(points)
    return (t + 1) / 2, weights / 2


def value_at(breaks, degree, coefficients, x):
    """A function on a side by its nodal values."""
    element = min(max(int(np.searchsorted(breaks, x, side="right")) - 1, 0), len(breaks) - 2)
    t = (x - breaks[element]) / (breaks[element + 1] - breaks[element])
    return float(coefficients[degree * element:degree * (element + 1) + 1] @ lagrange(degree, np.array([t]))[:, 0])


def index_of(places, points):
    """Numbers of the nodes at points."""
    found = cKDTree(places).query(points)[1]
    assert np.abs(places[found] - points).max() < 1e-9
    return found


def estimated(first, second, third):
    """The last of three values with an error that bounds its own for orders of convergence above 3/2."""
    return {"value": float(third), "error": float(f"{max(abs(third - second), abs(third - first) / 8):.1e}")}


def ending(ends):
    """The end of the zone, between the last node that is pressed and the first that is not, of three meshes."""
    middle = [sum(pair) / 2 for pair in ends]
    found = estimated(*middle)
    found["error"] = float(f"{max(found['error'], (ends[-1][1] - ends[-1][0]) / 2):.1e}")
    return found
