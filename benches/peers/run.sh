#!/usr/bin/env bash
# The workloads of `cargo bench --bench workloads` beside other programs, one thread each, in one run: see README.md.
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath -m "${1:-../../target/peers.jsonl}")
environment=$(realpath -m "${PEERS_VENV:-../../target/peers}")
matrices=$(mktemp -d)
trap 'rm -rf "$matrices"' EXIT
read -ra bench <<<"${BENCH:-cargo bench --quiet --bench workloads --}"
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
debian=/usr/bin/python3
own=$environment/bin/python

# ---- what is missing is installed, or left out with a message
has() { # python, module
    "$1" -c "import $2" >/dev/null 2>&1
}
packages=()
has $debian dolfinx || packages+=(python3-dolfinx gcc)
has $debian scipy || packages+=(python3-scipy)
for package in libopenblas0-pthread libsuitesparse-dev; do # not the reference BLAS; CHOLMOD
    dpkg -s $package >/dev/null 2>&1 || packages+=($package)
done
if [ ${#packages[@]} -gt 0 ]; then
    (apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${packages[@]}") >/dev/null 2>&1 \
        || echo "cannot be installed by apt: ${packages[*]}" >&2
fi
has $debian dolfinx || echo "dolfinx and MUMPS left out" >&2
[ -x "$own" ] || python3 -m venv "$environment"
# the versions that pyiga and scikit-sparse build with
has "$own" scipy || "$own" -m pip install -q "numpy<2.3" "cython<3.1" scipy setuptools wheel networkx
has "$own" ngsolve || "$own" -m pip install -q ngsolve || echo "NGSolve left out: pip cannot install it" >&2
has "$own" pypardiso || "$own" -m pip install -q pypardiso || echo "PARDISO left out: pip cannot install pypardiso" >&2
has "$own" sksparse.cholmod || "$own" -m pip install -q --no-build-isolation "scikit-sparse<0.5" || echo "CHOLMOD left out: pip cannot install scikit-sparse" >&2
if ! has "$own" pyiga; then
    if [ -z "${PYIGA:-}" ]; then
        echo "pyiga left out: set PYIGA to a checkout of github c-f-h/pyiga (the package of that name on the index is another)" >&2
    else
        "$own" -m pip install -q --no-build-isolation "$PYIGA" || echo "pyiga left out: $PYIGA cannot be built" >&2
    fi
fi

# ---- the run
: >"$out"
line() { # command..: its JSON lines go to the file; what fails says so
    local log
    log=$(mktemp)
    "$@" 2>"$log" </dev/null | grep '^{' >>"$out" || { echo "no line: $* ($(tail -n 1 "$log"))" >&2; }
    rm -f "$log"
}
peer() { # python, module, command..: only where the module is there
    ! has "$1" "$2" || line "$1" "${@:3}"
}
run() { # workload, p, n
    local options=("$1" --p "$2" --n "$3" --reps "${REPS:-3}")
    echo "$1 p = $2 n = $3" >&2
    case $1 in
        W7*)
            line "${bench[@]}" "${options[@]}" --export "$matrices"
            peer $debian dolfinx solver_peers.py mumps "${options[@]}" --folder "$matrices"
            peer "$own" pypardiso solver_peers.py pardiso "${options[@]}" --folder "$matrices"
            peer "$own" sksparse.cholmod solver_peers.py cholmod "${options[@]}" --folder "$matrices"
            peer "$own" ngsolve solver_peers.py ngsolve "${options[@]}" --folder "$matrices"
            ;;
        *)
            # W4f takes 10 GB and minutes to factor; direct solvers of 3D matrices are compared by W7, of W4f at n = 16
            [[ $1 != W4f ]] || options+=(--nosolve)
            line "${bench[@]}" "${options[@]}"
            ;;&
        W4*)
            [[ $1 != W4[cd] ]] || options+=(--nosolve)
            peer $debian dolfinx dolfinx_peer.py "${options[@]}"
            peer "$own" ngsolve ngsolve_peer.py "${options[@]}"
            ;;
        W1 | W2 | W3-2d) peer "$own" pyiga pyiga_peer.py "${options[@]}" ;;
    esac
}
while read -r name degrees sizes; do
    [ -z "${WORKLOADS:-}" ] || [[ " $WORKLOADS " == *" $name "* ]] || continue
    for p in ${degrees//,/ }; do for n in ${sizes//,/ }; do run "$name" "$p" "$n"; done; done
done <<'LIST'
W1 2,3,4,5 256
W2 2,3,4 32
W3-2d 3 128
W3-3d 2 24
W4a 2 256
W4b 2 256
W4c 2 30
W4d 2 24
W4e 2 256
W4f 2 24
W5-2d 2 1000
W6 2 32,96
W7-W1 3 256
W7-W3-2d 3 128
W7-W3-3d 2 24
W7-W4a 2 256
W7-W4b 2 256
W7-W4c 2 16
W7-W4d 2 24
W7-W4e 2 256
W7-W4f 2 16
LIST
python3 ratios.py "$out"
