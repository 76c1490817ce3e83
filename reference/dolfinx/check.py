"""Says where two folders of JSON documents differ: check.py STORED MADE. Exit 1 if they do.

Numbers agree within the "tolerance" that the script states (default 1e-9) of the larger one, or of the largest in their list. An
"error" beside a "value" is an estimate: it may differ by half of itself or by that tolerance of the value. Numbers that are not
finite never agree. With --all, every stored document must have been made.
"""

import json
import math
import os
import sys

TOLERANCE = 1e-9


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def largest(value):
    """The largest magnitude in a list of numbers, nested or not."""
    return max((largest(v) if isinstance(v, list) else abs(v) for v in value if isinstance(v, list) or is_number(v)), default=0.0)


def differences(stored, made, tolerance, place, scale=0.0):
    if is_number(stored) and is_number(made):
        if not (math.isfinite(stored) and math.isfinite(made)) or not abs(stored - made) <= tolerance * max(abs(stored), abs(made), scale):
            yield f"{place}: {stored!r} stored, {made!r} made"
    elif isinstance(stored, dict) and isinstance(made, dict):
        for key in sorted(set(stored) | set(made)):
            if key not in stored or key not in made:
                yield f"{place}.{key}: only {'made' if key in made else 'stored'}"
            elif key == "error" and all(is_number(d.get(k)) for d in (stored, made) for k in ("error", "value")):
                if not abs(stored[key] - made[key]) <= max(0.5 * abs(made[key]), tolerance * abs(made["value"])):
                    yield f"{place}.{key}: {stored[key]!r} stored, {made[key]!r} made"
            else:
                yield from differences(stored[key], made[key], tolerance, f"{place}.{key}", scale if key == "value" else 0.0)
    elif isinstance(stored, list) and isinstance(made, list) and len(stored) == len(made):
        scale = max(scale, largest(stored))
        for i, (a, b) in enumerate(zip(stored, made)):
            yield from differences(a, b, tolerance, f"{place}[{i}]", scale)
    elif type(stored) is not type(made) or stored != made:
        yield f"{place}: {stored!r} stored, {made!r} made"


def documents(folder):
    return sorted(name for name in os.listdir(folder) if name.endswith(".json"))


def main(stored, made, *options):
    names = documents(made)
    found = [] if names else [f"{made} holds no document"]
    if "--all" in options:
        found += [f"{name} is stored, and no script made it" for name in documents(stored) if name not in names]
    for name in names:
        if not os.path.exists(os.path.join(stored, name)):
            found.append(f"{name} is not stored")
            continue
        with open(os.path.join(stored, name), encoding="utf-8") as a, open(os.path.join(made, name), encoding="utf-8") as b:
            a, b = json.load(a), json.load(b)
        found += [name + d for d in differences(a, b, b.get("tolerance", TOLERANCE), "")]
    for line in found[:50]:
        print(line)
    print(f"{len(names)} documents, {len(found)} differences")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
