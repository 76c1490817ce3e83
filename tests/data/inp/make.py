"""Writes the input files of this folder by Gmsh (4.15.2), and prints what Gmsh's own Gauss points measure on each: area or volume, length or area of "rim".

    target/python/bin/python3 make.py
"""
import gmsh
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)


def measure(dimension, entities):
    total, mesh = 0.0, gmsh.model.mesh
    for entity in entities:
        for kind in mesh.getElementTypes(dimension, entity):
            points, weights = mesh.getIntegrationPoints(kind, "Gauss10")
            _, determinants, _ = mesh.getJacobians(kind, points, entity)
            total += float((np.abs(determinants).reshape(-1, len(weights)) @ weights).sum())
    return total


def write(name, solid, order, recombine):
    gmsh.clear()
    gmsh.model.add(name)
    occ = gmsh.model.occ
    body = (2, occ.addDisk(0, 0, 0, 1, 1))
    if solid and recombine:
        body = next(e for e in occ.extrude([body], 0, 0, 1, numElements=[1], recombine=True) if e[0] == 3)
    elif solid:
        body = (3, occ.addSphere(0, 0, 0, 1))
    occ.synchronize()
    if not (solid and recombine):
        rim = [b[1] for b in gmsh.model.getBoundary([body], oriented=False)]
    else:
        rim = [s[1] for s in gmsh.model.getEntities(2) if abs(occ.getCenterOfMass(*s)[2] - 0.5) < 0.1]
    gmsh.model.addPhysicalGroup(body[0], [body[1]], 1, "body")
    gmsh.model.addPhysicalGroup(body[0] - 1, rim, 2, "rim")
    for option, value in [("MeshSizeMax", 0.8), ("MeshSizeMin", 0.8), ("RecombineAll", recombine), ("ElementOrder", order), ("SecondOrderIncomplete", recombine), ("SaveGroupsOfNodes", 1), ("SaveAll", 0)]:
        gmsh.option.setNumber(f"Mesh.{option}", value)
    gmsh.model.mesh.generate(body[0])
    gmsh.write(f"{name}.inp")
    print(name, repr(measure(body[0], [body[1]])), repr(measure(body[0] - 1, rim)))


for name, solid, order, recombine in [
    ("disc_tri_1", 0, 1, 0),
    ("disc_tri_2", 0, 2, 0),
    ("disc_quad_1", 0, 1, 1),
    ("disc_quad_2", 0, 2, 1),
    ("ball_tet_1", 1, 1, 0),
    ("ball_tet_2", 1, 2, 0),
    ("drum_hex_1", 1, 1, 1),
    ("drum_hex_2", 1, 2, 1),
]:
    write(name, solid, order, recombine)
