//! Locks of values that are whole after each of their operations.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks a value, also after a panic under its lock: every operation on it leaves it whole.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
