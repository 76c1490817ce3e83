//! Moments that ties across a gap lose.

use super::model::{Model, TiePart};
use super::resultant::{Resultant, cross};
use super::state::StepState;
use super::tie_field::TractionEvaluator;
use crate::basis::Order;
use crate::geometry::MapTable;

/// Moment that a tie across a gap loses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LostMoment {
    /// ∫ (x_slave - x_master) x lambda ds, what the forces on both sides lack to balance in moments [force length].
    pub moment: [f64; 3],
    /// ∫ |lambda| ds \[force\].
    pub force: f64,
}

impl<const S: usize, const N: usize> TiePart<S, N> {
    /// The moment that lambda, equal and opposite on both sides, has about the distance of their points.
    pub fn lost_moment(&self, model: &Model<S, N>, state: &StepState<S, N>) -> LostMoment {
        let (field, mut lost) = (TractionEvaluator::of(model, self, state.t), Resultant::default());
        let (mut own, mut other, mut force) = (MapTable::new(), MapTable::new(), 0.0);
        for (k, pairing) in self.pairings.iter().enumerate() {
            let s = &pairing.segments;
            let lambda = field.on_segments(model, self, state, k);
            for piece in 0..s.num_pieces() {
                let points = s.points(piece);
                self.slave.trace.space.map(s.slave[piece], &s.slave_xi[points.clone()], Order::Values, &mut own);
                pairing.master.trace.space.map(s.master[piece], &s.master_xi[points.clone()], Order::Values, &mut other);
                for (i, q) in points.enumerate() {
                    let mut f = [0.0; 3];
                    f.iter_mut().zip(&lambda).for_each(|(f, l)| *f = l[q]);
                    let moment = cross(&(own.x[i] - other.x[i]), &f);
                    lost.moment.iter_mut().zip(moment).for_each(|(sum, m)| *sum += s.ds[q] * m);
                    force += s.ds[q] * f.iter().map(|v| v * v).sum::<f64>().sqrt();
                }
            }
        }
        LostMoment { moment: lost.moment, force }
    }
}
