//! Contract of [`InterfaceQuadrature`]: pieces tile the slave, points lie in their elements, partners coincide.

use crate::basis::{Basis, Cell, Order, ShapeTable};
use crate::coupling::{InterfaceQuadrature, Segments};
use crate::geometry::{Geometry, MapTable, cell};
use crate::linalg::{Real, Vector, measure, to_f64};
use crate::quadrature::Quadrature;
use crate::space::Space;

/// Tolerances of [`interface_quadrature`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentLimits {
    /// Error of the measure of each fully covered slave element, relative to its measure.
    pub tiling: f64,
    /// Largest distance of points outside their cells, in local coordinates: 0 for exact sides, more if kinked sides
    /// only approximate one curve.
    pub outside: f64,
    /// Distance of partners \[length\].
    pub distance: f64,
    /// Error of the column sums of the master, relative to the largest column; `None`: not checked (slave rules are inexact).
    pub columns: Option<f64>,
}

impl Default for SegmentLimits {
    /// Tolerances of two sides on exactly one curve, merged: 1e-12 for measures, 1e-9 for local coordinates, 1e-11 for columns.
    fn default() -> Self {
        Self { tiling: 1e-12, outside: 1e-9, distance: 1e-12, columns: Some(1e-11) }
    }
}

/// Checks the segments that `rule` makes of `slave` and `master`.
///
/// `own`: rules that integrate each side's own functions exactly enough, slave and master. The column sums
/// sum_j M_jk = ∫ N_k ds over the master are the test of a segmentation: row sums and force balance hold for any rule.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn interface_quadrature<const D: usize, const N: usize, T: Real>(
    rule: &dyn InterfaceQuadrature<D, N, T>,
    slave: &dyn Space<D, N, T>,
    master: &dyn Space<D, N, T>,
    own: [&dyn Quadrature<D, T>; 2],
    limits: SegmentLimits,
) -> Result<(), String> {
    let (slave_map, master_map): (&dyn Geometry<D, N, T>, &dyn Geometry<D, N, T>) = (slave, master);
    let segments = rule.segments(slave_map, master_map).map_err(|e| format!("no segments: {e}"))?;
    if rule.segments(slave_map, master_map).ok().as_ref() != Some(&segments) {
        return Err("the same sides give different segments when asked again".into());
    }
    segments.well_formed(slave.num_elements(), master.num_elements()).map_err(|e| e.to_string())?;
    if segments.num_pieces() == 0 {
        return Err("there are no pieces: no point of the slave has a partner".into());
    }
    if let Some(element) = segments.report.lost.first() {
        return Err(format!("the pieces of slave element {element} do not tile it, and the master does not end there"));
    }
    reported(&segments, slave_map, master_map)?;
    tiling(&segments, slave, own[0], limits.tiling)?;
    places(&segments, slave, master, limits)?;
    if let Some(limit) = limits.columns {
        columns(&segments, master, own[1], limit)?;
    }
    Ok(())
}

/// Checks that the report says what is measured from the points.
fn reported<const D: usize, const N: usize, T: Real>(
    segments: &Segments<D, T>,
    slave: &dyn Geometry<D, N, T>,
    master: &dyn Geometry<D, N, T>,
) -> Result<(), String> {
    let measured = segments.clone().verified(slave, master).map_err(|e| e.to_string())?.report;
    let told = &segments.report;
    if told.share.len() != measured.share.len() {
        return Err(format!("the report has shares of {} elements, the slave {}", told.share.len(), measured.share.len()));
    }
    match *told == measured {
        true => Ok(()),
        false => Err(format!(
            "the report says that {:?} of {:?} are covered, at distances up to {:?}; the points measure {:?} of {:?}, up to {:?} apart",
            told.covered, told.slave_measure, told.distance, measured.covered, measured.slave_measure, measured.distance
        )),
    }
}

/// Checks that pieces of a slave element have the measure of its covered part.
fn tiling<const D: usize, const N: usize, T: Real>(
    segments: &Segments<D, T>,
    slave: &dyn Space<D, N, T>,
    own: &dyn Quadrature<D, T>,
    limit: f64,
) -> Result<(), String> {
    let mut found = vec![0.0; slave.num_elements()];
    for piece in 0..segments.num_pieces() {
        found[segments.slave[piece]] += segments.points(piece).map(|q| to_f64(segments.ds[q])).sum::<f64>();
    }
    let mut table = MapTable::new();
    for (element, found) in found.iter().enumerate() {
        let rule = own.rule(element);
        slave.map(element, &rule.points, Order::Gradients, &mut table);
        let whole: f64 = table.jacobian.iter().zip(&rule.weights).map(|(j, &w)| to_f64(measure(j) * w)).sum();
        let expected = whole * to_f64(segments.report.share[element]);
        if (found - expected).abs() > limit * whole {
            return Err(format!("the pieces of slave element {element} measure {found:e}, its covered part {expected:e}"));
        }
    }
    Ok(())
}

/// Checks that points lie in their cells, and partners coincide and are no farther apart than reported.
fn places<const D: usize, const N: usize, T: Real>(
    segments: &Segments<D, T>,
    slave: &dyn Space<D, N, T>,
    master: &dyn Space<D, N, T>,
    limits: SegmentLimits,
) -> Result<(), String> {
    let inside = |kind: Cell, xi: &Vector<D, T>| to_f64(cell::outside(kind, xi)) <= limits.outside;
    let (mut here, mut there) = (MapTable::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        let kinds = [slave.cell(segments.slave[piece]), master.cell(segments.master[piece])];
        slave.map(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut here);
        master.map(segments.master[piece], &segments.master_xi[points.clone()], Order::Values, &mut there);
        for (k, q) in points.enumerate() {
            if !inside(kinds[0], &segments.slave_xi[q]) || !inside(kinds[1], &segments.master_xi[q]) {
                return Err(format!(
                    "point {q} of piece {piece} lies at {:?} and {:?}, outside its cells",
                    segments.slave_xi[q], segments.master_xi[q]
                ));
            }
            let distance = to_f64((here.x[k] - there.x[k]).norm());
            if distance > limits.distance || distance > to_f64(segments.report.distance) * (1.0 + 1e-9) + 1e-15 {
                return Err(format!("partners of point {q} are {distance:e} apart; reported {:?}", segments.report.distance));
            }
        }
    }
    Ok(())
}

/// Checks the sums of the master's functions over the points against the master's own rule.
fn columns<const D: usize, const N: usize, T: Real>(
    segments: &Segments<D, T>,
    master: &dyn Space<D, N, T>,
    own: &dyn Quadrature<D, T>,
    limit: f64,
) -> Result<(), String> {
    let n = Basis::<D, T>::num_functions(master);
    let (mut found, mut expected, mut ids) = (vec![0.0; n], vec![0.0; n], Vec::new());
    let (mut shapes, mut map) = (ShapeTable::new(), MapTable::new());
    for piece in 0..segments.num_pieces() {
        let points = segments.points(piece);
        master.active(segments.master[piece], &mut ids);
        master.tabulate(segments.master[piece], &segments.master_xi[points.clone()], Order::Values, &mut shapes);
        for (k, q) in points.enumerate() {
            ids.iter().zip(shapes.values(k)).for_each(|(&i, &v)| found[i] += to_f64(v * segments.ds[q]));
        }
    }
    for element in 0..master.num_elements() {
        let rule = own.rule(element);
        master.active(element, &mut ids);
        master.evaluate(element, &rule.points, Order::Gradients, &mut shapes, &mut map);
        for (k, (j, &w)) in map.jacobian.iter().zip(&rule.weights).enumerate() {
            ids.iter().zip(shapes.values(k)).for_each(|(&i, &v)| expected[i] += to_f64(v * measure(j) * w));
        }
    }
    let largest = expected.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    match (0..n).find(|&i| (found[i] - expected[i]).abs() > limit * largest) {
        None => Ok(()),
        Some(i) => Err(format!("master function {i} sums to {:e} over the segments, to {:e} over the master", found[i], expected[i])),
    }
}
