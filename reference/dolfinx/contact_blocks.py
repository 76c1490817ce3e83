"""Two blocks of different moduli on matching meshes, as a variational inequality with bounds on relative displacements.

One half, x >= 0, plane strain: the upper block is [0, 1] x [0, 1/2] with E = 1, nu = 0.3, the lower one [0, 3/2] x [-3/4, 0] with E = 1/2,
nu = 0.2. x = 0 is a plane of symmetry (u_x = 0), the lower block's base slides (u_y = 0), a pressure q loads the top of the upper one, all
else is free. Contact without friction, linear: c x^2 + u_y(upper) - u_y(lower) is not negative on [0, 1] x {0}, c = 1/20. The zone of
contact is [0, a], a < 1; no corner is singular, only its end is, u ~ r^(3/2). The same problem is cases/contact-blocks.toml on grids that
do not match, for several q: see contact_obstacle.py.

Method: both blocks have the same nodes on [0, 1] x {0}. dolfinx assembles the matrix K of Lagrange elements of degree 3; with the opening
w = c x^2 + u_y(upper) - u_y(lower) of a pair of nodes in the place of u_y(upper), u = T z + s, the contact condition is the bound w >= 0
of unknowns of T'KT z = T'(f - K s), which PETSc SNES vinewtonrsls solves. Meshes are graded towards the end of the zone, which a coarser
mesh finds, and halved twice.

Quantities are those of case files: force and moment (about the origin) of the lower block on the upper one, energy a(u, u)/2 of both, half
width and area (between the last node that is pressed and the first that is not), pressure, its maximum, and displacement at points.
Pressure, errors and the tolerance 1e-8 are as in contact_obstacle.py. The force is q: that it arrives is asserted, to 1e-9 of it, and q is
stored with that error.
Cost: about 15 s of one core.
"""

import bounds
import forms
import numpy as np
import record
import scipy.sparse as sp
import ufl
from dolfinx import fem

C, HEIGHT, WIDTH, DEPTH = 0.05, 0.5, 1.5, 0.75
LOADS = [0.0024, 0.0026, 0.0028, 0.003]
DEGREE = 3
PRESSURE_AT = [0.03, 0.13, 0.23, 0.33]
X_AT, Y_AT = [0.25, 0.5, 0.75, 1.0], [0.0, 0.25, 0.5, 0.75, 1.0]
# sizes of the coarsest mesh: at the end of the zone, far from it, and how they grow
LEAST, MOST, GROWTH = 0.01, 1 / 6, 0.7
# the force is the load but for this share
BALANCE = 1e-9


def mesh_of(xs, wide, ys, deep):
    """Both blocks: the upper on xs and ys, the lower on wide and deep; the first cells are the upper's."""
    upper, lower = bounds.grid(xs, ys), bounds.grid(wide, deep)
    points, cells = np.r_[upper[0], lower[0]], np.r_[upper[1], lower[1] + len(upper[0])]
    return forms.mesh_of("quadrilateral", 1, points, cells, bounds.SQUARE), np.repeat([0, 1], [len(upper[1]), len(lower[1])])


def solved(xs, wide, ys, deep, degree, loads, zones):
    """Per load the quantities of one mesh, and the two nodes at the end of the zone, which `zones` guesses."""
    msh, body = mesh_of(xs, wide, ys, deep)
    young, poisson = (forms.per_cell(msh, np.array(pair)[body]) for pair in ([1.0, 0.5], [0.3, 0.2]))
    K, space, places = bounds.stiffness(msh, degree, young, poisson)
    side = forms.Sides(msh, [lambda x: x[1] - HEIGHT], 2 * degree)
    v = ufl.TestFunction(space)
    load = fem.petsc.assemble_vector(fem.form(-v[1] * side.ds(1))).array.copy()
    upper = np.zeros(len(places), bool)
    for cell in range(msh.topology.index_map(2).size_local):
        upper[space.dofmap.cell_dofs(cell)] |= body[msh.topology.original_cell_index[cell]] == 0
    nodes = bounds.nodes_of(xs, degree)
    number = {b: np.flatnonzero(upper == b) for b in (True, False)}

    def on(b, y):
        return number[b][bounds.index_of(places[number[b]], np.c_[nodes, 0 * nodes + y])]

    slave, master, top = 2 * on(True, 0) + 1, 2 * on(False, 0) + 1, 2 * on(True, HEIGHT)
    fixed = np.r_[2 * np.flatnonzero(np.abs(places[:, 0]) < 1e-9), 2 * np.flatnonzero(np.abs(places[:, 1] + DEPTH) < 1e-9) + 1]
    free = np.ones(K.shape[0], bool)
    free[fixed] = False
    gap = C * nodes**2
    change = (sp.eye(K.shape[0]) + sp.csr_matrix((np.ones(len(nodes)), (slave, master)), shape=K.shape)).tocsr()[:, free]
    shift = np.zeros(K.shape[0])
    shift[slave] = -gap
    low = np.full(K.shape[0], bounds.NONE)
    low[slave] = 0
    turned = (change.T @ K @ change).tocsr()
    for q, zone in zip(loads, zones):
        active = np.zeros(K.shape[0], bool)
        active[slave[nodes < zone]] = True
        z, forces = bounds.bounded(turned, change.T @ (q * load - K @ shift), low[free], np.zeros(len(turned.indptr) - 1), active[free])
        u = change @ z + shift
        force = (K @ u - q * load)[slave]
        opening = np.zeros(K.shape[0])
        opening[free] = z
        closed = opening[slave] == 0
        ends = nodes[closed].max(), nodes[~closed].min()
        assert ends[0] < ends[1], "one zone"
        assert abs(force.sum() - q) < BALANCE * q, "what is applied arrives"
        pressure = bounds.direct.spsolve(bounds.mass(xs, degree), force)
        found = {"contact.pad.force.y": force.sum(), "contact.pad.moment": force @ nodes, "energy": u @ (K @ u) / 2}
        of = {"pressure": pressure, "upper.x": u[slave - 1], "upper.y": u[slave], "lower.x": u[master - 1], "lower.y": u[master]}
        of["top"] = u[top + 1]
        at = {key: lambda x, v=v: bounds.value_at(xs, degree, v, x) for key, v in of.items()}
        found["contact.pad.pressure.max"] = pressure.max()
        found |= {f"contact.pad.pressure at [{x}, 0.0]": at["pressure"](x) for x in PRESSURE_AT}
        for name in ("upper", "lower"):
            for axis, places_at in (("x", X_AT), ("y", Y_AT)):
                found |= {f"u.{axis} at [{x}, 0.0] in {name}": at[f"{name}.{axis}"](x) for x in places_at}
        found |= {f"u.y at [{x}, {HEIGHT}] in upper": at["top"](x) for x in Y_AT}
        yield found, ends


def main():
    even = np.linspace(0, 1, 33), np.linspace(0, WIDTH, 49), np.linspace(0, HEIGHT, 17), np.linspace(-DEPTH, 0, 25)
    zones = [sum(ends) / 2 for _, ends in solved(*even, 1, LOADS, [0.6] * len(LOADS))]
    loads = []
    for q, zone in zip(LOADS, zones):
        meshes = []
        for level in range(3):
            xs, ys = (bounds.sized(0, end, at, LEAST, MOST, GROWTH) for end, at in ((1, zone), (HEIGHT, 0)))
            beyond, deep = bounds.sized(1, WIDTH, 1, MOST, MOST, GROWTH), bounds.sized(-DEPTH, 0, 0, LEAST, MOST, GROWTH)
            breaks = [xs, np.r_[xs, beyond[1:]], ys, deep]
            for _ in range(level):
                breaks = [bounds.halved(b) for b in breaks]
            meshes += solved(*breaks, DEGREE, [q], [sum(meshes[-1][1]) / 2 if meshes else zone])
        quantities = {name: bounds.estimated(*[found[name] for found, _ in meshes]) for name in meshes[0][0]}
        quantities["contact.pad.force.y"] = {"value": q, "error": BALANCE * q}
        quantities["contact.pad.half_width"] = quantities["contact.pad.area"] = bounds.ending([ends for _, ends in meshes])
        loads.append({"sets": [f"let.q={q}"], "quantities": [{"quantity": name, **value} for name, value in quantities.items()]})
    record.write("A block on a block of another modulus, contact without friction: bounds on relative displacements of matching nodes",
                 tolerance=1e-8, case="contact-blocks", bodies=["upper", "lower"], exponent=1.5, stationary=[], loads=loads)


if __name__ == "__main__":
    main()
