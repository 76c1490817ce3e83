//! Case files: TOML with places into a typed [`Case`].

mod types;

pub use types::*;

impl Case {
    /// The case with every default written out, as a case file that reads back to the same case.
    pub fn effective_toml(&self) -> &str {
        &self.effective
    }
}
