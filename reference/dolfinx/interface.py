"""Two materials that meet on an arc, a load without rotational symmetry: one body here, two tied bodies in our cases.

Geometry   quarter ring 0.5 < r < 2 in x, y > 0; the materials meet at r = 1.
elasticity plane strain; inside E = 10, nu = 0.3, outside E = 1, nu = 0.35. u_y = 0 on y = 0, u_x = 0 on x = 0, the bore free,
           traction (x/2, -(y/2)^3/4) at r = 2.
poisson    conductivity 10 inside, 1 outside, source x, u = 0 on x = 0, flux k du/dn = x/2 + (x/2)^3 at r = 2, no flux elsewhere.
Computed   energy 1/2 a(u,u); displacement or u in both parts; stress or flux of both sides at the arc; minus the traction
           sigma n, or flux k du/dn, of the inner part at the arc (n outwards), which the multiplier is.
           All data are symmetric to the planes, so the solution is smooth in each part.
Method     quadrilaterals of degree 7 and 9 whose sides are arcs to that degree. Error: the difference of both runs.
Cost       about 15 s, most of it compiling.
Newer      dolfinx renames fem.FunctionSpace to functionspace; its elements come from basix.ufl.
"""

import numpy as np
import ufl

import forms
import graded
import record

RADII = [0.5, 0.62, 0.79, 1.0, 1.26, 1.59, 2.0]  # of the layers of cells; the first half is inside
AROUND = 6
DEGREES = [7, 9]
MARGIN = 0.25  # of observed orders: meshes of 48 elements along the arc are not yet asymptotic, and points lie anywhere in elements
LEAST = 2e-11  # round-off, of the largest value of a kind
INNER = [(0.45, 0.6), (0.6, 0.45), (0.3, 0.4)]
OUTER = [(0.9, 1.2), (1.2, 0.9), (1.2, 1.6)]
# spread over the arc by the golden ratio: no mesh has all of them at the same places of its elements
GOLDEN = (np.sqrt(5.0) - 1) / 2
ARC = [(float(np.cos(t)), float(np.sin(t))) for t in np.pi / 2 * 0.85 * (np.arange(1, 17) * GOLDEN % 1)]


class Ring:
    """A mesh of degree g and the material number of its cells."""

    def __init__(self, g):
        layers = len(RADII) - 1
        rows, columns = np.arange(layers * g + 1), np.arange(AROUND * g + 1)
        radius = np.interp(rows, np.arange(layers + 1) * g, RADII)
        angle = np.pi / 2 * columns / (AROUND * g)
        r, t = np.meshgrid(radius, angle, indexing="ij")
        points = np.stack([(r * np.cos(t)).ravel(), (r * np.sin(t)).ravel()], 1)
        points[np.abs(points) < 1e-15] = 0.0
        inside = [(a, b) for b in range(g + 1) for a in range(g + 1)]
        self.cells = [(k, c) for k in range(layers) for c in range(AROUND)]
        cells = [[(k * g + b) * len(columns) + c * g + a for a, b in inside] for k, c in self.cells]
        self.msh = forms.mesh_of("quadrilateral", g, points, np.array(cells), np.array(inside) / g)
        self.outer = [2 * k >= len(RADII) - 1 for k, _ in self.cells]

    def material(self, inner, outer):
        return forms.per_cell(self.msh, [outer if o else inner for o in self.outer])

    def table(self, expression, components, points, outer=None):
        """Named components at points; of one part, where a point lies on the arc."""
        where = "" if outer is None else " in outer" if outer else " in inner"
        values = forms.at_all(expression, self.msh, [self.locate(x, outer) for x in points])
        return [(f"{name} at [{x[0]}, {x[1]}]{where}", v[k]) for name, k in components for x, v in zip(points, values)]

    def locate(self, x, outer):
        r, t = np.hypot(*x), np.arctan2(x[1], x[0]) / (np.pi / 2) * AROUND
        for number, (k, c) in enumerate(self.cells):
            s = np.array([t - c, (r - RADII[k]) / (RADII[k + 1] - RADII[k])])
            if (np.abs(s - 0.5) <= 0.5 + 1e-12).all() and outer in (None, self.outer[number]):
                return number, np.clip(s, 0.0, 1.0)
        raise ValueError(f"no cell holds {x}")

    def sides(self, degree):
        return forms.Sides(self.msh, [lambda x: x[1], lambda x: x[0], lambda x: np.hypot(x[0], x[1]) - RADII[-1]], degree)


def elasticity(ring, p):
    space = forms.space(ring.msh, p, 2, forms.smooth_element(ring.msh, p))
    laws = [forms.lame(10.0, 0.3), forms.lame(1.0, 0.35)]
    lam, mu = (ring.material(*pair) for pair in zip(*laws))
    q = 4 * p
    sides, x = ring.sides(q), ufl.SpatialCoordinate(ring.msh)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    a = ufl.inner(forms.stress(u, lam, mu), forms.eps(v)) * ufl.dx(metadata={"quadrature_degree": q})
    L = (x[0] / 2 * v[0] - (x[1] / 2) ** 3 / 4 * v[1]) * sides.ds(3)
    found = forms.solve(a, L, [sides.fixed(space, 1, 1), sides.fixed(space, 2, 0)])
    stress = forms.stress(found, lam, mu)
    traction = -ufl.dot(stress, x / ufl.sqrt(ufl.dot(x, x)))
    names = [("stress.xx", 0), ("stress.yy", 3), ("stress.xy", 1)]
    shift = [("u.x", 0), ("u.y", 1)]
    return [("energy", [("energy", 0.5 * forms.number(ufl.action(L, found)))]),
            ("u", ring.table(found, shift, INNER) + ring.table(found, shift, OUTER)),
            ("stress", ring.table(stress, names, ARC[::3], False) + ring.table(stress, names, ARC[::3], True)),
            ("lambda", both(ring, traction, [("interface.arc.lambda.x", 0), ("interface.arc.lambda.y", 1)]))]


def poisson(ring, p):
    space = forms.space(ring.msh, p, one=forms.smooth_element(ring.msh, p))
    k = ring.material(10.0, 1.0)
    q = 4 * p
    sides, x = ring.sides(q), ufl.SpatialCoordinate(ring.msh)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    dx = ufl.dx(metadata={"quadrature_degree": q})
    a = k * ufl.inner(ufl.grad(u), ufl.grad(v)) * dx
    L = x[0] * v * dx + (x[0] / 2 + (x[0] / 2) ** 3) * v * sides.ds(3)
    found = forms.solve(a, L, [sides.fixed(space, 2)])
    flux = k * ufl.grad(found)
    names = [("flux.x", 0), ("flux.y", 1)]
    normal = -ufl.dot(flux, x / ufl.sqrt(ufl.dot(x, x)))
    return [("energy", [("energy", 0.5 * forms.number(ufl.action(L, found)))]),
            ("u", ring.table(found, [("u", 0)], INNER) + ring.table(found, [("u", 0)], OUTER)),
            ("flux", ring.table(flux, names, ARC[::3], False) + ring.table(flux, names, ARC[::3], True)),
            ("lambda", both(ring, normal, [("interface.arc.lambda", 0)]))]


def both(ring, expression, components):
    """The mean of both sides at the arc, where the solution itself has no jump."""
    sides = [ring.table(expression, components, ARC, outer) for outer in (False, True)]
    return [(text.removesuffix(" in inner"), 0.5 * (a + b)) for (text, a), (_, b) in zip(*sides)]


def main():
    found = []
    for p in DEGREES:
        ring = Ring(p)
        found.append((elasticity(ring, p), poisson(ring, p)))
    parts = [graded.compared(coarse, fine, LEAST) for coarse, fine in zip(*found)]
    record.write(
        "two materials that meet on an arc, elasticity in plane strain and Poisson; loads without rotational symmetry",
        tolerance=1e-8,  # a stress that all but vanishes at its point carries the round-off of those beside it
        degrees=DEGREES,
        margin=MARGIN,
        elasticity={"case": "interface-elasticity", **parts[0]},
        poisson={"case": "interface-poisson", **parts[1]},
    )


if __name__ == "__main__":
    main()
