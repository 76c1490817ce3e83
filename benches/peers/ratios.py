"""The table of ratios from the JSON lines of one run: our CPU seconds over those of the fastest peer."""

import json
import sys


def ratio(own, peers, key):
    """Our figure, and over the least of the peers with its name."""
    if own is None or own.get(key) is None:
        return "-"
    known = [(p[key], p["peer"]) for p in peers if p.get(key) is not None]
    best = min(known) if known else None
    return f"{own[key]:.3f}" + (f" ({own[key] / best[0]:.2f} of {best[1]} {best[0]:.3f})" if best else "")


def agreement(own, peers):
    """Largest relative difference of trace and Frobenius norm from the peers that have them."""
    if own is None:
        return "-"
    found = [abs(own[k] - p[k]) / abs(p[k]) for p in peers for k in ("fp_trace", "fp_fro") if p.get(k) and own.get(k)]
    return f"{max(found):.1e}" if found else "-"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        lines = [json.loads(text) for text in file if text.strip()]
    print("| workload | p | n | first | again | solve | fingerprints differ by |\n|---|---|---|---|---|---|---|")
    for key in dict.fromkeys((r["workload"], r["p"], r["n"]) for r in lines if "p" in r):
        rows = [r for r in lines if (r["workload"], r.get("p"), r.get("n")) == key]
        own = next((r for r in rows if r["peer"] == "faying"), None)
        peers = [r for r in rows if r["peer"] != "faying"]
        cells = [ratio(own, peers, k) for k in ("assemble_cpu_s", "assemble_again_s", "solve_cpu_s")]
        print("| " + " | ".join([*map(str, key), *cells, agreement(own, peers)]) + " |")


main()
