//! Data that change with the time.

use std::sync::Arc;

/// A material or an obstacle as a function of time.
pub struct Changing<V>(pub Arc<dyn Fn(f64) -> V + Send + Sync>);

impl<V> Clone for Changing<V> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<V> std::fmt::Debug for Changing<V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Changing")
    }
}
