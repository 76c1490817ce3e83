"""Tables of ratios from the JSON lines of one run: our CPU seconds over those of the fastest peer, beside what is wanted.

Ends with 1 where trace or Frobenius norm of a matrix differ from a peer's by more than 1e-9, a residual is large, or the contact forces
of W6 disagree.
"""

import json
import sys

SAME = 1e-9
RESIDUAL = 1e-9
# what the meshes of W6 leave between the forces of two backends, and of n = 32 and n = 96
SAME_FORCE = {"backends": 5e-4, "meshes": 1e-2}
# most of the best peer's time: first assembly, again, and the solver in total, again
WANTED = {"W1": (0.35, 0.15), "W2": (0.4, 0.2), "W3-2d": (0.35, 0.15), "W4": (0.7, 0.4)}
FLAT = {"W1", "W3-2d", "W4a", "W4b", "W4e"}
faults = []


def fault(text):
    faults.append(text)
    return f"**{text}**"


def ratio(own, peers, key, most):
    """Our figure, over the least of the peers with its name, and what is wanted."""
    if own is None or own.get(key) is None:
        return "-"
    known = [(p[key], p["peer"]) for p in peers if p.get(key) is not None]
    if not known:
        return f"{own[key]:.3f}"
    best, name = min(known)
    verdict = "" if most is None else f", wanted {most}" + ("" if own[key] <= most * best else ", missed")
    return f"{own[key]:.3f} ({own[key] / best:.2f} of {name} {best:.3f}{verdict})"


def agreement(own, peers):
    """Largest relative difference of trace and Frobenius norm from the peers that have them."""
    found = [(abs(own[k] - p[k]) / abs(p[k]), p["peer"]) for p in peers for k in ("fp_trace", "fp_fro") if p.get(k) and own.get(k)] if own else []
    if not found:
        return "-"
    largest, name = max(found)
    return f"{largest:.1e}" if largest <= SAME else fault(f"{own['workload']} differs from {name} by {largest:.1e}")


def assembly(groups):
    print("| workload | p | n | first [s] | again [s] | solve [s] | fingerprints differ by | error |\n|---|---|---|---|---|---|---|---|")
    for (name, p, n), own, peers in groups:
        first, again = WANTED.get(name, WANTED.get(name[:2], (None, None)))
        cells = [ratio(own, peers, "assemble_cpu_s", first), ratio(own, peers, "assemble_again_cpu_s", again), ratio(own, peers, "solve_cpu_s", None)]
        error = f"{own['error']:.2e}" if own and own.get("error") is not None else "-"
        print("| " + " | ".join([name, str(p), str(n), *cells, agreement(own, peers), error]) + " |")


def solvers(groups):
    print("\n| matrix | unknowns | total [s] | refactor [s] | fill, ours / least | peers, total (refactor) [s] |\n|---|---|---|---|---|---|")
    for (name, _, _), own, peers in groups:
        for r in [own, *peers]:
            if r and not r["residual"] < RESIDUAL:
                fault(f"{name}: {r['peer']} leaves a residual of {r['residual']:.1e}")
        total = ratio(own, peers, "total_cpu_s", 1.0 if name[3:] in FLAT else 1.3)
        entries = [p["factor_entries"] for p in peers if p.get("factor_entries")]
        fill = f"{own['factor_entries'] / min(entries):.2f}" if own and entries else "-"
        others = ", ".join(f"{p['peer']} {p['total_cpu_s']:.3f} ({p['refactor_s']:.3f})" for p in peers)
        print(f"| {name[3:]} | {(own or peers[0])['dofs']} | {total} | {ratio(own, peers, 'refactor_s', 0.9)} | {fill} | {others} |")


def contact(groups):
    print("\n| workload | n | total [s] | iterations | per iteration [s] | force |\n|---|---|---|---|---|---|")
    force = {}
    for (name, _, n), own, _ in groups:
        force[name, n] = own["force"]
        print(f"| {name} | {n} | {own['solve_cpu_s']:.3f} | {own['iterations']} | {own['iteration_cpu_s']:.3f} | {own['force']:.8f} |")
    for (a, f) in force.items():
        for (b, g) in force.items():
            kind = "backends" if a[1] == b[1] and a[0] < b[0] else "meshes" if a[0] == b[0] and a[1] < b[1] else None
            if kind and abs(f - g) > SAME_FORCE[kind] * abs(g):
                fault(f"contact forces of {a} and {b} differ: {f} and {g}")


def own_ratios(own):
    """What is wanted of our own figures among themselves."""

    def compare(text, a, b, most):
        print(f"- {text}: {a / b:.2f}, wanted {most}" + ("" if a <= most * b else ", missed"))

    w2 = {p: own.get(("W2", p, 32)) for p in (3, 4)}
    w3 = own.get(("W3-3d", 2, 24))
    print()
    if w2[3] and w2[4]:
        compare("W2 p = 4 first over p = 3", w2[4]["assemble_cpu_s"], w2[3]["assemble_cpu_s"], 3.0)
    if w2[3] and w3:
        compare("W3-3d first over W2 p = 3", w3["assemble_cpu_s"], w2[3]["assemble_cpu_s"], 2.5)
        compare("W3-3d per entry over W2 p = 3", w3["assemble_cpu_s"] / w3["nnz"], w2[3]["assemble_cpu_s"] / w2[3]["nnz"], 1.6)
    if w3:
        compare("W3-3d again over first", w3["assemble_again_cpu_s"], w3["assemble_cpu_s"], 0.5)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        lines = [r for r in map(json.loads, filter(str.strip, file)) if "p" in r]
    groups = []
    for key in dict.fromkeys((r["workload"], r["p"], r["n"]) for r in lines):
        rows = [r for r in lines if (r["workload"], r["p"], r["n"]) == key]
        groups.append((key, next((r for r in rows if r["peer"] == "faying"), None), [r for r in rows if r["peer"] != "faying"]))
    named = lambda *starts: [g for g in groups if g[0][0].startswith(starts)]  # noqa: E731
    assembly(named("W1", "W2", "W3", "W4", "W5"))
    own_ratios({key: own for key, own, _ in groups if own})
    if named("W6"):
        contact(named("W6"))
    if named("W7"):
        solvers(named("W7"))
    if faults:
        sys.exit("\n".join(["", "FAILED:", *faults]))


main()
