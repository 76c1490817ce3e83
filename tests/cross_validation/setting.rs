//! A problem with its bodies, ties and contacts by names.

use crate::choices::{Choices, Discretisation};
use crate::pressed::Pressed;
use crate::tied::Tied;
use faying::geometry::ControlNet;
use faying::physics::Material;
use faying::problem::{BodyId, BodyMaterial, BodySpec, Exact, InterfaceSide, Problem};
use faying::space::{Body, Divisions, Grading, Mesh, Patch, PatchSpec, Trace, divided};
use std::sync::Arc;

/// A problem, its bodies, its ties and its contacts.
pub struct Setting<const S: usize, const N: usize> {
    pub problem: Problem<S, N>,
    pub bodies: Vec<Member<S, N>>,
    pub ties: Vec<Tied>,
    pub contacts: Vec<Pressed>,
    /// The exact solution, if there is one.
    pub exact: Option<Box<dyn Exact>>,
}

/// A body of a problem.
pub struct Member<const S: usize, const N: usize> {
    pub name: String,
    pub id: BodyId,
    pub body: Arc<dyn Body<S, N>>,
    /// Components of its unknown.
    pub components: usize,
}

impl<const S: usize, const N: usize> Member<S, N> {
    pub fn trace(&self, side: &str) -> Trace<S, N> {
        self.body.trace(side).unwrap_or_else(|e| panic!("{}.{side}: {e}", self.name))
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
        Trace<S, N>: InterfaceSide<S, N>,
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

impl<const S: usize, const N: usize> Setting<S, N>
where
    Trace<S, N>: InterfaceSide<S, N>,
{
    /// Nothing yet.
    pub fn new() -> Self {
        Self { problem: Problem::new(), bodies: Vec::new(), ties: Vec::new(), contacts: Vec::new(), exact: None }
    }

    /// Adds the body of a shape.
    pub fn shape<const C: usize>(&mut self, choices: &Choices, shape: Shape<N>, material: impl Material<C, N> + 'static) -> BodyId
    where
        Trace<S, N>: InterfaceSide<S, N>,
    {
        let name = shape.name;
        let (body, extra_points) = shape.body(choices);
        self.add::<C>(BodySpec { extra_points, is_shaped: true, ..spec(name, body, material) })
    }

    /// Adds a body of its own.
    pub fn body<const C: usize>(
        &mut self,
        name: &str,
        body: Arc<dyn Body<S, N>>,
        extra_points: usize,
        material: impl Material<C, N> + 'static,
    ) -> BodyId {
        self.add::<C>(BodySpec { extra_points, ..spec(name, body, material) })
    }

    fn add<const C: usize>(&mut self, spec: BodySpec<S, N>) -> BodyId {
        let (name, body) = (spec.name.clone(), spec.body.clone());
        let id = self.problem.add(spec).unwrap();
        self.bodies.push(Member { name, id, body, components: C });
        id
    }

    /// Says the exact solution.
    pub fn exact(&mut self, exact: impl Exact + Clone + 'static) {
        self.problem.exact(exact.clone());
        self.exact = Some(Box::new(exact));
    }

    /// The body of a handle.
    pub fn member(&self, id: BodyId) -> &Member<S, N> {
        self.bodies.iter().find(|b| b.id == id).unwrap()
    }

    /// The body of a name.
    pub fn named(&self, name: &str) -> &Member<S, N> {
        self.bodies.iter().find(|b| b.name == name).unwrap_or_else(|| panic!("no body {name}"))
    }
}

fn spec<const C: usize, const S: usize, const N: usize>(
    name: &str,
    body: Arc<dyn Body<S, N>>,
    material: impl Material<C, N> + 'static,
) -> BodySpec<S, N> {
    BodySpec::new(name, body, BodyMaterial::of::<C>(material).unwrap())
}
