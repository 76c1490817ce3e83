//! Contract of [`ContactMethod`]: balance, weights and offsets of its rows, their compliance, and a patch test solved by it.

use crate::assembly::gauss_rules;
use crate::basis::Basis;
use crate::contact::{ContactAt, ContactMethod, ContactRows, HalfPlane, Opponent};
use crate::coupling::interface::{InterfaceQuadrature, MergedCurve, Partners, slave_segments};
use crate::coupling::multiplier::{self, MultiplierKind};
use crate::coupling::{Rows, Side};
use crate::geometry::shapes::rectangle;
use crate::linalg::Vector;
use crate::physics::{BodyFlux, Hooke, Material};
use crate::problem::{Components, ContactId, Problem, System};
use crate::space::{Body, Field, Mesh, Patch, PatchSpec};
use std::error::Error;
use std::sync::Arc;

/// Relative error of sums of rows.
const BALANCE: f64 = 1e-10;
/// Relative error of pressures and gaps of the patch test: the compliance of the softest method of the library, and its tolerance.
const PATCH: f64 = 1e-6;
/// Pressure of the patch test, and the gap of the blocks that are apart.
const PRESSURE: f64 = 1e-3;
const APART: f64 = 0.01;

/// Checks `method` on a NURBS block above a mesh, and on a NURBS block above a half-plane.
///
/// Rows, the blocks apart by a gap g: asked again they are the same; a translation of both bodies opens no gap, one of the slave by its
/// distance d along the normal opens (C u)_j = w_j d, with weights w_j > 0 of rows that face something; offsets are w_j g. The compliance is
/// empty or has one number per row, none negative; values at points have one lambda and one gap each. Patch test: under a constant load the
/// blocks have its force and its pressure everywhere, and their gap is closed up to 1e-6 of their displacement.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn contact_method(method: Arc<dyn ContactMethod<1, 2>>) -> Result<(), String> {
    method.check().map_err(|e| format!("its own check fails: {e}"))?;
    for rigid in [false, true] {
        let opponent = if rigid { "a half-plane" } else { "a mesh" };
        let wrong = |what: String| format!("against {opponent}: {what}");
        rows(&*method, rigid).map_err(|e| wrong(e.to_string()))?;
        let (mut system, contact) = blocks(&method, rigid).map_err(|e| wrong(e.to_string()))?;
        patch_test(&mut system, contact).map_err(wrong)?;
    }
    Ok(())
}

/// The upper block [0, 1] x [1/2, 1], moved up by `apart`, and the lower one [0, 1] x [0, 1/2].
fn bodies(apart: f64) -> Result<(Patch<1, 2>, Mesh<1, 2>), Box<dyn Error>> {
    let upper = PatchSpec::new(rectangle([0.0, 0.5 + apart], [1.0, 1.0 + apart])?).with_elements([4, 2]);
    let lower = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 0.5])?).with_elements([3, 2]);
    Ok((Patch::try_new(&upper)?, Mesh::from_patch(&lower)?))
}

fn plane() -> Result<HalfPlane<2>, &'static str> {
    HalfPlane::try_new(Vector::from([0.0, 0.5]), Vector::from([0.0, 1.0])).ok_or("a normal of length 1")
}

/// The upper block under the pressure, on the lower one or on a half-plane.
fn blocks(method: &Arc<dyn ContactMethod<1, 2>>, rigid: bool) -> Result<(System<1, 2>, ContactId), Box<dyn Error>> {
    let mut p = Problem::<1, 2>::new();
    let (upper, lower) = bodies(0.0)?;
    let upper = p.body("upper", upper, Hooke::plane_strain(1.0, 0.3)?)?;
    p.pressure(upper.side("v1"), PRESSURE)?;
    p.fix(upper.side("u0"), Components::X)?;
    let slave = upper.side("v0");
    let contact = if rigid {
        p.contact(slave, plane()?)?.method(Arc::clone(method)).id()
    } else {
        let lower = p.body("lower", lower, Hooke::plane_strain(1.0, 0.3)?)?;
        p.fix(lower.side("u0"), Components::X)?;
        p.fix(lower.side("v0"), Components::Y)?;
        p.contact(slave, lower.side("v1"))?.method(Arc::clone(method)).id()
    };
    Ok((p.assemble()?, contact))
}

/// Makes the rows of the blocks that are apart and checks them.
fn rows(method: &dyn ContactMethod<1, 2>, rigid: bool) -> Result<(), Box<dyn Error>> {
    let (upper, lower) = bodies(APART)?;
    let (slave, master, plane) = (upper.trace("v0")?, lower.trace("v1")?, plane()?);
    let of_slave = 2 * upper.space().num_functions();
    let fields = [Field { first: 0, components: 2 }, Field { first: of_slave, components: 2 }];
    let elastic: Arc<dyn Material<2, 2>> = Arc::new(Hooke::plane_strain(1.0, 0.3)?);
    let own = BodyFlux::<2, 1, 2, _>::new(upper.space().clone(), slave.clone(), fields[0], Arc::clone(&elastic))?;
    let other = BodyFlux::<2, 1, 2, _>::new(lower.space().clone(), master.clone(), fields[1], elastic)?;
    let (segments, opponent) = if rigid {
        (slave_segments(&*slave.space, &gauss_rules(&*slave.space, 0)), Opponent::Rigid(&plane, None))
    } else {
        let rule = MergedCurve { points: 3, partners: Partners::Facing { reach: None } };
        let side = Side { trace: &master, field: fields[1], flux: Some(&other) };
        (rule.segments(&slave.oriented(), &master.oriented())?, Opponent::Master(side))
    };
    let psi = multiplier::build(&slave.space, MultiplierKind::Auto, &[false; 2])?;
    let psi = Some(&*psi as &dyn Basis<1>).filter(|_| method.needs().multiplier);
    let side = Side { trace: &slave, field: fields[0], flux: Some(&own) };
    let unknowns = of_slave + 2 * lower.space().num_functions();
    let at = ContactAt::new(side, opponent, &segments, psi, &|_, g| g, unknowns);
    let made = method.rows(&at)?;
    made.sound(psi.map(Basis::num_functions), unknowns)?;
    if let Some(values) = method.values(&at, &vec![0.0; unknowns]) {
        values?.sound(segments.ds.len())?;
    }
    row_by_row(method, &made, of_slave, rigid)?;
    if method.rows(&at)? != made {
        return Err("the same sides give different rows when asked again".into());
    }
    Ok(())
}

/// Checks balance, weights, offsets and compliance; the unknowns of the slave are those below `of_slave`.
fn row_by_row(method: &dyn ContactMethod<1, 2>, built: &ContactRows<1, 2>, of_slave: usize, rigid: bool) -> Result<(), String> {
    for (name, rows) in [("C", Some(&built.rows)), ("B", built.reaction.as_ref())] {
        let Some(rows) = rows else { continue };
        for component in 0..2 {
            let both = moved(rows, built, &|unknown| f64::from(u8::from(unknown % 2 == component)));
            if let Some(j) = (0..both.len()).find(|&j| !rigid && both[j][0].abs() > BALANCE * both[j][1]) {
                return Err(format!("row {j} of {name}: a translation of both bodies opens the gap by {:e}", both[j][0]));
            }
        }
        // up, away from what it faces
        let away = moved(rows, built, &|unknown| f64::from(u8::from(unknown % 2 == 1 && unknown < of_slave)));
        let off = |j: &usize| built.facing[*j] && (away[*j][0] - built.weights[*j]).abs() > BALANCE * away[*j][1].max(built.weights[*j]);
        if let Some(j) = (0..away.len()).find(off) {
            let (found, weight) = (away[j][0], built.weights[j]);
            return Err(format!("row {j} of {name}: the slave moved away by 1 opens the gap by {found:e}, the weight is {weight:e}"));
        }
    }
    for j in (0..built.offset.len()).filter(|&j| built.facing[j]) {
        let (offset, weight) = (built.offset[j], built.weights[j]);
        if weight.is_nan() || weight <= 0.0 {
            return Err(format!("row {j} faces something and has the weight {weight:e}"));
        }
        if offset.is_nan() || (offset - weight * APART).abs() > BALANCE * weight {
            return Err(format!("row {j}: the offset is {offset:e} for the weight {weight:e} and the gap {APART}"));
        }
    }
    let area: f64 = built.weights.iter().sum();
    if (area - 1.0).abs() > BALANCE {
        return Err(format!("the weights add up to {area}, the area of the side is 1"));
    }
    let (begun, m) = (method.begin(built, &|j| built.weights[j].powi(2)), built.offset.len());
    if !begun.compliance.is_empty() && begun.compliance.len() != m {
        return Err(format!("{} compliances of {m} rows", begun.compliance.len()));
    }
    match begun.compliance.iter().position(|c| c.is_nan() || *c < 0.0) {
        Some(j) => Err(format!("row {j} has the compliance {:e}", begun.compliance[j])),
        None => Ok(()),
    }
}

/// Per row, the sum of its entries times the displacements, and that of their sizes.
fn moved(rows: &Rows, built: &ContactRows<1, 2>, displacement: &dyn Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 2]; built.offset.len()];
    for &(j, unknown, value) in rows.slave.entries.iter().chain(&rows.master.entries) {
        sums[j][0] += value * displacement(unknown);
        sums[j][1] += (value * displacement(unknown)).abs();
    }
    sums
}

/// The blocks that touch, under a constant load.
fn patch_test(system: &mut System<1, 2>, contact: ContactId) -> Result<(), String> {
    let solution = system.solve(1.0, None).map_err(|e| format!("the patch test is not solved: {e}"))?;
    let found = solution.contact(contact).map_err(|e| e.to_string())?;
    let off = |what: &str, found: f64, wanted: f64, size: f64| {
        let text = format!("the patch test has the {what} {found:e}, right is {wanted:e}");
        if (found - wanted).abs() <= PATCH * size { Ok(()) } else { Err(text) }
    };
    off("force", found.force[1], PRESSURE, PRESSURE)?;
    off("force along the side", found.force[0], 0.0, PRESSURE)?;
    off("moment", found.moment[2], 0.5 * PRESSURE, PRESSURE)?;
    off("largest pressure", found.largest_pressure, PRESSURE, PRESSURE)?;
    off("area", found.area, 1.0, 1.0)?;
    let lambda = solution.lambda(contact, 0).map_err(|e| e.to_string())?.ok_or("the slave side has no lambda")?;
    for element in 0..4 {
        for lambda in lambda.at(element, &[Vector::from([0.2]), Vector::from([0.7])]).concat() {
            off("lambda at a point", lambda, -PRESSURE, PRESSURE)?;
        }
    }
    let largest = solution.unknowns().iter().fold(0.0f64, |m, u| m.max(u.abs()));
    off("least gap", found.least_gap, 0.0, largest)
}
