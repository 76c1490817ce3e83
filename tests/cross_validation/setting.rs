//! A problem beside what its answers are computed from: bodies, materials and springs, by names.

use crate::choices::{Choices, Discretisation};
use crate::pressed::Pressed;
use crate::tied::Tied;
use faying::assembly::{gauss_rules, gauss_rules_along, points_of_curved_cells, stiffness, trace_springs};
use faying::coupling::Side;
use faying::geometry::ControlNet;
use faying::linalg::{Csr, Matrix, Vector};
use faying::physics::{BodyFlux, Flux, Material, energy, form};
use faying::problem::{BodyId, BodyMaterial, BodySpec, Data, Exact, Point, Problem};
use faying::space::{Body, Divisions, Field, Grading, Mesh, Patch, PatchSpec, Trace, divided};
use std::sync::Arc;

/// A problem, its bodies, its ties and its contacts.
pub struct Setting<const S: usize, const N: usize> {
    pub problem: Problem<S, N>,
    pub bodies: Vec<Member<S, N>>,
    pub ties: Vec<Tied<S, N>>,
    pub contacts: Vec<Pressed<S, N>>,
    /// The exact solution, if there is one.
    pub exact: Option<Box<dyn Exact>>,
    springs: Vec<Spring>,
}

/// Springs on a side of a body.
struct Spring {
    body: BodyId,
    side: String,
    component: usize,
    stiffness: Data,
}

/// Adds springs of a component to a matrix: trace, extra points of its rule, component and stiffness.
type AddSprings<const S: usize, const N: usize> = dyn Fn(&Trace<S, N>, usize, usize, &Data, &mut Csr);
/// Makes the flux of a body through a trace.
type MakeFlux<const S: usize, const N: usize> = dyn Fn(&Trace<S, N>, Field) -> Box<dyn Flux<S, N>>;

/// A body of a problem.
pub struct Member<const S: usize, const N: usize> {
    pub name: String,
    pub id: BodyId,
    pub body: Arc<dyn Body<S, N>>,
    /// Places of its unknowns.
    pub field: Field,
    matrix: Box<dyn Fn() -> Csr>,
    springs: Box<AddSprings<S, N>>,
    flux: Box<MakeFlux<S, N>>,
    extra_points: usize,
}

impl<const S: usize, const N: usize> Member<S, N> {
    /// Number of its unknowns.
    pub fn unknowns(&self) -> usize {
        self.field.components * self.body.space().num_functions()
    }

    pub fn trace(&self, side: &str) -> Trace<S, N> {
        self.body.trace(side).unwrap_or_else(|e| panic!("{}.{side}: {e}", self.name))
    }

    /// The flux through a side.
    pub fn flux(&self, trace: &Trace<S, N>) -> Box<dyn Flux<S, N>> {
        (self.flux)(trace, self.field)
    }

    /// A side of it for couplings.
    pub fn side<'a>(&self, trace: &'a Trace<S, N>, flux: Option<&'a dyn Flux<S, N>>) -> Side<'a, S, N> {
        Side { trace, field: self.field, flux }
    }
}

/// Geometry of a body, its elements and its discretisation, both by default.
pub struct Shape<const N: usize> {
    pub name: &'static str,
    pub net: ControlNet<N, N>,
    pub elements: [Divisions; N],
    pub grading: [Option<Grading>; N],
    pub by_default: Discretisation,
}

impl<const N: usize> Shape<N> {
    /// A spline body of degree 2 with so many elements.
    pub fn new(name: &'static str, net: ControlNet<N, N>, elements: [usize; N]) -> Self {
        let elements = elements.map(Divisions::Total);
        Self { name, net, elements, grading: [None; N], by_default: Discretisation::default() }
    }

    /// Its patch or mesh as `choices` have it, and the extra points of its rules.
    fn body<const S: usize>(self, choices: &Choices) -> (Arc<dyn Body<S, N>>, usize)
    where
        Patch<S, N>: Body<S, N>,
        Mesh<S, N>: Body<S, N>,
    {
        let d = choices.discretisation(self.name, self.by_default);
        let (elements, refine) = choices.elements(self.name, self.elements);
        let axis = |k: usize| divided(self.net.axes[k].breakpoints(), &elements[k], self.grading[k], refine).unwrap();
        let breakpoints = std::array::from_fn(axis);
        let spec = PatchSpec {
            degree: [d.degree; N],
            breakpoints,
            continuity: d.continuity,
            basis: d.basis,
            cells: d.cells,
            mapping: d.mapping,
            ..PatchSpec::new(self.net)
        };
        let body: Arc<dyn Body<S, N>> =
            if d.is_fe { Arc::new(Mesh::from_patch(&spec).unwrap()) } else { Arc::new(Patch::try_new(&spec).unwrap()) };
        (body, d.extra_points)
    }
}

impl<const S: usize, const N: usize> Setting<S, N> {
    /// Nothing yet.
    pub fn new() -> Self {
        let problem = Problem::new();
        Self { problem, bodies: Vec::new(), ties: Vec::new(), contacts: Vec::new(), exact: None, springs: Vec::new() }
    }

    /// Adds the body of a shape.
    pub fn shape<const C: usize>(&mut self, choices: &Choices, shape: Shape<N>, material: impl Material<C, N> + Clone + 'static) -> BodyId
    where
        Patch<S, N>: Body<S, N>,
        Mesh<S, N>: Body<S, N>,
    {
        let name = shape.name;
        let (body, extra_points) = shape.body(choices);
        self.add(BodySpec { extra_points, is_shaped: true, ..spec(name, body, &material) }, material)
    }

    /// Adds a body of its own.
    pub fn body<const C: usize>(
        &mut self,
        name: &str,
        body: Arc<dyn Body<S, N>>,
        extra_points: usize,
        material: impl Material<C, N> + Clone + 'static,
    ) -> BodyId {
        self.add(BodySpec { extra_points, ..spec(name, body, &material) }, material)
    }

    fn add<const C: usize>(&mut self, spec: BodySpec<S, N>, material: impl Material<C, N> + 'static) -> BodyId {
        let (name, body, extra) = (spec.name.clone(), spec.body.clone(), spec.extra_points);
        let id = self.problem.add(spec).unwrap();
        let material: Arc<dyn Material<C, N>> = Arc::new(material);
        let space = body.space().clone();
        let curved = points_of_curved_cells(&*space);
        let rules = gauss_rules_along(&*space, curved.map(|k| k + extra));
        let (of_matrix, of_flux) = (Arc::clone(&material), material);
        let field = Field { first: self.bodies.iter().map(Member::unknowns).sum(), components: C };
        let inner = space.clone();
        self.bodies.push(Member {
            name,
            id,
            body,
            field,
            matrix: Box::new(move || stiffness(&*inner, &rules, &form(&*of_matrix).unwrap())),
            springs: Box::new(|trace, extra, component, data, matrix| {
                let mut only = Matrix::<C, C>::zeros();
                only[(component, component)] = 1.0;
                let k = |x: &Vector<N>, _: &Vector<N>| only * data.value(&Point::new(x.as_slice()));
                trace_springs::<C, S, N, _, _>(trace, &gauss_rules(&*trace.space, extra), &k, matrix);
            }),
            flux: Box::new(move |trace, field| {
                Box::new(BodyFlux::<C, S, N>::new(space.clone(), trace.clone(), field, of_flux.clone()).unwrap())
            }),
            extra_points: extra + curved.into_iter().max().unwrap_or(0),
        });
        id
    }

    /// Says the exact solution.
    pub fn exact(&mut self, exact: impl Exact + Clone + 'static) {
        self.problem.exact(exact.clone());
        self.exact = Some(Box::new(exact));
    }

    /// Puts springs on a side.
    pub fn spring(&mut self, body: BodyId, side: &str, component: usize, stiffness: Data) {
        self.problem.spring(body.side(side), component, stiffness.clone()).unwrap();
        self.springs.push(Spring { body, side: side.into(), component, stiffness });
    }

    /// The body of a handle.
    pub fn member(&self, id: BodyId) -> &Member<S, N> {
        self.bodies.iter().find(|b| b.id == id).unwrap()
    }

    /// The body of a name.
    pub fn named(&self, name: &str) -> &Member<S, N> {
        self.bodies.iter().find(|b| b.name == name).unwrap_or_else(|| panic!("no body {name}"))
    }

    /// Half of uᵀ K u for the unknowns of a body, its springs included.
    pub fn energy_of(&self, member: &Member<S, N>, u: &[f64]) -> f64 {
        let mut matrix = (member.matrix)();
        for s in self.springs.iter().filter(|s| s.body == member.id) {
            (member.springs)(&member.trace(&s.side), member.extra_points, s.component, &s.stiffness, &mut matrix);
        }
        energy(&matrix, u)
    }
}

fn spec<const C: usize, const S: usize, const N: usize>(
    name: &str,
    body: Arc<dyn Body<S, N>>,
    material: &(impl Material<C, N> + Clone + 'static),
) -> BodySpec<S, N> {
    BodySpec::new(name, body, BodyMaterial::of::<C>(material.clone()).unwrap())
}
