"""A thick tube under a pressure that varies around it and along it: a smooth problem in space.

Body: the quarter of the tube 2 < r < 3, 0 < z < 2 between the x axis (u_y = 0) and the y axis (u_x = 0), its ends held along z
(u_z = 0); E = 1, nu = 0.3. Load: pressure (1 + cos(2 theta)/2) (1 + cos(pi z/2)) on r = 2; r = 3 is free. Every plane that bounds
the body is one of symmetry of an endless tube, so the solution is analytic up to the edges.

The solution is a part of plane strain and (a cos(pi z/2), b cos(pi z/2), c sin(pi z/2)) with functions a, b, c of x and y alone, so
that its amplitudes are solved for in the plane, with quadrilaterals of degree 8 and geometry of degree 8 through points of the
ring. Values: displacements and stresses at points, the energy; the error of each is its largest difference from a mesh with
three quarters of the cells per direction and from degree 7, at least ROUND_OFF of the scale of its kind.

The same energy from cubic hexahedra in space, with no such splitting, must approach it at order 6 ("hexahedra").

Cost: 24 s, mostly for compiling forms. Newer dolfinx: VectorElement and FiniteElement of ufl are basix.ufl.element.
"""

import numpy as np
import ufl
from dolfinx import fem

import forms
import record
from converge import MARGIN, RESOLVED, Reference, elements, variant
from lattice import Lattice

YOUNG, POISSON = 1.0, 0.3
LAM, MU = forms.lame(YOUNG, POISSON)
GEOMETRY, QUADRATURE = 8, 22
FINE, COARSE = (16, 16), (12, 12)
ROUND_OFF = 5e-11
BORE, RIM, HEIGHT = 2.0, 3.0, 2.0


def ring(t):
    angle, r = t
    return r * np.cos(angle), r * np.sin(angle)


def cylinder(t):
    return *ring(t[:2]), t[2]


def around(x):
    return 1 + (x[0] ** 2 - x[1] ** 2) / (x[0] ** 2 + x[1] ** 2) / 2


def strains(u, k):
    """Amplitudes of the strains that vary as cos(k z), and of xz and yz, which vary as sin(k z)."""
    plane = [[u[0].dx(0), (u[0].dx(1) + u[1].dx(0)) / 2, 0], [(u[0].dx(1) + u[1].dx(0)) / 2, u[1].dx(1), 0], [0, 0, k * u[2]]]
    return ufl.as_matrix(plane), ufl.as_vector([(u[2].dx(0) - k * u[0]) / 2, (u[2].dx(1) - k * u[1]) / 2])


def amplitudes(cells, degree):
    """By wave number along z, 0 and pi/2: values at points of the plane, energy per length of cos^2."""
    lattice = Lattice(GEOMETRY, [np.linspace(0, np.pi / 2, cells[0] + 1), np.linspace(BORE, RIM, cells[1] + 1)], ring)
    msh = lattice.msh
    radius = lambda x: np.hypot(x[0], x[1]) - BORE
    sides = forms.Sides(msh, [lambda x: x[1], lambda x: x[0], radius], QUADRATURE)
    space = forms.space(msh, degree, 3, forms.smooth_element(msh, degree))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    x, n, k = ufl.SpatialCoordinate(msh), ufl.FacetNormal(msh), fem.Constant(msh, 0.0)
    dx = ufl.dx(metadata={"quadrature_degree": QUADRATURE})
    law = lambda e: LAM * ufl.tr(e) * ufl.Identity(3) + 2 * MU * e
    work = lambda u, v: ufl.inner(law(strains(u, k)[0]), strains(v, k)[0]) + 4 * MU * ufl.inner(strains(u, k)[1], strains(v, k)[1])
    load = -around(x) * (n[0] * v[0] + n[1] * v[1]) * sides.ds(3)
    supports = [sides.fixed(space, 1, 1), sides.fixed(space, 2, 0)]
    found = {}
    points = {"bore x": (0, BORE), "bore y": (np.pi / 2, BORE), "rim x": (0, RIM), "rim y": (np.pi / 2, RIM),
              "inside": (np.pi / 4, 2.25)}
    for wave in 0.0, np.pi / HEIGHT:
        k.value = wave
        # plane strain leaves c as any constant
        w = forms.solve(work(u, v) * dx, load, supports + ([sides.fixed(space, 1, 2)] if wave == 0 else []))
        s, t = law(strains(w, k)[0]), 2 * MU * strains(w, k)[1]
        both = ufl.as_vector([w[0], w[1], w[2], s[0, 0], s[1, 1], s[2, 2], s[0, 1], t[0], t[1]])
        found[wave] = {name: lattice.at(both, t) for name, t in points.items()}
        found[wave]["energy"] = forms.number(0.5 * work(w, w) * dx)
    return found


COMPONENTS = {"u.x": 0, "u.y": 1, "u.z": 2, "stress.xx": 3, "stress.yy": 4, "stress.zz": 5, "stress.xy": 6, "stress.xz": 7, "stress.yz": 8}
ODD = {"u.z", "stress.xz", "stress.yz"}


def values(cells, degree):
    """Every value by its kind and quantity."""
    parts = amplitudes(cells, degree)

    def at(name, component, z):
        shape = lambda k: np.sin(k * z) if component in ODD else np.cos(k * z)
        return sum(part[name][COMPONENTS[component]] * shape(k) for k, part in parts.items())

    # the mean square of the cosine over the height is 1/2
    found = {("energy", "energy"): sum(part["energy"] * HEIGHT * (1.0 if k == 0 else 0.5) for k, part in parts.items())}
    diagonal = 2.25 * np.sqrt(0.5)
    for point, name, z, components in [("[2, 0, 0]", "bore x", 0, ["u.x", "stress.yy", "stress.zz"]),
                                       ("[0, 2, 2]", "bore y", 2, ["u.y", "stress.zz"]),
                                       ("[3, 0, 1]", "rim x", 1, ["u.x", "u.z", "stress.yy"]),
                                       ("[0, 3, 0]", "rim y", 0, ["u.y", "stress.xx"]),
                                       (f"[{diagonal}, {diagonal}, 1]", "inside", 1, ["u.x", "u.z"])]:
        for c in components:
            found["displacement" if c[0] == "u" else "stress", f"{c} at {point}"] = at(name, c, z)
    return found


def hexahedra(n):
    """The energy by cubic hexahedra in space, 2 n, n and n of them."""
    lattice = Lattice(3, [np.linspace(0, np.pi / 2, 2 * n + 1), np.linspace(BORE, RIM, n + 1), np.linspace(0, HEIGHT, n + 1)], cylinder)
    msh = lattice.msh
    sides = forms.Sides(msh, [lambda x: x[1], lambda x: x[0], lambda x: np.hypot(x[0], x[1]) - BORE, lambda x: x[2],
                             lambda x: x[2] - HEIGHT], 10)
    space = forms.space(msh, 3, 3)
    u, v, x = ufl.TrialFunction(space), ufl.TestFunction(space), ufl.SpatialCoordinate(msh)
    dx = ufl.dx(metadata={"quadrature_degree": 8})
    load = -around(x) * (1 + ufl.cos(np.pi * x[2] / HEIGHT)) * ufl.dot(ufl.FacetNormal(msh), v) * sides.ds(3)
    a = ufl.inner(forms.stress(u, LAM, MU), forms.eps(v)) * dx
    supports = [sides.fixed(space, 1, 1), sides.fixed(space, 2, 0), sides.fixed(space, 4, 2), sides.fixed(space, 5, 2)]
    # the energy of the solution is half the work of the load
    return forms.number(0.5 * ufl.action(load, forms.solve(a, load, supports)))


def variants():
    """The body by NURBS, hexahedra and tetrahedra."""
    level = lambda n: elements(tube=[2 * n, n, n])
    found = []
    for p in 2, 3:
        sets = [f"discretization.degree={p}", "discretization.extra_points=2"]
        found.append(variant(f"IGA {p}", "tube", p, sets, [level(n) for n in (2, 4, 8)], nested=True))
    for p in 1, 2, 3:
        levels = [level(n) for n in ((2, 4, 8) if p == 1 else (1, 2, 4))]
        sets = [f"discretization.degree={p}", "discretization.backend=fe"]
        found.append(variant(f"FE {p}, hexahedra", "tube", p, sets, levels))
        if p == 2:
            found.append(variant(f"FE {p}, tetrahedra", "tube", p, sets + ["discretization.cells=simplex"],
                                 [level(n) for n in (2, 4, 8)]))
            sets = sets + ["discretization.mapping=exact", "discretization.extra_points=2"]
            found.append(variant(f"FE {p}, hexahedra, exact map", "tube", p, sets, levels, nested=True))
    return found


def main():
    fine, coarse, lower = values(FINE, 8), values(COARSE, 8), values(FINE, 7)
    energy = fine["energy", "energy"]
    errors = [energy - hexahedra(n) for n in (2, 4)]
    print("hexahedra:", errors)
    # another limit than the energy above would show as another order
    assert abs(np.log2(errors[0] / errors[1]) - 6) < MARGIN
    record.write("quarter of the tube 2 < r < 3, 0 < z < 2 under pressure (1 + cos(2 theta)/2) (1 + cos(pi z/2)) inside, ends held along z",
                 margin=MARGIN, resolved=RESOLVED, quantities=Reference(fine, [coarse, lower], ROUND_OFF).listed(), variants=variants())


if __name__ == "__main__":
    main()
