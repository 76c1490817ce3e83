"""The mesh of a case as the program itself writes it: `faying run CASE --vtu lagrange`, points and cells of fields.vtu.

Only the mesh is taken; the solution beside it is never read. The program is named by the variable FAYING.
"""

import os
import subprocess
import tempfile
import xml.etree.ElementTree as xml
import zlib

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
KINDS = {69: "triangle", 70: "quadrilateral", 71: "tetrahedron", 72: "hexahedron"}
TYPES = {"Float64": np.float64, "Int64": np.int64, "Int32": np.int32, "UInt8": np.uint8}


class Exported:
    """kind: name of the cells; order: their degree; points (n, dimension); cells (m, nodes) in the order of `reference`,
    the nodes' reference coordinates; patch (m,): number of each cell's body."""

    def __init__(self, kind, order, points, cells, reference, patch):
        self.kind, self.order, self.points, self.cells, self.reference, self.patch = kind, order, points, cells, reference, patch


def export(case, sets=()):
    """The mesh of reference/dolfinx/cases/CASE.toml with `--set` texts."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        options = [word for text in sets for word in ("--set", text)]
        command = [os.environ.get("FAYING", "faying"), "run", os.path.join(HERE, "cases", case + ".toml"), "--vtu", "lagrange"]
        ended = subprocess.run(command + ["--out", out] + options, capture_output=True, text=True)
        # checks of a case may fail on a coarse mesh: the mesh is there all the same
        if ended.returncode not in (0, 1):
            raise SystemExit(f"{case} {list(sets)}: exit {ended.returncode}\n{ended.stderr}")
        return welded(read_vtu(os.path.join(out, "fields.vtu")))


def read_vtu(path):
    """The arrays of a .vtu file with appended data compressed by zlib: numbers of blocks and bytes, then the blocks."""
    with open(path, "rb") as file:
        data = file.read()
    start = data.index(b'<AppendedData encoding="raw">')
    header = xml.fromstring(data[:start] + b"</VTKFile>")
    start = data.index(b"_", start) + 1
    arrays = {}
    for array in header.iter("DataArray"):
        at = start + int(array.get("offset"))
        blocks = int(np.frombuffer(data, np.uint64, 1, at)[0])
        at += 24
        ends = at + 8 * blocks + np.cumsum([0, *np.frombuffer(data, np.uint64, blocks, at)], dtype=np.int64)
        raw = b"".join(zlib.decompress(data[a:b]) for a, b in zip(ends, ends[1:]))
        values = np.frombuffer(raw, TYPES[array.get("type")])
        arrays[array.get("Name")] = values.reshape(-1, int(array.get("NumberOfComponents", "1")))
    return arrays


def welded(arrays):
    """One kind and order of cells; points of one body at one place are one point."""
    types = np.unique(arrays["types"])
    assert len(types) == 1, "cells of one kind"
    kind = KINDS[int(types[0])]
    dimension = 2 if kind in ("triangle", "quadrilateral") else 3
    orders = np.unique(arrays["HigherOrderDegrees"][:, :dimension])
    assert len(orders) == 1, "cells of one order"
    order = int(orders[0])
    lattice = nodes(kind, order)
    cells = arrays["connectivity"].reshape(-1, len(lattice))
    patch = arrays["patch"].ravel()
    points = arrays["Points"][:, :dimension]
    size = np.abs(points).max()
    number, places, of_point = {}, [], np.empty(len(points), dtype=np.int64)
    body = np.empty(len(points), dtype=np.int64)
    body[cells.ravel()] = np.repeat(patch, len(lattice))
    for i, x in enumerate(points):
        key = (body[i],) + tuple(np.round(x / size * 1e9).astype(np.int64))
        # a coordinate on the edge of two boxes of rounding is looked for in both
        near = [k for k in neighbours(key) if k in number]
        if not near:
            number[key] = len(places)
            places.append(x)
        of_point[i] = number[near[0]] if near else number[key]
    return Exported(kind, order, np.array(places), of_point[cells], np.array(lattice) / order, patch)


def neighbours(key):
    """The boxes of rounding around one, itself first."""
    shifts = np.stack(np.meshgrid(*[[0, -1, 1]] * (len(key) - 1), indexing="ij"), -1).reshape(-1, len(key) - 1)
    return [(key[0],) + tuple(key[1 + k] + int(s[k]) for k in range(len(s))) for s in shifts]


def nodes(kind, p):
    """Multi-indices of VTK's Lagrange cells, version 1.0 of the file format; node = multi-index / p."""
    return {"triangle": triangle, "quadrilateral": quadrilateral, "tetrahedron": tetrahedron, "hexahedron": hexahedron}[kind](p)


def edges(p):
    return ([(i, 0) for i in range(1, p)] + [(p, j) for j in range(1, p)]
            + [(i, p) for i in range(1, p)] + [(0, j) for j in range(1, p)])


def quadrilateral(p):
    inside = range(1, p)
    return [(0, 0), (p, 0), (p, p), (0, p)] + edges(p) + [(i, j) for j in inside for i in inside]


def hexahedron(p):
    corners, inside = [(0, 0), (p, 0), (p, p), (0, p)], range(1, p)
    found = [(i, j, k) for k in (0, p) for i, j in corners]
    found += [(i, j, k) for k in (0, p) for i, j in edges(p)]
    found += [(i, j, k) for i, j in corners for k in inside]
    found += [(i, j, k) for i in (0, p) for k in inside for j in inside]
    found += [(i, j, k) for j in (0, p) for k in inside for i in inside]
    found += [(i, j, k) for k in (0, p) for j in inside for i in inside]
    return found + [(i, j, k) for k in inside for j in inside for i in inside]


def triangle(p):
    if p == 0:
        return [(0, 0)]
    found = [(0, 0), (p, 0), (0, p)]
    found += [(i, 0) for i in range(1, p)] + [(p - i, i) for i in range(1, p)] + [(0, p - i) for i in range(1, p)]
    return found + ([(i + 1, j + 1) for i, j in triangle(p - 3)] if p >= 3 else [])


def tetrahedron(p):
    assert p <= 3, "nodes inside a tetrahedron are not listed"

    def place(*on):
        b = [0] * 4
        for vertex, n in on:
            b[vertex] += n
        return tuple(b[1:])

    found = [place((v, p)) for v in range(4)]
    for a, b in [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]:
        found += [place((a, p - i), (b, i)) for i in range(1, p)]
    if p >= 3:
        for a, b, c in [(0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)]:
            found += [place((a, p - 2 - i - j), (b, i + 1), (c, j + 1)) for i, j in triangle(p - 3)]
    return found
