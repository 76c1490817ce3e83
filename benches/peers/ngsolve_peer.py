"""W4 with NGSolve (pip: ngsolve): the same problems as dolfinx_peer.py, its sparse Cholesky.

Its basis is hierarchical: trace and norm of the matrix are not those of nodal functions, so there are no fingerprints.
"""

import ngsolve
from ngsolve import (H1, BilinearForm, CoefficientFunction, GridFunction, Id, InnerProduct, Integrate, LinearForm, VectorH1, cos, div, dx,
                     grad, pi, sin, sqrt, x, y, z)
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

import measure

# dimension, quadrilaterals or hexahedra, components, n, n of the solve
WORKLOADS = {
    "W4a": (2, False, 1, 256, 256),
    "W4b": (2, True, 1, 256, 256),
    "W4c": (3, False, 1, 30, 16),
    "W4d": (3, True, 1, 24, 24),
    "W4e": (2, False, 2, 256, 256),
    "W4f": (3, True, 3, 24, 24),
}
LAM, MU = 0.3 / (1.3 * 0.4), 1 / 2.6


class Problem:
    def __init__(self, dimension, tensor, components, n, p):
        if dimension == 2:
            self.mesh = MakeStructured2DMesh(quads=tensor, nx=n, ny=n)
        else:
            self.mesh = MakeStructured3DMesh(hexes=tensor, nx=n, ny=n, nz=n)
        make = VectorH1 if components > 1 else H1
        self.space = make(self.mesh, order=p, dirichlet=".*")
        self.dimension, self.components = dimension, components
        s = [sin(pi * c) for c in (x, y, z)[:dimension]]
        c = [cos(pi * c) for c in (x, y, z)[:dimension]]
        wave = s[0] * s[1] * (s[2] if dimension == 3 else 1)
        self.exact = wave if components == 1 else CoefficientFunction((wave,) + (0,) * (components - 1))
        if components == 1:
            self.source = dimension * pi**2 * wave
        else:
            # -div sigma of (w, 0, ..): -mu lap w in its own direction, -(lam + mu) d_i d_1 w in direction i
            third = s[2] if dimension == 3 else 1
            mixed = [-s[0] * s[1] * third, c[0] * c[1] * third] + ([c[0] * s[1] * c[2]] if dimension == 3 else [])
            force = [-(LAM + MU) * pi**2 * m for m in mixed]
            force[0] += MU * dimension * pi**2 * wave
            self.source = CoefficientFunction(tuple(force))

    def form(self):
        u, v = self.space.TnT()
        a = BilinearForm(self.space, symmetric=False)
        if self.components == 1:
            a += grad(u) * grad(v) * dx
        else:
            sym = lambda w: 0.5 * (grad(w) + grad(w).trans)  # noqa: E731
            a += InnerProduct(LAM * div(u) * Id(self.dimension) + 2 * MU * sym(u), sym(v)) * dx
        return a

    def first(self):
        return self.form().Assemble()

    def solve(self, a, load):
        u = GridFunction(self.space)
        u.vec.data = a.mat.Inverse(self.space.FreeDofs(), inverse="sparsecholesky") * load.vec
        return u

    def load(self):
        v = self.space.TestFunction()
        return LinearForm(self.source * v * dx(bonus_intorder=3)).Assemble()

    def error(self, u):
        e, exact = u - self.exact, self.exact
        return sqrt(Integrate(InnerProduct(e, e), self.mesh, order=8) / Integrate(InnerProduct(exact, exact), self.mesh, order=8))


def main():
    options = measure.arguments()
    if options.name not in WORKLOADS:
        raise SystemExit(f"NGSolve runs {', '.join(WORKLOADS)}")
    dimension, tensor, components, n, n_solve = WORKLOADS[options.name]
    p, n_solve = options.p or 2, options.n or n_solve
    n = options.n or n
    problem = Problem(dimension, tensor, components, n, p)
    first, first_cpu, a = measure.timed(problem.first, options.reps)
    again, again_cpu, _ = measure.timed(a.Assemble, options.reps)
    fields = {"dofs": problem.space.ndof, "nnz": a.mat.nze, "assemble_s": first, "assemble_cpu_s": first_cpu, "assemble_again_s": again,
              "assemble_again_cpu_s": again_cpu,
              "fp_trace": None, "fp_fro": None, "solve_s": None, "solve_cpu_s": None, "error": None}
    if not options.nosolve:
        smaller = problem if n_solve == n else Problem(dimension, tensor, components, n_solve, p)
        a, load = smaller.first(), smaller.load()
        fields["solve_s"], fields["solve_cpu_s"], u = measure.timed(lambda: smaller.solve(a, load), options.reps)
        fields["error"] = float(smaller.error(u))
        if n_solve != n:
            fields["notes"] = f"solve and error at n = {n_solve}"
    measure.line("ngsolve", ngsolve.__version__, options, p, n, **fields)


main()
