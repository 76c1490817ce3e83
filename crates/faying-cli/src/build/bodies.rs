//! Bodies with their gluing, boundary conditions and loads, without ties and contacts.

use super::builder::{Builder, MakeNet};
use super::built::{Built, Sources};
use super::couples::Couples;
use super::{boundary, couples, exact, glue, meshes, obstacles, patches, sides, values};
use crate::errors::Diagnostics;
use faying::problem::Model;

/// A model without ties and contacts, the sides made for it, and which sides are coupled.
pub(super) type Supported<const S: usize, const N: usize> = (Built<S, N>, sides::Sides<S, N>, Couples<S, N>);

/// Builds bodies, gluing, boundary conditions and loads.
pub(super) fn supported<const S: usize, const N: usize>(
    builder: &mut Builder<'_, S, N>,
    net: MakeNet<N>,
) -> Result<Supported<S, N>, Diagnostics> {
    let case = builder.case;
    let patches = patches::build(builder, net);
    builder.stop()?;
    values::materials(builder, &patches);
    meshes::unshared(builder);
    let mut sides = sides::Sides::default();
    // patches of files with several patches: their touching sides are glued
    let couples = couples::find(builder, &patches, &mut sides, &case.glued_files());
    let (glued, hinges) = glue::of(builder, &patches, &couples);
    builder.stop()?;
    let mut model = Model::new(patches, glued, hinges);
    model.components = case.model.components();
    model.unknowns += obstacles::num_pressed(case);
    model.exact = case.model.exact.as_ref().map(|e| exact::of(&e.value));
    model.max_iterations = case.contacts.iter().map(|c| c.active_set.max_iterations.value).max().unwrap_or(1);
    model.c = case.contacts.first().map_or(1.0, |c| c.active_set.c.value);
    let mut model = Built { model, glued_sides: Vec::new(), reference: None, sources: Sources::default(), warnings: Diagnostics::new() };
    boundary::build(builder, &mut model, &mut sides, &couples);
    model.find_corners();
    values::in_bodies(builder, &model);
    builder.stop()?;
    Ok((model, sides, couples))
}
