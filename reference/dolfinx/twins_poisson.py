"""Same-mesh twins: Poisson, -div(k grad u) = f, in the plane and in space.

cases/twin-poisson-*.toml state the problems: straight cells (varying k, source, linear Dirichlet data on two sides that meet, flux,
spring) and curved isoparametric cells (a quarter ring and a quarter tube: varying k, a manufactured solution with its fluxes on the
arcs), triangles, quadrilaterals, tetrahedra and hexahedra of degree 1 to 4 (3 in space). Computed: u at all nodes, energy (of the
matrix, springs included), reactions, and norms of the error where the solution is known.

Error: none but rounding, the discrete problem is the same one; `agreement` says what may be left. The quadrature is not ours, and
both have enough points: what they differ by is part of what is compared.
Cost: about 50 s of one core with an empty cache of forms.
"""

import forms  # noqa: F401 (first: quiets the form compiler)
import numpy as np
import record
import twin

BOX = {"body.left": lambda x: x[0], "body.right": lambda x: x[0] - 1, "body.bottom": lambda x: x[1], "body.top": lambda x: x[1] - 1.5}
RING = {"body.u0": lambda x: x[1], "body.u1": lambda x: x[0], "body.v0": lambda x: np.hypot(x[0], x[1]) - 1,
        "body.v1": lambda x: np.hypot(x[0], x[1]) - 2}
BLOCK = {"body.left": lambda x: x[0], "body.right": lambda x: x[0] - 1, "body.front": lambda x: x[1], "body.back": lambda x: x[1] - 1.5,
         "body.bottom": lambda x: x[2], "body.top": lambda x: x[2] - 0.8}
TUBE = RING | {"body.w0": lambda x: x[2], "body.w1": lambda x: x[2] - 0.8}
CELLS = ("simplex", "tensor")

PROBLEMS = [
    {"case": "twin-poisson-box", "sides": BOX,
     "features": ["straight", "coefficient", "source", "dirichlet", "shared corners", "neumann", "spring"],
     "runs": [(cells, p, 7, 2 * p + 16, []) for cells in CELLS for p in (1, 2, 3, 4)]},
    {"case": "twin-poisson-ring", "sides": RING,
     "features": ["curved", "coefficient", "exact", "dirichlet", "neumann"],
     "runs": [(cells, p, 9, 28, []) for cells in CELLS for p in (1, 2, 3, 4)]},
    {"case": "twin-poisson-block", "sides": BLOCK,
     "features": ["straight", "coefficient", "source", "dirichlet", "shared corners", "neumann", "spring"],
     "runs": [(cells, p, 2, 2 * p + 2, []) for cells in CELLS for p in (1, 2, 3)]},
    {"case": "twin-poisson-shell", "sides": TUBE,
     "features": ["curved", "coefficient", "exact", "dirichlet", "neumann"],
     "runs": [(cells, p, 10 - p, 22 if cells == "simplex" else 18, []) for cells in CELLS for p in (1, 2, 3)]},
]

record.write("Poisson on the meshes of our own cases: the same discrete problems", **twin.document(PROBLEMS))
