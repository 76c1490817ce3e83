"""W4 with dolfinx 0.5 (Debian: python3-dolfinx): finite elements on the unit square and cube, MUMPS.

Poisson: -lap u = f with u = sin(pi x) sin(pi y) (sin(pi z)), zero boundary values; elasticity: E = 1, nu = 0.3, u = (that, 0, ..), plane strain in the
plane. Triangles and tetrahedra cut squares and cubes along the diagonal from the lowest to the highest corner.
"""

import logging

logging.disable(logging.WARNING)

import dolfinx  # noqa: E402
import numpy as np  # noqa: E402
import ufl  # noqa: E402
from dolfinx import fem, mesh  # noqa: E402
from mpi4py import MPI  # noqa: E402
from petsc4py import PETSc  # noqa: E402

import measure  # noqa: E402

# dimension, cells, components, n, n of the solve
WORKLOADS = {
    "W4a": (2, mesh.CellType.triangle, 1, 256, 256),
    "W4b": (2, mesh.CellType.quadrilateral, 1, 256, 256),
    "W4c": (3, mesh.CellType.tetrahedron, 1, 30, 16),
    "W4d": (3, mesh.CellType.hexahedron, 1, 24, 24),
    "W4e": (2, mesh.CellType.triangle, 2, 256, 256),
    "W4f": (3, mesh.CellType.hexahedron, 3, 24, 24),
}


class Problem:
    def __init__(self, dimension, cells, components, n, p):
        if dimension == 2:
            self.mesh = mesh.create_unit_square(MPI.COMM_SELF, n, n, cells)
        else:
            self.mesh = mesh.create_unit_cube(MPI.COMM_SELF, n, n, n, cells)
        element = ("Lagrange", p)
        self.space = fem.VectorFunctionSpace(self.mesh, element) if components > 1 else fem.FunctionSpace(self.mesh, element)
        u, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        x = ufl.SpatialCoordinate(self.mesh)
        wave = ufl.sin(ufl.pi * x[0]) * ufl.sin(ufl.pi * x[1]) * (ufl.sin(ufl.pi * x[2]) if dimension == 3 else 1)
        if components > 1:
            lam, mu = 0.3 / (1.3 * 0.4), 1 / 2.6
            stress = lambda w: lam * ufl.div(w) * ufl.Identity(dimension) + 2 * mu * ufl.sym(ufl.grad(w))  # noqa: E731
            self.exact = ufl.as_vector([wave] + [0] * (components - 1))
            a, source = ufl.inner(stress(u), ufl.sym(ufl.grad(v))), -ufl.div(stress(self.exact))
        else:
            self.exact = wave
            a, source = ufl.inner(ufl.grad(u), ufl.grad(v)), -ufl.div(ufl.grad(wave))
        # the degree that integrates the matrix exactly: gradients of P_p on simplices, of Q_p on tensor cells
        simplex = cells in (mesh.CellType.triangle, mesh.CellType.tetrahedron)
        self.form = fem.form(a * ufl.dx(metadata={"quadrature_degree": 2 * p - 2 if simplex else 2 * p}))
        self.load = fem.form(ufl.inner(source, v) * ufl.dx(metadata={"quadrature_degree": 2 * p + 2}))
        dim = dimension - 1
        edge = mesh.locate_entities_boundary(self.mesh, dim, lambda x: np.full(x.shape[1], True))
        zero = np.zeros(components) if components > 1 else 0.0
        self.fixed = [fem.dirichletbc(PETSc.ScalarType(zero), fem.locate_dofs_topological(self.space, dim, edge), self.space)]

    def first(self):
        matrix = fem.petsc.create_matrix(self.form)
        return self.again(matrix)

    def again(self, matrix):
        matrix.zeroEntries()
        fem.petsc.assemble_matrix(matrix, self.form)
        matrix.assemble()
        return matrix

    def system(self):
        matrix = fem.petsc.assemble_matrix(self.form, bcs=self.fixed)
        matrix.assemble()
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        b = fem.petsc.assemble_vector(self.load)
        fem.petsc.apply_lifting(b, [self.form], [self.fixed])
        fem.petsc.set_bc(b, self.fixed)
        return matrix, b

    def solve(self, matrix, b):
        solver = PETSc.KSP().create(MPI.COMM_SELF)
        solver.setOperators(matrix)
        solver.setType("preonly")
        solver.getPC().setType("cholesky")
        solver.getPC().setFactorSolverType("mumps")
        u = fem.Function(self.space)
        solver.solve(b, u.vector)
        return u

    def error(self, u):
        dx = ufl.dx(metadata={"quadrature_degree": 8})
        square = lambda w: fem.assemble_scalar(fem.form(ufl.inner(w, w) * dx))  # noqa: E731
        return float(np.sqrt(square(u - self.exact) / square(self.exact)))


def main():
    options = measure.arguments()
    if options.name not in WORKLOADS:
        raise SystemExit(f"dolfinx runs {', '.join(WORKLOADS)}")
    dimension, cells, components, n, n_solve = WORKLOADS[options.name]
    p, n_solve = options.p or 2, options.n or n_solve
    n = options.n or n
    problem = Problem(dimension, cells, components, n, p)
    first, first_cpu, matrix = measure.timed(problem.first, options.reps)
    again, again_cpu, _ = measure.timed(lambda: problem.again(matrix), options.reps)
    ia, _, values = matrix.getValuesCSR()
    fields = {"dofs": len(ia) - 1, "nnz": len(values), "assemble_s": first, "assemble_cpu_s": first_cpu, "assemble_again_s": again,
              "assemble_again_cpu_s": again_cpu,
              "fp_trace": matrix.getDiagonal().sum(), "fp_fro": float(np.linalg.norm(values)), "solve_s": None, "solve_cpu_s": None, "error": None}
    if not options.nosolve:
        smaller = problem if n_solve == n else Problem(dimension, cells, components, n_solve, p)
        matrix, b = smaller.system()
        fields["solve_s"], fields["solve_cpu_s"], u = measure.timed(lambda: smaller.solve(matrix, b), options.reps)
        fields["error"] = smaller.error(u)
        if n_solve != n:
            fields["notes"] = f"solve and error at n = {n_solve}"
    measure.line("dolfinx", dolfinx.__version__, options, p, n, **fields)


main()
