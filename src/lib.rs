//! Joining and pressing together discretisations that do not match.

pub mod assembly;
pub mod basis;
pub mod check;
pub mod constraint;
pub mod contact;
pub mod coupling;
pub mod geometry;
pub mod linalg;
pub mod physics;
pub mod quadrature;
pub mod space;

#[cfg(feature = "cli")]
pub mod app;
#[cfg(feature = "cli")]
pub mod io;
