"""What a script hands over: one JSON document under reference/data/, or in the folder that is named on the command line.

A number with an estimate of its error is {"value": v, "error": e}: the same problem on two resolutions or more.
"""

import json
import os
import sys

import dolfinx

HERE = os.path.dirname(os.path.abspath(__file__))


def write(problem, **fields):
    """Writes the document NAME.json of the script NAME.py."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(HERE, "..", "data")
    document = {"problem": problem, "script": f"dolfinx/{name}.py", "dolfinx": dolfinx.__version__, **fields}
    with open(os.path.join(folder, name + ".json"), "w", encoding="utf-8") as file:
        file.write(text(document, "") + "\n")


def plain(value):
    """Lists and numbers of Python for arrays and numbers of numpy."""
    return plain(value.tolist()) if hasattr(value, "tolist") else value


def text(value, indent):
    """JSON in which lists of numbers stand on one line."""
    value, deeper = plain(value), indent + "  "
    if isinstance(value, dict) and value:
        if all(isinstance(plain(v), (int, float, str)) for v in value.values()) and len(value) <= 4:
            return json.dumps({k: plain(v) for k, v in value.items()})
        inside = [f"{deeper}{json.dumps(k)}: {text(v, deeper)}" for k, v in value.items()]
        return "{\n" + ",\n".join(inside) + f"\n{indent}}}"
    if isinstance(value, (list, tuple)) and any(isinstance(plain(v), (dict, list, tuple)) for v in value):
        return "[\n" + ",\n".join(deeper + text(v, deeper) for v in value) + f"\n{indent}]"
    return json.dumps(value)


def estimated(coarser, finer, least=0.0):
    """The finer value with the difference of both as its error, two digits of it; `least` is the error by round-off."""
    return {"value": float(finer), "error": float(f"{max(abs(finer - coarser), least):.1e}")}
