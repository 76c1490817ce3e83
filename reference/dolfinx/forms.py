"""Meshes, forms and solutions with dolfinx 0.5; import it first: it quiets the form compiler."""

import logging

logging.disable(logging.WARNING)

import basix  # noqa: E402
import numpy as np  # noqa: E402
import ufl  # noqa: E402
from dolfinx import fem, mesh  # noqa: E402
from mpi4py import MPI  # noqa: E402
from petsc4py import PETSc  # noqa: E402

BASIX = {"triangle": basix.CellType.triangle, "quadrilateral": basix.CellType.quadrilateral,
         "tetrahedron": basix.CellType.tetrahedron, "hexahedron": basix.CellType.hexahedron}


def element(kind, dimension, degree):
    """Lagrange functions with equispaced nodes, as ours have them."""
    return ufl.FiniteElement("Lagrange", ufl.Cell(kind, geometric_dimension=dimension), degree, variant="equispaced")


def smooth_element(msh, degree):
    """Lagrange functions with nodes near those of Gauss and Lobatto: a basis whose condition stays good at a high degree."""
    return ufl.FiniteElement("Lagrange", msh.ufl_cell(), degree)


def mesh_of(kind, order, points, cells, reference):
    """A mesh of points and cells whose nodes have the given reference coordinates."""
    own = basix.create_element(basix.ElementFamily.P, BASIX[kind], order, basix.LagrangeVariant.equispaced).points
    distance = np.abs(own[:, None, :] - np.asarray(reference)[None, :, :]).max(-1)
    assert distance.min(1).max() < 1e-12
    points, cells = np.ascontiguousarray(points, float), np.ascontiguousarray(cells[:, distance.argmin(1)], np.int64)
    return mesh.create_mesh(MPI.COMM_SELF, cells, points, ufl.Mesh(ufl.VectorElement(element(kind, points.shape[1], order))))


def dolfinx_mesh(exported):
    """The mesh that the program wrote; cell k of it is cell original_cell_index[k] of the file."""
    return mesh_of(exported.kind, exported.order, exported.points, exported.cells, exported.reference)


def per_cell(msh, values):
    """A function that has values[c] in cell c of the input."""
    space = fem.FunctionSpace(msh, ("DG", 0))
    function = fem.Function(space)
    cells = np.arange(msh.topology.index_map(msh.topology.dim).size_local)
    dofs = np.array([space.dofmap.cell_dofs(c)[0] for c in cells])
    function.x.array[dofs] = np.asarray(values, float)[msh.topology.original_cell_index]
    return function


def space(msh, degree, components=0, one=None):
    """Scalar functions, or vectors of so many components; `one` is another element for each of them."""
    one = one or element(msh.ufl_cell().cellname(), msh.geometry.dim, degree)
    return fem.FunctionSpace(msh, ufl.VectorElement(one, dim=components) if components else one)


def eps(u):
    return ufl.sym(ufl.grad(u))


def lame(young, poisson, plane_stress=False):
    """lambda and mu; in plane stress the lambda of the reduced law."""
    lam, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    return (2 * lam * mu / (lam + 2 * mu) if plane_stress else lam), mu


def stress(u, lam, mu):
    return lam * ufl.tr(eps(u)) * ufl.Identity(len(u)) + 2 * mu * eps(u)


class Sides:
    """Facets by where their vertices lie: sides of a mesh as a measure ds(number) and as dofs."""

    def __init__(self, msh, where, degree):
        """where: list of functions of x, shape (3, n), that are 0 on the side; degree of the quadrature."""
        self.msh, self.dim = msh, msh.topology.dim - 1
        size = np.abs(msh.geometry.x).max()
        at = [mesh.locate_entities_boundary(msh, self.dim, lambda x, f=f: np.abs(f(x)) < 1e-9 * size) for f in where]
        facets = np.concatenate(at).astype(np.int32)
        numbers = np.repeat(np.arange(1, len(at) + 1, dtype=np.int32), [len(a) for a in at])
        order = np.argsort(facets)
        assert len(np.unique(facets)) == len(facets), "a facet lies on two sides"
        self.facets = at
        tags = mesh.meshtags(msh, self.dim, facets[order], numbers[order])
        self.ds = ufl.Measure("ds", domain=msh, subdomain_data=tags, metadata={"quadrature_degree": degree})

    def fixed(self, space, number, component=None, value=0.0):
        """The condition u = value on a side, or of one component; value: a number or a function of x."""
        facets = self.facets[number - 1]
        if component is None and not callable(value):
            zero = np.zeros(space.dofmap.index_map_bs) if space.dofmap.index_map_bs > 1 else 0.0
            return fem.dirichletbc(PETSc.ScalarType(zero + value), fem.locate_dofs_topological(space, self.dim, facets), space)
        if component is None:
            function = fem.Function(space)
            function.interpolate(value)
            return fem.dirichletbc(function, fem.locate_dofs_topological(space, self.dim, facets))
        part = space.sub(component)
        if not callable(value):
            return fem.dirichletbc(PETSc.ScalarType(value), fem.locate_dofs_topological(part, self.dim, facets), part)
        own, _ = part.collapse()
        function = fem.Function(own)
        function.interpolate(value)
        return fem.dirichletbc(function, fem.locate_dofs_topological((part, own), self.dim, facets), part)


def solve(a, L, conditions):
    """The solution by MUMPS, with one step of refinement."""
    options = {"ksp_type": "richardson", "ksp_rtol": 1e-15, "ksp_atol": 1e-300, "ksp_max_it": 2, "pc_type": "lu",
               "pc_factor_mat_solver_type": "mumps"}
    return fem.petsc.LinearProblem(a, L, bcs=conditions, petsc_options=options).solve()


def number(form):
    """The value of an integral."""
    return fem.assemble_scalar(fem.form(form))


def nodal(u):
    """Places and values of the nodes of a function, (n, dimension) and (n, components), sorted by place."""
    space, dimension = u.function_space, u.function_space.mesh.geometry.dim
    places = space.tabulate_dof_coordinates()[:, :dimension]
    values = u.x.array.reshape(len(places), -1)
    order = np.lexsort(np.round(places / np.abs(places).max(), 9).T[::-1])
    return places[order], values[order]


def at_all(expression, msh, places):
    """An expression at pairs of a cell, counted as in the input, and reference coordinates there: compiled once for all."""
    own = np.argsort(msh.topology.original_cell_index)
    cells = np.array([own[cell] for cell, _ in places], dtype=np.int32)
    found = fem.Expression(expression, np.array([s for _, s in places], float)).eval(cells)
    return [values.reshape(len(places), -1)[k] for k, values in enumerate(found)]
