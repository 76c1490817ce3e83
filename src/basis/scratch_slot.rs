//! Memory of a type that only its user knows, kept between calls.

use std::any::Any;
use std::fmt::{Debug, Formatter};

/// A value of any type that is kept between calls for its memory. Clones are empty.
#[derive(Default)]
pub struct ScratchSlot(Option<Box<dyn Any + Send + Sync>>);

impl ScratchSlot {
    /// Takes the value out, or makes one where the slot is empty or holds another type.
    pub fn take<V: Any + Default + Send + Sync>(&mut self) -> Box<V> {
        self.0.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }

    /// Keeps a value.
    pub fn keep<V: Any + Send + Sync>(&mut self, value: Box<V>) {
        self.0 = Some(value);
    }
}

impl Clone for ScratchSlot {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Debug for ScratchSlot {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str("ScratchSlot")
    }
}
