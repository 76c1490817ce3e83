//! Random pairs of surfaces: every slave element is tiled, no weight is negative, nothing is lost.
//!
//! Regions that reach out of their cells are told, and rare. Columns on large curved elements are as exact as their Gauss points: where
//! nine per direction leave more than 1e-6, thirteen leave less than half of it.
//!
//! `FAYING_BATTERY=2000` in the environment takes that many pairs on one surface, as many across gaps, and a quarter of that of facets;
//! 40, 40 and 20 otherwise, the same in every run. `FAYING_BATTERY_CASE=k` takes pair k alone.

use crate::common::{Measured, Patch, Random, Shape, measured};
use faying::coupling::InterfaceQuadrature;
use faying::coupling::interface::{MergedSurface, Tolerance};

/// The pairs to be taken out of `usual` ones.
fn cases(usual: usize, share: usize) -> Vec<u64> {
    let asked = |name: &str| std::env::var(name).ok().and_then(|n| n.parse::<usize>().ok());
    match asked("FAYING_BATTERY_CASE") {
        Some(only) => vec![only as u64],
        None => (0..asked("FAYING_BATTERY").map_or(usual, |n| n / share) as u64).collect(),
    }
}

/// A grid of random size, shape of cells, bend and vertices.
fn grid(shape: Shape, random: &mut Random, inside: [f64; 2], least: usize) -> Patch {
    let n = [least + random.below(6), least + random.below(6)];
    let (lo, width) = (inside[0], inside[1] - inside[0]);
    let by = random.between(0.0, 0.2) / n[0].max(n[1]) as f64;
    // a grid within stays within
    let by = if lo > 0.0 { by.min(lo) } else { by };
    let warp = if inside == [0.0, 1.0] { random.between(-0.06, 0.06) } else { 0.0 };
    let seed = random.below(1 << 20) as u64;
    Patch::grid(shape, n, random.below(2) == 0, |a, b| [lo + width * a, lo + width * b]).warped(warp).shaken(by, seed)
}

fn shape(random: &mut Random) -> Shape {
    match random.below(4) {
        0 => Shape::Wave(random.between(-0.25, 0.25)),
        1 => Shape::Cylinder(1.0, random.between(0.3, 2.0)),
        2 => Shape::Sphere(1.0, random.between(0.3, 1.6)),
        _ => Shape::Torus([1.5, random.between(0.3, 0.9)], random.between(0.3, 1.6)),
    }
}

/// The surface at a distance along its normals.
fn offset(shape: Shape, gap: f64) -> Shape {
    match shape {
        Shape::Cylinder(r, range) => Shape::Cylinder(r + gap, range),
        Shape::Sphere(r, range) => Shape::Sphere(r + gap, range),
        Shape::Torus([big, small], range) => Shape::Torus([big, small + gap], range),
        other => other,
    }
}

/// Largest part of a region outside of its cell that counts as none.
const OUTSIDE: f64 = 1e-6;
/// One in so many pairs may have a region that reaches out of its cell.
const RARE: usize = 500;

/// Runs all cases, and names those that fail; returns the number of those with regions that reach out of their cells.
fn all(name: &str, seeds: &[u64], check: impl Fn(u64) -> Result<Measured, String>) -> usize {
    let (mut failed, mut worst, mut pieces, mut outside) = (Vec::new(), [0.0f64; 3], 0, 0);
    for &seed in seeds {
        match check(seed) {
            Ok(found) => {
                worst = [worst[0].max(found.tiling), worst[1].max(found.master), worst[2].max(found.outside)];
                pieces += found.pieces;
                outside += usize::from(found.outside > OUTSIDE);
            }
            Err(what) => failed.push(format!("{seed}: {what}")),
        }
    }
    println!(
        "{name}: {} pairs, {pieces} pieces, tiling {:.1e}, columns {:.1e}, outside {:.1e} in {outside}",
        seeds.len(),
        worst[0],
        worst[1],
        worst[2]
    );
    assert!(failed.is_empty(), "{name}: {} of {} pairs fail:\n{}", failed.len(), seeds.len(), failed.join("\n"));
    outside
}

#[test]
fn random_pairs_on_one_surface() {
    let seeds = cases(40, 1);
    let outside = all("one surface", &seeds, |seed| {
        let mut random = Random(seed.wrapping_mul(7919) + 17);
        let shape = shape(&mut random);
        let turn = random.between(0.0, 6.0);
        let [slave, master] = [0, 1].map(|_| grid(shape, &mut random, [0.0, 1.0], 1).moved(turn, [0.5, 1.0, -2.0]));
        let with = |points: usize| measured(&MergedSurface::tied(points, Tolerance::Exact), [&slave, &master], 2, &|_| 1.0);
        let found = with(9).map_err(|e| format!("{shape:?}: {e}"))?;
        let falls = || with(13).is_ok_and(|finer| finer.master < 0.5 * found.master);
        let exact = found.master < 1e-6 || found.outside > OUTSIDE || falls();
        let sound = found.open == 0 && found.lost == 0 && found.tiling < 1e-11 && exact;
        if sound { Ok(found) } else { Err(format!("{shape:?}: {found:?}")) }
    });
    assert!(outside <= seeds.len() / RARE, "regions of {outside} of {} pairs reach out of their cells", seeds.len());
}

#[test]
fn random_pairs_across_gaps() {
    let seeds = cases(40, 1);
    let outside = all("gaps", &seeds, |seed| {
        let mut random = Random(seed.wrapping_mul(104_729) + 5);
        let gap = random.between(-0.3, 0.4);
        let shape = match shape(&mut random) {
            Shape::Wave(_) => Shape::Sphere(1.0, 1.2),
            Shape::Torus([big, small], range) => Shape::Torus([big, small.max(0.5)], range),
            other => other,
        };
        // the slave lies inside of what the master faces
        let slave = grid(offset(shape, gap), &mut random, [0.1, 0.9], 1);
        let master = grid(shape, &mut random, [0.0, 1.0], 1);
        // slaves smaller than the gap are faced, too
        let found = measured(&MergedSurface::facing(6, Some(0.5)), [&slave, &master], 1, &|_| 1.0);
        let found = found.map_err(|e| format!("{shape:?} {gap}: {e}"))?;
        // columns hold where the slave covers the master; not here
        let found = Measured { master: 0.0, ..found };
        let sound = found.open == 0 && found.lost == 0 && found.tiling < 1e-11 && (found.distance - gap.abs()).abs() < 1e-9;
        if sound { Ok(found) } else { Err(format!("{shape:?} {gap}: {found:?}")) }
    });
    assert!(outside <= seeds.len() / RARE, "regions of {outside} of {} pairs reach out of their cells", seeds.len());
}

#[test]
fn random_pairs_of_facets() {
    all("facets", &cases(20, 4), |seed| {
        let mut random = Random(seed.wrapping_mul(15_485_863) + 11);
        let shape = shape(&mut random);
        let gap = if matches!(shape, Shape::Wave(_)) { 0.0 } else { random.between(-0.1, 0.2) };
        let slave = grid(offset(shape, gap), &mut random, [0.15, 0.85], 3).facets(random.below(3));
        let master = grid(shape, &mut random, [0.0, 1.0], 3).facets(1 + random.below(2));
        let segments = MergedSurface::facing(4, None).segments(&slave, &master).map_err(|e| format!("{shape:?} {gap}: {e}"))?;
        let found = measured(&MergedSurface::facing(4, None), [&slave, &master], 1, &|_| 1.0).map_err(|e| format!("{e}"))?;
        let lost = segments.report.lost.len();
        // what is lost is told
        assert_eq!(lost > 0, segments.report.share.iter().any(|&s| s != 1.0), "{seed}: {:?}", segments.report);
        let found = Measured { master: 0.0, ..found };
        let sound = lost == 0 && found.tiling < 1e-11;
        let what = || format!("{shape:?} {gap} {:?} facets {} {}: lost {lost}, {found:?}", seed, slave.facet_degree, master.facet_degree);
        if sound { Ok(found) } else { Err(what()) }
    });
}
