//! A value that belongs to a time, kept until that of another time is asked for.

use std::sync::{Arc, Mutex, PoisonError};

/// The value of the last time that was asked for.
#[derive(Debug)]
pub struct LastTime<X>(Mutex<Option<(f64, Arc<X>)>>);

impl<X> Default for LastTime<X> {
    fn default() -> Self {
        Self(Mutex::new(None))
    }
}

impl<X> LastTime<X> {
    /// Returns the value of time `t`, made by `make` if the last time was another.
    pub fn at(&self, t: f64, make: impl FnOnce() -> X) -> Arc<X> {
        let last = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = last().as_ref().filter(|(of, _)| *of == t).map(|(_, made)| Arc::clone(made));
        known.unwrap_or_else(|| {
            // not under the lock: it is made in parallel
            let made = Arc::new(make());
            *last() = Some((t, Arc::clone(&made)));
            made
        })
    }
}
