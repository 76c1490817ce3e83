"""A thick ring under a pressure that varies around its bore: a smooth problem.

Body: the quarter of the ring 2 < r < 3 between the x axis (u_y = 0) and the y axis (u_x = 0); plane strain, E = 1, nu = 0.3.
Load: pressure 1 + cos(2 theta)/2 + cos(4 theta) on r = 2; r = 3 is free. Both axes are planes of symmetry of the
whole ring, so the solution is analytic up to the corners.

Values: displacements and stresses at points, the energy, tractions on r = 5/2, the force through half of the cut on the x
axis. Quadrilaterals of degree 8, geometry of degree 8 through points of the ring; the error of each value is its largest
difference from three quarters of the cells per direction and from degree 7, at least ROUND_OFF of the scale of its kind.

The same program with a constant pressure must give Lame's solution, and with the one above also Michell's, both to CHECKED:
for each wave Airy's function is (a r^(n+2) + b r^n + c r^-n + d r^(2-n)) cos(n theta).

Cost: 11 s, nearly all of it for compiling forms. Newer dolfinx: VectorElement and FiniteElement of ufl are basix.ufl.element.
"""

import numpy as np
import ufl
from dolfinx import fem

import forms
import record
from converge import KINDS, MARGIN, RESOLVED, Reference, elements, third, variant
from lattice import Lattice

YOUNG, POISSON = 1.0, 0.3
LAM, MU = forms.lame(YOUNG, POISSON)
GEOMETRY, QUADRATURE = 8, 22
FINE, COARSE = (16, 16), (12, 12)
ROUND_OFF, CHECKED = 5e-11, 1e-9
BORE, RIM, CUT = 2.0, 3.0, 2.5
# amplitude of cos(n theta) by n
LOAD = {0: 1.0, 2: 0.5, 4: 1.0}


def polar(t):
    angle, r = t
    return r * np.cos(angle), r * np.sin(angle)


def values(cells, degree, waves):
    """Every value by its kind and quantity; waves: amplitudes of the pressure."""
    lattice = Lattice(GEOMETRY, [np.linspace(0, np.pi / 2, cells[0] + 1), np.linspace(BORE, RIM, cells[1] + 1)], polar)
    msh = lattice.msh
    radius = lambda r: lambda x: np.hypot(x[0], x[1]) - r
    sides = forms.Sides(msh, [lambda x: x[1], lambda x: x[0], radius(BORE), radius(RIM)], QUADRATURE)
    space = forms.space(msh, degree, 2, forms.smooth_element(msh, degree))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    x, n = ufl.SpatialCoordinate(msh), ufl.FacetNormal(msh)
    p = fem.Constant(msh, [float(waves.get(k, 0.0)) for k in (0, 2, 4)])
    cos2 = (x[0] ** 2 - x[1] ** 2) / (x[0] ** 2 + x[1] ** 2)
    pressure = p[0] + p[1] * cos2 + p[2] * (2 * cos2**2 - 1)
    dx = ufl.dx(metadata={"quadrature_degree": QUADRATURE})
    a = ufl.inner(forms.stress(u, LAM, MU), forms.eps(v)) * dx
    load = -pressure * ufl.dot(n, v) * sides.ds(3)
    u = forms.solve(a, load, [sides.fixed(space, 1, 1), sides.fixed(space, 2, 0)])
    s = forms.stress(u, LAM, MU)
    found = {("energy", "energy"): forms.number(0.5 * ufl.inner(s, forms.eps(u)) * dx)}
    both = ufl.as_vector([u[0], u[1], s[0, 0], s[1, 1], s[0, 1]])
    components = {"u.x": 0, "u.y": 1, "stress.xx": 2, "stress.yy": 3, "stress.xy": 4}
    diagonal, angle_cut = 2.25 * np.sqrt(0.5), third()
    for point, angle, r, names in [("[2, 0]", 0, BORE, ["u.x", "stress.yy"]), ("[3, 0]", 0, RIM, ["u.x", "stress.yy"]),
                                   ("[0, 2]", np.pi / 2, BORE, ["u.y", "stress.xx"]), ("[0, 3]", np.pi / 2, RIM, ["u.y", "stress.xx"]),
                                   (f"[{diagonal}, {diagonal}]", np.pi / 4, 2.25, ["u.x", "u.y", "stress.xx", "stress.xy"])]:
        at = lattice.at(both, (angle, r))
        for name in names:
            found["displacement" if name[0] == "u" else "stress", f"{name} at {point}"] = at[components[name]]
    _, _, sx, sy, sxy = lattice.at(both, (angle_cut, CUT))
    # minus the traction of the inner half, whose normal is radial
    normal, place = (np.cos(angle_cut), np.sin(angle_cut)), f"[{CUT * np.cos(angle_cut)}, {CUT * np.sin(angle_cut)}]"
    found["flux", f"interface.arc.lambda.x at {place}"] = -(sx * normal[0] + sxy * normal[1])
    found["flux", f"interface.arc.lambda.y at {place}"] = -(sxy * normal[0] + sy * normal[1])
    inside = ufl.conditional(ufl.lt(x[0], CUT), 1.0, 0.0)
    found["reaction", "reaction.inner.u0.y"] = -forms.number(inside * s[1, 1] * sides.ds(1))
    return found


def exact(waves, r):
    """Radial displacement and hoop stress on the x axis."""
    # plane strain is plane stress with these constants
    nu, young = POISSON / (1 - POISSON), YOUNG / (1 - POISSON**2)
    big = waves[0] * BORE**2 / (RIM**2 - BORE**2)
    ur, hoop = big * ((1 - nu) * r + (1 + nu) * RIM**2 / r) / young, big * (1 + RIM**2 / r**2)
    for n in waves:
        if n == 0:
            continue
        powers = np.array([n + 2, n, -n, 2 - n], float)
        radial = lambda r: (powers - n**2) * r ** (powers - 2)
        shear = lambda r: n * (powers - 1) * r ** (powers - 2)
        c = np.linalg.solve([radial(BORE), radial(RIM), shear(BORE), shear(RIM)], [-waves[n], 0, 0, 0])
        ur += c @ ((powers - n**2 - nu * powers * (powers - 1)) * r ** (powers - 1) / (powers - 1)) / young
        hoop += c @ (powers * (powers - 1) * r ** (powers - 2))
    return ur, hoop


def checked(waves, found):
    for place, r in ("[2, 0]", BORE), ("[3, 0]", RIM):
        ur, hoop = exact(waves, r)
        assert abs(found["displacement", f"u.x at {place}"] - ur) < CHECKED * abs(ur)
        assert abs(found["stress", f"stress.yy at {place}"] - hoop) < CHECKED * abs(hoop)


def variants():
    """One body by NURBS and by Lagrange cells; two bodies, tied along r = 5/2, by NURBS inside and Lagrange cells outside."""
    level = lambda n: elements(ring=[2 * n, n])
    found = []
    for p in 2, 3, 4:
        sets = [f"discretization.degree={p}", "discretization.extra_points=2"]
        levels = [level(n) for n in ((4, 8, 16, 32) if p == 2 else (2, 4, 8, 16))]
        found.append(variant(f"IGA {p}", "annulus", p, sets, levels, nested=True))
    for p in 1, 2, 3:
        levels = [level(n) for n in (4, 8, 16, 32)]
        sets = [f"discretization.degree={p}", "discretization.backend=fe"]
        found.append(variant(f"FE {p}, quadrilaterals", "annulus", p, sets, levels))
        found.append(variant(f"FE {p}, triangles", "annulus", p, sets + ["discretization.cells=simplex"], levels))
        sets = sets + ["discretization.mapping=exact", "discretization.extra_points=2"]
        found.append(variant(f"FE {p}, quadrilaterals, exact map", "annulus", p, sets, levels, nested=True))
    for p, cells in (2, "tensor"), (3, "tensor"), (2, "simplex"), (3, "simplex"):
        for multiplier, degree, loss in ("p/p", p, 0.0), ("p/p-2", p - 2, 0.5):
            sets = [f"discretization.degree={p}", f"patch.outer.cells={cells}", f"interface.arc.multiplier={multiplier}"]
            levels = [elements(inner=[8 * n, 2 * n], outer=[6 * n, 2 * n]) for n in ((1, 2, 4, 8) if p == 2 else (1, 2, 4))]
            found.append(variant(f"IGA {p} on FE {p}, {cells}, multiplier {multiplier}", "annulus-tied", p, sets, levels,
                                 multiplier=degree, loss=loss, kinds=KINDS + ["flux", "reaction"]))
    return found


def main():
    checked({0: 1.0}, values(FINE, 8, {0: 1.0}))
    fine, coarse, lower = values(FINE, 8, LOAD), values(COARSE, 8, LOAD), values(FINE, 7, LOAD)
    checked(LOAD, fine)
    record.write("ring 2 < r < 3 under pressure 1 + cos(2 theta)/2 + cos(4 theta) on its bore, plane strain, a quarter of it",
                 margin=MARGIN, resolved=RESOLVED,
                 quantities=Reference(fine, [coarse, lower], ROUND_OFF).listed(), variants=variants())


if __name__ == "__main__":
    main()
