//! Nitsche's coupling of two sides: stiffness instead of multipliers.
//!
//! ```text
//! a(u, v) - ∫ {t(u)} . [v] ds - θ ∫ {t(v)} . [u] ds + ∫ γ [u] . [v] ds
//! ```
//!
//! ```text
//! [u] = u_slave - u_master,   {t} = w_s t_s - w_m t_m,   t_s = sigma(u_s) n_s,  t_m = sigma(u_m) n_m   (outward normals; exact: t_m = -t_s)
//! w_s = d_m / (d_s + d_m),   w_m = d_s / (d_s + d_m),   γ = factor d_s d_m / (d_s + d_m)
//! ```
//!
//! θ = 1 symmetric, -1 unsymmetric, 0 incomplete. d \[modulus/length\] is the bound of the flux by the energy of the element
//! behind the facet, ∫ |t|² ds <= d a(u, u), from a local eigenvalue ([`Flux::stabilisation`](crate::physics::Flux)); on the master
//! ds is the slave's wherever that is larger, as the sums have it. The
//! weights put the flux on the softer or larger side, and γ is half the harmonic mean of both bounds: a jump of the modulus by
//! any factor changes neither the coercivity nor the condition that the softer side has by itself.
//!
//! Coercive by Young's inequality, piece by piece, where no element has more than m facets on tied sides: symmetric for
//! factor > m, incomplete for factor > m / 4, unsymmetric for factor > 0. The default [`Nitsche::AUTO`] = 4 holds for m <= 3. Factors
//! below 1 are an error for the first two; between 1 and m the solver rejects a symmetric matrix with negative energy.
//!
//! lambda = -{t} + γ \[u\] is the flux that crosses numerically, in the sign of a multiplier: minus the slave's traction. It is in
//! balance with the loads of both bodies, whatever γ is.
//!
//! Sources: Nitsche, Abh. Math. Sem. Hamburg 36 (1971) 9-15; Ern, Stephansen, Zunino, IMA J. Numer. Anal. 29 (2009) 235-256
//! (weights); Annavarapu, Hautefeuille, Dolbow, CMAME 225 (2012) 44-54 (weights and eigenvalues); Griebel, Schweitzer (2003) and
//! Embar, Dolbow, Harari, IJNME 83 (2010) 877-898 (local eigenvalues, splines).

use super::{Coupling, CouplingBlocks, CouplingError, Interface, Segments, Side};
use crate::basis::{Basis, Elements, Order, ShapeTable};
use crate::linalg::{Real, Triplets, lit, to_f64};
use crate::parallel;
use crate::physics::{Flux, FluxTable};
use std::ops::Range;

/// Completion of the consistency term: the value of θ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Variant {
    /// θ = 1: symmetric, optimal in L2, needs a factor above the bound.
    #[default]
    Symmetric,
    /// θ = -1: coercive for every positive factor; the order in L2 may be p for even p.
    Unsymmetric,
    /// θ = 0: no term in the flux of the test function.
    Incomplete,
}

/// Nitsche's method with weighted fluxes; slave and master enter alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nitsche {
    /// Multiplies the stabilisation, a pure number.
    pub factor: f64,
    /// Symmetric, unsymmetric, incomplete.
    pub variant: Variant,
}

impl Default for Nitsche {
    fn default() -> Self {
        Self { factor: Self::AUTO, variant: Variant::Symmetric }
    }
}

/// The smallest factor of the symmetric and the incomplete variant. Below it the symmetric form has next to no energy in some
/// directions, or less than none: answers would lose accuracy before a factorisation fails. The incomplete form is coercive from
/// there on if elements have up to four facets on tied sides; its matrix is not symmetric, so no factorisation would detect a loss.
const LEAST: f64 = 1.0;

impl Nitsche {
    /// The factor of `factor = "auto"`: above the bound of elements with up to three facets on tied sides.
    pub const AUTO: f64 = 4.0;

    fn check<const S: usize, const N: usize, T: Real>(&self, interface: &Interface<'_, S, N, T>) -> Result<(), CouplingError> {
        let fault = |text: &str| Err(CouplingError::Missing(text.into()));
        if interface.direction.is_some() {
            return fault("Nitsche's coupling ties all components; rows along a direction belong to mortar coupling");
        }
        if interface.master_segments.is_some() {
            return fault(
                "mixed integration has no meaning for Nitsche's coupling, which has no multiplier; write integration = \"merged\"",
            );
        }
        if let Some(master) = &interface.master
            && master.field.components != interface.slave.field.components
        {
            return fault("both sides must have the same number of components");
        }
        self.check_factor()
    }

    /// Checks that the variant is stable for the factor.
    ///
    /// # Errors
    /// [`CouplingError::Missing`] where the factor is not positive, or too small for the symmetric and the incomplete variant.
    pub fn check_factor(&self) -> Result<(), CouplingError> {
        if !(self.factor > 0.0 && self.factor.is_finite()) {
            return Err(CouplingError::Missing(format!("the factor of Nitsche's method must be positive, found {}", self.factor)));
        }
        if self.variant != Variant::Unsymmetric && self.factor < LEAST {
            return Err(CouplingError::Missing(format!(
                "this variant of Nitsche's method is stable for factors from {LEAST} on, found {}; the unsymmetric one takes any",
                self.factor
            )));
        }
        Ok(())
    }

    /// θ of the variant (module docs).
    pub(crate) fn theta(&self) -> f64 {
        match self.variant {
            Variant::Symmetric => 1.0,
            Variant::Unsymmetric => -1.0,
            Variant::Incomplete => 0.0,
        }
    }
}

/// The flux of a side.
fn flux<'a, const S: usize, const N: usize, T: Real>(side: &Side<'a, S, N, T>) -> Result<&'a dyn Flux<S, N, T>, CouplingError> {
    side.flux.ok_or_else(|| CouplingError::Missing("Nitsche's coupling needs the fluxes of both bodies".into()))
}

/// d per element of a side, zero for elements that are not in `elements`.
pub(crate) fn bounds<const S: usize, const N: usize, T: Real>(
    side: &Side<'_, S, N, T>,
    elements: &[usize],
) -> Result<Vec<T>, CouplingError> {
    let flux = flux(side)?;
    let mut wanted = elements.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    let found: Vec<T> = parallel::map(wanted.len(), |k| flux.stabilisation(wanted[k]));
    let mut all = vec![T::zero(); side.trace.space.num_elements()];
    for (&e, &d) in wanted.iter().zip(&found) {
        if !(d > T::zero() && to_f64(d).is_finite()) {
            return Err(CouplingError::Missing(format!(
                "the flux through element {e} of a side has no bound by its energy (found {}); its element is degenerate",
                to_f64(d)
            )));
        }
        all[e] = d;
    }
    Ok(all)
}

/// Part by which the sum over the points of a master's element may exceed the bound by its own measure: sides that touch differ by as
/// much where facets stand for one of them.
const ALIKE: f64 = 0.05;

/// d per element of the master. The coupling sums the master's flux with the weights of the slave: where these exceed the master's own
/// measure, as on a slave that is steep to it, d bounds that sum.
pub(crate) fn master_bounds<const S: usize, const N: usize, T: Real>(
    side: &Side<'_, S, N, T>,
    segments: &Segments<S, T>,
) -> Result<Vec<T>, CouplingError> {
    let (flux, mut all) = (flux(side)?, bounds(side, &segments.master)?);
    let mut pieces: Vec<usize> = (0..segments.num_pieces()).collect();
    pieces.sort_by_key(|&piece| segments.master[piece]);
    let of_element: Vec<&[usize]> = pieces.chunk_by(|&a, &b| segments.master[a] == segments.master[b]).collect();
    let of_sums: Vec<T> = parallel::map(of_element.len(), |k| {
        let pieces = of_element[k];
        let points = || pieces.iter().flat_map(|&piece| segments.points(piece));
        let xi: Vec<_> = points().map(|q| segments.master_xi[q]).collect();
        let ds: Vec<T> = points().map(|q| segments.ds[q]).collect();
        flux.stabilisation_of_sum(segments.master[pieces[0]], &xi, &ds)
    });
    for (pieces, sum) in of_element.iter().zip(of_sums) {
        let own = &mut all[segments.master[pieces[0]]];
        if sum > *own * lit(1.0 + ALIKE) && sum.is_finite() {
            *own = sum;
        }
    }
    Ok(all)
}

/// Weights of the fluxes and the stabilisation of every piece.
pub(crate) struct Weights<T> {
    slave: Vec<T>,
    master: Vec<T>,
    /// γ.
    pub stabilisation: Vec<T>,
}

impl<T: Real> Weights<T> {
    pub fn of<const S: usize, const N: usize>(nitsche: &Nitsche, interface: &Interface<'_, S, N, T>) -> Result<Self, CouplingError> {
        let segments = interface.segments;
        let on_slave = bounds(&interface.slave, &segments.slave)?;
        let on_master = interface.master.as_ref().map(|side| master_bounds(side, segments)).transpose()?;
        let mut weights = Self { slave: Vec::new(), master: Vec::new(), stabilisation: Vec::new() };
        for (&s, &m) in segments.slave.iter().zip(&segments.master) {
            let a = on_slave[s];
            // a rigid master has no flux: all weight is on the slave
            let share = on_master.as_ref().map_or(T::one(), |d| d[m] / (a + d[m]));
            weights.slave.push(share);
            weights.master.push(on_master.as_ref().map_or(T::zero(), |d| a / (a + d[m])));
            weights.stabilisation.push(a * share * lit(nitsche.factor));
        }
        Ok(weights)
    }
}

/// Jump and mean flux at the points of a piece; work arrays of one thread, reused from piece to piece.
pub(crate) struct PointFluxes<const S: usize, T: Real> {
    shapes: ShapeTable<S, T>,
    table: FluxTable<T>,
    ids: Vec<usize>,
    /// Unknowns of the jump, component by component of every function.
    pub jump: Vec<usize>,
    /// `[u]_c = values[q * functions + i] u_(i,c)`, master negative.
    pub values: Vec<T>,
    /// Unknowns of the mean flux.
    pub flux: Vec<usize>,
    /// Mean flux, `mean[(q * components + c) * flux + f]`.
    pub mean: Vec<T>,
    /// Number of unknowns of the slave in `jump` and `flux`, where they come first.
    pub of_slave: [usize; 2],
    /// Consistency block, `block[j * flux + f]`.
    block: Vec<T>,
    /// Values of the functions and of the fluxes of both sides.
    sides: [[Vec<T>; 2]; 2],
}

impl<const S: usize, T: Real> PointFluxes<S, T> {
    pub fn new() -> Self {
        Self {
            shapes: ShapeTable::new(),
            table: FluxTable::default(),
            ids: Vec::new(),
            jump: Vec::new(),
            values: Vec::new(),
            flux: Vec::new(),
            mean: Vec::new(),
            of_slave: [0; 2],
            block: Vec::new(),
            sides: Default::default(),
        }
    }

    /// Fills jump and mean flux of `piece`.
    pub fn tabulate<const N: usize>(
        &mut self,
        interface: &Interface<'_, S, N, T>,
        weights: &Weights<T>,
        piece: usize,
    ) -> Result<(), CouplingError> {
        let segments = interface.segments;
        let points = segments.points(piece);
        let (count, components) = (points.len(), interface.slave.field.components);
        self.jump.clear();
        self.flux.clear();
        let (mut widths, mut counts) = ([0; 2], [0; 2]);
        let [tables, fluxes] = &mut self.sides;
        tables.iter_mut().chain(fluxes.iter_mut()).for_each(Vec::clear);
        let sides = [
            (Some(&interface.slave), &segments.slave, &segments.slave_xi),
            (interface.master.as_ref(), &segments.master, &segments.master_xi),
        ];
        for (k, (side, elements, xi)) in sides.into_iter().enumerate() {
            let Some(side) = side else { continue };
            let (element, xi) = (elements[piece], &xi[points.clone()]);
            side.trace.space.active(element, &mut self.ids);
            side.trace.space.tabulate(element, xi, Order::Values, &mut self.shapes);
            counts[k] = self.ids.len();
            self.jump.extend(
                self.ids.iter().flat_map(|&i| (0..components).map(move |c| (i, c))).map(|(i, c)| side.field.unknown(side.trace.dofs[i], c)),
            );
            tables[k].extend((0..count).flat_map(|q| self.shapes.values(q).iter().copied()));
            flux(side)?.tabulate(element, xi, &mut self.table);
            if self.table.components != components || self.table.values.len() != count * components * self.table.dofs.len() {
                return Err(CouplingError::Missing("the table of a flux has not the shape points x components x unknowns".into()));
            }
            widths[k] = self.table.dofs.len();
            self.flux.extend_from_slice(&self.table.dofs);
            std::mem::swap(&mut fluxes[k], &mut self.table.values);
        }
        self.of_slave = [counts[0] * components, widths[0]];
        self.values.clear();
        self.mean.clear();
        for q in 0..count {
            self.values.extend(tables[0][q * counts[0]..][..counts[0]].iter().copied());
            self.values.extend(tables[1].iter().skip(q * counts[1]).take(counts[1]).map(|&v| -v));
            for c in 0..components {
                let row = q * components + c;
                self.mean.extend(fluxes[0][row * widths[0]..][..widths[0]].iter().map(|&t| weights.slave[piece] * t));
                self.mean.extend(fluxes[1].iter().skip(row * widths[1]).take(widths[1]).map(|&t| -weights.master[piece] * t));
            }
        }
        Ok(())
    }

    /// Appends the entries of `piece`.
    fn push<const N: usize>(
        &mut self,
        interface: &Interface<'_, S, N, T>,
        piece: usize,
        theta: T,
        stabilisation: T,
        entries: &mut Vec<(usize, usize, T)>,
    ) {
        let ds = &interface.segments.ds[interface.segments.points(piece)];
        let components = interface.slave.field.components;
        let (nj, nf) = (self.jump.len() / components, self.flux.len());
        self.block.clear();
        self.block.resize(nj * components * nf, T::zero());
        for (q, &ds) in ds.iter().enumerate() {
            for i in 0..nj {
                let weight = ds * self.values[q * nj + i];
                for c in 0..components {
                    let mean = &self.mean[(q * components + c) * nf..][..nf];
                    let row = &mut self.block[(i * components + c) * nf..][..nf];
                    row.iter_mut().zip(mean).for_each(|(b, &t)| *b -= weight * t);
                }
            }
        }
        for (f, &unknown) in self.flux.iter().enumerate() {
            // functions of splines may be active on the element without any flux through the side
            if (0..nj * components).all(|j| self.block[j * nf + f] == T::zero()) {
                continue;
            }
            for (j, &row) in self.jump.iter().enumerate() {
                let value = self.block[j * nf + f];
                entries.push((row, unknown, value));
                if theta != T::zero() {
                    entries.push((unknown, row, theta * value));
                }
            }
        }
        for i in 0..nj {
            for k in 0..nj {
                let sum = ds.iter().enumerate().fold(T::zero(), |s, (q, &ds)| s + ds * (self.values[q * nj + i] * self.values[q * nj + k]));
                for c in 0..components {
                    entries.push((self.jump[i * components + c], self.jump[k * components + c], stabilisation * sum));
                }
            }
        }
    }
}

pub(crate) type Entries<T> = Vec<(usize, usize, T)>;

impl<const S: usize, const N: usize, T: Real> Coupling<S, N, T> for Nitsche {
    fn assemble(&self, interface: &Interface<'_, S, N, T>, unknowns: usize) -> Result<CouplingBlocks<T>, CouplingError> {
        self.check(interface)?;
        let weights = Weights::of(self, interface)?;
        let theta = lit(self.theta());
        let of_run = |work: &mut PointFluxes<S, T>, pieces: Range<usize>| -> Result<Entries<T>, CouplingError> {
            let mut entries = Vec::new();
            for piece in pieces {
                work.tabulate(interface, &weights, piece)?;
                work.push(interface, piece, theta, weights.stabilisation[piece], &mut entries);
            }
            Ok(summed(entries))
        };
        let runs = interface.segments.runs();
        let parts: Vec<Result<Entries<T>, CouplingError>> =
            parallel::map_init(runs.len(), PointFluxes::new, |work, k| of_run(work, runs[k].clone()));
        let mut stiffness = Triplets::new(unknowns, unknowns);
        stiffness.entries = parts.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
        Ok(CouplingBlocks { stiffness, ..CouplingBlocks::empty(unknowns) })
    }

    fn has_rows(&self) -> bool {
        false
    }

    fn needs_fluxes(&self) -> bool {
        true
    }

    fn lambda(&self, interface: &Interface<'_, S, N, T>, unknowns: &[T]) -> Result<Vec<Vec<T>>, CouplingError> {
        self.check(interface)?;
        let weights = Weights::of(self, interface)?;
        let segments: &Segments<S, T> = interface.segments;
        let components = interface.slave.field.components;
        let mut values = vec![Vec::with_capacity(segments.ds.len()); components];
        let mut work = PointFluxes::new();
        for piece in 0..segments.num_pieces() {
            work.tabulate(interface, &weights, piece)?;
            let (nj, nf) = (work.jump.len() / components, work.flux.len());
            for q in 0..segments.points(piece).len() {
                for (c, values) in values.iter_mut().enumerate() {
                    let mean = &work.mean[(q * components + c) * nf..][..nf];
                    let flux = mean.iter().zip(&work.flux).fold(T::zero(), |s, (&t, &i)| s + t * unknowns[i]);
                    let jump = (0..nj).fold(T::zero(), |s, i| s + work.values[q * nj + i] * unknowns[work.jump[i * components + c]]);
                    values.push(weights.stabilisation[piece] * jump - flux);
                }
            }
        }
        Ok(values)
    }
}

/// Sums entries of equal row and column: the pieces of an element share most of theirs.
pub(crate) fn summed<T: Real>(mut entries: Entries<T>) -> Entries<T> {
    entries.sort_by_key(|e| (e.0, e.1)); // stable: equal places keep their order
    entries.dedup_by(|next, kept| {
        let same = (next.0, next.1) == (kept.0, kept.1);
        if same {
            kept.2 += next.2;
        }
        same
    });
    entries
}
