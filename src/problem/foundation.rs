//! Springs of the volume: foundations of elastic bodies, and the term c u of -div(k grad u) + c u = f.

use super::data::Point;
use super::model::{Foundation, Model};
use super::physics::StiffnessFn;
use super::resultant::Resultant;
use crate::basis::{Order, ShapeTable};
use crate::geometry::MapTable;
use crate::linalg::{Vector, measure};
use crate::parallel;
use crate::quadrature::Quadrature;

impl Foundation {
    /// The stiffness at a place and a time.
    pub(super) fn at<const N: usize>(&self, x: &Vector<N>, t: f64) -> f64 {
        self.stiffness.value(&Point::new(x.as_slice()).at_time(t))
    }
}

impl<const S: usize, const N: usize> Model<S, N> {
    /// The foundation of a patch at time `t`; `None` if it has none.
    pub(super) fn foundation(&self, patch: usize, t: f64) -> Option<Box<StiffnessFn<'_, N>>> {
        let own: Vec<&Foundation> = self.foundations.iter().filter(|f| f.body == patch).collect();
        if own.is_empty() {
            return None;
        }
        Some(Box::new(move |x| {
            let mut stiffness = [0.0; 3];
            own.iter().for_each(|f| stiffness[f.component] += f.at(x, t));
            stiffness
        }))
    }

    /// The forces of all foundations on their bodies, -∫ k u dx, at a state.
    pub(super) fn foundation_forces(&self, u: &[f64], t: f64) -> Resultant {
        let mut total = Resultant::default();
        for (k, patch) in self.patches.iter().enumerate() {
            let Some(stiffness) = self.foundation(k, t) else { continue };
            let space = &**patch.body.space();
            let of_element = |(ids, table, map): &mut (Vec<usize>, ShapeTable<N>, MapTable<N, N>), e: usize| {
                let (rule, mut own) = (patch.rules.rule(e), Resultant::default());
                space.active(e, ids);
                space.evaluate(e, &rule.points, Order::Gradients, table, map);
                for (q, w) in rule.weights.iter().enumerate() {
                    let k = stiffness(&map.x[q]);
                    let value = |c: usize| ids.iter().zip(table.values(q)).map(|(&i, n)| n * u[patch.field.unknown(i, c)]).sum::<f64>();
                    let force: [f64; 3] = std::array::from_fn(|c| if c < self.components { -k[c] * value(c) } else { 0.0 });
                    own.add(&map.x[q], &force, w * measure(&map.jacobian[q]));
                }
                own
            };
            let parts: Vec<Resultant> =
                parallel::map_init(space.num_elements(), || (Vec::new(), ShapeTable::new(), MapTable::new()), of_element);
            parts.iter().for_each(|own| total.sum(own));
        }
        total
    }

    /// Whether foundations change with the time, of one patch or of any.
    pub(super) fn foundations_change(&self, patch: Option<usize>) -> bool {
        self.foundations.iter().any(|f| patch.is_none_or(|k| f.body == k) && f.stiffness.depends_on_time())
    }
}
