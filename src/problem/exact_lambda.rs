//! The exact lambda along sides of ties and contacts.

use super::handles::InterfaceId;
use super::own_piece::Depths;
use super::own_side::OwnSide;
use super::side_field::Field;
use super::solved::State;
use crate::basis::Order;
use crate::geometry::MapTable;
use std::sync::Arc;

/// The exact lambda along a slave side, by its number, of a tie or a contact; `None` where none is known.
pub(super) fn exact_along<const S: usize, const N: usize>(state: &Arc<dyn State<S, N>>, of: InterfaceId, side: usize) -> Option<Field<S>> {
    let (model, t) = (state.model(), state.state().t);
    let (slave, is_own) = match of {
        InterfaceId::Tie(tie) => (&model.ties[tie.number].parts[side].slave, model.ties[tie.number].exact.is_some()),
        InterfaceId::Contact(contact) => {
            (&model.contacts[contact.number].parts[side].slave, model.contacts[contact.number].exact.is_some())
        }
    };
    if !is_own && !model.has_exact() {
        return None;
    }
    let own = OwnSide::new(model, slave);
    let depths: Vec<Depths> = (0..slave.trace.facets.len()).map(|e| own.depths(e, 0.0)).collect();
    let (state, slave) = (Arc::clone(state), Arc::clone(slave));
    Some(Box::new(move |element, xi| {
        let (model, mut map) = (state.model(), MapTable::new());
        slave.trace.space.map(element, xi, Order::Gradients, &mut map);
        let at = |(x, jacobian)| {
            let (place, at) = ((element, depths[element]), [x, &slave.trace.normal(element, jacobian)]);
            match of {
                InterfaceId::Tie(tie) => model.ties[tie.number].exact_at(model, &slave, t, place, at),
                InterfaceId::Contact(contact) => vec![model.contacts[contact.number].exact_at(model, &slave, t, place, at)],
            }
        };
        map.x.iter().zip(&map.jacobian).flat_map(at).collect()
    }))
}
