//! Options that help with an error or a note of the library, which names none.

use crate::pipeline::{RunError, StoreError, TooLarge};
use anastomesh_io::network::{NetworkFileError, NetworkNote};

/// Error of a network file, with the option that helps.
pub fn of_file(error: &NetworkFileError) -> String {
    format!("{error}{}", if error.lacks_radii() { " with --radius-array" } else { "" })
}

/// Note on a network file, with the option that helps.
pub fn of_note(note: &NetworkNote) -> String {
    let hint = match note {
        NetworkNote::NotUsed { .. } => " (choose with --radius-array)",
        NetworkNote::OutOfProportion { .. } => " (--radius-scale multiplies radii alone)",
        _ => "",
    };
    format!("{note}{hint}")
}

/// Error of a store of blocks, with the option that helps.
pub fn of_store(error: &StoreError) -> String {
    let hint = match error {
        StoreError::Missing { .. } => ", or give --make-missing to have this run make what is not there",
        StoreError::Damaged { .. } => ", or give --make-missing to have this run make them",
        StoreError::Other { .. } => ", or give --restart to throw its blocks away",
        StoreError::Write { .. } => " (--work-dir)",
        StoreError::Read(_) => ", or start anew with --restart",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Refusal of a run that is too large, with the options that help.
pub fn of_size(error: &TooLarge) -> String {
    let hint = match error {
        TooLarge::Block { .. } => " (--memory, --rho)",
        TooLarge::Whole { .. } => " (--memory)",
        TooLarge::Disk { .. } => " (--rho)",
    };
    format!("{error}{hint}")
}

/// Error of a run, with the options that help.
pub fn of_run(error: &RunError) -> String {
    match error {
        RunError::Store(error) => of_store(error),
        RunError::TooLarge(error) => of_size(error),
        error => error.to_string(),
    }
}
