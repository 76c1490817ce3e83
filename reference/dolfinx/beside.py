"""Error against unknowns and against time, dolfinx beside the program: docs/dolfinx.csv, docs/dolfinx.svg and the table of docs/comparisons.md.

Problem: a quarter of the infinite plate with a hole, cut at r = 4 (cases/kirsch.toml); plane strain, E = 1e5, nu = 0.3, tension
10 along x, exact traction on r = 4, symmetry on both axes. Error: L2 norm of u - u_h over that of u, by the exact solution.
dolfinx solves on the quadrilaterals that `backend = "fe"` uses, nodes on the exact arc in the parameter of its rational quadratic
form, degree of the geometry = degree of the space; p + 2 Gauss points per direction in all integrals.

Time: one thread, the least of three, no import and no compilation of forms; mesh or spline space, matrices, load, solution by a
direct solver (MUMPS; ours), error norm. Of the program that is the time of the row in the study's manifest.

    FAYING=target/release/faying OMP_NUM_THREADS=1 /usr/bin/python3 reference/dolfinx/beside.py      (some minutes, python3-matplotlib)
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time

import forms
import matplotlib
import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

DOCS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "docs")
CASE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cases", "kirsch.toml")
LEVELS, REPEATED = 6, 3
QUANTITY = "error.u.L2.rel"


def ring(n, p):
    """n x n quadrilaterals of degree p: points, cells, reference nodes."""
    t = np.linspace(0, 1, n * p + 1)
    weight = 1 + (math.sqrt(2) - 2) * t * (1 - t)
    arc = np.stack([(1 - t) ** 2 + math.sqrt(2) * t * (1 - t), math.sqrt(2) * t * (1 - t) + t**2]) / weight
    r = np.linspace(1, 4, n * p + 1)
    points = (r[:, None, None] * arc.T[None, :, :]).reshape(-1, 2)
    i, j = np.meshgrid(np.arange(p + 1), np.arange(p + 1), indexing="xy")
    local = (j * (n * p + 1) + i).ravel()
    first = (p * np.arange(n)[:, None] * (n * p + 1) + p * np.arange(n)[None, :]).ravel()
    return points, first[:, None] + local[None, :], np.stack([i.ravel(), j.ravel()], 1) / p


def exact(x):
    young, nu, tension = 1e5, 0.3, 10.0
    k, s = 3 - 4 * nu, tension * (1 + nu) / (4 * young)
    r, theta = ufl.sqrt(x[0] ** 2 + x[1] ** 2), ufl.atan_2(x[1], x[0])
    return ufl.as_vector([s * (r * (k + 1) * ufl.cos(theta) + 2 / r * ((1 + k) * ufl.cos(theta) + ufl.cos(3 * theta))
                               - 2 / r**3 * ufl.cos(3 * theta)),
                          s * (r * (k - 3) * ufl.sin(theta) + 2 / r * ((1 - k) * ufl.sin(theta) + ufl.sin(3 * theta))
                               - 2 / r**3 * ufl.sin(3 * theta))])


def run(n, p):
    """Unknowns, error and seconds of one mesh."""
    arrays = ring(n, p)
    start = time.perf_counter()
    msh = forms.mesh_of("quadrilateral", p, *arrays)
    space = forms.space(msh, p, 2)
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    lam, mu = forms.lame(1e5, 0.3)
    sides = forms.Sides(msh, [lambda x: x[1], lambda x: x[0], lambda x: np.hypot(x[0], x[1]) - 4], 2 * p + 3)
    dx = ufl.dx(metadata={"quadrature_degree": 2 * p + 3})
    solution = exact(ufl.SpatialCoordinate(msh))
    traction = ufl.dot(forms.stress(solution, lam, mu), ufl.FacetNormal(msh))
    options = {"ksp_type": "preonly", "pc_type": "cholesky", "pc_factor_mat_solver_type": "mumps"}
    problem = fem.petsc.LinearProblem(ufl.inner(forms.stress(u, lam, mu), forms.eps(v)) * dx, ufl.dot(traction, v) * sides.ds(3),
                                      bcs=[sides.fixed(space, 1, 1), sides.fixed(space, 2, 0)], petsc_options=options)
    problem.A.setOption(PETSc.Mat.Option.SPD, True)
    found = problem.solve()
    error = found - solution
    value = math.sqrt(forms.number(ufl.inner(error, error) * dx) / forms.number(ufl.inner(solution, solution) * dx))
    return 2 * len(arrays[0]), value, time.perf_counter() - start


def dolfinx_rows():
    for p in (1, 2, 3):
        run(2, p)  # compiles the forms
        for level in range(LEVELS):
            found = [run(4 * 2**level, p) for _ in range(REPEATED)]
            yield {"program": "dolfinx", "backend": "fe", "degree": p, "elements": 16 * 4**level, "unknowns": found[0][0],
                   "error": found[0][1], "seconds": min(f[2] for f in found)}


def own_rows():
    options = ["--levels", str(LEVELS), "--degrees", "iga:2,3,4", "--degrees", "fe:1,2,3", "--backends", "iga,fe"]
    rows, seconds = [], []
    for _ in range(REPEATED):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.environ.get("FAYING", "faying"), "convergence", CASE, *options, "--threads", "1", "--out", folder + "/out"],
                           check=True, capture_output=True)
            with open(folder + "/out/manifest.json", encoding="utf-8") as file:
                phases = json.load(file)["seconds"]
            seconds.append([p["seconds"] for p in phases if p["phase"].startswith("row ")])
            with open(folder + "/out/study.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
    for row, times in zip(rows, zip(*seconds)):
        yield {"program": "faying", "backend": row["backend"], "degree": int(row["degree"]), "elements": int(row["elements"]),
               "unknowns": int(row["unknowns.primal"]), "error": float(row[QUANTITY]), "seconds": min(times)}


def draw(rows):
    plt.rcParams.update({"svg.hashsalt": "faying", "svg.fonttype": "none", "font.size": 9, "font.family": "sans-serif"})
    figure, axes = plt.subplots(1, 2, figsize=(9, 4.2), sharey=True)
    colours = {1: "#7f7f7f", 2: "#1f77b4", 3: "#d62728", 4: "#2ca02c"}
    styles = {("faying", "iga"): ("-", "o", "IGA"), ("faying", "fe"): ("--", "s", "FE"), ("dolfinx", "fe"): (":", "x", "dolfinx")}
    for (program, backend), (line, mark, label) in styles.items():
        for p in (1, 2, 3, 4):
            own = [r for r in rows if (r["program"], r["backend"], r["degree"]) == (program, backend, p)]
            for axis, key in zip(axes, ("unknowns", "seconds")):
                if own:
                    axis.loglog([r[key] for r in own], [r["error"] for r in own], line, marker=mark, markersize=4 if mark != "x" else 7,
                                color=colours[p], fillstyle="none", linewidth=1, label=f"{label} p = {p}")
    axes[0].set(xlabel="unknowns", ylabel="error of u, relative, L2")
    axes[1].set(xlabel="seconds, one thread")
    for axis in axes:
        axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
    axes[0].legend(fontsize=7, ncol=2, frameon=False)
    figure.tight_layout()
    figure.savefig(os.path.join(DOCS, "dolfinx.svg"), metadata={"Date": None, "Creator": None})


def table(rows):
    """Per curve: the last mesh, and the orders from the last two."""
    print("| | p | unknowns | error | order | seconds |\n|---|---|---|---|---|---|")
    for program, backend, name in (("faying", "iga", "IGA"), ("faying", "fe", "FE"), ("dolfinx", "fe", "dolfinx")):
        for p in (1, 2, 3, 4):
            own = [r for r in rows if (r["program"], r["backend"], r["degree"]) == (program, backend, p)]
            if own:
                a, b = own[-2:]
                print(f"| {name} | {p} | {b['unknowns']:,} | {b['error']:.3e} | {math.log2(a['error'] / b['error']):.2f} | {b['seconds']:.2f} |")


def main():
    rows = [*dolfinx_rows(), *own_rows()]
    with open(os.path.join(DOCS, "dolfinx.csv"), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows)
    table(rows)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        raise SystemExit(__doc__)
    main()
