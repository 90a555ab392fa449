//! Faults: kills, full disks, refused system calls, losses of power. Earlier files must stay, and a second run must give the same bytes.

mod disk;
mod inject;
mod jobs;
mod kill;
mod power;
mod trial;

use crate::judge::{Judged, Programs};
use crate::random::Random;
use jobs::{Job, Reference};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use trial::Trial;

/// Kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// SIGTERM at a random time.
    Term,
    /// SIGKILL at a random time.
    Kill,
    /// File system with little space.
    Full,
    /// Limit on the size of files.
    FileSize,
    /// Read-only output folder.
    ReadOnly,
    /// System call that fails, by strace.
    Call,
    /// Loss of power, by strace.
    Power,
}

/// Results of undisturbed runs, by job.
#[derive(Default)]
pub struct References(Mutex<BTreeMap<usize, Arc<Reference>>>);

impl References {
    fn of(&self, job: usize, programs: &Programs, folder: &Path) -> io::Result<Arc<Reference>> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&job).cloned();
        if let Some(reference) = known {
            return Ok(reference);
        }
        let made = Arc::new(jobs::JOBS[job].reference(&programs.mesher, folder)?);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(job, made.clone());
        Ok(made)
    }
}

impl Fault {
    /// All faults.
    pub const ALL: [Self; 7] =
        [Self::Term, Self::Kill, Self::Full, Self::FileSize, Self::ReadOnly, Self::Call, Self::Power];

    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Term => "SIGTERM at a random time",
            Self::Kill => "SIGKILL at a random time",
            Self::Full => "full file system",
            Self::FileSize => "limit on the size of files",
            Self::ReadOnly => "read-only output folder",
            Self::Call => "failing system call",
            Self::Power => "loss of power",
        }
    }

    /// Runs the fault of a seed.
    pub fn judge(self, seed: u64, programs: &Programs, references: &References, folder: &Path) -> io::Result<Judged> {
        let mut random = Random::of_case(self.name(), seed);
        let number = random.below(jobs::JOBS.len());
        disk::unmount(folder);
        let reference = references.of(number, programs, folder)?;
        let job = &jobs::JOBS[number];
        let has_earlier = random.chance(0.7);
        let trial = Trial { job, reference: &reference, mesher: &programs.mesher, folder, has_earlier };
        Job::prepare(folder, has_earlier.then_some(&reference.earlier))?;
        let judged = match self {
            Self::Term => kill::judge(&trial, "-TERM", &mut random),
            Self::Kill => kill::judge(&trial, "-KILL", &mut random),
            Self::Full => disk::full(&trial, &mut random),
            Self::FileSize => disk::file_size(&trial, &mut random),
            Self::ReadOnly => disk::read_only(&trial),
            Self::Call => inject::judge(&trial, &mut random),
            Self::Power => power::judge(&trial, &mut random),
        };
        disk::unmount(folder);
        judged
    }
}
