//! 3MF format for slicers: an archive with a model in XML. Lengths are in millimetres by default.

mod archive;

use anastomesh_mesh::boundary::BoundarySurface;
use archive::Archive;
use std::io::{self, Seek, Write};

const CONTENT_TYPES: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";

const RELATIONS: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

const MODEL_OPEN: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <model unit=\"millimeter\" xml:lang=\"en-US\" \
    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n\
    <resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n";

const MODEL_CLOSE: &str =
    "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n";

/// Writes a boundary.
pub(super) fn write_boundary(out: &mut (impl Write + Seek), surface: &BoundarySurface) -> io::Result<()> {
    let mut archive = Archive::new(out)?;
    archive.add("[Content_Types].xml", |entry| entry.write_all(CONTENT_TYPES.as_bytes()))?;
    archive.add("_rels/.rels", |entry| entry.write_all(RELATIONS.as_bytes()))?;
    archive.add("3D/3dmodel.model", |entry| write_model(entry, surface))?;
    archive.finish()
}

fn write_model(out: &mut dyn Write, surface: &BoundarySurface) -> io::Result<()> {
    out.write_all(MODEL_OPEN.as_bytes())?;
    surface.each_points(|points| {
        points.iter().try_for_each(|p| writeln!(out, "<vertex x=\"{:?}\" y=\"{:?}\" z=\"{:?}\"/>", p.x, p.y, p.z))
    })?;
    out.write_all(b"</vertices>\n<triangles>\n")?;
    surface.each_faces(|piece| {
        let mut triangles = piece.faces.iter();
        triangles.try_for_each(|[a, b, c]| writeln!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>"))
    })?;
    out.write_all(MODEL_CLOSE.as_bytes())
}
