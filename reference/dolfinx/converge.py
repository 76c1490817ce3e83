"""Values that are converged, with the error that two coarser solutions leave, and the variants that have to approach them."""

import math


class Reference:
    """values: {(kind, quantity): number} of the finest solution; coarser: the same of others. `round_off` is relative to the
    largest value of a kind."""

    def __init__(self, values, coarser, round_off):
        self.values, self.coarser, self.round_off = values, coarser, round_off

    def listed(self):
        scale = {}
        for (kind, _), value in self.values.items():
            scale[kind] = max(scale.get(kind, 0.0), abs(value))
        found = []
        for (kind, name), value in self.values.items():
            error = max([abs(value - other[kind, name]) for other in self.coarser] + [self.round_off * scale[kind]])
            print(f"{name:40} {float(value):.15g} {error:.1e} {[float(abs(value - other[kind, name])) for other in self.coarser]}")
            found.append({"quantity": name, "kind": kind, "value": float(value), "error": float(f"{error:.1e}")})
        return found


# Between meshes of sizes 2 h and h a next term c h beside the first one of an error changes its observed order by
# log2((1 + 2 c h) / (1 + c h)), which stays below this for c h <= 1/6: the finest meshes have 4 to 32 elements across.
MARGIN = 0.2
# a mesh shows its order as long as the reference's error is at most this share of its own: that costs 0.07 of it
RESOLVED = 0.05
KINDS = ["displacement", "stress", "energy"]


def elements(**patches):
    """Settings of one level: elements per direction by patch."""
    return [f"patch.{name}.elements={list(counts)}" for name, counts in patches.items()]


def variant(name, case, degree, sets, levels, **more):
    """One discretisation: a case with `--set` texts, on meshes of which each halves the elements of the one before."""
    return {"name": name, "case": case, "degree": degree, "sets": sets, "levels": levels, "kinds": more.pop("kinds", KINDS), **more}


def third():
    """Angle at a third of the parameter of a quarter circle as a quadratic NURBS: a third or two of an element's length on meshes
    of 2^k elements, so that the place within the element is the same, mirrored, on all of them."""
    return math.atan2(1 + 2 * math.sqrt(2), 4 + 2 * math.sqrt(2))
