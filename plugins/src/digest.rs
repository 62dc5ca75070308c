//! What others work out from the domains once and look up for every request: word tables and the like.

use std::any::{Any, TypeId};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

type Known = BTreeMap<(TypeId, String), Arc<dyn Any + Send + Sync>>;

/// Values by type and name.
#[derive(Default)]
pub(crate) struct Digests(Mutex<Known>);

impl Digests {
    /// Returns the value of this type and name, made where it is not known.
    ///
    /// Two threads that ask at once may both make it; the first one's is kept, and they are equal.
    pub(crate) fn get<T: Any + Send + Sync>(&self, name: &str, make: impl FnOnce() -> T) -> Arc<T> {
        let key = (TypeId::of::<T>(), name.to_owned());
        let known = |digests: &Self| digests.known().get(&key).cloned();
        if let Some(found) = known(self).and_then(|d| d.downcast().ok()) {
            return found;
        }
        let made = Arc::new(make());
        let kept = Arc::clone(self.known().entry(key).or_insert_with(|| made.clone()));
        kept.downcast().unwrap_or(made)
    }

    fn known(&self) -> std::sync::MutexGuard<'_, Known> {
        // whoever panicked left whole values behind
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::Digests;

    #[test]
    fn values_are_made_once_for_a_name_and_a_type() {
        let digests = Digests::default();
        assert_eq!(*digests.get("a", || 1_u32), 1);
        assert_eq!(*digests.get("a", || 2_u32), 1);
        assert_eq!(*digests.get("b", || 3_u32), 3);
        assert_eq!(*digests.get("a", || "text".to_owned()), "text");
    }
}
