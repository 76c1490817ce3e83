//! Couplings that are not rows alone: Nitsche's method, penalty, stiffness from outside; orders, contrasts, units, refusals.
#![allow(clippy::unwrap_used)]

#[path = "../coupled/mod.rs"]
mod coupled;
mod patch;
mod solvers;

#[cfg(feature = "cli")]
mod cases;
#[cfg(feature = "cli")]
mod contrast;
#[cfg(feature = "cli")]
mod orders;
#[cfg(feature = "cli")]
mod outside;
#[cfg(feature = "cli")]
mod sample;
