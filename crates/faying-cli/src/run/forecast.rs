//! Size of a case estimated from its input alone, before any body is built.
//!
//! Counts are `f64`, so that products of large counts do not overflow.

use super::room::MemoryLimit;
use crate::case::{Case, Linear, Patch};
use crate::errors::Diagnostic;
use crate::lower::mesh_counts;
use crate::registry::is_spline;
use crate::shapes::MakeControlNet;
use crate::text_format::bytes;
use faying::problem::Sizes;

/// Largest number of unknowns in this version: columns are 32 bits wide.
const MOST_UNKNOWNS: f64 = u32::MAX as f64;

/// Estimated sizes of a case.
#[derive(Clone, Copy, Debug, Default)]
struct Forecast {
    sizes: Sizes,
    /// The patch with the most unknowns.
    largest: usize,
}

/// Estimates unknowns, entries and factor of a patch; `None` if its geometry is invalid, which is reported when the body is built.
fn of_patch<const N: usize>(case: &Case, patch: &Patch, net: MakeControlNet<N>) -> Option<Sizes> {
    let d = &patch.discretization;
    if let Some(cells) = mesh_counts::<N>(patch) {
        return Some(Sizes::of_mesh(cells, N, d.degree.value.first().copied()?, case.model.components()));
    }
    let net = net(&patch.geometry.value).ok()?;
    let spline = is_spline(&d.backend.value);
    let mut sizes = [(0.0, 0usize, 0usize); N];
    for (k, size) in sizes.iter_mut().enumerate() {
        let p = *d.degree.value.get(k).or(d.degree.value.last())?;
        let smooth = if spline { d.continuity.value.unwrap_or(p.saturating_sub(1)).min(p.saturating_sub(1)) } else { 0 };
        let spans = net.axes[k].breakpoints().len().checked_sub(1).filter(|&n| n > 0)?;
        *size = (patch.elements.value.get(k)?.value.at_most(spans, patch.refine.value), p, smooth);
    }
    Some(Sizes::of_patch(&sizes, case.model.components()))
}

impl Forecast {
    fn of<const N: usize>(case: &Case, net: MakeControlNet<N>) -> Self {
        let mut all = Self::default();
        let mut most = 0.0;
        for (k, patch) in case.patches.iter().enumerate() {
            let Some(sizes) = of_patch(case, patch, net) else { continue };
            if sizes.unknowns() > most {
                (most, all.largest) = (sizes.unknowns(), k);
            }
            all.sizes = all.sizes.and(&sizes);
        }
        all
    }
}

/// Whether `case` asks for linear systems without a factor; systems that are not symmetric take one still.
pub fn avoids_factors(case: &Case) -> bool {
    case.solver.linear.value == Linear::Iterative
}

/// Returns E081 if `case`, solved with a factor or without, exceeds the memory `room` or the limits of this version.
pub fn too_large<const N: usize>(case: &Case, net: MakeControlNet<N>, room: Option<MemoryLimit>, factor: bool) -> Option<Diagnostic> {
    let mut forecast = Forecast::of(case, net);
    if !factor {
        forecast.sizes = forecast.sizes.without_factor();
    }
    let sizes = &forecast.sizes;
    let memory = sizes.forecast().memory;
    // the limit of this version comes first: it cannot be exceeded by raising the limit on memory
    let fixed = sizes.unknowns() > MOST_UNKNOWNS;
    let short = room.filter(|room| memory > room.bytes && !fixed);
    let why = match short {
        _ if fixed => format!("this version holds up to {MOST_UNKNOWNS:.1e} unknowns"),
        Some(room) => room.why(),
        None => return None,
    };
    let patch = case.patches.get(forecast.largest)?;
    let unknowns = if sizes.unknowns() < 1e15 { format!("{:.0}", sizes.unknowns()) } else { format!("{:.1e}", sizes.unknowns()) };
    let text = format!("about {unknowns} unknowns need about {} of memory; {why}", bytes(memory));
    let mut help = format!("give patch \"{}\" fewer elements", patch.name.value);
    if patch.refine.value > 0 {
        help += &format!(" or a smaller refine (it is {})", patch.refine.value);
    }
    if let Some(room) = short {
        help += &format!("; or {}", room.raise());
    }
    Some(Diagnostic::error("E081", text).at(&case.source, patch.elements.at).with_help(help))
}
