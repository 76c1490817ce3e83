//! Guides: theory of the numerical methods, with runnable examples.
//!
//! Formulas are MathML, which browsers draw without any script; `alttext` holds the TeX of each.

#[doc = include_str!("02_mortar_theory.md")]
pub mod mortar_theory {}

#[doc = include_str!("03_contact.md")]
pub mod contact {}

#[doc = include_str!("04_surfaces.md")]
pub mod surfaces {}
