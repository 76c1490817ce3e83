#!/usr/bin/env bash
# Makes every document of reference/data/ again with FEniCSx (Debian: python3-dolfinx, installed here if it is missing).
#   regenerate.sh            writes reference/data/
#   regenerate.sh --check    writes a temporary folder and fails where it differs from reference/data/ (see dolfinx/check.py)
#   regenerate.sh NAME..     only dolfinx/NAME.py, also after --check
# FAYING names the program that writes the meshes; without it, it is built. Exit 2: no such script or
# program; 3: dolfinx cannot be had here.
set -euo pipefail
[ -z "${FAYING:-}" ] || FAYING=$(realpath "$FAYING")
cd "$(dirname "$0")"
check=
if [ "${1:-}" = --check ]; then
    check=yes
    shift
fi
python=/usr/bin/python3 # Debian's own: another one does not see the package
# -I: the folder dolfinx/ here is no module
has_dolfinx() { "$python" -I -c 'import basix, ufl, dolfinx.fem' >/dev/null 2>&1; }
if ! has_dolfinx; then
    if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
        echo "python3-dolfinx is missing: apt-get install --no-install-recommends python3-dolfinx (Debian), as root"
        exit 3
    fi
    log=$(mktemp)
    (apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends python3-dolfinx gcc) >"$log" 2>&1 \
        || { tail -n 5 "$log"; echo "python3-dolfinx cannot be installed"; exit 3; }
    rm -f "$log"
    has_dolfinx || { echo "python3-dolfinx is installed, but cannot be imported: $("$python" -I -c 'import basix, ufl, dolfinx.fem' 2>&1 | tail -n 1)"; exit 3; }
fi
if [ -z "${FAYING:-}" ]; then
    (cd .. && cargo build --release --locked --bin faying)
    FAYING=$(realpath "${CARGO_TARGET_DIR:-../target}/release/faying")
fi
[ -x "$FAYING" ] || { echo "FAYING: $FAYING is no program; build it with cargo build --release"; exit 2; }
export FAYING OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# one process each: Open MPI starts no daemon of its own, which may fail where two start at once
export OMPI_MCA_ess_singleton_isolated=1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
out=data
[ -z "$check" ] || out=$work/data
mkdir -p "$out"
all=
if [ $# = 0 ]; then
    all=--all
    # those that write a document; the other modules are only read by them
    set -- $(cd dolfinx && grep -l '\brecord\.write(' ./*.py | sed 's|^\./||; s|\.py$||')
fi
for name in "$@"; do
    [ -f "dolfinx/$name.py" ] || { echo "there is no script dolfinx/$name.py; documents are: $(cd data && ls ./*.json | sed 's|^\./||; s|\.json$||' | tr '\n' ' ')"; exit 2; }
done
one() { # script: one process with its own cache of compiled forms
    mkdir -p "$work/$1"
    local start=$SECONDS
    XDG_CACHE_HOME=$work/$1 "$python" "dolfinx/$1.py" "$out" >"$work/$1.log" 2>&1 || { echo "FAILED: $1"; tail -n 30 "$work/$1.log"; return 1; }
    echo "$1: $((SECONDS - start)) s"
    rm -rf "${work:?}/$1"
}
export -f one
export work out python
printf '%s\n' "$@" | xargs -P 2 -I NAME bash -c 'one NAME'
[ -z "$check" ] || "$python" dolfinx/check.py data "$out" $all
