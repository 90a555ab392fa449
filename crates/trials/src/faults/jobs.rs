//! Runs of all commands and formats that faults disturb.

use crate::network::Network;
use crate::process::{Ended, Limits, run};
use crate::surface::sphere;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// Files below a folder: relative names and contents.
pub type Files = BTreeMap<String, Vec<u8>>;

/// Limits of a job.
pub const LIMITS: Limits = Limits { seconds: 60.0, bytes: 3 << 30 };

/// A command: input, output and options.
pub struct Job {
    verb: &'static str,
    input: &'static str,
    output: &'static str,
    options: &'static str,
}

const fn job(verb: &'static str, input: &'static str, output: &'static str, options: &'static str) -> Job {
    Job { verb, input, output, options }
}

/// Jobs over all writing commands and formats.
pub const JOBS: [Job; 44] = [
    job("mesh", "net.vtp", "a.vtu", "--rho 4"),
    job("mesh", "net.vtp", "a.vtu", "--rho 4 --work-dir work"),
    job("mesh", "net.vtp", "a.vtu", "--rho 4 --work-dir work --refine"),
    job("mesh", "net.vtp", "a.vtu", "--work-dir work --memory 200MB"),
    job("mesh", "net.vtp", "a.vtu", "--wall 0.2r --tissue box"),
    job("mesh", "net.vtp", "a.vtu", "--wall 0.2r --split-regions"),
    job("mesh", "net.vtp", "a.vtu", "--order 2"),
    job("mesh", "net.vtp", "a.vtu", "--layers 2 --cells tets"),
    job("mesh", "net.vtp", "a.vtu", "--embed"),
    job("mesh", "net.vtp", "a.vtu", "--certificate out/a.json --refined out/refined.vtp --refine"),
    job("mesh", "net.vtp", "a.pvtu", ""),
    job("mesh", "net.vtp", "a.pvtu", "--parts 3"),
    job("mesh", "net.vtp", "a.msh", "--work-dir work"),
    job("mesh", "net.vtp", "a.msh", "--parts 2"),
    job("mesh", "net.vtp", "a.msh2", ""),
    job("mesh", "net.vtp", "a.mesh", ""),
    job("mesh", "net.vtp", "a.foam", ""),
    job("mesh", "net.vtp", "a.foam", "--parts 2"),
    job("mesh", "net.vtp", "a.svmesh", ""),
    job("mesh", "net.vtp", "a.ele", "--work-dir work"),
    job("mesh", "net.vtp", "a.npyd", ""),
    job("surface", "net.vtp", "a.stl", ""),
    job("surface", "net.vtp", "a.ply", ""),
    job("surface", "net.vtp", "a.obj", ""),
    job("surface", "net.vtp", "a.off", ""),
    job("surface", "net.vtp", "a.glb", ""),
    job("surface", "net.vtp", "a.3mf", ""),
    job("surface", "net.vtp", "a.vtp", ""),
    job("refine", "net.vtp", "a.vtp", ""),
    job("prepare", "net.vtp", "a.vtp", ""),
    job("prepare", "net.vtp", "a.swc", ""),
    job("convert", "net.vtp", "a.swc", ""),
    job("convert", "net.vtp", "a.npyd", ""),
    job("convert", "ball.off", "a.stl", ""),
    job("flow", "net.vtp", "a.vtp", ""),
    job("flow", "net.vtp", "a.json", ""),
    job("render", "net.vtp", "a.png", ""),
    job("view", "net.vtp", "a.html", ""),
    job("tetrahedralize", "ball.off", "a.vtu", "--size 0.15"),
    job("tetrahedralize", "ball.off", "a.pvtu", ""),
    job("tetrahedralize", "ball.off", "a.msh", "--layers 2"),
    job("tetrahedralize", "ball.off", "a.mesh", ""),
    job("tetrahedralize", "ball.off", "a.ele", ""),
    job("tetrahedralize", "ball.off", "a.npyd", ""),
];

/// Results of undisturbed runs.
pub struct Reference {
    /// Files of a run on another input.
    pub earlier: Files,
    /// Files of the run.
    pub new: Files,
    /// Wall time in seconds.
    pub seconds: f64,
}

/// Small tree; the second version has other radii.
fn network(second: bool) -> Network {
    let mut net = Network::default();
    let root = net.node([0.0; 3], 1.0);
    let mut front = vec![(net.tip(root, [8.0, 0.0, 0.0], 1.0), 0.0_f64, 1.0)];
    for level in 0..3 {
        for (node, heading, radius) in std::mem::take(&mut front) {
            for side in [-0.5, 0.5] {
                let (angle, radius): (f64, f64) = (heading + side, radius * if second { 0.75 } else { 0.8 });
                let at = net.points[node];
                let place = [at[0] + 9.0 * angle.cos(), at[1] + 9.0 * angle.sin(), at[2] + f64::from(level) * side];
                front.push((net.tip(node, place, radius), angle, radius));
            }
        }
    }
    net
}

impl Job {
    /// Arguments of the program, run in the folder above `out`.
    pub fn arguments(&self) -> Vec<String> {
        let output = format!("out/{}", self.output);
        let mut words: Vec<String> = [self.verb, self.input, "-o", &output].map(str::to_owned).into();
        words.extend(self.options.split_whitespace().map(str::to_owned));
        words.extend((self.verb != "convert").then(|| "-q".to_owned()));
        words
    }

    /// Command line.
    pub fn line(&self) -> String {
        format!("anastomesh {}", self.arguments().join(" "))
    }

    /// Empties a folder and writes the input, and files of an earlier run.
    pub fn prepare(folder: &Path, earlier: Option<&Files>) -> io::Result<()> {
        Self::prepare_version(folder, false)?;
        write_files(&folder.join("out"), earlier.unwrap_or(&Files::new()))
    }

    fn prepare_version(folder: &Path, second: bool) -> io::Result<()> {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder.join("out"))?;
        fs::write(folder.join("net.vtp"), network(second).vtp())?;
        fs::write(folder.join("ball.off"), sphere(if second { 7 } else { 8 }).off())
    }

    /// Files in the output folder.
    pub fn output(folder: &Path) -> io::Result<Files> {
        let (base, mut files) = (folder.join("out"), Files::new());
        read_files(&base, &base, &mut files)?;
        Ok(files)
    }

    /// Runs the job on both inputs.
    pub fn reference(&self, mesher: &Path, folder: &Path) -> io::Result<Reference> {
        Self::prepare_version(folder, true)?;
        self.run_to_end(mesher, folder)?;
        let earlier = Self::output(folder)?;
        Self::prepare_version(folder, false)?;
        let start = std::time::Instant::now();
        self.run_to_end(mesher, folder)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(Reference { earlier, new: Self::output(folder)?, seconds })
    }

    fn run_to_end(&self, mesher: &Path, folder: &Path) -> io::Result<()> {
        let run = run(mesher, &self.arguments(), folder, LIMITS)?;
        match run.ended {
            Ended::Code(0) => Ok(()),
            ended => Err(io::Error::other(format!("{}: {ended:?}: {}", self.line(), run.stderr.trim()))),
        }
    }
}

/// Writes files below a folder.
pub fn write_files(base: &Path, files: &Files) -> io::Result<()> {
    for (name, bytes) in files {
        let path = base.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(path, bytes)?;
    }
    Ok(())
}

fn read_files(base: &Path, folder: &Path, files: &mut Files) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            read_files(base, &path, files)?;
        } else {
            let name = path.strip_prefix(base).unwrap_or(&path).to_string_lossy().into_owned();
            files.insert(name, fs::read(&path)?);
        }
    }
    Ok(())
}
