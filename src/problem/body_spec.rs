//! Bodies of a problem: materials, sources and weights.

use super::builder::Problem;
use super::changing::Changing;
use super::data::Data;
use super::error::{ErrorKind, ProblemError};
use super::handles::{BodyId, Statement};
use super::model::Foundation;
use super::physics::{Physics, PhysicsError};
use super::regions::SideNames;
use super::revolution_error::RevolutionError;
use crate::linalg::Vector;
use crate::physics::Material;
use crate::quadrature::PerElement;
use crate::space::Body;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// A body with all that may be said of it; [`Problem::body`] says name, body and material.
pub struct BodySpec<const S: usize, const N: usize> {
    /// Its name, one of its own in the problem.
    pub name: String,
    /// The body.
    pub body: Arc<dyn Body<S, N>>,
    /// Its material.
    pub material: BodyMaterial<N>,
    /// Gauss points per direction beyond those that degree and curved cells need.
    pub extra_points: usize,
    /// Rules of the integrals over the body, without the factor 2 pi r of bodies of revolution; `None`: Gauss rules.
    pub rules: Option<PerElement<N>>,
    /// The mesh before refinement, by whose facets the surface is known; `None`: the body itself.
    pub unrefined: Option<Arc<dyn Body<S, N>>>,
    /// Whether its facets stand for a geometry that is known, as those of a mesh made of a patch; not for meshes of cells.
    pub is_shaped: bool,
    /// Names of its sides in messages and results; `None`: those of the body.
    pub side_names: Option<SideNames>,
    /// Name of the backend that made it; may be empty.
    pub backend: String,
}

impl<const S: usize, const N: usize> Debug for BodySpec<S, N> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("BodySpec").field("name", &self.name).field("material", &self.material).finish_non_exhaustive()
    }
}

impl<const S: usize, const N: usize> BodySpec<S, N> {
    /// A body with a name and a material.
    pub fn new(name: &str, body: Arc<dyn Body<S, N>>, material: BodyMaterial<N>) -> Self {
        Self {
            name: name.into(),
            body,
            material,
            extra_points: 0,
            rules: None,
            unrefined: None,
            is_shaped: false,
            side_names: None,
            backend: String::new(),
        }
    }
}

/// A material, the same at all times or a function of time.
#[derive(Clone, Debug)]
pub enum BodyMaterial<const N: usize> {
    /// Independent of time.
    Constant(Physics<N>),
    /// A function of time.
    Changing(Changing<Physics<N>>),
}

impl<const N: usize> BodyMaterial<N> {
    /// A linear material of C components: 1, or one per coordinate.
    ///
    /// # Errors
    /// [`PhysicsError`] for a material that is not linear or has another number of components.
    pub fn of<const C: usize>(material: impl Material<C, N> + 'static) -> Result<Self, PhysicsError> {
        Physics::new::<C>(material).map(Self::Constant)
    }

    /// A material that changes with the time.
    pub fn changing(material: impl Fn(f64) -> Physics<N> + Send + Sync + 'static) -> Self {
        Self::Changing(Changing(Arc::new(material)))
    }

    fn at(&self, t: f64) -> Physics<N> {
        match self {
            Self::Constant(physics) => physics.clone(),
            Self::Changing(Changing(of)) => of(t),
        }
    }
}

impl<const S: usize, const N: usize> Problem<S, N> {
    /// Adds a body of a linear material of C components: 1, or one per coordinate.
    ///
    /// # Errors
    /// [`ErrorKind::Material`], and the errors of [`add`](Self::add).
    pub fn body<const C: usize>(
        &mut self,
        name: &str,
        body: impl Body<S, N> + 'static,
        material: impl Material<C, N> + 'static,
    ) -> Result<BodyId, ProblemError> {
        let material = BodyMaterial::of::<C>(material).map_err(|error| ProblemError::named(ErrorKind::Material(error), &[name]))?;
        self.add(BodySpec::new(name, Arc::new(body), material))
    }

    /// Adds a body.
    ///
    /// # Errors
    /// [`ErrorKind::NameTaken`], and [`ErrorKind::Mixed`] for a material with another number of components than those before it,
    /// [`ErrorKind::Revolution`] for an elastic one that is not of the kind of the problem.
    pub fn add(&mut self, spec: BodySpec<S, N>) -> Result<BodyId, ProblemError> {
        let BodySpec { name, body, material, extra_points, rules, unrefined, is_shaped, side_names, backend } = spec;
        if self.bodies.iter().any(|b| b.name == name) {
            return Err(ProblemError::named(ErrorKind::NameTaken, &[&name]));
        }
        let physics = material.at(self.times[0]);
        let (found, expected) = (physics.components(), self.bodies.first().map_or(physics.components(), |b| b.field.components));
        if found != expected {
            return Err(ProblemError::named(ErrorKind::Mixed { found, expected }, &[&name]));
        }
        if physics.components() > 1 && physics.is_of_revolution() != self.is_revolved {
            let error = if self.is_revolved { RevolutionError::NoHoopStrain } else { RevolutionError::HoopStrain };
            return Err(ProblemError::named(error.into(), &[&name]));
        }
        let first = self.bodies.last().map_or(0, |b| b.range().end);
        let id = self.body_id(self.bodies.len());
        let mut model = self.compiled.body((id, name), body, physics, first, extra_points);
        if let Some(rules) = rules {
            model.rules = rules;
        }
        if let BodyMaterial::Changing(changing) = material {
            model.changing = Some(changing);
        }
        if self.is_revolved {
            model = model.revolved();
        }
        (model.backend, model.unrefined) = (backend, unrefined);
        model.is_shaped = is_shaped && !model.exact_map;
        self.bodies.push(model);
        self.regions.add_body(side_names);
        Ok(id)
    }

    /// Loads a body by a force per volume, or a source, one function per component; several add up.
    ///
    /// # Errors
    /// [`ErrorKind::NoComponent`] for another number of components, [`ErrorKind::OtherProblem`].
    pub fn source(&mut self, body: BodyId, force: Vec<Data>) -> Result<Statement, ProblemError> {
        let number = self.number(body)?;
        let (component, components) = (force.len(), self.components());
        if component != components {
            return Err(ProblemError::named(ErrorKind::NoComponent { component, components }, &[]));
        }
        self.bodies[number].source.extend(force);
        let of = self.statement();
        self.volume_loads.push((of, number));
        Ok(of)
    }

    /// Holds a body, everywhere in it, by springs [force/volume per length] along a component; several add up. In problems of one component
    /// it is the term c u of -div(k grad u) + c u = f.
    ///
    /// The stiffness is not negative. Not beside an exact solution, whose source is that of a body without foundation.
    ///
    /// # Errors
    /// [`ErrorKind::NoComponent`], [`ErrorKind::OtherProblem`].
    #[doc(alias = "reaction")]
    pub fn foundation(&mut self, body: BodyId, component: usize, stiffness: impl Into<Data>) -> Result<Statement, ProblemError> {
        let (body, component) = (self.number(body)?, self.component(component)?);
        let of = self.statement();
        self.said.foundations.push(Foundation { of, body, component, stiffness: stiffness.into() });
        Ok(of)
    }

    /// Loads a body by its weight: its density [mass/volume] times the acceleration g of gravity.
    ///
    /// # Errors
    /// [`ErrorKind::Scalar`] in problems of one component, [`ErrorKind::OtherProblem`].
    pub fn gravity(&mut self, body: BodyId, density: impl Into<Data>, g: [f64; N]) -> Result<Statement, ProblemError> {
        let number = self.number(body)?;
        if self.components() == 1 {
            return Err(ProblemError::new(ErrorKind::Scalar, vec![body.into()], vec![self.bodies[number].name.clone()]));
        }
        self.bodies[number].weights.push((density.into(), Vector::from(g)));
        let of = self.statement();
        self.weight_loads.push((of, number));
        Ok(of)
    }
}
