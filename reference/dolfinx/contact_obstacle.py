"""A block on a rigid hill, as a variational inequality with bounds on nodal displacements.

Half a block, [0, 1] x [0, 1/2], plane strain, E = 1, nu = 0.3. Its top moves down by d and slides without friction, x = 0 is a plane of
symmetry (u_x = 0), the right side is free. Below lies the rigid hill y = -c x^2, c = 1/20, contact without friction, linear: the gap
c x^2 + u_y(x, 0) is not negative. The zone of contact is [0, a]; no corner is singular (sliding against free sides of a right angle),
only its end is, u ~ r^(3/2). The same problem is cases/contact-obstacle.toml, for several d: how far the end of the zone lies from a
node of a mesh changes errors by more than a halving does, and a mean over several d does not.

Method: Lagrange elements of degree 3, u_y >= -c x^2 at the nodes of the side, PETSc SNES vinewtonrsls. Meshes are graded towards the end
of the zone, which a coarser mesh finds, and halved twice. This is another discrete problem than any of ours: only converged numbers agree.

Quantities are those of case files: force and moment (about the origin) of the hill on the block, energy a(u, u)/2, half width and
area (between the last node that is pressed and the first that is not), pressure, its maximum, and displacement at points. The pressure is
the function of the side's space whose integrals with all nodal functions are the nodal forces. Errors: the larger of |v3 - v2| and
|v3 - v1|/8, which bounds the error of v3 for orders above 3/2 (2 and more are seen); of the end of the zone, at least half the distance
of both nodes. "stationary" names what is a minimum over all displacements: its errors are squares.

Tolerance 1e-8 for regeneration: which nodes are active is decided by margins far above round-off (asserted in bounds.py), so it does not
change from machine to machine; what is left is round-off of a direct solver on cells whose sizes differ by a factor of 60.
Cost: about 6 s of one core.
"""

import bounds
import forms
import numpy as np
import record

C, HEIGHT = 0.05, 0.5
DEPTHS = [0.018, 0.019, 0.02, 0.021]
DEGREE = 3
PRESSURE_AT = [0.03, 0.13, 0.23, 0.33]
BOTTOM_AT, TOP_AT = {"x": [0.25, 0.5, 0.75, 1.0], "y": [0.75, 1.0]}, [0.25, 0.5, 0.75, 1.0]
# sizes of the coarsest mesh: at the end of the zone, far from it, and how they grow
LEAST, MOST, GROWTH = 0.008, 1 / 8, 0.6


def solved(xs, ys, degree, depths, zones):
    """Per depth the quantities of one mesh, and the two nodes at the end of the zone, which `zones` guesses."""
    msh = forms.mesh_of("quadrilateral", 1, *bounds.grid(xs, ys), bounds.SQUARE)
    K, _, places = bounds.stiffness(msh, degree, 1.0, 0.3)
    nodes = bounds.nodes_of(xs, degree)
    bottom, top = (bounds.index_of(places, np.c_[nodes, 0 * nodes + y]) for y in (0, HEIGHT))
    free = np.ones(K.shape[0], bool)
    free[2 * np.flatnonzero(np.abs(places[:, 0]) < 1e-9)] = False
    free[2 * top + 1] = False
    inside = K[free][:, free].tocsr()
    low = np.full(K.shape[0], bounds.NONE)
    low[2 * bottom + 1] = -C * nodes**2
    for depth, zone in zip(depths, zones):
        u, on = np.zeros(K.shape[0]), np.zeros(K.shape[0], bool)
        u[2 * top + 1] = -depth
        on[2 * bottom[nodes < zone] + 1] = True
        u[free], _ = bounds.bounded(inside, -(K @ u)[free], low[free], np.where(on, low, 0)[free], on[free])
        forces = (K @ u)[2 * bottom + 1]
        closed = u[2 * bottom + 1] == low[2 * bottom + 1]
        ends = nodes[closed].max(), nodes[~closed].min()
        assert ends[0] < ends[1], "one zone"
        pressure = bounds.direct.spsolve(bounds.mass(xs, degree), forces)
        found = {"contact.hill.force.y": forces.sum(), "contact.hill.moment": forces @ nodes, "energy": u @ (K @ u) / 2}
        value = {"pressure": pressure, "x": u[2 * bottom], "y": u[2 * bottom + 1], "top": u[2 * top]}
        value = {key: lambda x, v=v: bounds.value_at(xs, degree, v, x) for key, v in value.items()}
        found["contact.hill.pressure.max"] = pressure.max()
        found |= {f"contact.hill.pressure at [{x}, 0.0]": value["pressure"](x) for x in PRESSURE_AT}
        found |= {f"u.{axis} at [{x}, 0.0]": value[axis](x) for axis, at in BOTTOM_AT.items() for x in at}
        found |= {f"u.x at [{x}, {HEIGHT}]": value["top"](x) for x in TOP_AT}
        yield found, ends


def main():
    even = np.linspace(0, 1, 33), np.linspace(0, HEIGHT, 17)
    zones = [sum(ends) / 2 for _, ends in solved(*even, 1, DEPTHS, [0.5] * len(DEPTHS))]
    loads = []
    for depth, zone in zip(DEPTHS, zones):
        meshes = []
        for level in range(3):
            xs, ys = (bounds.sized(0, end, at, LEAST, MOST, GROWTH) for end, at in ((1, zone), (HEIGHT, 0)))
            for _ in range(level):
                xs, ys = bounds.halved(xs), bounds.halved(ys)
            meshes += solved(xs, ys, DEGREE, [depth], [sum(meshes[-1][1]) / 2 if meshes else zone])
        quantities = {name: bounds.estimated(*[found[name] for found, _ in meshes]) for name in meshes[0][0]}
        quantities["contact.hill.half_width"] = quantities["contact.hill.area"] = bounds.ending([ends for _, ends in meshes])
        loads.append({"sets": [f"let.d={depth}"], "quantities": [{"quantity": name, **value} for name, value in quantities.items()]})
    record.write("A block on a rigid hill, contact without friction: bounds on nodal displacements", tolerance=1e-8,
                 case="contact-obstacle", bodies=["block"], exponent=1.5, stationary=["energy"], loads=loads)


if __name__ == "__main__":
    main()
