//! Blockwise writer of VTK XML arrays. Blocks are compressed in parallel, one wave at a time, so memory does not grow
//! with the mesh.

use anastomesh_mesh::source::miscounted;
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;
use std::io::{self, Seek, SeekFrom, Write};

/// Values per compressed block: a multiple of 3, so that no point spans two waves.
const BLOCK: usize = 98_304;

/// Minimum bytes for parallel conversion of values.
const SERIAL: usize = 1 << 16;

/// Array encoding in a file.
#[derive(Clone, Copy, Debug)]
pub enum Packing {
    /// Raw bytes after their number.
    Raw,
    /// Zlib-compressed blocks after their number and sizes.
    Zlib(Compression),
}

/// Writes an array after its sizes. `fill` must provide `values` values of `width` bytes. The bytes depend on the
/// values only, not on push sizes or the number of threads.
///
/// # Errors
/// `out` or `fill` fails; `InvalidData` if the number of values differs from the announced one.
pub fn write_blocks(
    out: &mut (impl Write + Seek),
    values: usize,
    width: usize,
    packing: Packing,
    fill: impl FnOnce(&mut Blocks) -> io::Result<()>,
) -> io::Result<()> {
    if matches!(packing, Packing::Raw) {
        out.write_all(&((values * width) as u64).to_le_bytes())?;
        let mut blocks = Blocks::new(out, values, width, packing);
        fill(&mut blocks)?;
        return blocks.finish().map(drop);
    }
    let head = out.stream_position()?;
    write_spaces(out, 8 * (3 + values.div_ceil(BLOCK)))?;
    let mut blocks = Blocks::new(out, values, width, packing);
    fill(&mut blocks)?;
    let sizes = blocks.finish()?;
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(head))?;
    for size in sizes {
        out.write_all(&size.to_le_bytes())?;
    }
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

/// Writes spaces to be overwritten later.
pub fn write_spaces(out: &mut impl Write, count: usize) -> io::Result<()> {
    let spaces = [b' '; 256];
    let mut left = count;
    while left > 0 {
        let now = left.min(spaces.len());
        out.write_all(&spaces[..now])?;
        left -= now;
    }
    Ok(())
}

/// Collector of the values of one array.
pub struct Blocks<'a> {
    out: &'a mut dyn Write,
    packing: Packing,
    /// Bytes in a full block.
    block: usize,
    /// Current wave, of which the first `filled` bytes are set.
    wave: Vec<u8>,
    filled: usize,
    /// Number of remaining bytes.
    left: usize,
    /// Number of blocks, bytes of a full one, bytes of a partial last one, then their compressed sizes.
    sizes: Vec<u64>,
}

impl<'a> Blocks<'a> {
    fn new(out: &'a mut dyn Write, values: usize, width: usize, packing: Packing) -> Self {
        let (block, total) = (BLOCK * width, values * width);
        // Enough blocks for every thread, and few enough to limit memory.
        let wave = block * (4 * rayon::current_num_threads()).clamp(8, 64);
        let sizes = vec![values.div_ceil(BLOCK) as u64, block as u64, (total % block) as u64];
        Self { out, packing, block, wave: vec![0; wave.min(total)], filled: 0, left: total, sizes }
    }

    /// Appends `count` items, where `item(i)` gives the bytes of each.
    pub fn push<const W: usize>(&mut self, count: usize, item: impl Fn(usize) -> [u8; W] + Sync) -> io::Result<()> {
        if count * W > self.left {
            return Err(miscounted());
        }
        let mut first = 0;
        while first < count {
            let now = (count - first).min((self.wave.len() - self.filled) / W);
            let room = self.wave.get_mut(self.filled..self.filled + now * W).unwrap_or_default();
            lay_out(room, |i| item(first + i));
            first += now;
            self.filled += now * W;
            self.left -= now * W;
            if self.filled == self.wave.len() || now == 0 {
                self.write_wave()?;
            }
        }
        Ok(())
    }

    /// Appends integers.
    pub fn push_ints(&mut self, values: &[i32]) -> io::Result<()> {
        self.push(values.len(), |i| values[i].to_le_bytes())
    }

    fn write_wave(&mut self) -> io::Result<()> {
        let wave = &self.wave[..self.filled];
        match self.packing {
            Packing::Raw => self.out.write_all(wave)?,
            Packing::Zlib(level) => {
                let packed: Vec<_> = wave.par_chunks(self.block).map(|raw| compress(raw, level)).collect();
                for bytes in packed {
                    let bytes = bytes?;
                    self.sizes.push(bytes.len() as u64);
                    self.out.write_all(&bytes)?;
                }
            }
        }
        self.filled = 0;
        Ok(())
    }

    fn finish(mut self) -> io::Result<Vec<u64>> {
        if self.left > 0 {
            return Err(miscounted());
        }
        self.write_wave()?;
        Ok(self.sizes)
    }
}

fn lay_out<const W: usize>(room: &mut [u8], item: impl Fn(usize) -> [u8; W] + Sync) {
    on_all_threads(room, W, &|first, part| {
        let (items, _) = part.as_chunks_mut::<W>();
        for (i, bytes) in items.iter_mut().enumerate() {
            *bytes = item(first + i);
        }
    });
}

/// Fills items of `width` bytes; `fill` receives the first item of its bytes. Compiled once for all arrays.
fn on_all_threads(room: &mut [u8], width: usize, fill: &(dyn Fn(usize, &mut [u8]) + Sync)) {
    if room.len() <= SERIAL {
        return fill(0, room);
    }
    let part = SERIAL / width;
    room.par_chunks_mut(part * width).enumerate().for_each(|(k, bytes)| fill(k * part, bytes));
}

fn compress(raw: &[u8], level: Compression) -> io::Result<Vec<u8>> {
    let room = if level == Compression::none() { raw.len() + 64 } else { raw.len() / 2 };
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(room), level);
    encoder.write_all(raw)?;
    encoder.finish()
}
