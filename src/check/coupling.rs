//! Contract of [`Coupling`]: shapes, unknowns of the right side, force balance, the slave's own column sums.

use crate::basis::{Basis, Order, ShapeTable};
use crate::coupling::{Coupling, Interface, Rows};
use crate::linalg::{Real, to_f64};

/// Largest error of force balance and column sums, relative to the largest sum.
const BALANCE: f64 = 1e-12;

/// Share of the largest integral of a function below which a weight may be as small.
const SMALL: f64 = 1e-6;

/// Checks the blocks that `coupling` makes of `interface` in a system of `unknowns` unknowns.
///
/// Rows: entries lie in the unknowns of their side; where the functions of both sides sum to one, the slave and master
/// entries of every row cancel (a translation opens no gap: force balance); where the multiplier sums to one, its rows
/// add up to ∫ w N_i ds with a weight w > 0, the same of all components: to a positive number where N_i is nowhere negative, and to
/// none where it vanishes.
/// Stiffness: a translation of both sides gives no force.
///
/// # Errors
/// A sentence that names the broken rule and the place.
pub fn coupling<const S: usize, const N: usize, T: Real>(
    coupling: &dyn Coupling<S, N, T>,
    interface: &Interface<'_, S, N, T>,
    unknowns: usize,
) -> Result<(), String> {
    let blocks = coupling.assemble(interface, unknowns).map_err(|e| format!("no blocks: {e}"))?;
    if coupling.assemble(interface, unknowns).ok().as_ref() != Some(&blocks) {
        return Err("the same interface gives different blocks when asked again".into());
    }
    for rows in std::iter::once(&blocks.constraint).chain(&blocks.reaction) {
        ownership(rows, interface, unknowns)?;
        balance(rows, interface)?;
    }
    columns(&blocks.constraint, interface)?;
    let field = interface.slave.field;
    let mut force = vec![[0.0; 2]; unknowns];
    for &(i, j, v) in &blocks.stiffness.entries {
        if i >= unknowns || j >= unknowns {
            return Err(format!("the stiffness has an entry at ({i}, {j}) among {unknowns} unknowns"));
        }
        if (j.wrapping_sub(field.first)) % field.components == 0 {
            force[i][0] += to_f64(v);
        }
        force[i][1] += to_f64(v).abs();
    }
    match (0..unknowns).find(|&i| force[i][0].abs() > BALANCE * force[i][1]) {
        Some(i) if interface.master.is_some() => Err(format!("a translation makes the force {:e} at unknown {i}", force[i][0])),
        _ => Ok(()),
    }
}

/// Checks that entries are unknowns of their side's functions, in a matrix of the right width.
fn ownership<const S: usize, const N: usize, T: Real>(
    rows: &Rows<T>,
    interface: &Interface<'_, S, N, T>,
    unknowns: usize,
) -> Result<(), String> {
    let sides = [("slave", &rows.slave, Some(&interface.slave)), ("master", &rows.master, interface.master.as_ref())];
    for (name, part, side) in sides {
        if part.cols != unknowns {
            return Err(format!("the {name} part has {} columns for {unknowns} unknowns", part.cols));
        }
        let mut own = vec![false; unknowns];
        if let Some(side) = side {
            for &function in &side.trace.dofs {
                (0..side.field.components).for_each(|c| own[side.field.unknown(function, c)] = true);
            }
        }
        if let Some((i, j, v)) = part.entries.iter().find(|(i, j, _)| *i >= part.rows || !own.get(*j).copied().unwrap_or(false)) {
            return Err(format!("the {name} part has {v:?} at ({i}, {j}), which is no unknown of that side"));
        }
    }
    Ok(())
}

/// Checks that slave and master entries of every row cancel; along a direction this holds for the sum over components too.
fn balance<const S: usize, const N: usize, T: Real>(rows: &Rows<T>, interface: &Interface<'_, S, N, T>) -> Result<(), String> {
    // the coefficients of a translation are known only if the functions of both sides sum to one
    let Some(master) = &interface.master else { return Ok(()) };
    if !sums_to_one(&*interface.slave.trace.space) || !sums_to_one(&*master.trace.space) {
        return Ok(());
    }
    let (mut sums, mut sizes) = (vec![0.0; rows.slave.rows], vec![0.0; rows.slave.rows]);
    for part in [&rows.slave, &rows.master] {
        for &(i, _, v) in &part.entries {
            sums[i] += to_f64(v);
            sizes[i] += to_f64(v).abs();
        }
    }
    let largest = sizes.iter().fold(0.0, |m: f64, v| m.max(*v));
    match (0..sums.len()).find(|&i| sums[i].abs() > BALANCE * largest) {
        None => Ok(()),
        Some(i) => Err(format!("the entries of row {i} sum to {:e}: a translation would open a gap", sums[i])),
    }
}

/// Checks that the rows of a multiplier that sums to one add up to weighted integrals of the slave's functions over the segments.
fn columns<const S: usize, const N: usize, T: Real>(rows: &Rows<T>, interface: &Interface<'_, S, N, T>) -> Result<(), String> {
    if interface.direction.is_some() || rows.slave.entries.is_empty() || !interface.multiplier.iter().all(|m| sums_to_one(*m)) {
        return Ok(());
    }
    let (space, field) = (&interface.slave.trace.space, interface.slave.field);
    // per function: the integral, that of its absolute value, and its least value
    let (mut of, mut ids, mut table) = (vec![[0.0; 3]; space.num_functions()], Vec::new(), ShapeTable::new());
    for piece in 0..interface.segments.num_pieces() {
        let points = interface.segments.points(piece);
        space.active(interface.segments.slave[piece], &mut ids);
        space.tabulate(interface.segments.slave[piece], &interface.segments.slave_xi[points.clone()], Order::Values, &mut table);
        for (k, q) in points.enumerate() {
            for (&i, &v) in ids.iter().zip(table.values(k)) {
                let (v, ds) = (to_f64(v), to_f64(interface.segments.ds[q]));
                of[i] = [of[i][0] + v * ds, of[i][1] + v.abs() * ds, of[i][2].min(v)];
            }
        }
    }
    let mut found = vec![0.0; rows.slave.cols];
    rows.slave.entries.iter().for_each(|&(_, j, v)| found[j] += to_f64(v));
    let largest = found.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let full = of.iter().fold(0.0, |m: f64, o| m.max(o[1]));
    for (i, &function) in interface.slave.trace.dofs.iter().enumerate() {
        let first = found[field.unknown(function, 0)];
        for c in 0..field.components {
            let sum = found[field.unknown(function, c)];
            let wrong = match of[i] {
                [_, size, _] if size <= BALANCE * full => sum.abs() > BALANCE * largest,
                [_, size, least] if least >= -BALANCE && size > SMALL * full => sum <= BALANCE * largest,
                _ => false,
            };
            if wrong || (sum - first).abs() > BALANCE * largest {
                return Err(format!(
                    "the rows of slave function {i}, component {c}, add up to {sum:e}, those of component 0 to {first:e}; its integral is {:e}",
                    of[i][0]
                ));
            }
        }
    }
    Ok(())
}

fn sums_to_one<const S: usize, T: Real, B: Basis<S, T> + ?Sized>(multiplier: &B) -> bool {
    let mut table = ShapeTable::new();
    (0..multiplier.num_elements()).all(|e| {
        multiplier.tabulate(e, &[crate::linalg::Vector::repeat(crate::linalg::lit(0.3))], Order::Values, &mut table);
        (to_f64(table.values(0).iter().fold(T::zero(), |s, &v| s + v)) - 1.0).abs() < BALANCE
    })
}
