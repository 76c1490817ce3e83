"""Same-mesh twins: elasticity in space.

cases/twin-solid-*.toml state the problems: a block on straight cells (varying stiffness, body force, linear Dirichlet data that share
an edge, tractions, pressure, springs), a quarter tube on curved isoparametric cells (sliding supports, pressure and springs on the
cylinders), and a block with a doubly curved top (a manufactured solution and its tractions); tetrahedra and hexahedra of degree 1 to
3. Computed: u at all nodes, energy (of the matrix, springs included), reactions, and norms of the error where the solution is known.

Error: none but rounding, the discrete problem is the same one; `agreement` says what may be left. The quadrature is not ours, and
both have enough points: what they differ by is part of what is compared.
Cost: about 60 s of one core with an empty cache of forms.
"""

import forms  # noqa: F401 (first: quiets the form compiler)
import numpy as np
import record
import twin

BOX = {"body.left": lambda x: x[0], "body.right": lambda x: x[0] - 1, "body.bottom": lambda x: x[2], "body.top": lambda x: x[2] - 0.8}
TUBE = {"body.u0": lambda x: x[1], "body.u1": lambda x: x[0], "body.v0": lambda x: np.hypot(x[0], x[1]) - 1,
        "body.v1": lambda x: np.hypot(x[0], x[1]) - 2, "body.w0": lambda x: x[2], "body.w1": lambda x: x[2] - 0.8}


def top(x):
    """Height over the curved top, whose control points are lifted: 0.8 + 0.1 b(x) + 0.1 b(y) + 0.2 b(x) b(y), b(s) = 2 s (1 - s)."""
    a, b = 2 * x[0] * (1 - x[0]), 2 * x[1] * (1 - x[1])
    return x[2] - (0.8 + 0.1 * a + 0.1 * b + 0.2 * a * b)


DOME = {"body.u0": lambda x: x[0], "body.u1": lambda x: x[0] - 1, "body.v0": lambda x: x[1], "body.v1": lambda x: x[1] - 1,
        "body.w0": lambda x: x[2], "body.w1": top}

CELLS, DEGREES, ONE = ("simplex", "tensor"), (1, 2, 3), ["patch.body.elements=[1, 1, 1]"]
PROBLEMS = [
    {"case": "twin-solid-box", "sides": BOX,
     "features": ["straight", "coefficient", "body_force", "dirichlet", "shared corners", "sliding", "traction", "pressure", "spring"],
     "runs": [(c, p, 2, 2 * p + 2, []) for c in CELLS for p in DEGREES]},
    {"case": "twin-solid-tube", "sides": TUBE,
     "features": ["curved", "coefficient", "body_force", "sliding", "traction", "pressure", "spring"],
     "runs": [(c, p, 10 - p, 22 if c == "simplex" else 18, []) for c in CELLS for p in DEGREES]},
    {"case": "twin-solid-dome", "sides": DOME, "features": ["curved", "coefficient", "exact", "dirichlet", "traction"],
     "runs": [(c, p, 10 - p, 22 if c == "simplex" else 18, ONE if p == 3 else []) for c in CELLS for p in DEGREES]},
]

record.write("Elasticity in space on the meshes of our own cases: the same discrete problems", **twin.document(PROBLEMS))
