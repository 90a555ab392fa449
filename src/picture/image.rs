//! A finished picture, and its file.

use std::io::{self, Write};

/// Red, green, blue and how opaque, row by row from above.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    /// Writes it as PNG: without the fourth value where all is opaque.
    ///
    /// # Errors
    /// What the stream reports.
    pub fn write_png(&self, out: impl Write) -> io::Result<()> {
        let opaque = self.pixels.iter().all(|p| p[3] == 255);
        let mut encoder = png::Encoder::new(out, self.width, self.height);
        encoder.set_color(if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let bytes: Vec<u8> = if opaque {
            self.pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect()
        } else {
            self.pixels.iter().flatten().copied().collect()
        };
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(())
    }
}
