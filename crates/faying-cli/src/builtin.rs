//! Entries of the registry that come with the program.

use super::lower::{PLANE_OBSTACLES, patch_fault};
use super::registry::{Family, Fault, MakeSolver, Names, Registry, Shaped};
use faying::constraint::{Augmented, Condensed, Direct, Krylov, Schur};
use faying::coupling::multiplier::MultiplierKind;
use faying::coupling::{Mortar, Nitsche, Penalty};
use faying::problem::Integration;
use faying::space::{Mesh, Patch};

impl<const S: usize, const N: usize> Names<S, N> {
    /// Creates the built-in backends, without other names.
    fn bodies() -> Self {
        let mut names = Self::empty();
        names
            .backends
            .add("iga", Box::new(|spec| Ok(Box::new(Patch::<S, N>::try_new(spec).map_err(|e| patch_fault(&e))?))))
            .add("fe", Box::new(|spec| Ok(Box::new(Mesh::<S, N>::from_patch(spec).map_err(|e| patch_fault(&e))?))));
        names
    }
}

/// Highest k of the built-in pairings p/p-k: the highest degree of a patch.
const HIGHEST_PAIRING: usize = 12;

impl Names<1, 2> {
    /// The built-in names of the plane.
    pub fn plane() -> Self {
        let mut names = Self::bodies();
        let mut kinds = vec![MultiplierKind::Auto, MultiplierKind::Constant, MultiplierKind::Dual];
        kinds.extend((0..=HIGHEST_PAIRING).map(MultiplierKind::Lowered));
        for kind in kinds {
            names.multipliers.add(&kind.to_string(), kind.into());
        }
        names.shaped = Shaped(Some(PLANE_OBSTACLES));
        names
            .couplings
            .add("mortar", Box::new(|_| Box::new(Mortar)))
            .add("nitsche", Box::new(|o| Box::new(Nitsche { factor: o.factor.unwrap_or(Nitsche::AUTO), variant: o.variant })))
            .add("penalty", Box::new(|o| Box::new(Penalty { factor: o.factor.unwrap_or(Penalty::AUTO) })));
        names.integrations.add("merged", Integration::Merged.into()).add("slave", Integration::Slave.into());
        names
    }
}

impl Names<2, 3> {
    /// The built-in names of space: bodies; couplings of surfaces are not in this version.
    pub fn volume() -> Self {
        Self::bodies()
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
