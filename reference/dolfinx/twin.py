"""The same discrete problem as a case file states, solved by dolfinx on the mesh that the program exports.

The case file itself is read here: laws, formulas, loads and supports have one text, and two programs that interpret it. What is
read: one patch, one material, `exact` or `body_force` / `source`, and of boundaries `fix`, `dirichlet`, `neumann`, `traction`,
`pressure`, `spring`. Anything else is refused.

Newer dolfinx: `form_compiler_params` is `form_compiler_options`, `Function.vector` is `Function.x.petsc_vec`, elements come from
`basix.ufl` and spaces from `fem.functionspace`, `dolfinx.fem.petsc` is imported by name.
"""

import os
import time
import tomllib

import exported
import forms
import numpy as np
import ufl
from dolfinx import fem, mesh
from petsc4py import PETSc

AXES = "xyz"
# by default the form compiler takes numbers of its tables for 0 or 1 within 1e-9
EXACT_TABLES = {"table_rtol": 1e-15, "table_atol": 1e-16}
SYMBOLS = {"ufl": {name: getattr(ufl, name) for name in ("sin", "cos", "exp", "sqrt", "ln")} | {"log": ufl.ln},
           "numpy": {name: getattr(np, name) for name in ("sin", "cos", "exp", "sqrt", "log")}}
KNOWN = {"model": {"physics", "dimension", "assumption", "exact", "body_force", "source"},
         "patch": {"name", "geometry", "elements"},
         "material": {"name", "young", "poisson", "conductivity"},
         "boundary": {"on", "fix", "dirichlet", "neumann", "traction", "pressure", "spring"}}
# digits of what is stored, and of places, which only tell nodes apart
DIGITS, PLACE_DIGITS = 13, 8
# what may differ between the program and dolfinx, relative to the largest of each kind; of an error norm relative to itself, which is
# a small part of the solution
AGREEMENT = {"u": 1e-11, "energy": 1e-11, "reactions": 1e-11, "errors": 1e-9}


class Case:
    """A case file with `--set` texts of the form table.key=value."""

    def __init__(self, name, sets):
        with open(os.path.join(exported.HERE, "cases", name + ".toml"), "rb") as file:
            self.tree = tomllib.load(file)
        for text in sets:
            path, value = text.split("=", 1)
            *tables, key = path.split(".")
            at = self.tree
            for table in tables:
                at = at[table] if not isinstance(at, list) else next(entry for entry in at if entry["name"] == table)
            try:
                at[key] = tomllib.loads(f"value = {value}")["value"]
            except tomllib.TOMLDecodeError:
                at[key] = value
        assert len(self.tree["patch"]) == 1 and len(self.tree.get("material", [{}])) <= 1, "one patch, one material"
        assert set(self.tree) <= {"schema", "title", "let", "model", "discretization", "material", "patch", "boundary", "probe", "check"}
        self.model, self.blocks = self.tree["model"], self.tree["boundary"]
        self.material = self.tree.get("material", [{}])[0]
        tables = [(self.model, "model"), (self.material, "material"), (self.tree["patch"][0], "patch")]
        for table, known in tables + [(block, "boundary") for block in self.blocks]:
            assert set(table) <= KNOWN[known], f"keys of {known} that a twin does not read: {set(table) - KNOWN[known]}"
        self.components = 1 if self.model["physics"] == "poisson" else self.model["dimension"]

    def law(self):
        """poisson, plane-strain, plane-stress or solid."""
        if self.model["physics"] == "poisson":
            return "poisson"
        return "solid" if self.model["dimension"] == 3 else self.model.get("assumption", "plane-strain")

    def formula(self, text, x, library):
        """A formula at the coordinates x, as an expression of "ufl" or as numbers of "numpy"."""
        names = dict(zip(AXES, x)) | {"pi": np.pi, "e": np.e, "t": 1.0} | SYMBOLS[library]
        names["r"] = names["sqrt"](x[0] ** 2 + x[1] ** 2)
        for name, value in self.tree.get("let", {}).items():
            names[name] = evaluated(value, names)
        return evaluated(text, names)

    def per_component(self, value, key):
        """{component: formula} of data that are one formula, a list, a table, or "exact"."""
        if value == "exact":
            value = self.model["exact"]["u"]
        if isinstance(value, dict):
            return {AXES.index(c): self.one(text, AXES.index(c)) for c, text in value.items()}
        if isinstance(value, list):
            return dict(enumerate(value))
        assert self.components == 1, f"`{key}` of elasticity has a value per component"
        return {0: value}

    def one(self, text, component):
        return self.model["exact"]["u"][component] if text == "exact" else text


def evaluated(value, names):
    return eval(value.replace("^", "**"), {"__builtins__": {}}, names) if isinstance(value, str) else value


def form(expression):
    return fem.form(expression, form_compiler_params=EXACT_TABLES)


class Twin:
    """Forms, solution and numbers of a case on its exported mesh."""

    def __init__(self, name, sets, sides, quadrature, shared=False):
        """sides: {"patch.side": function of x that is 0 there}; quadrature: degree of the rule in cells and on sides; shared: sides
        that meet hold the same component."""
        self.case, self.names = Case(name, sets), list(sides)
        made = exported.export(name, sets)
        self.kind, self.degree, self.elements = made.kind, made.order, len(made.cells)
        self.mesh = forms.dolfinx_mesh(made)
        self.sides = forms.Sides(self.mesh, list(sides.values()), quadrature)
        self.ds = self.of_blocks(quadrature)
        self.dx = ufl.dx(domain=self.mesh, metadata={"quadrature_degree": quadrature})
        self.x, self.n = ufl.SpatialCoordinate(self.mesh), ufl.FacetNormal(self.mesh)
        # what a corner gives to each of its sides depends on its function: then those of Gauss-Lobatto points, as ours; else those
        # of the geometry, whose tables are compiled already
        self.shared = shared
        components = 0 if self.case.components == 1 else self.case.components
        self.nodal = self.space = forms.space(self.mesh, self.degree, components)
        if shared:
            one = ufl.FiniteElement("Lagrange", self.mesh.ufl_cell(), self.degree)
            self.space = fem.FunctionSpace(self.mesh, ufl.VectorElement(one, dim=components) if components else one)
        self.exact = self.vector(self.case.model["exact"]["u"]) if "exact" in self.case.model else None
        self.solve()

    def value(self, text):
        return self.case.formula(text, self.x, "ufl")

    def vector(self, texts):
        """A scalar of one formula, a vector of several."""
        return self.value(texts) if self.case.components == 1 else ufl.as_vector([self.value(t) for t in texts])

    def flux(self, u):
        """k grad u, or the stress."""
        if self.case.components == 1:
            return self.value(self.case.material.get("conductivity", 1.0)) * ufl.grad(u)
        young, poisson = (self.value(self.case.material[key]) for key in ("young", "poisson"))
        return forms.stress(u, *forms.lame(young, poisson, self.case.model.get("assumption") == "plane-stress"))

    def strain(self, v):
        return ufl.grad(v) if self.case.components == 1 else forms.eps(v)

    def part(self, v, component):
        return v if self.case.components == 1 else v[component]

    def on(self, block):
        """Numbers of the sides of a block in the measure."""
        return [1 + self.names.index(side) for side in ([block["on"]] if isinstance(block["on"], str) else block["on"])]

    def of_blocks(self, quadrature):
        """The measure of all sides of block k as ds(k): one compiled integral per block, not per side."""
        facets = [np.concatenate([self.sides.facets[side - 1] for side in self.on(block)]) for block in self.case.blocks]
        numbers = np.repeat(np.arange(len(facets), dtype=np.int32), [len(f) for f in facets])
        facets = np.concatenate(facets).astype(np.int32)
        order = np.argsort(facets)
        assert len(np.unique(facets)) == len(facets), "a side in two blocks"
        tags = mesh.meshtags(self.mesh, self.sides.dim, facets[order], numbers[order])
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=tags, metadata={"quadrature_degree": quadrature})

    def forms(self):
        u, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        stiffness = ufl.inner(self.flux(u), self.strain(v)) * self.dx
        if self.exact is not None:
            source = -ufl.div(self.flux(self.exact))
        else:
            zero = "0*x" if self.case.components == 1 else ["0*x"] * self.case.components
            source = self.vector(self.case.model.get("body_force", self.case.model.get("source", zero)))
        load = ufl.inner(source, v) * self.dx
        for number, block in enumerate(self.case.blocks):
            for term in self.loads(block, v):
                load = load + term * self.ds(number)
            for c, k in self.case.per_component(block.get("spring", {}), "spring").items():
                stiffness = stiffness + self.value(k) * self.part(u, c) * self.part(v, c) * self.ds(number)
        return stiffness, load

    def loads(self, block, v):
        """What a block adds on its sides."""
        if "pressure" in block:
            yield -self.value(block["pressure"]) * ufl.dot(self.n, v)
        given = block.get("traction", block.get("neumann", {}))
        if given == "exact":
            yield ufl.inner(ufl.dot(self.flux(self.exact), self.n), v)
        elif isinstance(given, dict) and "exact" in given.values():
            traction = ufl.dot(self.flux(self.exact), self.n)
            for c, text in given.items():
                yield (self.part(traction, AXES.index(c)) if text == "exact" else self.value(text)) * self.part(v, AXES.index(c))
        else:
            for c, text in self.case.per_component(given, "traction").items():
                yield self.value(text) * self.part(v, c)

    def prescribed(self):
        """{(side, component): formula} of all supports."""
        held = {}
        for block in self.case.blocks:
            for side in self.on(block):
                for c in block.get("fix", []):
                    held[side, AXES.index(c)] = 0.0
                for c, text in self.case.per_component(block.get("dirichlet", {}), "dirichlet").items():
                    held[side, c] = text
        return held

    def solve(self):
        a, L = (form(f) for f in self.forms())
        self.held = self.prescribed()
        conditions = []
        for (side, c), text in self.held.items():
            def value(x, text=text):
                return self.case.formula(text, x, "numpy") + 0 * x[0]
            conditions.append(self.sides.fixed(self.space, side, c if self.case.components > 1 else None, value))
        matrix = fem.petsc.assemble_matrix(a, bcs=conditions)
        matrix.assemble()
        rhs = fem.petsc.assemble_vector(L)
        self.full = fem.petsc.assemble_matrix(a)
        self.full.assemble()
        self.load = rhs.array.copy()
        fem.petsc.apply_lifting(rhs, [a], bcs=[conditions])
        fem.petsc.set_bc(rhs, conditions)
        self.u = fem.Function(self.space)
        solver = PETSc.KSP().create(self.mesh.comm)
        solver.setOperators(matrix)
        # direct, with one step of refinement
        solver.setType("richardson")
        solver.setTolerances(rtol=1e-16, atol=1e-300, max_it=2)
        solver.getPC().setType("lu")
        solver.getPC().setFactorSolverType("mumps")
        solver.solve(rhs, self.u.vector)

    def energy(self):
        u = self.u.vector
        return 0.5 * u.dot(self.full * u)

    def reactions(self):
        """({"side.component": force}, their scale): the residual a(u, v) - L(v) of what is held. A function that several sides
        hold in one direction is shared in proportion to its integrals over them, evenly where one is not positive: as the program
        reports it."""
        residual = (self.full * self.u.vector).array - self.load
        bs = self.space.dofmap.index_map_bs
        located = {side: fem.locate_dofs_topological(self.space, self.sides.dim, self.sides.facets[side - 1]) for side, _ in self.held}
        nodes = {side: set(found.tolist()) for side, found in located.items()}
        weights, sums = {}, {}
        for c in range(self.case.components):
            mine = [side for side, held in self.held if held == c]
            for node in sorted(set().union(*(nodes[side] for side in mine))) if mine else []:
                holders = [side for side in mine if node in nodes[side]]
                share = {side: 1.0 for side in holders}
                if len(holders) > 1:
                    assert self.shared, "sides that meet hold the same component"
                    for side in holders:
                        if side not in weights:
                            v = ufl.TestFunction(self.space)
                            weights[side] = fem.petsc.assemble_vector(form(self.part(v, 0) * self.sides.ds(side))).array
                    own = {side: weights[side][bs * node] / np.abs(weights[side]).max() for side in holders}
                    # corners of quadratic triangles have no integral
                    if min(own.values()) > 1e-9:
                        share = {side: weights[side][bs * node] for side in holders}
                for side in holders:
                    part = residual[bs * node + c] * share[side] / sum(share.values())
                    sums.setdefault((side, c), []).append(part)
        scale = max(np.abs(parts).sum() for parts in sums.values())
        label = "" if self.case.components == 1 else "."
        return {self.names[s - 1] + label + (AXES[c] if label else ""): sum(p) for (s, c), p in sorted(sums.items())}, scale

    def errors(self):
        """{quantity: {"value", "scale"}}: norms of u - exact, and of exact."""
        choose = [fem.Constant(self.mesh, 0.0) for _ in range(3)]
        e = self.u - self.exact
        square = (choose[0] * ufl.inner(e, e) + choose[1] * ufl.inner(ufl.grad(e), ufl.grad(e))
                  + choose[2] * ufl.inner(self.flux(e), self.strain(e))) * self.dx
        integral, kept, found = form(square), self.u.x.array.copy(), {}
        for k, norm in enumerate(["L2", "H1", "energy"]):
            for j in range(3):
                choose[j].value = float(j == k)
            self.u.x.array[:] = kept
            error = fem.assemble_scalar(integral) ** 0.5
            self.u.x.array[:] = 0
            found[f"error.u.{norm}"] = {"value": rounded(error), "scale": rounded(fem.assemble_scalar(integral) ** 0.5)}
        self.u.x.array[:] = kept
        return found

    def numbers(self):
        """Everything that is compared."""
        equispaced = fem.Function(self.nodal)
        equispaced.interpolate(self.u)
        places, values = forms.nodal(equispaced)
        reactions, scale = self.reactions()
        found = {"places": rounded(places, PLACE_DIGITS), "u": rounded(values), "energy": rounded(self.energy()),
                 "reactions": {k: rounded(v, scale=scale) for k, v in reactions.items()}, "reaction_scale": rounded(scale, 3)}
        return found | ({"errors": self.errors()} if self.exact is not None else {})


def rounded(values, digits=DIGITS, scale=None):
    """Numbers to so many digits of the largest."""
    scale = scale or np.abs(values).max()
    decimals = digits - 1 - int(np.floor(np.log10(scale)))
    cut = np.round(np.asarray(values, float), decimals) + 0.0
    return cut.tolist()


def document(problems):
    """The fields of a document: "places", one list of nodes per mesh, and "twins", one per problem, kind of cells and degree: {"case",
    "set", "law", "kind", "degree", "elements", "features", "places" (number of its list), "u", "energy", ..}.

    problems: dicts of case, features (words), sides, runs: list of (cells, degree, extra_points, quadrature, more `--set` texts)."""
    meshes, twins = [], []
    for problem in problems:
        for cells, degree, extra, quadrature, more in problem["runs"]:
            sets = [f"discretization.degree={degree}", f"discretization.extra_points={extra}"] + list(more)
            sets += [f"discretization.cells={cells}"] if cells else []
            started = time.time()
            twin = Twin(problem["case"], sets, problem["sides"], quadrature, "shared corners" in problem["features"])
            assert twin.degree == degree
            same_rule = cells == "tensor" and quadrature // 2 == degree + extra
            assert not same_rule, "two rules: otherwise too few points would stay unseen"
            numbers = twin.numbers()
            places = numbers.pop("places")
            if places not in meshes:
                meshes.append(places)
            twins.append({"case": problem["case"], "set": sets, "law": twin.case.law(), "kind": twin.kind, "degree": degree,
                          "elements": twin.elements, "features": problem["features"], "places": meshes.index(places), **numbers})
            print(f"{problem['case']} {twin.kind} {degree}: {twin.elements} elements, {time.time() - started:.1f} s", flush=True)
    return {"tolerance": 1e-9, "agreement": AGREEMENT, "places": meshes, "twins": twins}
