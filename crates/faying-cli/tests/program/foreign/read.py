"""Reads a mesh with Gmsh and with meshio: measures per dimension, element types, groups with their cells, counts of meshio."""
import json
import sys

import gmsh
import meshio
import numpy as np


def by_gmsh(path):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(path)
    mesh = gmsh.model.mesh
    measures = []
    for dimension in range(1, 4):
        total = 0.0
        for kind in mesh.getElementTypes(dimension):
            points, weights = mesh.getIntegrationPoints(kind, "Gauss8")
            _, determinants, _ = mesh.getJacobians(kind, points)
            total += float((np.abs(determinants).reshape(-1, len(weights)) @ weights).sum())
        measures.append(total)
    groups = []
    for dimension, number in gmsh.model.getPhysicalGroups():
        cells = 0
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, number):
            cells += sum(len(tags) for tags in mesh.getElements(dimension, entity)[1])
        groups.append([int(dimension), int(number), gmsh.model.getPhysicalName(dimension, number), cells])
    kinds = sorted(int(kind) for kind in mesh.getElementTypes())
    gmsh.finalize()
    return {"measures": measures, "groups": sorted(groups), "types": kinds}


def by_meshio(path):
    counts = {}
    mesh = meshio.read(path)
    for cells in mesh.cells:
        counts[cells.type] = counts.get(cells.type, 0) + len(cells.data)
    return {"cells": dict(sorted(counts.items())), "names": sorted(mesh.field_data)}


print(json.dumps([[by_gmsh(path), by_meshio(path)] for path in sys.argv[1:]]))
