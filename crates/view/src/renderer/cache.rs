//! One value of each type, made on first use.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Value of some type, empty until it is made.
type CacheCell = Arc<OnceLock<Arc<dyn Any + Send + Sync>>>;

/// One value of each requested type.
#[derive(Default)]
pub(super) struct TypedCache(Mutex<HashMap<TypeId, CacheCell>>);

impl TypedCache {
    /// Returns the value of a type, after making it if it is the first request.
    ///
    /// Threads that request the same type meanwhile wait. `make` may request other types.
    pub fn get<T: Any + Send + Sync>(&self, make: impl FnOnce() -> T) -> Arc<T> {
        let cell = {
            let mut cells = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(cells.entry(TypeId::of::<T>()).or_default())
        };
        let value = Arc::clone(cell.get_or_init(|| Arc::new(make())));
        value.downcast().expect("cells are found by type")
    }
}

impl fmt::Debug for TypedCache {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TypedCache").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_type_is_made_once_and_may_need_another() {
        let cache = TypedCache::default();
        let outer = cache.get(|| format!("{}", cache.get(|| 7u32)));
        assert_eq!(*outer, "7");
        assert_eq!(*cache.get(|| 8u32), 7);
        assert!(Arc::ptr_eq(&outer, &cache.get(|| String::from("again"))));
    }
}
