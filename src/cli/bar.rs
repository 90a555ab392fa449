//! The progress bar on the terminal, of which there is one at a time.

use std::sync::{Mutex, PoisonError};

use indicatif::ProgressBar;

/// Bar on the terminal.
static CURRENT: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn current() -> Option<ProgressBar> {
    CURRENT.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Registers a bar that was drawn.
pub fn show(bar: &ProgressBar) {
    *CURRENT.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
}

/// Removes the bar from the terminal.
pub fn clear() {
    let taken = CURRENT.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(bar) = taken {
        bar.finish_and_clear();
    }
}

/// Prints something while the bar is hidden.
pub fn aside<T>(print: impl FnOnce() -> T) -> T {
    match current().filter(|bar| !bar.is_finished()) {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}
