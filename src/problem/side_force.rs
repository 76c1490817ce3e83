//! Force of the stresses on a side: ∫ sigma n ds with its moment, n out of the body; of conduction the flux ∫ k du/dn ds.
//!
//! It is the force on the body by what lies beyond the side. The stresses are those of the elements beside the side, by the side's points of
//! integration, so that it converges with the mesh as they do.

use super::model::{BodySide, Model};
use super::resultant::Resultant;
use super::state::StepState;
use crate::basis::Order;
use crate::geometry::MapTable;
use crate::linalg::measure;
use crate::physics::FluxTable;
use crate::quadrature::Quadrature;

impl<const S: usize, const N: usize> Model<S, N> {
    /// ∫ sigma n ds over `sides` in a state.
    pub(super) fn force_through<'a>(&self, sides: impl IntoIterator<Item = &'a BodySide<S, N>>, state: &StepState<S, N>) -> Resultant {
        let (mut sum, mut table, mut map) = (Resultant::default(), FluxTable::default(), MapTable::new());
        for side in sides {
            let (space, flux) = (&side.trace.space, self.flux(side, state.t));
            for e in 0..space.num_elements() {
                let rule = side.rules.rule(e);
                space.map(e, &rule.points, Order::Gradients, &mut map);
                flux.tabulate(e, &rule.points, &mut table);
                let rows = table.values.chunks(table.dofs.len()).map(|row| row.iter().zip(&table.dofs).map(|(v, &i)| v * state.u[i]).sum());
                let values: Vec<f64> = rows.collect();
                for (q, force) in values.chunks(table.components).enumerate() {
                    sum.add(&map.x[q], force, rule.weights[q] * measure(&map.jacobian[q]));
                }
            }
        }
        if self.components == 1 {
            sum.moment = [0.0; 3];
        }
        self.in_space(sum)
    }
}
