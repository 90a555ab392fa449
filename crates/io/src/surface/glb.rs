//! GLB, the binary form of glTF 2.0: a scene with one mesh, for viewers and the web.
//!
//! Layout: a header of 12 bytes, a JSON chunk, and a binary chunk with coordinates (3 × f32) and corners (3 × u32).
//! Coordinates are relative to the centre of the surface, the position of the node, so that 32 bits suffice.

use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::{Aabb, Point3};
use serde_json::json;
use std::io::{self, Write};

const MAGIC: u32 = 0x4654_6C67;
const VERSION: u32 = 2;
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BYTES_CHUNK: u32 = 0x004E_4942;

/// Writes a boundary.
pub(super) fn write_boundary(out: &mut impl Write, surface: &BoundarySurface) -> io::Result<()> {
    let counts = surface.counts();
    let mut bounds = Aabb::EMPTY;
    surface.each_points(|points| {
        bounds = bounds.union(&Aabb::of_points(points));
        Ok(())
    })?;
    let middle = nalgebra::center(&bounds.min, &bounds.max);
    let local = |p: &Point3| <[f64; 3]>::from(p - middle).map(|x| x as f32);
    let [low, high] = [local(&bounds.min), local(&bounds.max)];
    let [points, corners] = [12 * counts.points as u64, 12 * counts.boundary as u64];
    let text = json!({
        "asset": { "version": "2.0", "generator": "anastomesh" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "translation": <[f64; 3]>::from(middle.coords) }],
        "meshes": [{ "name": "wall", "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{
            "name": "vessel",
            "doubleSided": true,
            "pbrMetallicRoughness": { "baseColorFactor": [0.7, 0.12, 0.1, 1.0], "metallicFactor": 0.0 },
        }],
        "buffers": [{ "byteLength": points + corners }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": points, "target": 34962 },
            { "buffer": 0, "byteOffset": points, "byteLength": corners, "target": 34963 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": counts.points, "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": 5125, "count": 3 * counts.boundary, "type": "SCALAR" },
        ],
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + text.len() as u64 + 8 + points + corners;
    let Ok(total) = u32::try_from(total) else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "GLB holds at most 4 GiB; write PLY or STL"));
    };
    write_words(out, &[MAGIC, VERSION, total, text.len() as u32, JSON_CHUNK])?;
    out.write_all(&text)?;
    write_words(out, &[(points + corners) as u32, BYTES_CHUNK])?;
    surface.each_points(|points| {
        let bytes: Vec<[u8; 4]> = points.iter().flat_map(|p| local(p).map(f32::to_le_bytes)).collect();
        out.write_all(bytes.as_flattened())
    })?;
    surface.each_faces(|piece| write_words(out, piece.faces.as_flattened()))
}

fn write_words(out: &mut impl Write, words: &[u32]) -> io::Result<()> {
    out.write_all(words.iter().map(|word| word.to_le_bytes()).collect::<Vec<_>>().as_flattened())
}
