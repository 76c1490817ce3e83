//! Mortar coupling of two sides with one multiplier space, or one per component.
//!
//! C = [D | -M],  D_ji = ∫ ψ_j N_i^s ds,  M_jk = ∫ ψ_j N_k^m ds        (j multipliers, i slave, k master)
//!
//! Rows: component after component, each with its own multiplier where several are given. With a direction n per point
//! the rows are scalar, one per multiplier function: D_j(i,c) = ∫ ψ_j N_i^s n_c ds, and M alike (contact).
//! Sign: C u = ∫ ψ_j (u_slave - u_master) ds, so K u + Cᵀ lambda = f gives lambda = minus the slave's traction.
//!
//! Limits: segments must not overlap. Without a master side the M part is empty (rigid).
//! Source: Brivadis, Buffa, Wohlmuth, Wunderlich, CMAME 284 (2015) 292-319.

use super::{Coupling, CouplingBlocks, CouplingError, Interface, Rows, Segments, Side};
use crate::basis::{Basis, Order, ShapeTable};
use crate::linalg::{Real, Triplets, Vector};
use crate::parallel;
use std::ops::Range;

/// Mortar rows from the segments of an interface. With `master_segments` the reaction keeps D and takes its master part
/// from the second list (mixed integration); then B differs from C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mortar;

impl<const S: usize, const N: usize, T: Real> Coupling<S, N, T> for Mortar {
    fn rows_are_mortar(&self) -> bool {
        true
    }
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError> {
        let rows = RowNumbers::of(interface)?;
        let constraint = mortar_rows(interface, &rows, interface.segments, [true, true], unknowns);
        let reaction = match interface.master_segments {
            None => None,
            Some(_) if interface.direction.is_some() => {
                return Err(CouplingError::Missing(
                    "mixed integration has no directions for its second list of points; use merged integration with contact rows".into(),
                ));
            }
            Some(second) => {
                let master = mortar_rows(interface, &rows, second, [false, true], unknowns).master;
                Some(Rows { slave: constraint.slave.clone(), master })
            }
        };
        Ok(CouplingBlocks { constraint, reaction, ..CouplingBlocks::empty(unknowns) })
    }
}

/// First row of each component, and the number of rows.
struct RowNumbers {
    first: Vec<usize>,
    total: usize,
}

impl RowNumbers {
    fn of<const S: usize, const N: usize, T: Real>(interface: &Interface<'_, S, N, T>) -> Result<Self, CouplingError> {
        let expected = interface.slave.trace.space.num_elements();
        for multiplier in interface.multiplier {
            let found = multiplier.num_elements();
            if found != expected {
                return Err(CouplingError::Elements { expected, found });
            }
        }
        let components = interface.slave.field.components;
        if let Some(master) = &interface.master
            && master.field.components != components
        {
            return Err(CouplingError::Missing(format!(
                "the slave has {components} components, the master {}; both must have the same number",
                master.field.components
            )));
        }
        let given = interface.multiplier.len();
        if let Some(direction) = interface.direction {
            if given != 1 || components != N {
                return Err(CouplingError::Missing(format!(
                    "rows along a direction need one multiplier and {N} components; {given} multipliers and {components} components are given"
                )));
            }
            if direction.len() != interface.segments.ds.len() {
                return Err(CouplingError::Missing(format!(
                    "{} directions are given for {} points of the segments; one per point is needed",
                    direction.len(),
                    interface.segments.ds.len()
                )));
            }
            return Ok(Self { first: vec![0], total: interface.multiplier[0].num_functions() });
        }
        if given != 1 && given != components {
            return Err(CouplingError::Missing(format!(
                "{given} multiplier spaces are given for {components} components; one, or one per component is needed"
            )));
        }
        let mut first = Vec::with_capacity(components);
        let mut total = 0;
        for c in 0..components {
            first.push(total);
            total += interface.multiplier[if given == 1 { 0 } else { c }].num_functions();
        }
        Ok(Self { first, total })
    }
}

/// Work arrays of one thread, reused from element to element.
struct Work<const S: usize, T: Real> {
    psi: ShapeTable<S, T>,
    shapes: ShapeTable<S, T>,
    psi_ids: Vec<usize>,
    ids: Vec<usize>,
    slave: Vec<T>,
    master: Vec<T>,
}

impl<const S: usize, T: Real> Work<S, T> {
    fn new() -> Self {
        Self {
            psi: ShapeTable::new(),
            shapes: ShapeTable::new(),
            psi_ids: Vec::new(),
            ids: Vec::new(),
            slave: Vec::new(),
            master: Vec::new(),
        }
    }
}

type Entries<T> = Vec<(usize, usize, T)>;

/// D and -M of one list of segments, parallel by slave element, in order of slave elements.
fn mortar_rows<const S: usize, const N: usize, T: Real>(
    interface: &Interface<'_, S, N, T>,
    rows: &RowNumbers,
    segments: &Segments<S, T>,
    wanted: [bool; 2],
    unknowns: usize,
) -> Rows<T> {
    let runs = segments.runs();
    let parts: Vec<(Entries<T>, Entries<T>)> =
        parallel::map_init(runs.len(), Work::new, |work, k| element_rows(interface, rows, segments, runs[k].clone(), wanted, work));
    let mut out = Rows { slave: Triplets::new(rows.total, unknowns), master: Triplets::new(rows.total, unknowns) };
    out.slave.entries.reserve(parts.iter().map(|p| p.0.len()).sum());
    out.master.entries.reserve(parts.iter().map(|p| p.1.len()).sum());
    for (slave, master) in parts {
        out.slave.entries.extend(slave);
        out.master.entries.extend(master);
    }
    out
}

/// Entries of the pieces of one slave element.
fn element_rows<const S: usize, const N: usize, T: Real>(
    interface: &Interface<'_, S, N, T>,
    rows: &RowNumbers,
    segments: &Segments<S, T>,
    pieces: Range<usize>,
    wanted: [bool; 2],
    work: &mut Work<S, T>,
) -> (Entries<T>, Entries<T>) {
    let (mut slave_entries, mut master_entries) = (Vec::new(), Vec::new());
    let element = segments.slave[pieces.start];
    for (m, &multiplier) in interface.multiplier.iter().enumerate() {
        // one multiplier serves all components, or there is one per component
        let components = if interface.multiplier.len() == 1 { 0..interface.slave.field.components } else { m..m + 1 };
        multiplier.active(element, &mut work.psi_ids);
        work.slave.clear();
        for piece in pieces.clone() {
            let points = segments.start[piece]..segments.start[piece + 1];
            let directions = interface.direction.map(|d| &d[points.clone()]);
            multiplier.tabulate(element, &segments.slave_xi[points.clone()], Order::Values, &mut work.psi);
            if wanted[0] {
                let space = &interface.slave.trace.space;
                space.tabulate(element, &segments.slave_xi[points.clone()], Order::Values, &mut work.shapes);
                add_products(&work.psi, &work.shapes, &segments.ds[points.clone()], directions, &mut work.slave);
            }
            if let (true, Some(side)) = (wanted[1], &interface.master) {
                let other = segments.master[piece];
                side.trace.space.active(other, &mut work.ids);
                side.trace.space.tabulate(other, &segments.master_xi[points.clone()], Order::Values, &mut work.shapes);
                work.master.clear();
                add_products(&work.psi, &work.shapes, &segments.ds[points], directions, &mut work.master);
                let block = Block { values: &work.master, psi: &work.psi_ids, ids: &work.ids, sign: -T::one() };
                block.push(side, rows, components.clone(), interface.direction.is_some(), &mut master_entries);
            }
        }
        if wanted[0] {
            interface.slave.trace.space.active(element, &mut work.ids);
            let block = Block { values: &work.slave, psi: &work.psi_ids, ids: &work.ids, sign: T::one() };
            block.push(&interface.slave, rows, components, interface.direction.is_some(), &mut slave_entries);
        }
    }
    (slave_entries, master_entries)
}

/// block[j, a] += sum_q ds_q psi_j N_a, or block[j, a, c] += sum_q ds_q psi_j N_a n_c.
fn add_products<const S: usize, const N: usize, T: Real>(
    psi: &ShapeTable<S, T>,
    shapes: &ShapeTable<S, T>,
    ds: &[T],
    directions: Option<&[Vector<N, T>]>,
    block: &mut Vec<T>,
) {
    let (nj, na) = (psi.num_functions(), shapes.num_functions());
    let width = if directions.is_some() { N } else { 1 };
    if block.is_empty() {
        block.resize(nj * na * width, T::zero());
    }
    for (q, &ds) in ds.iter().enumerate() {
        let values = shapes.values(q);
        for (j, &psi_j) in psi.values(q).iter().enumerate() {
            let weight = ds * psi_j;
            let line = &mut block[j * na * width..(j + 1) * na * width];
            match directions {
                None => line.iter_mut().zip(values).for_each(|(b, &v)| *b += weight * v),
                Some(n) => {
                    for (a, &v) in values.iter().enumerate() {
                        for c in 0..N {
                            line[a * N + c] += weight * v * n[q][c];
                        }
                    }
                }
            }
        }
    }
}

/// Products of the active multipliers and functions on one element pair.
struct Block<'a, T> {
    values: &'a [T],
    psi: &'a [usize],
    ids: &'a [usize],
    sign: T,
}

impl<T: Real> Block<'_, T> {
    fn push<const S: usize, const N: usize>(
        &self,
        side: &Side<'_, S, N, T>,
        rows: &RowNumbers,
        components: Range<usize>,
        directed: bool,
        entries: &mut Entries<T>,
    ) {
        let na = self.ids.len();
        entries.reserve(self.psi.len() * na * components.len());
        for c in components {
            let first = if directed { 0 } else { rows.first[c] };
            for (j, &row) in self.psi.iter().enumerate() {
                for (a, &i) in self.ids.iter().enumerate() {
                    let place = if directed { (j * na + a) * N + c } else { j * na + a };
                    let unknown = side.field.unknown(side.trace.dofs[i], c);
                    entries.push((first + row, unknown, self.sign * self.values[place]));
                }
            }
        }
    }
}

/// w_j = ∫ ψ_j ds over the segments, one per multiplier function \[length^S\].
pub fn multiplier_weights<const S: usize, T: Real>(multiplier: &dyn Basis<S, T>, segments: &Segments<S, T>) -> Vec<T> {
    weighted_sums(multiplier, segments, |_| T::one())
}

/// ∫ |ψ_j| ds over the segments, one per multiplier function.
pub(crate) fn multiplier_magnitudes<const S: usize, T: Real>(multiplier: &dyn Basis<S, T>, segments: &Segments<S, T>) -> Vec<T> {
    sums_over(multiplier, segments, |q, value| segments.ds[q] * value.abs())
}

/// ∫ f ψ_j ds over the segments for values `f(point number)`, one per multiplier function.
pub fn weighted_sums<const S: usize, T: Real>(multiplier: &dyn Basis<S, T>, segments: &Segments<S, T>, f: impl Fn(usize) -> T) -> Vec<T> {
    sums_over(multiplier, segments, |q, value| segments.ds[q] * f(q) * value)
}

/// Sums of `part(point number, ψ_j)` over the points of the segments, one per multiplier function.
fn sums_over<const S: usize, T: Real>(multiplier: &dyn Basis<S, T>, segments: &Segments<S, T>, part: impl Fn(usize, T) -> T) -> Vec<T> {
    let (mut sums, mut psi, mut ids) = (vec![T::zero(); multiplier.num_functions()], ShapeTable::new(), Vec::new());
    for piece in 0..segments.slave.len() {
        let points = segments.start[piece]..segments.start[piece + 1];
        multiplier.active(segments.slave[piece], &mut ids);
        multiplier.tabulate(segments.slave[piece], &segments.slave_xi[points.clone()], Order::Values, &mut psi);
        for (k, q) in points.enumerate() {
            for (&j, &value) in ids.iter().zip(psi.values(k)) {
                sums[j] += part(q, value);
            }
        }
    }
    sums
}
