//! Cross-validation: the two backends against each other, against FEniCSx, against theory, and with backends from outside; all through
//! `Problem`.
#![allow(clippy::unwrap_used)]

mod answers;
mod axisymmetric;
mod backends;
mod cases;
mod choices;
mod contact;
mod contact_twins;
mod converged;
mod curved_neighbours;
mod curved_supports;
mod document;
mod exact;
mod foundation;
mod interface;
mod mortar_rates;
mod pressed;
mod same_mesh;
mod setting;
mod singular;
mod third_backend;
mod tied;
