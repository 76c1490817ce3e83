//! Warning E065 if rounding spoils the solution: its error is at most the condition number of the system times the rounding of a double.
//!
//! A hard body on a soft one moves with it as a whole, and its own stresses are small differences: the condition number grows with the
//! contrast of their moduli.

use crate::case::Case;
use crate::errors::Diagnostic;
use crate::result::RunResult;
use crate::words::{percent, short};
use faying::basis::Order;
use faying::geometry::{MapTable, cell};
use faying::problem::{Model, PatchModel};

/// Bound of the relative error above which the warning is given.
const POOR: f64 = 1e-6;
/// Moduli that differ by less are not named.
const CONTRAST: f64 = 100.0;

/// Returns at most one warning.
pub fn warning<const S: usize, const N: usize>(case: &Case, model: &Model<S, N>, result: &RunResult) -> Option<Diagnostic> {
    let condition = result.solve.as_ref()?.condition?;
    let error = condition * f64::EPSILON / 2.0;
    if !condition.is_finite() || error <= POOR {
        return None;
    }
    let moduli: Vec<f64> = model.patches.iter().map(modulus).collect();
    let by = |order: std::cmp::Ordering| (0..moduli.len()).reduce(|a, b| if moduli[b].total_cmp(&moduli[a]) == order { b } else { a });
    let (hard, soft) = (by(std::cmp::Ordering::Greater)?, by(std::cmp::Ordering::Less)?);
    let contrast = moduli[hard] / moduli[soft];
    let names = [hard, soft].map(|k| &model.patches[k].name);
    let why = match contrast > CONTRAST {
        true => format!("; patch \"{}\" is {} times as stiff as \"{}\"", names[0], short(contrast), names[1]),
        false => String::new(),
    };
    let text = format!(
        "rounding is not small: the condition number {} of the system lets the solution be wrong by up to {} %{why}",
        short(condition),
        percent(error.min(1.0))
    );
    let help = "let moduli differ less: a body that hardly deforms may be a rigid obstacle, or a side that moves as one; cells may be too thin, springs too soft";
    Some(Diagnostic::warning("E065", text).at(&case.source, case.patches[hard].head.at).with_help(help))
}

/// The modulus in the middle of the first element.
fn modulus<const S: usize, const N: usize>(patch: &PatchModel<S, N>) -> f64 {
    let (space, mut table) = (&**patch.body.space(), MapTable::new());
    if space.num_elements() == 0 {
        return 0.0;
    }
    space.map(0, &[cell::center::<N, f64>(space.cell(0))], Order::Values, &mut table);
    patch.physics.modulus(&table.x[0])
}
