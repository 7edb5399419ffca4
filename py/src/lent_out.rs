//! Values that change, which one piece of work at a time has.
//!
//! No lock is held while work runs. A worker of the pool that waits inside parallel work may start
//! another piece of work meanwhile: if that one waited for a lock, it would wait for the work below
//! it on its own stack. So the value itself goes to the work, and the thread that asks for it waits
//! outside the pool.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;

use crate::work::TICK;

/// Value that is taken for a piece of work and comes back when that ends.
pub struct LentOut<T>(Arc<Place<T>>);

struct Place<T> {
    /// `None` while some work has the value.
    value: Mutex<Option<T>>,
    is_back: Condvar,
}

impl<T> Place<T> {
    fn lock(&self) -> MutexGuard<'_, Option<T>> {
        self.value.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the value, if it comes back before the next look at signals.
    fn take_soon(&self) -> Option<T> {
        let waited = self.is_back.wait_timeout_while(self.lock(), TICK, |value| value.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.take()
    }
}

impl<T: Send> LentOut<T> {
    /// Takes over a value.
    pub fn new(value: T) -> Self {
        Self(Arc::new(Place { value: Mutex::new(Some(value)), is_back: Condvar::new() }))
    }

    /// Waits for the value, without the GIL, and takes it.
    ///
    /// # Errors
    /// The exception of a signal handler.
    pub fn take(&self, py: Python<'_>) -> PyResult<Taken<T>> {
        loop {
            if let Some(value) = py.detach(|| self.0.take_soon()) {
                return Ok(Taken { value: Some(value), place: Arc::clone(&self.0) });
            }
            py.check_signals()?;
        }
    }
}

/// A taken value, which goes back on drop, also if the work has panicked.
pub struct Taken<T> {
    /// `None` only while it is dropped.
    value: Option<T>,
    place: Arc<Place<T>>,
}

impl<T> Deref for Taken<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().expect("the value is there until it is dropped")
    }
}

impl<T> DerefMut for Taken<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().expect("the value is there until it is dropped")
    }
}

impl<T> Drop for Taken<T> {
    fn drop(&mut self) {
        *self.place.lock() = self.value.take();
        self.place.is_back.notify_one();
    }
}
