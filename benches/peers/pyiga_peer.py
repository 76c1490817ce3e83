"""W1, W2 and W3-2d with pyiga (github.com/c-f-h/pyiga): assembly only.

W1 and W2: its low-rank assembly to 1e-10 (cross approximation, not the whole Gauss rule), or with --exact its Gauss rule of p + 1 points
per direction; W3-2d: the Gauss rule. Its first assembly builds the pattern, and there is no other.
"""

import importlib.metadata
import sys

import numpy as np
import scipy.sparse
from pyiga import assemble, bspline, geometry

import measure

LAM, MU = 0.3 / (1.3 * 0.4), 1 / 2.6
WORKLOADS = {"W1": (2, 3, 256), "W2": (3, 3, 32), "W3-2d": (2, 3, 128)}


def main():
    exact = "--exact" in sys.argv
    if exact:
        sys.argv.remove("--exact")
    options = measure.arguments()
    if options.name not in WORKLOADS:
        raise SystemExit(f"pyiga runs {', '.join(WORKLOADS)}")
    dimension, p, n = WORKLOADS[options.name]
    p, n = options.p or p, options.n or n
    kvs = dimension * (bspline.make_knots(p, 0.0, 1.0, n),)
    annulus = geometry.quarter_annulus(1.0, 2.0)
    geo = annulus if dimension == 2 else geometry.tensor_product(geometry.line_segment(0.0, 1.0), annulus)
    if options.name == "W3-2d":
        form = "(lam * div(u) * div(v) + mu * inner(grad(u), grad(v)) + mu * inner(grad(u), grad(v).T)) * dx"
        args = {"geo": geo, "lam": LAM, "mu": MU}

        def work():
            return assemble.assemble(form, kvs, args=args, bfuns=[("u", 2), ("v", 2)], symmetric=True)

        exact = True
    elif exact:

        def work():
            return assemble.stiffness(kvs, geo)
    else:

        def work():
            return assemble.stiffness_fast(kvs, geo, tol=1e-10, verbose=0)

    first, first_cpu, matrix = measure.timed(work, options.reps)
    matrix = scipy.sparse.csr_matrix(matrix)
    fields = {"dofs": matrix.shape[0], "nnz": int(matrix.nnz), "assemble_s": first, "assemble_cpu_s": first_cpu, "assemble_again_s": first,
              "assemble_again_cpu_s": first_cpu,
              "fp_trace": float(matrix.diagonal().sum()), "fp_fro": float(np.linalg.norm(matrix.data)), "solve_s": None, "solve_cpu_s": None,
              "error": None, "notes": "Gauss rule" if exact else "low rank, 1e-10"}
    measure.line("pyiga", importlib.metadata.version("pyiga"), options, p, n, **fields)


main()
