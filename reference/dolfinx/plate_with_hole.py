"""A square plate with a round hole in tension: smooth but for the free corners, which are weakly singular.

Body: a quarter of the square |x|, |y| < 3/2 without the disc of radius 1, symmetric about both axes (u_y = 0 on the x axis, u_x = 0
on the y axis); plane stress, E = 1, nu = 0.3. Load: tension 1 along x on the edge x = 3/2; the edge y = 3/2 and the hole are free.
Where an axis meets an edge or the hole the solution continues by reflection and is analytic. At the free corner (3/2, 3/2) it holds
r^z, z the root of sin(z pi/2) + z = 0 with Re z = 2.7396 (Williams): "regularity" below, the order of the energy norm on uniform
meshes, and of the displacement of that corner (kind "corner").

Values: displacements and stresses at points, the energy, tractions on the circle r = 5/4, the force through the part of the cut
on the x axis inside that circle. Quadrilaterals of degree 8 graded toward the corner, geometry of degree 8 through points of the
body; the error of each value is its largest difference from degree 7 and from a mesh with fewer cells, at least ROUND_OFF of the
scale of its kind.

Cost: 9 s, nearly all of it for compiling forms. Newer dolfinx: VectorElement and FiniteElement of ufl are basix.ufl.element.
"""

import cmath

import numpy as np
import ufl

import forms
import record
from converge import KINDS, MARGIN, RESOLVED, Reference, elements, third, variant
from lattice import Lattice

YOUNG, POISSON = 1.0, 0.3
LAM, MU = forms.lame(YOUNG, POISSON, plane_stress=True)
GEOMETRY, QUADRATURE = 8, 24
HALF, CUT = 1.5, 1.25
# five times what another rule of quadrature on this mesh changes, and what splines, extrapolated, find it off by; finer meshes
# and higher degrees scatter more, by 1e-9
ROUND_OFF = 3e-10
# sizes fall toward the corner, by about 3 from one cell to the next; the circle r = 5/4 meets the x axis at v = 1/2
ALONG = [0, 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 17 / 18, 53 / 54, 1]
RADIAL = [0, 1 / 12, 1 / 6, 1 / 4, 3 / 8, 1 / 2, 5 / 8, 3 / 4, 5 / 6, 17 / 18, 53 / 54, 1]
FEWER, FEWER_RADIAL = [0, 0.2, 0.4, 0.6, 0.8, 0.94, 1], [0, 1 / 8, 1 / 4, 1 / 2, 3 / 4, 0.93, 1]


def place(t):
    """u from 0 to 2 around the hole, v from the hole to the edges."""
    u, v = t
    hole = np.array([np.cos(np.pi / 4 * u), np.sin(np.pi / 4 * u)])
    edge = HALF * np.array([np.where(u < 1, 1, 2 - u), np.where(u < 1, u, 1)])
    return (1 - v) * hole + v * edge


def parameters(angle, r):
    """Parameters of a point below the diagonal by polar coordinates, by Newton's method."""
    t, target = np.array([angle * 4 / np.pi, (r - 1) / (HALF - 1)]), r * np.array([np.cos(angle), np.sin(angle)])
    for _ in range(50):
        here = place(t)
        jacobian = np.array([(place(t + d) - place(t - d)) / 2e-6 for d in 1e-6 * np.eye(2)]).T
        t = t - np.linalg.solve(jacobian, here - target)
    assert np.abs(place(t) - target).max() < 1e-14
    return t


def values(along, radial, degree):
    """Every value by its kind and quantity."""
    around = list(along) + [2 - t for t in along[-2::-1]]
    lattice = Lattice(GEOMETRY, [around, radial], place)
    msh = lattice.msh
    sides = forms.Sides(msh, [lambda x: x[1], lambda x: x[0], lambda x: x[0] - HALF], QUADRATURE)
    space = forms.space(msh, degree, 2, forms.smooth_element(msh, degree))
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.dx(metadata={"quadrature_degree": QUADRATURE})
    a = ufl.inner(forms.stress(u, LAM, MU), forms.eps(v)) * dx
    u = forms.solve(a, v[0] * sides.ds(3), [sides.fixed(space, 1, 1), sides.fixed(space, 2, 0)])
    s = forms.stress(u, LAM, MU)
    found = {("energy", "energy"): forms.number(0.5 * ufl.inner(s, forms.eps(u)) * dx)}
    both = ufl.as_vector([u[0], u[1], s[0, 0], s[1, 1], s[0, 1]])
    components = {"u.x": 0, "u.y": 1, "stress.xx": 2, "stress.yy": 3, "stress.xy": 4}
    root = np.sqrt(0.5)
    for point, t, names in [("[1, 0]", (0, 0), ["u.x", "stress.yy"]), ("[0, 1]", (2, 0), ["u.y", "stress.xx"]),
                            (f"[{root}, {root}]", (1, 0), ["u.x", "u.y"]), ("[1.5, 0]", (0, 1), ["u.x", "stress.yy"]),
                            ("[0, 1.5]", (2, 1), ["u.y", "stress.xx"]), ("[1.5, 0.75]", (0.5, 1), ["u.x", "u.y"]),
                            ("[1.5, 1.5]", (1, 1), ["u.x", "u.y"])]:
        at = lattice.at(both, t)
        for name in names:
            kind = "stress" if name[0] == "s" else "corner" if t == (1, 1) else "displacement"
            found[kind, f"{name} at {point}"] = at[components[name]]
    angle = third()
    _, _, sx, sy, sxy = lattice.at(both, parameters(angle, CUT))
    # minus the traction of the inner part, whose normal is radial
    normal, point = (np.cos(angle), np.sin(angle)), f"[{CUT * np.cos(angle)}, {CUT * np.sin(angle)}]"
    found["flux", f"interface.circle.lambda.x at {point}"] = -(sx * normal[0] + sxy * normal[1])
    found["flux", f"interface.circle.lambda.y at {point}"] = -(sxy * normal[0] + sy * normal[1])
    inside = ufl.conditional(ufl.lt(ufl.SpatialCoordinate(msh)[0], CUT), 1.0, 0.0)
    found["reaction", "reaction.inner.u0.y"] = -forms.number(inside * s[1, 1] * sides.ds(1))
    return found


def corner():
    """Re z of the root of sin(z pi / 2) + z = 0 beside 2.7 + 1.1 i."""
    z = 2.7 + 1.1j
    for _ in range(30):
        z -= (cmath.sin(z * cmath.pi / 2) + z) / (cmath.pi / 2 * cmath.cos(z * cmath.pi / 2) + 1)
    return z.real


def variants():
    """One body by NURBS and by Lagrange cells; two bodies, tied along r = 5/4, by NURBS inside and Lagrange cells outside."""
    level = lambda n: elements(plate=[2 * n, n])
    found = []
    for p in 2, 3, 4:
        sets = [f"discretization.degree={p}", "discretization.extra_points=2"]
        levels = [level(n) for n in (4, 8, 16, 32)[:4 if p == 2 else 3]]
        found.append(variant(f"IGA {p}", "plate-with-hole", p, sets, levels, nested=True, kinds=KINDS + ["corner"]))
    for p in 1, 2, 3:
        levels = [level(n) for n in ((4, 8, 16, 32) if p < 3 else (4, 8, 16))]
        sets = [f"discretization.degree={p}", "discretization.backend=fe"]
        found.append(variant(f"FE {p}, quadrilaterals", "plate-with-hole", p, sets, levels, kinds=KINDS + ["corner"]))
        found.append(variant(f"FE {p}, triangles", "plate-with-hole", p, sets + ["discretization.cells=simplex"], levels,
                             kinds=KINDS + ["corner"]))
        sets = sets + ["discretization.mapping=exact", "discretization.extra_points=2"]
        found.append(variant(f"FE {p}, quadrilaterals, exact map", "plate-with-hole", p, sets, levels, nested=True,
                             kinds=KINDS + ["corner"]))
    for p in 2, 3:
        for multiplier, degree, loss in ("p/p", p, 0.0), ("p/p-2", p - 2, 0.5):
            sets = [f"discretization.degree={p}", f"interface.circle.multiplier={multiplier}"]
            levels = [elements(inner=[8 * n, 2 * n], outer=[6 * n, 2 * n]) for n in (1, 2, 4, 8)[:4 if p == 2 else 3]]
            found.append(variant(f"IGA {p} on FE {p}, multiplier {multiplier}", "plate-with-hole-tied", p, sets, levels,
                                 multiplier=degree, loss=loss, kinds=KINDS + ["corner", "flux", "reaction"]))
    return found


def main():
    fine, coarse, lower = values(ALONG, RADIAL, 8), values(FEWER, FEWER_RADIAL, 8), values(ALONG, RADIAL, 7)
    record.write("quarter of the plate |x|, |y| < 3/2 with a hole of radius 1, tension 1 on x = 3/2, plane stress",
                 margin=MARGIN, resolved=RESOLVED, regularity=corner(),
                 quantities=Reference(fine, [coarse, lower], ROUND_OFF).listed(), variants=variants())


if __name__ == "__main__":
    main()
