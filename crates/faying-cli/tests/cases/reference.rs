//! Numbers of others under reference/: published ones, and what FEniCSx finds for the same problems.

#[path = "reference/contact.rs"]
mod contact;
#[path = "reference/contact_twins.rs"]
mod contact_twins;
#[path = "reference/converged.rs"]
mod converged;
#[path = "reference/document.rs"]
mod document;
#[path = "reference/interface.rs"]
mod interface;
#[path = "reference/published.rs"]
mod published;
#[path = "reference/singular.rs"]
mod singular;
#[path = "reference/twins.rs"]
mod twins;
