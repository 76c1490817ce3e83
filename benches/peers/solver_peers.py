"""W7: direct solvers on a matrix that `cargo bench --bench workloads -- W7-* --export FOLDER` has written.

`python solver_peers.py SOLVER WORKLOAD --folder FOLDER`, SOLVER one of mumps (petsc4py), pardiso (pypardiso), cholmod (scikit-sparse),
ngsolve. FOLDER holds the upper triangle by rows and the load, little endian: ptr.i64, cols.i32, vals.f64, rhs.f64. CHOLMOD orders with METIS,
the others with what they have. Seconds of CPU: analyse (order and symbolic), factor, solve, their sum, and
refactor: the same pattern with other numbers. A load that is not solved to 1e-9 is an error.
"""

import importlib.metadata
import pathlib
import statistics
import sys

import numpy as np
import scipy.sparse

import measure

LIMIT = 1e-9


def petsc_mumps(upper, full, load):
    """MUMPS by PETSc with the orderings that it was built with; Debian's has PORD."""
    from petsc4py import PETSc

    size = (upper.shape[0],) * 2
    make = lambda a: PETSc.Mat().createSBAIJ(size, 1, csr=(a.indptr, a.indices, a.data), comm=PETSc.COMM_SELF)  # noqa: E731
    matrix = make(upper)
    if positive(upper):
        matrix.setOption(PETSc.Mat.Option.SPD, True)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(matrix)
    pc.setType("cholesky")
    pc.setFactorSolverType("mumps")
    pc.setFactorSetUpSolverType()
    pc.setFromOptions()
    factor = pc.getFactorMatrix()
    x, b = matrix.createVecs()
    b.setArray(load)
    _, both = measure.cpu_of(pc.setUp)
    _, solve = measure.cpu_of(lambda: pc.apply(b, x))
    solution = x.getArray().copy()
    matrix.scale(1.5)
    _, again = measure.cpu_of(pc.setUp)
    entries = factor.getMumpsInfog(29)
    # PETSc orders and factors in one step: the factorisation alone is what the second one takes
    return solution, {"analyse": both - again, "factor": again, "solve": solve, "refactor": again}, entries if entries > 0 else -1000000 * entries


def pardiso(upper, full, load):
    """PARDISO of MKL, its own nested dissection."""
    import ctypes

    import pypardiso

    solver = pypardiso.PyPardisoSolver(mtype=2 if positive(upper) else -2)
    n = upper.shape[0]
    indptr, indices = (np.ascontiguousarray(a, dtype=np.int32) + 1 for a in (upper.indptr, upper.indices))
    x, rhs = np.zeros(n), load.copy()
    pointer = lambda a, kind: a.ctypes.data_as(ctypes.POINTER(kind))  # noqa: E731
    number = lambda v: ctypes.byref(ctypes.c_int32(v))  # noqa: E731

    def call(phase, values):
        error = ctypes.c_int32(0)
        solver._mkl_pardiso(pointer(solver.pt, ctypes.c_int64), number(1), number(1), number(solver.mtype), number(phase), number(n),
                            pointer(values, ctypes.c_double), pointer(indptr, ctypes.c_int32), pointer(indices, ctypes.c_int32),
                            pointer(solver.perm, ctypes.c_int32), number(1), pointer(solver.iparm, ctypes.c_int32), number(0),
                            pointer(rhs, ctypes.c_double), pointer(x, ctypes.c_double), ctypes.byref(error))
        if error.value:
            raise SystemExit(f"PARDISO: error {error.value} in phase {phase}")

    solver.iparm[17] = -1  # count the entries of the factor
    times = {name: measure.cpu_of(lambda: call(phase, upper.data))[1] for name, phase in (("analyse", 11), ("factor", 22), ("solve", 33))}
    solution, entries = x.copy(), int(solver.iparm[17])
    other = 1.5 * upper.data
    times["refactor"] = measure.cpu_of(lambda: call(22, other))[1]
    call(-1, other)
    return solution, times, entries


def cholmod(upper, full, load):
    """CHOLMOD, supernodal, METIS."""
    from sksparse.cholmod import analyze

    if not positive(upper):
        raise SystemExit("CHOLMOD factors definite matrices only")
    lower = upper.T.tocsc()  # CHOLMOD reads the lower triangle of a column matrix
    factor, analyse = measure.cpu_of(lambda: analyze(lower, mode="supernodal", ordering_method="metis"))
    _, numeric = measure.cpu_of(lambda: factor.cholesky_inplace(lower))
    solution, solve = measure.cpu_of(lambda: factor.solve_A(load))
    other = lower * 1.5
    _, again = measure.cpu_of(lambda: factor.cholesky_inplace(other))
    return solution, {"analyse": analyse, "factor": numeric, "solve": solve, "refactor": again}, int(factor.L().nnz)


def ngsolve(upper, full, load):
    """NGSolve's sparse Cholesky."""
    from ngsolve.la import BaseVector, SparseMatrixd

    entries = full.tocoo()
    matrix = SparseMatrixd.CreateFromCOO(entries.row.astype(np.int32), entries.col.astype(np.int32), entries.data, *full.shape)
    inverse, both = measure.cpu_of(lambda: matrix.Inverse(inverse="sparsecholesky"))
    b, x = BaseVector(len(load)), BaseVector(len(load))
    b.FV().NumPy()[:] = load
    _, solve = measure.cpu_of(lambda: inverse.Mult(b, x))
    solution = x.FV().NumPy().copy()
    matrix.AsVector().data *= 1.5
    _, again = measure.cpu_of(inverse.Update)
    return solution, {"analyse": both - again, "factor": again, "solve": solve, "refactor": again}, None


# what runs it, and the package that says its version
SOLVERS = {"mumps": (petsc_mumps, "petsc4py"), "pardiso": (pardiso, "mkl"), "cholmod": (cholmod, "scikit-sparse"), "ngsolve": (ngsolve, "ngsolve")}


def positive(upper):
    """Whether the diagonal is: the matrices of W7 are definite or have zeros or negative numbers there."""
    return bool((upper.diagonal() > 0).all())


def read(folder):
    """Upper triangle, full matrix, load."""
    part = lambda name, kind: np.fromfile(folder / name, dtype=kind)  # noqa: E731
    indptr, indices = part("ptr.i64", "<i8").astype(np.int32), part("cols.i32", "<i4").astype(np.int32)
    n = len(indptr) - 1
    upper = scipy.sparse.csr_matrix((part("vals.f64", "<f8"), indices, indptr), shape=(n, n))
    return upper, (upper + scipy.sparse.triu(upper, 1).T).tocsr(), part("rhs.f64", "<f8")


def main():
    solver = sys.argv.pop(1)
    run, package = SOLVERS[solver]
    options = measure.arguments(folder=True)
    upper, full, load = read(pathlib.Path(options.folder))
    runs = []
    for _ in range(options.reps + 1):
        solution, times, entries = run(upper, full, load)
        runs.append(times)
        if sum(times.values()) > measure.LONG:
            runs = [times, times]
            break
    size = abs(full).sum(axis=1).max() * abs(solution).max() + abs(load).max()
    residual = float(abs(load - full @ solution).max() / size)
    if not residual < LIMIT:
        raise SystemExit(f"{solver}: residual {residual:.1e} of {options.name}")
    middle = {name: statistics.median(run[name] for run in runs[1:]) for name in times}
    fields = {f"{name}_s": seconds for name, seconds in middle.items()}
    fields["total_cpu_s"] = middle["analyse"] + middle["factor"] + middle["solve"]
    version = f"{package} {importlib.metadata.version(package)}"
    measure.line(solver, version, options, options.p, options.n, dofs=len(load), nnz=int(full.nnz), residual=residual, factor_entries=entries, **fields)


main()
