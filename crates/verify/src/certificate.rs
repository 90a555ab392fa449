//! Certificates: a summary of a mesh with hashes, written beside it and compared with it later. `docs/certificate.md`
//! describes the format.

use crate::report::{Condition, Outcome, Report};
use anyhow::{Context as _, Result, ensure};
use hmac::{Hmac, Mac as _};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Value of `format` in every certificate.
const FORMAT: &str = "anastomesh-certificate-1";
/// Key before the hash of all preceding bytes.
const SEAL: &str = "\"seal\"";
/// Maximum relative difference of volumes. They are rounded sums, possibly of 32-bit coordinates.
const VOLUME: f64 = 1e-6;

/// Returns the SHA-256 of the bytes of files, one after the other, in hexadecimal.
///
/// # Errors
/// A file that cannot be read.
pub fn hash(files: &[PathBuf]) -> Result<String> {
    let mut sha = Sha256::new();
    for file in files {
        sha.update(std::fs::read(file)?);
    }
    Ok(format!("{:x}", sha.finalize()))
}

/// Text of the certificate of a mesh. `input` is the network or surface from which it was made. With a key the seal
/// authenticates the author (HMAC-SHA256).
///
/// # Errors
/// A file that cannot be read.
pub fn write(report: &Report, mesh: &Path, input: Option<&Path>, key: Option<&[u8]>) -> Result<String> {
    let entry = |files: &[PathBuf]| -> Result<Value> {
        let name = files[0].file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(json!({"file": name, "sha256": hash(files)?}))
    };
    let input = input.map(|input| entry(&[input.to_owned()])).transpose()?;
    let condition = |o: &Outcome| json!({"name": o.condition.name(), "violations": o.count});
    let document = json!({
        "format": FORMAT, "program": concat!("anastomesh-verify ", env!("CARGO_PKG_VERSION")), "options": null,
        "input": input, "mesh": entry(&crate::files_of(mesh))?, "valid": report.is_valid(),
        "figures": json!(report.figures), "conditions": report.outcomes.iter().map(condition).collect::<Value>(),
    });
    let text = format!("{document:#}");
    let body = format!("{},\n  ", text.trim_end_matches('}').trim_end());
    let seal = seal(body.as_bytes(), key);
    Ok(format!("{body}{SEAL}: \"{seal}\"\n}}\n"))
}

/// Compares a certificate with the files and the report, and adds the conditions to the report.
///
/// # Errors
/// Text that is not a certificate, or a file that cannot be read.
pub fn check(text: &str, mesh: &Path, input: Option<&Path>, key: Option<&[u8]>, report: &mut Report) -> Result<()> {
    let certificate: Value = serde_json::from_str(text).ok().context("the certificate is not JSON")?;
    ensure!(certificate["format"] == FORMAT, "the certificate does not have the format '{FORMAT}'");
    let body = text.rfind(SEAL).map_or("", |at| &text[..at]);
    let is_sealed = certificate["seal"] == seal(body.as_bytes(), key);
    let mut differences = Vec::new();
    if certificate["mesh"]["sha256"] != hash(&crate::files_of(mesh))? {
        differences.push("the mesh has another hash");
    }
    if let Some(input) = input
        && certificate["input"]["sha256"] != hash(&[input.to_owned()])?
    {
        differences.push("the input has another hash");
    }
    let claims = claims(&certificate, report);
    report.add(Condition::Seal, (!is_sealed).then_some("another seal"));
    report.add(Condition::Hashes, differences);
    report.add(Condition::Claims, claims);
    Ok(())
}

/// Claims that differ from the report. Conditions that only one of both programs checks are skipped.
fn claims(certificate: &Value, report: &Report) -> Vec<&'static str> {
    let claimed = certificate["conditions"].as_array().map_or(&[][..], Vec::as_slice);
    let differs = |outcome: &&Outcome| {
        let claim = claimed.iter().find(|claim| claim["name"] == outcome.condition.name());
        claim.is_some_and(|claim| (claim["violations"] == 0) != (outcome.count == 0))
    };
    let mut wrong: Vec<&'static str> =
        report.outcomes.iter().filter(differs).map(|outcome| outcome.condition.name()).collect();
    if certificate["valid"] != report.is_valid() {
        wrong.push("valid");
    }
    let (figures, own) = (&certificate["figures"], json!(report.figures));
    // Programs without an expectation do not state the genus.
    let is_equal = |name: &&str| figures[name] == own[name] || (*name == "genus" && figures[name].is_null());
    wrong.extend(["genus", "points", "tets", "boundary_faces", "components"].iter().filter(|name| !is_equal(name)));
    let volume = report.figures.volume;
    if figures["volume"].as_f64().is_none_or(|claimed| (claimed - volume).abs() > VOLUME * volume.abs()) {
        wrong.push("volume");
    }
    wrong
}

/// SHA-256 of the bytes before the seal, or HMAC-SHA256 (RFC 2104) with a key.
fn seal(body: &[u8], key: Option<&[u8]>) -> String {
    let Some(key) = key else { return format!("{:x}", Sha256::digest(body)) };
    let mac = Hmac::<Sha256>::new_from_slice(key).expect("keys of HMAC have any length");
    format!("{:x}", mac.chain_update(body).finalize().into_bytes())
}

#[cfg(test)]
mod tests {
    use super::seal;

    #[test]
    fn seals_are_those_of_the_standards() {
        assert_eq!(seal(b"abc", None), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        let text = b"what do ya want for nothing?";
        let expected = "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843";
        assert_eq!(seal(text, Some(b"Jefe")), expected);
        // RFC 4231, case 6: a key longer than a block.
        let text = b"Test Using Larger Than Block-Size Key - Hash Key First";
        let expected = "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54";
        assert_eq!(seal(text, Some(&[0xaa; 131])), expected);
        // Python's hmac, with keys of one block and of one byte more.
        let bytes: Vec<u8> = (0..65).collect();
        let expected = "6ab541b4869dca71c4ca11d8bb1b02533b789a557583161429292c7404bc21f6";
        assert_eq!(seal(b"abc", Some(&bytes[..64])), expected);
        let expected = "dfbffee4671bad00ed5d1e1999d55ed3b0cc774ac357f9ebf649c1612414fcec";
        assert_eq!(seal(b"abc", Some(&bytes)), expected);
    }
}
