//! Statements about regions: prescribed values, sliding, rigid sides, tractions, forces, springs.

use super::builder::Problem;
use super::data::Data;
use super::error::{ErrorKind, ProblemError};
use super::handles::{Components, Kind, Region, Statement, Unknown};
use super::model::{Action, BodySide, CurvedSlide, HeldSide, PointLoad, RigidSides, SaidEquation, SideLoad, SideSpring, Value, tangents};
use super::regions::RegionPart;
use crate::assembly::{Equation, planar_normal};
use crate::basis::Order;
use crate::geometry::MapTable;
use crate::linalg::Vector;
use crate::quadrature::Quadrature;
use std::sync::Arc;

/// Components of a unit normal below this count as zero.
const PERPENDICULAR: f64 = 1e-9;

impl<const S: usize, const N: usize> Problem<S, N> {
    /// A new handle of a support, a load, or of what joins bodies.
    pub(super) fn statement(&mut self) -> Statement {
        self.statements += 1;
        let number = self.statements - 1;
        Statement { problem: self.identity.maker(Kind::Other, number), kind: Kind::Other, number }
    }

    pub(super) fn component(&self, component: usize) -> Result<usize, ProblemError> {
        let components = self.components();
        if component < components { Ok(component) } else { Err(ProblemError::named(ErrorKind::NoComponent { component, components }, &[])) }
    }

    /// Names a load or springs in results and messages, in place of the label of their region. Loads of one such name are one in results.
    pub fn name(&mut self, of: Statement, name: &str) {
        let group = *self.groups.entry(name.to_owned()).or_insert(of);
        for load in self.said.loads.iter_mut().filter(|l| l.of == of) {
            (load.group, load.name) = (group, name.to_owned());
        }
        for load in self.said.point_loads.iter_mut().filter(|l| l.of == of) {
            (load.group, load.name) = (group, name.to_owned());
        }
        self.said.springs.iter_mut().filter(|s| s.of == of).for_each(|s| name.clone_into(&mut s.name));
    }

    /// Prescribes components to be zero on a side, an edge or in a corner.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::NoComponent`], [`ErrorKind::OtherProblem`].
    pub fn fix<'a>(&mut self, on: impl Into<Region<'a>>, components: Components) -> Result<Statement, ProblemError> {
        let all = match components {
            Components::All => 0..self.components(),
            Components::One(c) => self.component(c)?..c + 1,
        };
        self.prescribed(on.into(), all, &Value::Zero)
    }

    /// Prescribes a component on a side, an edge or in a corner: a number, a function, or [`Value::Exact`].
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix). A problem without the exact solution that it asks for is not assembled.
    pub fn prescribe<'a>(
        &mut self,
        on: impl Into<Region<'a>>,
        component: usize,
        value: impl Into<Value>,
    ) -> Result<Statement, ProblemError> {
        let component = self.component(component)?;
        self.prescribed(on.into(), component..component + 1, &value.into())
    }

    fn prescribed(&mut self, on: Region<'_>, components: std::ops::Range<usize>, value: &Value) -> Result<Statement, ProblemError> {
        let pieces = self.pieces(on)?;
        let of = self.statement();
        for piece in &pieces {
            components.clone().for_each(|c| self.said.condition(of, piece, c, value.clone()));
        }
        Ok(of)
    }

    /// Prescribes n . u = 0 on a side with the normals n: in every function of a planar side; of a curved one as ∫ ψ n . u ds = 0 for all
    /// functions ψ of the degree of the side. Its body has an exact map ([`Body::is_exact`](crate::space::Body::is_exact)): the normals of facets
    /// of degree p are wrong by h^p, which holds what should slide and costs an order.
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix), [`ErrorKind::NoNormal`], [`ErrorKind::Faceted`], [`ErrorKind::NotASide`], [`ErrorKind::Scalar`].
    pub fn fix_normal<'a>(&mut self, on: impl Into<Region<'a>>) -> Result<Statement, ProblemError> {
        self.sliding(on.into(), true)
    }

    /// Prescribes u - (n . u) n = 0 on a side with the normals n, as [`fix_normal`](Self::fix_normal) prescribes n . u = 0.
    ///
    /// # Errors
    /// Those of [`fix_normal`](Self::fix_normal).
    pub fn fix_tangential<'a>(&mut self, on: impl Into<Region<'a>>) -> Result<Statement, ProblemError> {
        self.sliding(on.into(), false)
    }

    /// Conditions where the normal is an axis, equations along other planar sides, rows on curved ones, each between the kinks of the side:
    /// in a kink the directions of both sides of it are held.
    fn sliding(&mut self, on: Region<'_>, along_normal: bool) -> Result<Statement, ProblemError> {
        let sides = self.sides_of(on)?;
        for side in &sides {
            let kind = if side.field.components == 1 { ErrorKind::Scalar } else { ErrorKind::NoNormal };
            if kind == ErrorKind::Scalar || !has_normal(side) {
                return Err(ProblemError::named(kind, &[&side.label]));
            }
            if !self.bodies[side.patch].exact_map && planar_normal(&side.trace).is_none() {
                return Err(ProblemError::named(ErrorKind::Faceted, &[&side.label]));
            }
        }
        let of = self.statement();
        for side in &sides {
            self.pieces_between_kinks(side).iter().for_each(|piece| self.slide(of, piece, along_normal));
        }
        Ok(of)
    }

    /// Says that a side without kinks slides.
    fn slide(&mut self, of: Statement, side: &Arc<BodySide<S, N>>, along_normal: bool) {
        let Some(normal) = planar_normal(&side.trace) else {
            self.said.slides.push(CurvedSlide { of, side: side.clone(), along_normal });
            self.said.support(side);
            return;
        };
        if let Some(axis) = (0..N).find(|&k| (normal[k].abs() - 1.0).abs() < PERPENDICULAR) {
            for component in (0..N).filter(|&c| (c == axis) == along_normal) {
                self.said.condition(of, &RegionPart::Side(side.clone()), component, Value::Zero);
            }
            return;
        }
        let directions: Vec<Vector<N>> = if along_normal { vec![normal] } else { tangents(&normal) };
        self.said.held.extend(directions.iter().map(|d| HeldSide { of, side: side.clone(), direction: *d }));
        let mut dofs = side.trace.dofs.clone();
        dofs.sort_unstable();
        dofs.dedup();
        for dof in dofs {
            for d in &directions {
                let terms = (0..N).filter(|&c| d[c].abs() > PERPENDICULAR).map(|c| (side.field.unknown(dof, c), d[c])).collect();
                self.said.equations.push(SaidEquation { of, equation: Equation { terms, value: 0.0 } });
            }
        }
        self.said.support(side);
    }

    /// Prescribes a linear combination of unknowns: the sum of factor times unknown is `value`. Rigid motions that it prevents are seen
    /// if its unknowns are components of one function on a side with a support.
    ///
    /// # Errors
    /// [`ErrorKind::NoComponent`], [`ErrorKind::NoFunction`], [`ErrorKind::OtherProblem`].
    pub fn equation(&mut self, terms: &[(Unknown, f64)], value: f64) -> Result<Statement, ProblemError> {
        let mut all = Vec::with_capacity(terms.len());
        for (unknown, factor) in terms {
            let (body, component) = (self.number(unknown.body)?, self.component(unknown.component)?);
            let body = &self.bodies[body];
            let functions = body.body.space().num_functions();
            if unknown.function >= functions {
                let kind = ErrorKind::NoFunction { function: unknown.function, functions };
                return Err(ProblemError::new(kind, vec![unknown.body.into()], vec![body.name.clone()]));
            }
            all.push((body.field.unknown(unknown.function, component), *factor));
        }
        let of = self.statement();
        self.said.equations.push(SaidEquation { of, equation: Equation { terms: all, value } });
        Ok(of)
    }

    /// Applies a component of a traction [force/area], or of a flux k du/dn: a number, a function, or [`Value::Exact`].
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix), and [`ErrorKind::NotASide`]. A problem without the exact solution that it asks for is not assembled.
    pub fn traction<'a>(
        &mut self,
        on: impl Into<Region<'a>>,
        component: usize,
        traction: impl Into<Value>,
    ) -> Result<Statement, ProblemError> {
        let (sides, component) = (self.sides_of(on)?, self.component(component)?);
        let action = match traction.into() {
            Value::Zero => Action::Traction(component, 0.0.into()),
            Value::Data(f) => Action::Traction(component, f),
            Value::Exact => Action::Exact(component),
        };
        Ok(self.load(&sides, &action))
    }

    /// Applies a pressure [force/area] along minus the outward normal.
    ///
    /// # Errors
    /// [`ErrorKind::Side`], [`ErrorKind::NotASide`], [`ErrorKind::Scalar`], [`ErrorKind::OtherProblem`].
    pub fn pressure<'a>(&mut self, on: impl Into<Region<'a>>, pressure: impl Into<Data>) -> Result<Statement, ProblemError> {
        let sides = self.sides_of(on)?;
        if let Some(side) = sides.iter().find(|s| s.field.components == 1) {
            return Err(ProblemError::named(ErrorKind::Scalar, &[&side.label]));
        }
        Ok(self.load(&sides, &Action::Pressure(pressure.into())))
    }

    /// Applies a component of a force, spread evenly over the region: sides, edges, or corners, where each gets the same share.
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix), and [`ErrorKind::MixedRegion`] for a region of sides and edges, edges and corners, or sides and corners.
    pub fn force<'a>(&mut self, on: impl Into<Region<'a>>, component: usize, force: impl Into<Data>) -> Result<Statement, ProblemError> {
        let (pieces, component, force) = (self.pieces(on.into())?, self.component(component)?, force.into());
        let is_revolved = self.is_revolved;
        let pieces: Vec<RegionPart<S, N>> = pieces.into_iter().map(|piece| if is_revolved { piece.revolved() } else { piece }).collect();
        let dimension = |piece: &RegionPart<S, N>| match piece {
            RegionPart::Side(_) => S,
            RegionPart::Rim(rim) => rim.rim.dimension,
        };
        if let Some(other) = pieces.iter().find(|piece| dimension(piece) != dimension(&pieces[0])) {
            return Err(ProblemError::named(ErrorKind::MixedRegion, &[pieces[0].label(), other.label()]));
        }
        let measure = pieces.iter().map(RegionPart::measure).sum();
        let of = self.statement();
        for piece in pieces {
            let (group, name) = (of, piece.label().to_owned());
            match piece {
                RegionPart::Side(side) => {
                    let action = Action::Force(component, force.clone(), measure);
                    self.said.loads.push(SideLoad { of, group, name, side, action });
                }
                RegionPart::Rim(rim) => {
                    self.said.point_loads.push(PointLoad { of, group, name, rim, component, force: force.clone(), measure });
                }
            }
        }
        Ok(of)
    }

    /// Puts springs [force/area per length] between sides and the ground.
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix), and [`ErrorKind::NotASide`].
    pub fn spring<'a>(
        &mut self,
        on: impl Into<Region<'a>>,
        component: usize,
        stiffness: impl Into<Data>,
    ) -> Result<Statement, ProblemError> {
        let (sides, component, stiffness) = (self.sides_of(on)?, self.component(component)?, stiffness.into());
        let of = self.statement();
        for side in sides {
            self.said.springs.push(SideSpring { of, name: side.label.clone(), side, component, stiffness: stiffness.clone() });
        }
        Ok(of)
    }

    /// Makes all sides of the region move as one in a component, driven by a resultant, spread evenly.
    ///
    /// # Errors
    /// Those of [`fix`](Self::fix), and [`ErrorKind::NotASide`].
    pub fn rigid<'a>(&mut self, on: impl Into<Region<'a>>, component: usize, force: impl Into<Data>) -> Result<Statement, ProblemError> {
        let region = on.into();
        let sides = self.sides_of(region)?;
        let of = self.force(region, component, force)?;
        // functions of a side sum to one: equal coefficients are a constant
        let mut unknowns: Vec<usize> =
            sides.iter().flat_map(|side| side.trace.dofs.iter().map(|&dof| side.field.unknown(dof, component))).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let Some((&first, rest)) = unknowns.split_first() else { return Ok(of) };
        let as_first = |&i: &usize| Equation { terms: vec![(i, 1.0), (first, -1.0)], value: 0.0 };
        self.said.equations.extend(rest.iter().map(|i| SaidEquation { of, equation: as_first(i) }));
        let direction = Vector::from_fn(|k, _| f64::from(u8::from(k == component)));
        for side in &sides {
            self.said.support(side);
            self.said.held.push(HeldSide { of, side: side.clone(), direction });
        }
        self.said.rigid_sides.push(RigidSides { of, sides, component });
        Ok(of)
    }

    fn load(&mut self, sides: &[Arc<BodySide<S, N>>], action: &Action) -> Statement {
        let of = self.statement();
        let load =
            |side: &Arc<BodySide<S, N>>| SideLoad { of, group: of, name: side.label.clone(), side: side.clone(), action: action.clone() };
        self.said.loads.extend(sides.iter().map(load));
        of
    }
}

/// Whether a side has a normal somewhere: it is no line and no point.
fn has_normal<const S: usize, const N: usize>(side: &BodySide<S, N>) -> bool {
    let (space, mut map) = (&*side.trace.space, MapTable::new());
    (0..space.num_elements()).any(|e| {
        space.map(e, &side.rules.rule(e).points, Order::Gradients, &mut map);
        map.jacobian.iter().any(|jacobian| side.trace.normal(e, jacobian).norm() > 0.5)
    })
}
