"""Same-mesh twins: elasticity in the plane, plane strain and plane stress.

cases/twin-plane-*.toml state the problems: a box on straight cells (varying stiffness, body force, linear Dirichlet data that share a
corner, tractions, pressure, springs), a quarter ring on curved isoparametric cells (sliding supports, a linear displacement, pressure
and springs on arcs), a plate with a hole (a manufactured solution and its tractions), and curved triangles from Gmsh; triangles and
quadrilaterals of degree 1 to 4. Computed: u at all nodes, energy (of the matrix, springs included), reactions, and norms of the error
where the solution is known.

Error: none but rounding, the discrete problem is the same one; `agreement` says what may be left. The quadrature is not ours, and
both have enough points: what they differ by is part of what is compared.
Cost: about 30 s of one core with an empty cache of forms.
"""

import forms  # noqa: F401 (first: quiets the form compiler)
import numpy as np
import record
import twin

BOX = {"body.left": lambda x: x[0], "body.right": lambda x: x[0] - 1, "body.bottom": lambda x: x[1], "body.top": lambda x: x[1] - 1.5}
RING = {"body.u0": lambda x: x[1], "body.u1": lambda x: x[0], "body.v0": lambda x: np.hypot(x[0], x[1]) - 1,
        "body.v1": lambda x: np.hypot(x[0], x[1]) - 2}
HOLE = {"body.u0": lambda x: x[1], "body.u1": lambda x: x[0], "body.v0": lambda x: np.hypot(x[0], x[1]) - 1,
        "body.v1": lambda x: np.maximum(x[0], x[1]) - 2.5}
GMSH = {'body."x axis"': lambda x: x[1], 'body."y axis"': lambda x: x[0], "body.right": lambda x: x[0] - 4,
        "body.arc": lambda x: np.hypot(x[0], x[1]) - 2}
STRESS, STRAIN = ["model.assumption=plane-stress"], ["model.assumption=plane-strain"]
CELLS = ("simplex", "tensor")

PROBLEMS = [
    {"case": "twin-plane-box", "sides": BOX,
     "features": ["straight", "coefficient", "body_force", "dirichlet", "shared corners", "sliding", "traction", "pressure", "spring"],
     "runs": [(c, p, 7, 2 * p + 16, STRAIN if c == "simplex" else STRESS) for c in CELLS for p in (1, 2, 3, 4)]},
    {"case": "twin-plane-ring", "sides": RING,
     "features": ["curved", "coefficient", "dirichlet on an arc", "shared corners", "sliding", "traction", "pressure", "spring"],
     "runs": [(c, p, 9, 28, STRESS if c == "simplex" else STRAIN) for c in CELLS for p in (1, 2, 3, 4)]},
    {"case": "twin-plane-hole", "sides": HOLE, "features": ["curved", "coefficient", "exact", "dirichlet", "sliding", "traction"],
     "runs": [(c, p, 10, 30, STRAIN if c == "simplex" else STRESS) for c in CELLS for p in (1, 2, 3, 4)]},
    {"case": "twin-plane-gmsh", "sides": GMSH, "features": ["curved", "sliding", "traction", "pressure", "gmsh"],
     "runs": [(None, 2, 4, 14, [])]},
]

record.write("Plane elasticity on the meshes of our own cases: the same discrete problems", **twin.document(PROBLEMS))
