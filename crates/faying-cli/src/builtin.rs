//! Entries of the registry that come with the program.

use super::case::{self, Given};
use super::registry::{Family, Fault, MakeMethod, MakeShaped, MakeSolver, Names, Registry, Shaped};
use super::shapes::{PLANE_OBSTACLES, SPACE_OBSTACLES};
use faying::constraint::{Augmented, Condensed, Direct, Krylov, Schur};
use faying::contact::{self, Lagrange};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::nitsche::Variant;
use faying::coupling::{Mortar, Nitsche, Penalty};
use faying::problem::Integration;
use faying::space::{Dimension, Mesh, Patch, Trace};
use std::sync::Arc;

impl<const S: usize, const N: usize> Names<S, N>
where
    Trace<S, N>: Dimension<S, N>,
{
    /// The built-in names that both dimensions have: backends, methods of contact, multipliers, couplings, integrations; and obstacles that are `shaped`.
    fn of_both(shaped: MakeShaped<S, N>) -> Self {
        let mut names = Self::empty();
        names.shaped = Shaped(Some(shaped));
        names
            .backends
            .add("iga", Box::new(|spec| Ok(Box::new(Patch::<S, N>::try_new(spec)?))))
            .add("fe", Box::new(|spec| Ok(Box::new(Mesh::<S, N>::from_patch(spec)?))));
        for method in case::built_in_methods() {
            let make: MakeMethod<S, N> = match method.entry.name.as_str() {
                "penalty" => Box::new(|given| Ok(Arc::new(penalty(given)))),
                "augmented" => Box::new(|given| Ok(Arc::new(augmented(given)))),
                "nitsche" => Box::new(|given| Ok(Arc::new(nitsche(given)))),
                _ => Box::new(|_| Ok(Arc::new(Lagrange))),
            };
            names.methods.add_keyed(&method.entry.name, method.entry.keys, make);
        }
        let mut kinds = vec![MultiplierKind::Auto, MultiplierKind::Constant, MultiplierKind::Dual];
        kinds.extend((0..=HIGHEST_PAIRING).map(MultiplierKind::Lowered));
        for kind in kinds {
            names.multipliers.add(&kind.to_string(), kind.into());
        }
        let keys = |name: &str| case::built_in_couplings().into_iter().find(|e| e.name == name).map_or_else(Vec::new, |e| e.keys);
        names
            .couplings
            .add_keyed("mortar", Vec::new(), Box::new(|_| Ok(Box::new(Mortar))))
            .add_keyed("nitsche", keys("nitsche"), Box::new(|given| Ok(Box::new(nitsche(given)))))
            .add_keyed("penalty", keys("penalty"), Box::new(|given| Ok(Box::new(penalty(given)))));
        names.integrations.add("merged", Integration::Merged.into()).add("slave", Integration::Slave.into());
        names
    }
}

fn penalty(given: &Given) -> Penalty {
    Penalty { factor: given.auto("factor").unwrap_or(Penalty::AUTO) }
}

fn augmented(given: &Given) -> contact::Augmented {
    contact::Augmented {
        factor: given.auto("factor").unwrap_or(contact::Augmented::FACTOR),
        tolerance: given.auto("tolerance").unwrap_or(contact::Augmented::TOLERANCE),
    }
}

fn nitsche(given: &Given) -> Nitsche {
    let variant = match given.word("variant") {
        "unsymmetric" => Variant::Unsymmetric,
        "incomplete" => Variant::Incomplete,
        _ => Variant::Symmetric,
    };
    Nitsche { factor: given.auto("factor").unwrap_or(Nitsche::AUTO), variant }
}

/// Highest k of the built-in pairings p/p-k: the highest degree of a patch.
const HIGHEST_PAIRING: usize = 12;

impl Names<1, 2> {
    /// The built-in names of the plane.
    pub fn plane() -> Self {
        Self::of_both(PLANE_OBSTACLES)
    }
}

impl Names<2, 3> {
    /// The built-in names of space.
    pub fn volume() -> Self {
        Self::of_both(SPACE_OBSTACLES)
    }
}

impl Default for Registry {
    /// The built-in names.
    fn default() -> Self {
        Self { plane: Names::plane(), volume: Names::volume(), solvers: solvers() }
    }
}

/// The built-in solvers:
///
/// | name | `linear = "direct"` | `linear = "iterative"` |
/// | --- | --- | --- |
/// | saddle-point | LDLᵀ, one for all sets of contact where its rows are few; LU without symmetry | MINRES without a factor; without symmetry GMRES with the symmetric factor |
/// | condensed | LDLᵀ of Tᵀ K T | conjugate gradients on it |
/// | schur | conjugate gradients on C K⁻¹ Cᵀ over a factor of K, as numbers where rows are few | refused: it needs the factor |
/// | uzawa | augmented Lagrangian over a factor of K + Cᵀ W C | the same over conjugate gradients |
fn solvers() -> Family<MakeSolver> {
    let mut solvers: Family<MakeSolver> = Family::new("constraint solver");
    solvers.add(
        "saddle-point",
        Box::new(|o| Ok(if o.is_iterative() { Box::new(Krylov::new(o.limits.clone())) } else { Box::new(Direct::new()) })),
    );
    solvers.add(
        "condensed",
        Box::new(|o| Ok(Box::new(if o.is_iterative() { Condensed::iterative(o.limits.clone()) } else { Condensed::new() }))),
    );
    solvers.add(
        "schur",
        Box::new(|o| {
            if o.is_iterative() {
                let text =
                    "constraint = \"schur\" iterates over a factor of the stiffness: write linear = \"direct\", or constraint = \"uzawa\"";
                return Err(Fault::new("E015", text));
            }
            Ok(Box::new(Schur::new(o.limits.clone())))
        }),
    );
    solvers.add(
        "uzawa",
        Box::new(|o| {
            let limits = o.limits.clone();
            Ok(if o.is_iterative() { Box::new(Augmented::uzawa_iterative(limits)) } else { Box::new(Augmented::uzawa(limits)) })
        }),
    );
    solvers
}
