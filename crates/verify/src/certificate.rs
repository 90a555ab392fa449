//! Certificates: a summary of a mesh with hashes, written beside it and compared with it later. `docs/certificate.md`
//! describes the format.

use crate::mesh::{Read, fail};
use crate::report::{Condition, Figures, Report};
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
pub fn hash(files: &[PathBuf]) -> Read<String> {
    let mut sha = Sha256::new();
    for file in files {
        sha.update(std::fs::read(file)?);
    }
    Ok(hexadecimal(&sha.finalize()))
}

/// Text of the certificate of a mesh. `input` is the network or surface from which it was made. With a key the seal
/// authenticates the author (HMAC-SHA256).
///
/// # Errors
/// A file that cannot be read.
pub fn write(report: &Report, mesh: &Path, input: Option<&Path>, key: Option<&[u8]>) -> Read<String> {
    let entry = |files: &[PathBuf]| -> Read<Value> {
        let name = files[0].file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(json!({"file": name, "sha256": hash(files)?}))
    };
    let input = input.map(|input| entry(&[input.to_owned()])).transpose()?;
    let conditions = report.outcomes.iter().map(|o| json!({"name": o.condition.name(), "violations": o.count}));
    let f = &report.figures;
    let document = json!({
        "format": FORMAT, "program": concat!("anastomesh-verify ", env!("CARGO_PKG_VERSION")), "options": null,
        "input": input, "mesh": entry(&crate::files_of(mesh))?, "valid": report.is_valid(),
        "figures": {
            "points": f.points, "tets": f.tets, "boundary_faces": f.boundary_faces, "components": f.components,
            "genus": f.genus, "volume": f.volume,
        },
        "conditions": conditions.collect::<Vec<_>>(),
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
pub fn check(text: &str, mesh: &Path, input: Option<&Path>, key: Option<&[u8]>, report: &mut Report) -> Read<()> {
    let Ok(certificate) = serde_json::from_str::<Value>(text) else { return fail("the certificate is not JSON") };
    if certificate["format"] != FORMAT {
        return fail(format!("the certificate does not have the format '{FORMAT}'"));
    }
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
fn claims(certificate: &Value, report: &Report) -> Vec<String> {
    let mut wrong = Vec::new();
    for outcome in &report.outcomes {
        let name = outcome.condition.name();
        let listed = certificate["conditions"].as_array().into_iter().flatten().find(|claim| claim["name"] == name);
        if listed.is_some_and(|claim| (claim["violations"].as_u64() == Some(0)) != (outcome.count == 0)) {
            wrong.push(name.to_owned());
        }
    }
    if certificate["valid"] != report.is_valid() {
        wrong.push("valid".into());
    }
    let Figures { points, tets, boundary_faces, components, genus, volume } = report.figures;
    let exact = [
        ("points", points as i64),
        ("tets", tets as i64),
        ("boundary_faces", boundary_faces as i64),
        ("components", components as i64),
    ];
    let figures = &certificate["figures"];
    // Programs without an expectation do not state the genus.
    if !figures["genus"].is_null() && figures["genus"] != genus {
        wrong.push("genus".into());
    }
    wrong.extend(exact.iter().filter(|(name, value)| figures[name] != *value).map(|(name, _)| (*name).to_owned()));
    let claimed = figures["volume"].as_f64().unwrap_or(f64::NAN);
    if (claimed - volume).abs() > VOLUME * volume.abs() || claimed.is_nan() {
        wrong.push("volume".into());
    }
    wrong
}

/// SHA-256 of the bytes before the seal, or HMAC-SHA256 (RFC 2104) with a key.
fn seal(body: &[u8], key: Option<&[u8]>) -> String {
    let sha = |parts: [&[u8]; 2]| Sha256::new().chain_update(parts[0]).chain_update(parts[1]).finalize();
    let Some(key) = key else { return hexadecimal(&sha([body, &[]])) };
    let short = if key.len() > 64 { sha([key, &[]]).to_vec() } else { key.to_vec() };
    let padded = |pad: u8| -> Vec<u8> { (0..64).map(|i| short.get(i).copied().unwrap_or(0) ^ pad).collect() };
    hexadecimal(&sha([&padded(0x5c), &sha([&padded(0x36), body])]))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
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
