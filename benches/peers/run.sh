#!/usr/bin/env bash
# The workloads of `cargo bench --bench workloads` beside other programs on this machine, one thread each: JSON lines in peers.jsonl
# (or the file that is named), then a table of ratios. Peers that are missing are installed (dolfinx by apt, NGSolve by pip into a
# virtual environment) or, if they cannot be, left out with a message. PYIGA names a checkout of github.com/c-f-h/pyiga; without it
# pyiga is left out. WORKLOADS="W4a W4b" takes those only.
set -euo pipefail
cd "$(dirname "$0")"
out=$(realpath -m "${1:-peers.jsonl}")
environment=$(realpath -m ../../target/peers)
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1

if ! /usr/bin/python3 -c 'import dolfinx' >/dev/null 2>&1; then
    (apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends python3-dolfinx gcc) >/dev/null 2>&1 \
        || echo "dolfinx left out: python3-dolfinx (Debian) cannot be installed"
fi
[ -x "$environment/bin/python" ] || python3 -m venv "$environment"
"$environment/bin/python" -c 'import ngsolve' >/dev/null 2>&1 || "$environment/bin/pip" install -q ngsolve || echo "NGSolve left out: pip cannot install it"
if [ -z "${PYIGA:-}" ]; then
    echo "pyiga left out: set PYIGA to a checkout of github.com/c-f-h/pyiga"
elif ! "$environment/bin/python" -c 'import pyiga' >/dev/null 2>&1; then
    # the versions it was written for; its own build uses -march=native
    "$environment/bin/pip" install -q "numpy<2.3" "cython<3.1" scipy setuptools wheel networkx
    "$environment/bin/pip" install -q --no-build-isolation "$PYIGA"
fi

: >"$out"
line() { # command..: its JSON line goes to the file; a peer that does not know the workload says so
    "$@" 2>/dev/null | grep '^{' >>"$out" || true
}
run() { # workload, p, n, reps
    local options=("$1" --p "$2" --n "$3" --reps "$4")
    echo "$1 p = $2 n = $3" >&2
    line cargo bench --quiet --bench workloads -- "${options[@]}"
    case $1 in
        W4*)
            line /usr/bin/python3 dolfinx_peer.py "${options[@]}"
            line "$environment/bin/python" ngsolve_peer.py "${options[@]}"
            ;;
        W1 | W2 | W3-2d) line "$environment/bin/python" pyiga_peer.py "${options[@]}" ;;
    esac
}
chosen() { # whether the workload is asked for
    [ -z "${WORKLOADS:-}" ] || [[ " $WORKLOADS " == *" $1 "* ]]
}
for p in 2 3 4 5; do chosen W1 && run W1 $p 256 3; done
for p in 2 3 4; do chosen W2 && run W2 $p 32 3; done
chosen W3-2d && run W3-2d 3 128 3
chosen W3-3d && run W3-3d 2 24 3
for name in W4a W4b W4e; do chosen $name && run $name 2 256 3; done
chosen W4c && run W4c 2 30 3
for name in W4d W4f; do chosen $name && run $name 2 24 3; done
python3 ratios.py "$out"
