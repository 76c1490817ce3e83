"""Cook's membrane, plane stress and nearly incompressible plane strain: singular where the clamped side meets the free top.

Geometry   the quadrilateral (0,0), (48,44), (48,60), (0,44), unit thickness.
Conditions u = 0 on the left x = 0; traction (0, 1/16) on the right x = 48, total 1; top and bottom free.
Laws       E = 1: nu = 1/3 in plane stress, nu = 0.49 in plane strain.
Computed   energy 1/2 a(u,u); displacement of the tip (48,60) and of the middle of the right side; stress in the middle of the
           bottom, of the top and of the body. Exponent a of the displacement in a clamped-free corner of angle w (Williams):
           least root in (0,1) of sin^2(w a) = (k+1)^2/(4 k) - a^2 sin^2(w)/k, k = 3 - 4 nu, in plane stress (3 - nu)/(1 + nu);
           108.4 degrees at (0,44), 47.5 degrees at (0,0): the least of both. The free corners on the right have r log r, as the
           load does not fit the free sides there.
Method     quadrilaterals of degree 8 and 10 that shrink towards all four corners. Error: the difference of both runs, in which
           the number of rings differs, too.
Cost       about 25 s, a third of it compiling.
Newer      dolfinx renames fem.FunctionSpace to functionspace; its elements come from basix.ufl.
"""

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc
from scipy.optimize import brentq

import forms
import graded
import record

CORNERS = np.array([[0.0, 0.0], [48.0, 44.0], [48.0, 60.0], [0.0, 44.0]])
LAWS = [("plane-stress", 1 / 3), ("plane-strain", 0.49)]
YOUNG = 1.0
# nearly square blocks
COLUMNS = [0, 0.19, 0.37, 0.54, 0.69, 0.82, 0.91, 1]
ROWS = [0, 0.25, 0.5, 0.75, 1]
FACTOR = 0.35
RUNS = [(8, 12), (10, 16)]  # degree, rings
MARGIN = 0.06  # of the rate of the energy on uniform meshes of 64 cells a side: what the next term, of a larger exponent, still adds
LEAST = 4e-10  # round-off, of the largest value of a kind: another order of elimination changes half of that at nu = 0.49
POINTS = [(48, 60), (48, 52)]
STRESS_POINTS = [(24, 22), (24, 52), (24, 37)]


def place(s, t):
    if s in (0, 1) and t in (0, 1):
        return tuple(CORNERS[[[0, 3], [1, 2]][int(s)][int(t)]])
    c = CORNERS
    return tuple(c[0] + s * (c[1] - c[0]) + t * (c[3] - c[0]) + s * t * (c[0] - c[1] + c[2] - c[3]))


def blocks(rings):
    made = graded.Blocks(FACTOR)
    for a, b in zip(COLUMNS, COLUMNS[1:]):
        for d, e in zip(ROWS, ROWS[1:]):
            made.add([place(a, d), place(b, d), place(b, e), place(a, e)], {tuple(c): rings for c in CORNERS})
    return made


class Problem:
    """The forms of one mesh, for every law."""

    def __init__(self, made, p):
        self.made, self.msh = made, made.mesh()
        self.space = forms.space(self.msh, p, 2, forms.smooth_element(self.msh, p))
        # sides of the smallest cells lie within 1e-8 of x = 0 without being on it
        self.sides = forms.Sides(self.msh, [lambda x: 1e5 * x[0], lambda x: 1e5 * (x[0] - 48)], 2 * p)
        self.law = [fem.Constant(self.msh, PETSc.ScalarType(1)) for _ in range(2)]
        u, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        self.a = ufl.inner(forms.stress(u, *self.law), forms.eps(v)) * ufl.dx(metadata={"quadrature_degree": 2 * p + 4})
        self.load = v[1] / 16 * self.sides.ds(2)

    def values(self, lam, mu):
        self.law[0].value, self.law[1].value = lam, mu
        found = forms.solve(self.a, self.load, [self.sides.fixed(self.space, 1)])
        stress = forms.stress(found, *self.law)
        components = [("stress.xx", 0), ("stress.yy", 3), ("stress.xy", 1)]
        return [("energy", [("energy", 0.5 * forms.number(ufl.action(self.load, found)))]),
                ("u", self.made.table(found, self.msh, [("u.x", 0), ("u.y", 1)], POINTS)),
                ("stress", self.made.table(stress, self.msh, components, STRESS_POINTS))]


def angle(k):
    a, b = CORNERS[(k + 1) % 4] - CORNERS[k], CORNERS[k - 1] - CORNERS[k]
    return np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b)


def exponent(kappa, w):
    """The least root in (0,1), or 1 if there is none."""

    def f(a):
        return np.sin(a * w) ** 2 - (kappa + 1) ** 2 / (4 * kappa) + (a * np.sin(w)) ** 2 / kappa

    places = np.linspace(0.01, 1.0, 100)
    for a, b in zip(places, places[1:]):
        if f(a) * f(b) < 0:
            return brentq(f, a, b, xtol=1e-15)
    return 1.0


def main():
    found = {name: [] for name, _ in LAWS}
    for p, rings in RUNS:
        problem = Problem(blocks(rings), p)
        for name, poisson in LAWS:
            found[name].append(problem.values(*forms.lame(YOUNG, poisson, name == "plane-stress")))
    parts = {}
    for name, nu in LAWS:
        kappa = (3 - nu) / (1 + nu) if name == "plane-stress" else 3 - 4 * nu
        least = min(exponent(kappa, angle(0)), exponent(kappa, angle(3)))
        sets = [f"model.assumption={name}", f"material.rubber.poisson={nu!r}"]
        parts[name] = {"case": "cook", "sets": sets, "exponent": least, **graded.compared(*found[name], LEAST)}
    problem = "Cook's membrane, plane stress and nearly incompressible plane strain"
    record.write(problem, degrees=[p for p, _ in RUNS], margin=MARGIN, **parts)


if __name__ == "__main__":
    main()
