//! Header of every file.

/// Header of a text file.
pub(super) fn text(class: &str, path: &str) -> String {
    head("ascii", "", class, path)
}

/// Header of a little-endian binary file.
pub(super) fn binary(class: &str, path: &str, note: &str) -> String {
    let arch = format!("    arch        \"LSB;label=32;scalar=64\";\n    note        \"{note}\";\n");
    head("binary", &arch, class, path)
}

fn head(format: &str, more: &str, class: &str, path: &str) -> String {
    let (location, object) = path.rsplit_once('/').unwrap_or(("", path));
    format!(
        "FoamFile\n{{\n    version     2.0;\n    format      {format};\n{more}    class       {class};\n    \
         location    \"{location}\";\n    object      {object};\n}}\n\n"
    )
}
