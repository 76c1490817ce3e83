"""Contact on one mesh: the discrete problems of our multipliers and cones, turned into bounds on single unknowns.

The problems are those of contact_obstacle.py and contact_blocks.py on the coarse meshes of cases/contact-obstacle.toml and
cases/contact-blocks.toml, which the program writes: rectangles with Lagrange functions of degree p. Rows of a multiplier space psi_j on the
slave side are

    r_j(u) = integral psi_j (u_s - u_m) . n + integral psi_j g,    n out of the master, g the gap,

and lambda = sum lambda_j psi_j. A discrete cone is lambda = T mu, mu <= 0, T'r >= 0, mu . T'r = 0:
  "coefficients": T = 1;   "weights": T = G^-1, G the Gram matrix of psi;   "values": T = V^-1, V_ij = psi_j at Greville's point i.
The minimum of energy under T'r >= 0 is asked for; with A = T'C_s on the n slave nodes and A' = Q1 R (QR), the change of variables

    u_s = Q1 R'^-1 (w - T'(g + C_m u_m)) + Q2 y

makes w = T'r unknowns, w >= 0 their bounds, and -mu the forces on them: PETSc SNES vinewtonrsls answers, as in bounds.py. All of
C, g, G, V are integrated here, on the common breakpoints of both sides; nothing but the mesh is taken from the program.

Multipliers: p/p and p/p-2 are Bernstein polynomials, continuous and discontinuous; dual (p = 1) is biorthogonal to the hats. So are the
functions of the program: coefficients enter the first cone. The pressure of dual multipliers is read through the hats, sum lambda_j N_j,
which have the integrals of psi_j and do not oscillate: so does the program. What agrees is everything: energy, force, moment, number of active functions,
displacements at nodes, pressure at points, to "agreement" of the largest value of a kind; differences are round-off, of matrices whose
condition is below 1e6.

Regeneration tolerance: 1e-9, the general one; the active set is decided by margins above it (asserted in bounds.py).
Cost: about 15 s of one core, most of it for compiling forms of degrees 1 to 3.
"""

import bounds
import exported
import forms
import numpy as np
import record
import scipy.sparse as sp
from math import comb
from scipy.linalg import qr, solve_triangular

C = 0.05
AGREEMENT = 1e-9
PRESSURE_AT = [0.03, 0.21, 0.33, 0.47]


def bernstein(degree, t):
    return np.array([comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(degree + 1)])


class Multipliers:
    """Functions of a multiplier space on breakpoints: per element their numbers and their values."""

    def __init__(self, breaks, degree, pairing):
        n = len(breaks) - 1
        self.breaks, self.dual = breaks, pairing == "dual"
        self.degree = degree - 2 if pairing == "p/p-2" else degree
        joined = pairing != "p/p-2"
        stride = self.degree if joined else self.degree + 1
        self.index = stride * np.arange(n)[:, None] + np.arange(self.degree + 1)
        self.count = self.index.max() + 1

    def values(self, t):
        # biorthogonal to 1 - t and t
        return np.array([2 - 3 * t, 3 * t - 1]) if self.dual else bernstein(self.degree, t)

    def greville(self):
        """Greville's points of the functions: of Bernstein polynomials equispaced, the middle for constants."""
        t = np.arange(self.degree + 1) / self.degree if self.degree else np.array([0.5])
        points = np.empty(self.count)
        points[self.index] = self.breaks[:-1, None] + np.diff(self.breaks)[:, None] * t
        return points

    def at(self, points):
        """Values at points of the side of what the pressure is read through, (points, functions)."""
        found = np.zeros((len(points), self.count))
        for row, x in enumerate(points):
            e, t = local(self.breaks, x)
            found[row, self.index[e]] = bernstein(self.degree, t)
        return found


def local(breaks, x):
    e = min(max(int(np.searchsorted(breaks, x, side="right")) - 1, 0), len(breaks) - 2)
    return e, (x - breaks[e]) / (breaks[e + 1] - breaks[e])


def integrals(space, sides, degree, reach):
    """Integrals over [0, reach]: psi_j times the nodal functions of each of the sides, times the gap, and psi_j psi_i."""
    cuts = np.unique(np.r_[space.breaks, *sides].round(12))
    cuts = cuts[cuts <= reach + 1e-9]
    t, weights = bounds.gauss(degree + 3)
    rows = [np.zeros((space.count, degree * (len(s) - 1) + 1)) for s in sides]
    gap, gram = np.zeros(space.count), np.zeros((space.count, space.count))
    for a, b in zip(cuts[:-1], cuts[1:]):
        e = local(space.breaks, (a + b) / 2)[0]
        x = a + (b - a) * t
        psi = space.values((x - space.breaks[e]) / (space.breaks[e + 1] - space.breaks[e])) * weights * (b - a)
        on = space.index[e]
        gap[on] += psi @ (C * x**2)
        gram[np.ix_(on, on)] += psi @ space.values((x - space.breaks[e]) / (space.breaks[e + 1] - space.breaks[e])).T
        for row, side in zip(rows, sides):
            f = local(side, (a + b) / 2)[0]
            nodes = degree * f + np.arange(degree + 1)
            row[np.ix_(on, nodes)] += psi @ bounds.lagrange(degree, (x - side[f]) / (side[f + 1] - side[f])).T
    return rows, gap, gram


class Problem:
    """The mesh of a case, its matrix and loads."""

    def __init__(self, case, degree):
        mesh = exported.export(case, ["discretization.backend=fe", f"discretization.degree={degree}"])
        assert mesh.order == degree
        self.degree, self.blocks = degree, case == "contact-blocks"
        msh = forms.dolfinx_mesh(mesh)
        young, poisson = (forms.per_cell(msh, np.array(pair)[mesh.patch]) for pair in ([1.0, 0.5], [0.3, 0.2]))
        self.K, space, self.places = bounds.stiffness(msh, degree, young, poisson)
        body = np.zeros(len(self.places), int)
        for cell in range(msh.topology.index_map(2).size_local):
            body[space.dofmap.cell_dofs(cell)] = mesh.patch[msh.topology.original_cell_index[cell]]
        self.sides = [self.nodes(lambda x: (np.abs(x[:, 1]) < 1e-9) & (body == b)) for b in range(1 + self.blocks)]
        self.breaks = [self.places[side, 0][::degree] for side in self.sides]
        top = self.nodes(lambda x: np.abs(x[:, 1] - 0.5) < 1e-9)
        low = np.flatnonzero(np.abs(self.places[:, 1] + 0.75) < 1e-9)
        left = np.flatnonzero(np.abs(self.places[:, 0]) < 1e-9)
        self.given, self.f = np.zeros(self.K.shape[0]), np.zeros(self.K.shape[0])
        fixed = np.r_[2 * left, 2 * low + 1]
        if self.blocks:
            self.f[2 * top + 1] = -0.0026 * bounds.mass(self.places[top, 0][::degree], degree).sum(1).A1
        else:
            self.given[2 * top + 1] = -0.02
            fixed = np.r_[fixed, 2 * top + 1]
        self.free = np.setdiff1d(np.arange(self.K.shape[0]), fixed)
        self.top = top

    def nodes(self, where):
        found = np.flatnonzero(where(self.places))
        return found[np.argsort(self.places[found, 0])]


ROUND_OFF = 1e-14  # of the largest displacement


def solved(problem, pairing, cone, slave):
    """Quantities of one discrete problem; slave: number of the body."""
    p, sides, breaks = problem.degree, problem.sides, problem.breaks
    order = [slave] + [b for b in range(len(sides)) if b != slave]
    space = Multipliers(breaks[slave], p, pairing)
    rows, gap, gram = integrals(space, [breaks[b] for b in order], p, min(b[-1] for b in breaks))
    # n is up on the lower side, down on the upper one; functions that face nothing are left out
    faces = np.flatnonzero(np.abs(rows[0]).sum(1) > 0)
    up = -1.0 if slave == 1 else 1.0
    change = {"coefficients": lambda: np.eye(space.count), "weights": lambda: np.linalg.inv(gram),
              "values": lambda: np.linalg.inv(space.at(space.greville()))}[cone]()[np.ix_(faces, faces)]
    rows = [up * sign * change.T @ row[faces] for sign, row in zip((1, -1), rows)]
    gap = change.T @ gap[faces]

    dofs = [2 * sides[b] + 1 for b in order]
    Q, R = qr(rows[0].T)
    m = len(faces)
    inverse = solve_triangular(R[:m], np.eye(m), trans="T")
    particular = Q[:, :m] @ inverse
    assert np.linalg.cond(R[:m]) < 1e6
    n = problem.K.shape[0]
    turn = sp.eye(n).tolil()
    turn[np.ix_(dofs[0], dofs[0])] = np.c_[particular, Q[:, m:]]
    if len(dofs) > 1:
        turn[np.ix_(dofs[0], dofs[1])] = -particular @ rows[1]
    shift = problem.given.copy()
    shift[dofs[0]] -= particular @ gap
    turn = turn.tocsr()[:, problem.free]
    low = np.full(n, bounds.NONE)
    low[dofs[0][:m]] = 0
    K = (turn.T @ problem.K @ turn).tocsr()
    on = np.zeros(n, bool)
    on[dofs[0][: max(1, m // 3)]] = True  # the iteration begins with a third of the side closed
    load = turn.T @ (problem.f - problem.K @ shift)
    z, forces = bounds.bounded(K, load, low[problem.free], np.zeros(len(load)), on[problem.free])
    u = turn @ z + shift
    full, at = np.zeros(n), np.zeros(n)
    full[problem.free], at[problem.free] = forces, z
    pressure = np.zeros(space.count)
    pressure[faces] = change @ full[dofs[0][:m]]
    reaction = (problem.K @ u - problem.f)[dofs[0]]
    name = "pad" if problem.blocks else "hill"
    x = problem.places[sides[slave], 0]
    found = {"energy": u @ (problem.K @ u) / 2, f"contact.{name}.force.y": reaction.sum(), f"contact.{name}.moment": reaction @ x,
             f"contact.{name}.active": int((at[dofs[0][:m]] == 0).sum())}
    for place, value in zip(PRESSURE_AT, space.at(PRESSURE_AT) @ pressure):
        found[f"contact.{name}.pressure at [{place}, 0.0]"] = value
    # what is round-off of zero, in places and in values, differs from machine to machine
    shown = np.where(np.abs(u) < ROUND_OFF * np.abs(u).max(), 0.0, u)
    for b, side in enumerate(sides):
        patch = (["upper", "lower"] if problem.blocks else ["block"])[b]
        for node in side[:: 2 * p]:
            for c, axis in enumerate("xy"):
                place = round(float(problem.places[node, 0]), 12) + 0.0
                found[f"u.{axis} at [{place}, 0.0] in {patch}"] = shown[2 * node + c]
    return found


OBSTACLE = [(1, "p/p", "coefficients"), (1, "p/p", "weights"), (1, "p/p", "values"), (1, "dual", "coefficients"),
            (2, "p/p", "coefficients"), (2, "p/p", "weights"), (2, "p/p", "values"), (2, "p/p-2", "coefficients"),
            (3, "p/p", "coefficients"), (3, "p/p", "weights"), (3, "p/p-2", "coefficients")]
BLOCKS = [(1, "p/p", "coefficients", 0), (1, "dual", "coefficients", 0), (2, "p/p-2", "coefficients", 0),
          (2, "p/p", "coefficients", 0), (2, "p/p", "weights", 0), (2, "p/p-2", "coefficients", 1), (1, "p/p", "coefficients", 1)]


def main():
    runs, problems = [], {}
    for case, name, variants in (("contact-obstacle", "hill", [v + (0,) for v in OBSTACLE]), ("contact-blocks", "pad", BLOCKS)):
        for degree, pairing, cone, slave in variants:
            if (case, degree) not in problems:
                problems[case, degree] = Problem(case, degree)
            sets = ["discretization.backend=fe", f"discretization.degree={degree}"]
            sets += [f"contact.{name}.multiplier={pairing}", f"contact.{name}.cone={cone}"]
            sets += ["contact.pad.slave=lower.top", "contact.pad.master=upper.bottom"] if slave else []
            found = solved(problems[case, degree], pairing, cone, slave)
            runs.append({"case": case, "sets": sets, "quantities": [{"quantity": q, "value": v} for q, v in found.items()]})
    record.write("Contact on one mesh: multipliers and cones as bounds on unknowns", agreement=AGREEMENT, runs=runs)


if __name__ == "__main__":
    main()
