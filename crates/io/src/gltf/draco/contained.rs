//! Containment of panics in the decoders of other crates.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

thread_local! {
    /// Whether this thread is in [`contained`].
    static IS_CONTAINED: Cell<bool> = const { Cell::new(false) };
}

type PanicHook = Box<dyn Fn(&PanicHookInfo) + Sync + Send>;

/// Runs foreign code that may panic on hostile bytes; returns `None` if it did.
///
/// Nothing is printed then. The first call installs a hook that forwards all panics outside of this
/// function to the previous hook.
pub(crate) fn contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| panic::set_hook(silent_inside(panic::take_hook())));
    let before = IS_CONTAINED.replace(true);
    // Whatever `work` was about to change is dropped with it or, if borrowed, with the file.
    let outcome = panic::catch_unwind(AssertUnwindSafe(work));
    IS_CONTAINED.set(before);
    outcome.ok()
}

/// Returns a hook that forwards only panics outside of [`contained`] to `other`.
fn silent_inside(other: PanicHook) -> PanicHook {
    Box::new(move |info| {
        if !IS_CONTAINED.get() {
            other(info);
        }
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use super::*;

    #[test]
    fn panics_inside_are_silent_and_all_others_are_not() {
        let heard = Arc::new(AtomicUsize::new(0));
        assert_eq!(contained(|| 7), Some(7));
        let (counter, before) = (heard.clone(), panic::take_hook());
        let counting: PanicHook = Box::new(move |info| match info.payload().downcast_ref() {
            Some(&"counted") => drop(counter.fetch_add(1, Ordering::SeqCst)),
            _ => before(info),
        });
        panic::set_hook(silent_inside(counting));
        assert_eq!(contained(|| panic!("counted")), None::<()>);
        let nested = contained(|| contained(|| panic!("counted")).is_none());
        assert_eq!((nested, heard.load(Ordering::SeqCst)), (Some(true), 0));
        assert!(panic::catch_unwind(|| panic!("counted")).is_err());
        assert_eq!(heard.load(Ordering::SeqCst), 1);
        contained(|| {
            let elsewhere = thread::spawn(|| panic!("counted"));
            assert!(elsewhere.join().is_err());
        });
        assert_eq!(heard.load(Ordering::SeqCst), 2);
    }
}
