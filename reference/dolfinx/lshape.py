"""A corner of 270 degrees: a square plate with a square hole (elasticity), and an L with u = 0 at its notch (Poisson).

Geometry   (-1,1)^2 without (0,1)x(-1,0); the corner is the origin. Sides: left x = -1, top y = 1, right x = 1 (y > 0),
           bottom y = -1 (x < 0), and the notch: x = 0 (y < 0) with y = 0 (x > 0).
elasticity plane strain, E = 1, nu = 0.3: a quarter of the plate. u_x = 0 on the right, u_y = 0 at the bottom, traction (-1, 0) on
           the left, all else free. Exponent a of the displacement: least root of sin(w a) + a sin(w) = 0, w = 270 degrees.
poisson    -div grad u = 1, u = 0 on the notch and on the top, du/dn = 0 elsewhere. Exponent a = pi/w.
Computed   energy 1/2 a(u,u); displacement and stress, u and its gradient at points away from the corner; the reaction of the top,
           the integral of du/dn over it, by the residual of the discrete system.
Method     quadrilaterals of degree 8 and 10 that shrink towards the corner (a few also towards the free corner (-1,1), where
           r^2.74 enters). Error: the difference of both runs, in which the number of rings differs, too.
Cost       about 15 s, half of it compiling.
Newer      dolfinx renames fem.FunctionSpace to functionspace; its elements come from basix.ufl.
"""

import numpy as np
import ufl
from dolfinx import fem
from scipy.optimize import brentq

import forms
import graded
import record

YOUNG, POISSON = 1.0, 0.3
ANGLE = 1.5 * np.pi
FACTOR = 0.35
RUNS = [(8, 20), (10, 24)]  # degree, rings
MARGIN = 0.06  # of the rate of the energy on uniform meshes of 64 cells a unit: what the next term, of a larger exponent, still adds
LEAST = 5e-11  # round-off, of the largest value of a kind: another order of elimination changes about as much
POINTS = [(-0.5, 0.5), (-0.75, -0.75), (0.75, 0.25), (0.25, 0.8)]
FLUX_POINTS = [(-0.6, 0.3), (-0.8, -0.7), (0.7, 0.6)]


def blocks(rings):
    made = graded.Blocks(FACTOR)
    for x in (-1.0, -0.5, 0.0, 0.5):
        for y in (-1.0, -0.5, 0.0, 0.5):
            if x < 0 or y >= 0:
                square = [(x, y), (x + 0.5, y), (x + 0.5, y + 0.5), (x, y + 0.5)]
                made.add(square, {(0.0, 0.0): rings, (-1.0, 1.0): rings // 4})
    return made


def elasticity(made, msh, p):
    lam, mu = forms.lame(YOUNG, POISSON)
    space = forms.space(msh, p, 2, forms.smooth_element(msh, p))
    sides = forms.Sides(msh, [lambda x: x[0] + 1, lambda x: x[0] - 1, lambda x: x[1] + 1], 2 * p)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    a = ufl.inner(forms.stress(u, lam, mu), forms.eps(v)) * ufl.dx(metadata={"quadrature_degree": 2 * p + 4})
    L = -v[0] * sides.ds(1)
    found = forms.solve(a, L, [sides.fixed(space, 2, 0), sides.fixed(space, 3, 1)])
    values = [("energy", [("energy", 0.5 * forms.number(ufl.action(L, found)))])]
    values.append(("u", made.table(found, msh, [("u.x", 0), ("u.y", 1)], POINTS)))
    stress = [("stress.xx", 0), ("stress.yy", 3), ("stress.xy", 1)]
    values.append(("stress", made.table(forms.stress(found, lam, mu), msh, stress, FLUX_POINTS)))
    return values


def poisson(made, msh, p):
    space = forms.space(msh, p, one=forms.smooth_element(msh, p))
    # x >= 0 >= y holds on the notch and nowhere else in the body
    sides = forms.Sides(msh, [lambda x: x[1] - 1, lambda x: 1.0 - ((x[0] > -1e-14) & (x[1] < 1e-14))], 2 * p)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.dx(metadata={"quadrature_degree": 2 * p + 4})
    a, L = ufl.inner(ufl.grad(u), ufl.grad(v)) * dx, v * dx
    found = forms.solve(a, L, [sides.fixed(space, 1), sides.fixed(space, 2)])
    values = [("energy", [("energy", 0.5 * forms.number(ufl.action(L, found)))])]
    values.append(("u", made.table(found, msh, [("u", 0)], POINTS)))
    values.append(("flux", made.table(ufl.grad(found), msh, [("flux.x", 0), ("flux.y", 1)], FLUX_POINTS)))
    # a(u,w) - f(w) for a w that is 1 on the top and 0 on the notch
    residual = fem.petsc.assemble_vector(fem.form(ufl.action(a, found) - L)).array
    reaction = residual[fem.locate_dofs_topological(space, 1, sides.facets[0])].sum()
    values.append(("reaction", [("reaction", reaction)]))
    return values


def main():
    found = []
    for p, rings in RUNS:
        made = blocks(rings)
        msh = made.mesh()
        found.append((elasticity(made, msh, p), poisson(made, msh, p)))
    opening = brentq(lambda a: np.sin(ANGLE * a) + a * np.sin(ANGLE), 0.4, 0.9, xtol=1e-15)
    parts = [graded.compared(coarse, fine, LEAST) for coarse, fine in zip(*found)]
    record.write(
        "a corner of 270 degrees: plate with a square hole in plane strain, L with u = 0 at the notch (Poisson)",
        degrees=[p for p, _ in RUNS],
        margin=MARGIN,
        elasticity={"case": "lshape-elasticity", "exponent": opening, **parts[0]},
        poisson={"case": "lshape-poisson", "exponent": np.pi / ANGLE, "reaction_sides": ["corner.top", "right.top"], **parts[1]},
    )


if __name__ == "__main__":
    main()
