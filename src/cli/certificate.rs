//! `--certificate`: hashes of a mesh and its input, with the result of the check (`docs/certificate.md`).
//! `anastomesh-verify` compares it with the mesh.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use super::exit::Failure;
use anastomesh_io::volume::MeshFormat;
use anastomesh_io::{OutputSet, ensure_text_writable};
use anastomesh_mesh::check::{CheckReport, Line, Outcome};

/// Bytes that are read at once for a hash.
const CHUNK: usize = 1 << 20;

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct CertificateArgs {
    /// Write a certificate: hashes of the mesh and the network, options, and the result of each condition. Formats: VTU, MSH and `TetGen`
    #[arg(long, value_name = "FILE.json")]
    certificate: Option<PathBuf>,
}

/// Facts about a complete mesh.
pub struct Certified<'a> {
    /// Network from which it was made.
    pub input: &'a Path,
    /// File of the mesh.
    pub mesh: &'a Path,
    /// Format of the mesh.
    pub format: MeshFormat,
    /// Options that the mesh depends on, as command-line text.
    pub options: &'a str,
    /// Result of the check.
    pub check: &'a CheckReport,
}

impl CertificateArgs {
    /// Path of the certificate, if requested.
    pub fn path(&self) -> Option<&Path> {
        self.certificate.as_deref()
    }

    /// Checks before any work that the certificate can be written.
    pub fn ensure_writable(&self, format: MeshFormat) -> Result<(), Failure> {
        let Some(path) = &self.certificate else { return Ok(()) };
        if !matches!(format, MeshFormat::Vtu | MeshFormat::Msh | MeshFormat::Msh2 | MeshFormat::Tetgen) {
            return Err(Failure::usage("--certificate is not supported by this format: use .vtu, .msh, .msh2 or .ele"));
        }
        ensure_text_writable(path).map_err(|e| Failure::unwritable(path, &e))
    }

    /// Adds the requested certificate to the outputs, which contain the mesh.
    pub fn stage(&self, certified: &Certified, outputs: &mut OutputSet) -> Result<(), Failure> {
        let Some(path) = &self.certificate else { return Ok(()) };
        let text = certified.text(outputs).map_err(|e| Failure::unreadable(certified.mesh, &e))?;
        outputs.add_bytes(path, text.as_bytes()).map_err(|e| Failure::unwritable(path, &e))
    }
}

impl Certified<'_> {
    fn text(&self, outputs: &OutputSet) -> io::Result<String> {
        let beside = ["node", "face"].map(|extension| self.mesh.with_extension(extension));
        let beside = beside.iter().filter(|_| self.format == MeshFormat::Tetgen);
        // The files do not have their names yet.
        let mut files: Vec<&Path> = beside.filter_map(|file| outputs.temporary(file)).collect();
        files.insert(0, outputs.temporary(self.mesh).ok_or(io::ErrorKind::NotFound)?);
        // Networks on standard input and in folders have no hash.
        let input = if self.input.is_file() { entry(self.input, &[self.input])? } else { Value::Null };
        let counts = &self.check.counts;
        let certificate = json!({
            "format": "anastomesh-certificate-1",
            "program": concat!("anastomesh ", env!("CARGO_PKG_VERSION")),
            "options": self.options,
            "input": input,
            "mesh": entry(self.mesh, &files)?,
            "valid": self.check.failed().next().is_none(),
            "figures": {
                "points": counts.points, "tets": counts.tets, "boundary_faces": counts.boundary_faces,
                "components": counts.components, "genus": self.genus(), "volume": counts.volume,
            },
            "conditions": self.conditions(),
        });
        // The seal is the last key, and covers all bytes before it.
        let text = format!("{certificate:#}");
        let body = format!("{},\n  ", text.trim_end_matches('}').trim_end());
        let seal = hexadecimal(Sha256::digest(&body).as_slice());
        Ok(format!("{body}\"seal\": \"{seal}\"\n}}\n"))
    }

    /// Sum of the genera of all boundary surfaces; `None` if they were not determined.
    fn genus(&self) -> Option<u32> {
        self.check.line(Line::Loops)?.found.as_ref().map(|found| found.iter().sum())
    }

    /// Conditions that were checked, with the number of violations.
    fn conditions(&self) -> Vec<Value> {
        let checked = self.check.lines.iter().filter(|line| !matches!(line.outcome, Outcome::NotChecked(_)));
        let violations = |passed: bool, count: u64| if passed { 0 } else { count.max(1) };
        checked
            .map(|line| json!({"name": line.line, "violations": violations(line.outcome == Outcome::Pass, line.count)}))
            .collect()
    }
}

/// Name of a path, and SHA-256 of all its files, one after the other.
fn entry(path: &Path, files: &[&Path]) -> io::Result<Value> {
    let (mut sha, mut buffer) = (Sha256::new(), vec![0; CHUNK]);
    for file in files {
        let mut file = File::open(file)?;
        loop {
            match file.read(&mut buffer)? {
                0 => break,
                length => sha.update(&buffer[..length]),
            }
        }
    }
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned());
    Ok(json!({"file": name, "sha256": hexadecimal(sha.finalize().as_slice())}))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes
        .iter()
        .flat_map(|byte| [byte >> 4, byte & 15])
        .filter_map(|digit| char::from_digit(digit.into(), 16))
        .collect()
}
