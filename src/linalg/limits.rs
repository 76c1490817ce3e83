//! Stopping criteria of iterative methods: tolerance, iteration limit, cancellation.

use super::LinearError;
use std::fmt;
use std::sync::Arc;

/// Cancellation callback, polled once per iteration. The default one never stops.
#[derive(Clone, Default)]
pub struct Cancellation(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

impl Cancellation {
    /// Stops as soon as `asked` returns true.
    pub fn new(asked: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Some(Arc::new(asked)))
    }

    /// Whether to stop now.
    pub fn is_requested(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked())
    }
}

impl fmt::Debug for Cancellation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("StopSign").field(&self.0.is_some()).finish()
    }
}

/// Stopping criteria of an iterative method.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Relative residual wanted, a pure number.
    pub tolerance: f64,
    /// Iterations allowed; 0: the default of the method.
    pub max_iterations: usize,
    /// Cancellation callback, polled before every iteration.
    pub stop: Cancellation,
}

impl Limits {
    /// Creates limits with the relative residual `tolerance` and the default number of iterations.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, max_iterations: 0, stop: Cancellation::default() }
    }

    /// Sets the iteration limit.
    #[must_use]
    pub fn within(mut self, max_iterations: usize) -> Self {
        self.max_iterations = max_iterations;
        self
    }

    /// Iterations allowed; `usual` if no limit is set.
    pub fn most(&self, usual: usize) -> usize {
        if self.max_iterations == 0 { usual } else { self.max_iterations }
    }

    /// Checks whether another iteration may begin after `done` of `most` that reached `residual`.
    pub(crate) fn allow(&self, done: usize, most: usize, residual: f64) -> Result<(), LinearError> {
        if done >= most || residual.is_nan() {
            return Err(LinearError::NotConverged { iterations: done, residual, tolerance: self.tolerance });
        }
        if self.stop.is_requested() {
            return Err(LinearError::Stopped { iterations: done });
        }
        Ok(())
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::new(1e-12)
    }
}
