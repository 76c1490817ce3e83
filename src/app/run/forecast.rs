//! How large a case will be, from its numbers alone: said before any body is built.
//!
//! Counts are `f64`: a product of large counts grows, it never wraps around.

use super::need::Need;
use super::predict::{Prediction, bytes};
use crate::app::build::{MakeNet, elements_along, mesh_counts};
use crate::app::registry::is_spline;
use crate::io::case::{Case, Patch};
use crate::io::errors::Diagnostic;

/// Most unknowns in this version: columns are 32 bits wide.
const MOST_UNKNOWNS: f64 = u32::MAX as f64;
/// Share of the machine's memory that a run may be predicted to need where no limit is given.
const SHARE: f64 = 0.9;

/// The need of a case, as far as its numbers say.
#[derive(Clone, Copy, Debug, Default)]
struct Forecast {
    need: Need,
    /// The patch with the most unknowns.
    largest: usize,
}

/// Unknowns, entries and factor of a patch; none where its geometry is wrong, which building says better.
fn of_patch<const N: usize>(case: &Case, patch: &Patch, net: MakeNet<N>) -> Option<Need> {
    let d = &patch.discretization;
    if let Some(cells) = mesh_counts::<N>(patch) {
        return Some(Need::of_mesh(cells, N, d.degree.value.first().copied()?, case.model.components()));
    }
    let net = net(&patch.geometry.value).ok()?;
    let spline = is_spline(&d.backend.value);
    let mut sizes = [(0.0, 0usize, 0usize); N];
    for (k, size) in sizes.iter_mut().enumerate() {
        let p = *d.degree.value.get(k).or(d.degree.value.last())?;
        let smooth = if spline { d.continuity.value.unwrap_or(p.saturating_sub(1)).min(p.saturating_sub(1)) } else { 0 };
        *size = (elements_along(patch, net.axes[k].breakpoints(), k)?, p, smooth);
    }
    Some(Need::of_patch(&sizes, case.model.components()))
}

impl Forecast {
    fn of<const N: usize>(case: &Case, net: MakeNet<N>) -> Self {
        let mut all = Self::default();
        let mut most = 0.0;
        for (k, patch) in case.patches.iter().enumerate() {
            let Some(need) = of_patch(case, patch, net) else { continue };
            if need.unknowns > most {
                (most, all.largest) = (need.unknowns, k);
            }
            all.need = all.need.and(&need);
        }
        all
    }
}

/// E081 where `case` is larger than `limit`, or without one than this version or this machine can hold.
pub fn too_large<const N: usize>(case: &Case, net: MakeNet<N>, limit: Option<u64>) -> Option<Diagnostic> {
    let forecast = Forecast::of(case, net);
    let need = &forecast.need;
    let Prediction { memory, .. } = need.prediction();
    let machine = limit.is_none().then(physical_memory).flatten();
    // what this version holds is asked first: no limit on memory can be raised above it
    let fixed = need.unknowns > MOST_UNKNOWNS;
    let why = if fixed {
        format!("this version holds up to {MOST_UNKNOWNS:.1e} unknowns")
    } else if let Some(limit) = limit.filter(|&l| memory > l) {
        format!("the limit is {}", bytes(limit))
    } else if let Some(all) = machine.filter(|&all| memory as f64 > SHARE * all as f64) {
        format!("this machine has {}", bytes(all))
    } else {
        return None;
    };
    let patch = case.patches.get(forecast.largest)?;
    let unknowns = if need.unknowns < 1e15 { format!("{:.0}", need.unknowns) } else { format!("{:.1e}", need.unknowns) };
    let text = format!("about {unknowns} unknowns need about {} of memory; {why}", bytes(memory));
    let mut help = format!("give patch \"{}\" fewer elements", patch.name.value);
    if patch.refine.value > 0 {
        help += &format!(" or a smaller refine (it is {})", patch.refine.value);
    }
    if !fixed {
        help += "; or raise --max-memory";
    }
    Some(Diagnostic::error("E081", text).at(&case.source, patch.elements.at).with_help(help))
}

/// Most bytes that reading a geometry file may take: the limit of the user, else what this machine has.
pub fn memory_for_files(limit: Option<u64>) -> Option<u64> {
    limit.or_else(|| physical_memory().map(|all| (SHARE * all as f64) as u64))
}

/// Bytes of the machine's memory, where the system says them.
fn physical_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let kilobytes: u64 = text.lines().find_map(|l| l.strip_prefix("MemTotal:"))?.split_whitespace().next()?.parse().ok()?;
    kilobytes.checked_mul(1024)
}
