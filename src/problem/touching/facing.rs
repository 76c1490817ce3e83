//! Sides that face each other: their distance, and the share that does.

use crate::geometry::{MapTable, Sag};
use crate::space::{Skin, Trace, raised, skin_points};

/// More than this share of a side must face another one for both to be neighbours.
pub(super) const COVERED: f64 = 0.5;

/// The part of a side that sees another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Its share of the side.
    pub share: f64,
    /// The mean of |gap| \[length\].
    pub distance: f64,
    /// The mean gap, negative if the sides overlap \[length\].
    pub gap: f64,
}

/// Measures the facets of a side whose centres see another side within `reach` \[length\]; `None` if no facet does.
pub fn facing<const S: usize, const N: usize>(side: &Trace<S, N>, other: &Trace<S, N>, reach: f64) -> Option<Facing> {
    let [own, far] = [side, other].map(|t| Sag::none(t.facets.len()));
    let (skin, mut table) = (Skin::new(other, &far), MapTable::new());
    let (mut size, mut sum, mut seen, mut all) = (0.0, 0.0, 0.0, 0.0);
    for (f, bounds) in side.space.all_bounds().iter().enumerate() {
        let weight = bounds.diagonal().powi(S as i32);
        all += weight;
        let middle = raised(side, &own, f, &skin_points(side.space.cell(f))[..1], &mut table)[0];
        if let Some(sight) = skin.sight(&middle, reach, 0.0, &mut table) {
            size += sight.gap.abs() * weight;
            sum += sight.gap * weight;
            seen += weight;
        }
    }
    (seen > 0.0).then(|| Facing { share: seen / all, distance: size / seen, gap: sum / seen })
}

/// Returns how two sides face each other, seen from the one of which the larger share does; `None` if less than half of both does.
pub(super) fn facing_either<const S: usize, const N: usize>(a: &Trace<S, N>, b: &Trace<S, N>, reach: f64) -> Option<Facing> {
    let seen = [(a, b), (b, a)].into_iter().filter_map(|(a, b)| facing(a, b, reach));
    seen.filter(|f| f.share > COVERED).reduce(|a, b| if b.share > a.share { b } else { a })
}
