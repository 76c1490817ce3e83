#!/usr/bin/env bash
# Runs every study of this folder whole and says where a number departs from expected.json.
# The reports are left in brivadis.out/ of the current folder, or in the folder that is named.
set -euo pipefail
out=$(realpath -m "${1:-brivadis.out}")
cd "$(dirname "$0")/../.."
FAYING_BRIVADIS=$out cargo test --release --locked --test brivadis -- --nocapture
echo "reports: $out/*/report.html"
