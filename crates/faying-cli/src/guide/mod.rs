//! Long texts: what the numerics rest on, with examples that run.
//!
//! Formulas are MathML, which browsers draw without any script; `alttext` holds the TeX of each.

#[doc = include_str!("02_mortar_theory.md")]
pub mod mortar_theory {}

#[doc = include_str!("03_contact.md")]
pub mod contact {}
