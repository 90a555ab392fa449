//! Writer of lines with radii, and of refinement data per node.

use crate::network::content::NetworkArray;
use crate::network::radii::END_RADII;
use anastomesh_skeleton::{Edge, Skeleton};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::{Compression, write::ZlibEncoder};
use std::fmt::Write as _;
use std::io::{self, Write};

/// File contents.
pub(in crate::network) fn bytes_of(skeleton: &Skeleton, arrays: &[NetworkArray]) -> io::Result<Vec<u8>> {
    let (nodes, edges) = (&skeleton.nodes, &skeleton.edges);
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n",
    );
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" \
         NumberOfPolys=\"0\">",
        nodes.len(),
        edges.len()
    );
    text.push_str("<PointData Scalars=\"Radius\">\n");
    floats(&mut text, "Radius", 1, nodes.iter().map(|n| n.radius))?;
    for array in arrays {
        match array {
            NetworkArray::NodeInts(name, values) => {
                let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
                data_array(&mut text, "UInt32", name, 1, &bytes)?;
            }
            NetworkArray::NodeVectors(name, values) => floats(&mut text, name, 3, values.iter().flatten().copied())?,
            NetworkArray::NodeFloats(name, values) => floats(&mut text, name, 1, values.iter().copied())?,
            NetworkArray::EdgeFloats(..) => {}
        }
    }
    text.push_str("</PointData>\n<CellData>\n");
    floats(&mut text, "EdgeRadius", 1, edges.iter().map(Edge::mean_radius))?;
    floats(&mut text, END_RADII, 2, edges.iter().flat_map(|e| e.radii))?;
    for array in arrays {
        if let NetworkArray::EdgeFloats(name, values) = array {
            floats(&mut text, name, 1, values.iter().copied())?;
        }
    }
    text.push_str("</CellData>\n<Points>\n");
    floats(&mut text, "Points", 3, nodes.iter().flat_map(|n| <[f64; 3]>::from(n.position)))?;
    text.push_str("</Points>\n<Lines>\n");
    let ends: Vec<u8> = edges.iter().flat_map(|e| e.nodes).flat_map(|n| i64::from(n.0).to_le_bytes()).collect();
    data_array(&mut text, "Int64", "connectivity", 1, &ends)?;
    let offsets: Vec<u8> = (1..=edges.len() as i64).flat_map(|i| (2 * i).to_le_bytes()).collect();
    data_array(&mut text, "Int64", "offsets", 1, &offsets)?;
    text.push_str("</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n");
    Ok(text.into_bytes())
}

fn floats(text: &mut String, name: &str, components: usize, values: impl Iterator<Item = f64>) -> io::Result<()> {
    data_array(text, "Float64", name, components, &values.flat_map(f64::to_le_bytes).collect::<Vec<u8>>())
}

/// Appends an array: base64 of the compressed bytes, in blocks of VTK's default size.
fn data_array(text: &mut String, kind: &str, name: &str, components: usize, bytes: &[u8]) -> io::Result<()> {
    const BLOCK: usize = 1 << 20;
    let blocks: Vec<Vec<u8>> = bytes
        .chunks(BLOCK)
        .map(|chunk| {
            let mut encoder = ZlibEncoder::new(Vec::with_capacity(chunk.len() / 2), Compression::default());
            encoder.write_all(chunk)?;
            encoder.finish()
        })
        .collect::<io::Result<_>>()?;
    let mut head = vec![blocks.len() as u64, BLOCK as u64, (bytes.len() % BLOCK) as u64];
    head.extend(blocks.iter().map(|b| b.len() as u64));
    let head: Vec<u8> = head.into_iter().flat_map(u64::to_le_bytes).collect();
    let width = if components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
    let _ = writeln!(text, "<DataArray type=\"{kind}\" Name=\"{name}\"{width} format=\"binary\">");
    BASE64_STANDARD.encode_string(head, text);
    BASE64_STANDARD.encode_string(blocks.concat(), text);
    text.push_str("\n</DataArray>\n");
    Ok(())
}
