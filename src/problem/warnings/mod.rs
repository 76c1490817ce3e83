//! Warnings about problems that are solved all the same: from the model, and from the solution.
//!
//! | file | warning |
//! | --- | --- |
//! | `corner_values` | prescribed values of bodies that are tied jump in a common corner |
//! | `overlap` | contacts that overlap deeper than half a body: wrong sides face each other, and `meant` finds better ones |
//! | `too_few_functions` | multipliers hold less than their points |
//! | `thin_cells` | digits, in cells that are thinner than 1e-8 of their length |
//! | `patch_test` | stresses, in coarse cells of rational maps that their Gauss points do not integrate |
//! | `part_uncovered` | parts of tied sides that meet no master, as far as facets explain it |
//! | `facets` | gaps of sides that nearly fit, where facets leave their surface by as much |
//! | `low_order` | orders of convergence: dual multipliers of splines, mixed integration of low multipliers |
//! | `round_kink` | tractions beside an edge of a slave side round which its multiplier runs |
//! | `uneven_gap` | lambda and stresses beside ties of facets that are apart by unlike distances |
//! | `hardly_held` | motions that only soft springs hold |
//! | `flux_jumps` | errors against a piecewise exact solution whose flux jumps: its source is not that of the data |
//! | `integration` | forces through an interface whose rule does not see the other side's functions |
//! | `unbalanced` | places of bodies on springs, which take what forces of mixed integration lack in balance |
//! | `left_open` | errors of lambda against a piecewise exact solution, where it is open which piece a side has |
//! | `sliding` | contact zones, where bodies slide so far that the normal at rest is no longer theirs |
//! | `rounding` | digits, where the condition number is large: moduli of high contrast |
//! | `coarse_zone` | forces and extents of zones that few functions of the slave carry |
//! | `lost_moment` | moments that ties across a gap lose |
//! | `lost_parts` | parts of slave elements that no piece of integration covers though they face the opponent and may be pressed |
//! | `soft_penalty` | places of bodies that a soft penalty lets sink into each other |
//! | `coarse_tie` | places of bodies whose tie has too coarse a multiplier |
//! | `gap_pressure` | pressures at points that come from gaps, or from waves of facets, and not from the stress of the bodies |
//! | `tension` | forces and pressures of contacts whose cone lets them pull |
//! | `held_within` | places of bodies, and pressures beside parts of a side that are held inside of what it faces |
//! | `kinematics` | all, where bodies deform too far for small kinematics |
//!
//! Loads, springs, prescribed values and moduli that jump inside of elements or have no bound are found by [`Model::inexact_integrals`].

mod adjusted;
mod coarse_tie;
mod coarse_values;
mod coarse_zone;
mod corner_values;
mod display;
mod facets;
mod flux_jumps;
mod gap_pressure;
mod hardly_held;
mod held_within;
mod integration;
mod kinematics;
mod kinks;
mod left_open;
mod locking;
mod lost_moment;
mod lost_parts;
mod low_order;
mod meant;
mod overlap;
mod part_uncovered;
mod patch_test;
mod round_kink;
mod rounding;
mod sliding;
mod soft_penalty;
mod tension;
mod thin_cells;
mod too_few_functions;
mod unbalanced;
mod uneven_gap;
mod warning;
mod zone_extent;

use super::model::Model;
use super::state::StepState;

pub use warning::{Subject, SubjectKind, Warning};

impl<const S: usize, const N: usize> Model<S, N> {
    /// Warnings about what is stated, at `times`, at least one.
    pub fn statement_warnings(&self, times: &[f64]) -> Vec<Warning> {
        let first = times.first().copied().unwrap_or(1.0);
        let mut found: Vec<Warning> = self.findings.iter().cloned().map(Warning::FacetsApart).collect();
        found.extend(self.corner_values(times));
        found.extend(self.contacts.iter().enumerate().filter_map(|(k, contact)| self.overlap(k, contact, first)));
        found.extend(self.too_few_functions(first));
        found
    }

    /// Warnings about the accuracy that the model lets a solution have, at `times`, at least one: cells, integrals, springs, data.
    pub fn accuracy_warnings(&self, times: &[f64]) -> Vec<Warning> {
        let first = times.first().copied().unwrap_or(1.0);
        let mut found = thin_cells::thin_cells(self);
        found.extend(patch_test::patch_test(self));
        found.extend(part_uncovered::parts_uncovered(self));
        found.extend(facets::facets(self, first));
        found.extend(adjusted::adjusted(self));
        found.extend(low_order::low_orders(self));
        found.extend(round_kink::round_kinks(self));
        found.extend(uneven_gap::uneven_gaps(self));
        found.extend(locking::locking(self, first));
        found.extend(hardly_held::hardly_held(self, first));
        found.extend(flux_jumps::flux_jumps(self, first));
        found.extend(self.inexact_integrals(times).into_iter().map(Warning::Inexact));
        found.extend(coarse_values::coarse_values(self, times, &found));
        found
    }

    /// Warnings about a solution.
    pub fn state_warnings(&self, state: &StepState<S, N>) -> Vec<Warning> {
        let mut found = integration::integration(self, state);
        found.extend(unbalanced::unbalanced(self, state));
        found.extend(left_open::left_open(self, state));
        found.extend(sliding::sliding(self, state));
        found.extend(rounding::rounding(self, state));
        found.extend(coarse_zone::coarse_zones(self, state));
        found.extend(lost_moment::lost_moments(self, state));
        found.extend(lost_parts::lost_parts(self, state));
        found.extend(soft_penalty::soft_penalties(self, state));
        found.extend(coarse_tie::coarse_ties(self, state));
        let held = held_within::held_within(self, state);
        // where a side is held deep, the gap is why the pressure comes from it
        let is_deep = |of: &Warning| held.iter().any(|held| held.subject() == of.subject());
        found.extend(gap_pressure::gap_pressures(self, state).into_iter().filter(|of| !is_deep(of)));
        found.extend(tension::tensions(self, state));
        found.extend(held);
        found.extend(kinematics::kinematics(self, state));
        found
    }
}
