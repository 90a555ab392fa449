//! Finished picture and its PNG file.

use std::io::{self, Write};

/// RGBA image, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[u8; 4]>,
}

impl Image {
    /// Writes the image as PNG, without an alpha channel if all pixels are opaque.
    ///
    /// # Errors
    /// The stream fails.
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
