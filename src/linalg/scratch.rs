//! Scratch memory that a thread keeps between calls.

use std::any::Any;
use std::cell::RefCell;

thread_local! {
    /// One value per type that was asked for.
    static KEPT: RefCell<Vec<Box<dyn Any>>> = const { RefCell::new(Vec::new()) };
}

/// Calls `f` with the thread's value of type `S`, which holds what earlier calls left in it.
///
/// Calls may nest: the inner one gets a new value.
pub(crate) fn with_scratch<S: Any + Default, R>(f: impl FnOnce(&mut S) -> R) -> R {
    let kept = KEPT.with_borrow_mut(|all| all.iter().position(|s| s.is::<S>()).map(|k| all.swap_remove(k)));
    let mut scratch = kept.and_then(|s| s.downcast::<S>().ok()).unwrap_or_default();
    let result = f(&mut scratch);
    KEPT.with_borrow_mut(|all| {
        if !all.iter().any(|s| s.is::<S>()) {
            all.push(scratch);
        }
    });
    result
}

#[cfg(test)]
mod tests {
    use super::with_scratch;

    #[test]
    fn values_are_kept_per_type_and_calls_nest() {
        with_scratch(|a: &mut Vec<u8>| {
            a.push(1);
            with_scratch(|b: &mut Vec<u8>| assert!(b.is_empty()));
            with_scratch(|b: &mut Vec<u16>| b.push(3));
        });
        // the inner value was kept first
        with_scratch(|a: &mut Vec<u8>| assert!(a.is_empty()));
        with_scratch(|a: &mut Vec<u16>| assert_eq!(*a, [3]));
    }
}
