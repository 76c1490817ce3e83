//! lambda of ties and contacts at any point of their slave sides.

use super::contact_field::PressureEvaluator;
use super::error::ProblemError;
use super::handles::InterfaceId;
use super::solved::Solved;
use super::tie_field::TractionEvaluator;
use crate::linalg::Vector;
use std::fmt::{Debug, Formatter};
use std::sync::Arc;

/// lambda on a slave side: that of its multiplier, or where it has none, that of its coupling or its method of contact
/// [force/area]. It keeps its solution.
#[derive(Clone)]
pub struct LambdaField<const S: usize>(Arc<dyn Lambda<S>>);

trait Lambda<const S: usize>: Send + Sync {
    fn at(&self, element: usize, xi: &[Vector<S>]) -> Vec<Vec<f64>>;
}

impl<const S: usize> LambdaField<S> {
    /// lambda on the slave side with a number; `None` if there is no such side.
    pub(super) fn of<const N: usize>(solved: Arc<Solved<S, N>>, of: InterfaceId, side: usize) -> Result<Option<Self>, ProblemError> {
        let (model, t) = (Arc::clone(&solved.common.model), solved.state.t);
        Ok(match of {
            InterfaceId::Tie(tie) => solved.of_tie(tie)?.parts.get(side).map(|part| {
                let field = TractionEvaluator::of(&model, part, t);
                Self(Arc::new(OfTie { solved: Arc::clone(&solved), place: [tie.number, side], field }))
            }),
            InterfaceId::Contact(id) => {
                let contact = solved.of_contact(id)?;
                contact.parts.get(side).map(|part| {
                    let field = PressureEvaluator::of(&model, contact, part, t);
                    Self(Arc::new(OfContact { solved: Arc::clone(&solved), place: [id.number, side], field }))
                })
            }
        })
    }

    /// lambda at local points of an element of the side, `[component][point]`: of ties in the components of the unknown, of contacts along
    /// the normal alone, negative where they press. NaN at points of ties, zero at points of contacts that face nothing and have no
    /// multiplier.
    pub fn at(&self, element: usize, xi: &[Vector<S>]) -> Vec<Vec<f64>> {
        self.0.at(element, xi)
    }
}

impl<const S: usize> Debug for LambdaField<S> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("LambdaField")
    }
}

struct OfTie<const S: usize, const N: usize> {
    solved: Arc<Solved<S, N>>,
    place: [usize; 2],
    field: TractionEvaluator<S, N>,
}

impl<const S: usize, const N: usize> Lambda<S> for OfTie<S, N> {
    fn at(&self, element: usize, xi: &[Vector<S>]) -> Vec<Vec<f64>> {
        let (model, [tie, part]) = (&self.solved.common.model, self.place);
        self.field.at(model, &model.ties[tie].parts[part], &self.solved.state, element, xi)
    }
}

struct OfContact<const S: usize, const N: usize> {
    solved: Arc<Solved<S, N>>,
    place: [usize; 2],
    field: PressureEvaluator<S, N>,
}

impl<const S: usize, const N: usize> Lambda<S> for OfContact<S, N> {
    fn at(&self, element: usize, xi: &[Vector<S>]) -> Vec<Vec<f64>> {
        let (model, [number, part]) = (&self.solved.common.model, self.place);
        let contact = &model.contacts[number];
        let found = self.field.at(model, contact, &contact.parts[part], &self.solved.state, element, xi);
        vec![found.into_iter().map(|[lambda, _]| lambda).collect()]
    }
}
