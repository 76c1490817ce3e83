//! Construction of a model from a case: bodies, supports, loads, interfaces, contacts; errors of the input are found before solving.

mod boundary;
mod built;
mod contacts;
mod corners;
mod couples;
mod divisions;
mod exact;
mod fixed;
mod functions;
mod glue;
mod glued_sides;
mod joined;
mod materials;
mod meant;
mod meetings;
mod meshes;
mod multipliers;
mod near;
mod obstacles;
mod outline;
mod parameters;
mod patches;
mod plane;
mod reference;
mod rims;
mod sides;
mod stored;
mod supports;
mod ties;
mod touch;
mod traces;
mod values;
mod volume;
mod weak;

use super::registry::Names;
use crate::case::{Case, Shape};
use crate::errors::{Diagnostic, Diagnostics};
use crate::place::Place;
use faying::geometry::ControlNet;
use faying::problem::Model;

pub use built::{Built, Sources};
pub(crate) use divisions::elements_along;
pub(crate) use meshes::{counts as mesh_counts, named_point};
pub(crate) use obstacles::PLANE as PLANE_OBSTACLES;
pub use patches::patch_fault;
pub use plane::plane_net;
pub use reference::{OnSide, Reference, ReferenceLambda, ReferencePatch};
pub(crate) use sides::canonical as canonical_side;
pub(crate) use stored::stored_run;
pub(crate) use ties::short;
pub use touch::sag;
pub use traces::{SlaveEnds, SlaveSpaces, slave_spaces};
pub use volume::volume_net;
pub(crate) use weak::weakly_held;

/// Builds the net of a shape with its transformations in N dimensions; an error is a code and a message.
pub type MakeNet<const N: usize> = fn(&crate::case::Geometry) -> Result<ControlNet<N, N>, (&'static str, String)>;

/// Common data of all build steps: the case, the registered names, and the diagnostics found so far.
#[derive(Debug)]
pub(crate) struct Builder<'a, const S: usize, const N: usize> {
    pub case: &'a Case,
    pub names: &'a Names<S, N>,
    pub faults: Diagnostics,
}

/// Help text for elements that fold over (E041).
const INVERTED: &str = "move the points around it apart; `faying inspect` lists such elements and draws them with --svg";

impl<const S: usize, const N: usize> Builder<'_, S, N> {
    /// Creates an error at a source location of the case.
    pub fn error(&self, code: &'static str, message: impl Into<String>, at: Place) -> Diagnostic {
        let error = Diagnostic::error(code, message).at(&self.case.source, at);
        if code == "E041" { error.with_help(INVERTED) } else { error }
    }

    /// Creates a warning at a source location of the case.
    pub fn warning(&self, code: &'static str, message: impl Into<String>, at: Place) -> Diagnostic {
        Diagnostic::warning(code, message).at(&self.case.source, at)
    }

    /// Returns the diagnostics so far as `Err` if there is an error among them.
    fn stop(&mut self) -> Result<(), Diagnostics> {
        if self.faults.has_errors() { Err(std::mem::take(&mut self.faults)) } else { Ok(()) }
    }
}

/// Builds the model of `case` with the bodies, multipliers and couplings of `names`.
///
/// # Errors
/// Everything that is wrong with the case, with its places.
pub fn build<const S: usize, const N: usize>(case: &Case, names: &Names<S, N>, net: MakeNet<N>) -> Result<Built<S, N>, Diagnostics> {
    let mut builder = Builder { case, names, faults: Diagnostics::new() };
    let (mut model, mut sides, couples) = supported(&mut builder, net)?;
    let fixed = fixed::Fixed::of(&builder, &model).map_err(|fault| Diagnostics::from(*fault))?;
    model.glued_sides = glued_sides::of(case, &couples);
    ties::build(&mut builder, &mut model, &couples, &fixed);
    builder.stop()?;
    corners::jumps(&mut builder, &model);
    contacts::build(&mut builder, &mut model, &mut sides, &couples, &fixed);
    builder.stop()?;
    supports::check(&mut builder, &model);
    builder.stop()?;
    model.reference = reference::build(&builder, &model, net).map_err(|fault| Diagnostics::from(*fault))?;
    model.warnings.extend(std::mem::take(&mut builder.faults));
    Ok(model)
}

/// A model without ties and contacts, the sides made for it, and which sides are coupled.
type Supported<const S: usize, const N: usize> = (Built<S, N>, sides::Sides<S, N>, couples::Couples<S, N>);

/// Builds bodies, gluing, boundary conditions and loads.
fn supported<const S: usize, const N: usize>(builder: &mut Builder<'_, S, N>, net: MakeNet<N>) -> Result<Supported<S, N>, Diagnostics> {
    let case = builder.case;
    let patches = patches::build(builder, net);
    builder.stop()?;
    values::materials(builder, &patches);
    let (center, size) = patches::extent(&patches);
    let mut sides = sides::Sides::default();
    // patches of files with several patches: their touching sides are glued
    let couples = couples::find(builder, &patches, &mut sides, &case.glued_files());
    let (glued, hinges) = glue::of(builder, &patches, &couples);
    builder.stop()?;
    let model = Model {
        glued,
        hinges,
        components: case.model.components(),
        unknowns: patches.last().map_or(0, |p| p.range().end) + obstacles::num_pressed(case),
        patches,
        conditions: Vec::new(),
        corners: Vec::new(),
        pins: Vec::new(),
        supports: Vec::new(),
        equations: Vec::new(),
        held: Vec::new(),
        rigid_sides: Vec::new(),
        loads: Vec::new(),
        springs: Vec::new(),
        exact: case.model.exact.as_ref().map(|e| exact::of(&e.value)),
        ties: Vec::new(),
        contacts: Vec::new(),
        rows: 0,
        max_iterations: case.contacts.iter().map(|c| c.active_set.max_iterations.value).max().unwrap_or(1),
        c: case.contacts.first().map_or(1.0, |c| c.active_set.c.value),
        center,
        size,
    };
    let mut model = Built { model, glued_sides: Vec::new(), reference: None, sources: Sources::default(), warnings: Diagnostics::new() };
    boundary::build(builder, &mut model, &mut sides, &couples);
    model.find_corners();
    values::in_bodies(builder, &model);
    builder.stop()?;
    Ok((model, sides, couples))
}

/// Whether `elements` is a total count for this shape, not one per piece.
fn counts_in_total(shape: &Shape) -> bool {
    shape.is_built_in()
}
