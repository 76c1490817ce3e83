#!/usr/bin/env bash
# Runs every study of this folder whole and says where a number departs from expected.json.
# The reports and pictures are left in brivadis.out/ of the current folder, or in the folder that is named.
# --references first makes the stored runs of contact/ again, P4-P4 on 511 x 128 elements: some minutes, 4 GB.
set -euo pipefail
references=
if [ "${1:-}" = --references ]; then
    references=yes
    shift
fi
out=$(realpath -m "${1:-brivadis.out}")
cd "$(dirname "$0")/../.."
if [ -n "$references" ]; then
    cargo build --release --locked --bin faying
    for kind in full:p/p partial:p/p-2; do
        name=${kind%%:*}
        target/release/faying run "reference/brivadis/contact/$name.toml" --out "$out/contact-$name-reference" --force --vtu none \
            --set "patch.upper.elements=[511, 128]" --set "patch.lower.elements=[511, 128]" --set discretization.degree=4 \
            --set "contact.pad.multiplier=\"${kind#*:}\"" --save-reference "reference/brivadis/contact/$name.ref"
    done
fi
FAYING_BRIVADIS=$out cargo test --release --locked --test brivadis -- --nocapture
echo "reports: $out/*/report.html; pictures: $out/contact-*-picture/*.svg"
