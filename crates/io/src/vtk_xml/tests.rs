use super::array::{DataArray, Values};
use super::document::VtkXml;
use super::error::VtkError;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::ZlibEncoder};
use proptest::prelude::*;
use std::io::Write as _;

/// Variant of a test file.
#[derive(Clone, Copy, Debug)]
struct Style {
    big_endian: bool,
    wide: bool,
    zlib: bool,
    /// 0 ascii, 1 inline, 2 appended raw, 3 appended base64.
    place: u8,
}

impl Style {
    fn length(self, n: usize) -> Vec<u8> {
        match (self.wide, self.big_endian) {
            (false, false) => (n as u32).to_le_bytes().to_vec(),
            (false, true) => (n as u32).to_be_bytes().to_vec(),
            (true, false) => (n as u64).to_le_bytes().to_vec(),
            (true, true) => (n as u64).to_be_bytes().to_vec(),
        }
    }

    /// Header and data, with the length of the part that base64 encodes separately.
    fn pack(self, data: &[u8]) -> (Vec<u8>, usize) {
        if !self.zlib {
            return ([self.length(data.len()), data.to_vec()].concat(), 0);
        }
        let size = 24;
        let blocks: Vec<Vec<u8>> = data
            .chunks(size)
            .map(|c| {
                let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
                encoder.write_all(c).unwrap();
                encoder.finish().unwrap()
            })
            .collect();
        let mut header = [self.length(blocks.len()), self.length(size), self.length(data.len() % size)].concat();
        for block in &blocks {
            header.extend(self.length(block.len()));
        }
        let apart = header.len();
        header.extend(blocks.concat());
        (header, apart)
    }

    fn base64(self, data: &[u8]) -> String {
        let (bytes, apart) = self.pack(data);
        STANDARD.encode(&bytes[..apart]) + &STANDARD.encode(&bytes[apart..])
    }

    fn file(self, kind: &str, ascii: &str, data: &[u8]) -> Vec<u8> {
        let order = if self.big_endian { "BigEndian" } else { "LittleEndian" };
        let header = if self.wide { "UInt64" } else { "UInt32" };
        let zlib = if self.zlib { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let (format, inline) = match self.place {
            0 => ("ascii", ascii.to_owned()),
            1 => ("binary", format!("\n  {}\n ", self.base64(data))),
            _ => ("appended", String::new()),
        };
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"{order}\" header_type=\"{header}\"{zlib}>\n\
             <PolyData><!-- a comment --><DataArray Name=\"A &amp; B\" type=\"{kind}\" format=\"{format}\" offset=\"3\">\
             {inline}</DataArray></PolyData>"
        );
        let mut bytes = head.into_bytes();
        if self.place >= 2 {
            let encoding = if self.place == 2 { "raw" } else { "base64" };
            bytes.extend(format!("<AppendedData encoding=\"{encoding}\">\n  _xyz").into_bytes());
            let data = if self.place == 2 { self.pack(data).0 } else { self.base64(data).into_bytes() };
            bytes.extend(data);
            bytes.extend(b"\n </AppendedData>\n");
        }
        bytes.extend(b"</VTKFile>\n");
        bytes
    }
}

fn style() -> impl Strategy<Value = Style> {
    (any::<bool>(), any::<bool>(), any::<bool>(), 0..4_u8).prop_map(|(big_endian, wide, zlib, place)| Style {
        big_endian,
        wide,
        zlib,
        place,
    })
}

fn named(bytes: &[u8]) -> Result<(String, DataArray), VtkError> {
    let document = VtkXml::parse(bytes, "PolyData")?;
    let poly = document.child(VtkXml::ROOT, "PolyData").ok_or(VtkError::Empty)?;
    let (name, array) = document.arrays(poly).next().ok_or(VtkError::Empty)?;
    Ok((name.to_owned(), document.read(array)?))
}

fn read(bytes: &[u8]) -> Result<DataArray, VtkError> {
    Ok(named(bytes)?.1)
}

fn words<T: ToString>(values: &[T]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

proptest! {
    #[test]
    fn every_encoding_gives_the_values_back(
        style in style(),
        floats in prop::collection::vec(any::<i32>().prop_map(|x| f64::from(x) / 7.0), 0..40),
        ints in prop::collection::vec(any::<i32>(), 0..40),
    ) {
        let big = style.big_endian;
        let doubles: Vec<u8> =
            floats.iter().flat_map(|x| if big { x.to_be_bytes() } else { x.to_le_bytes() }).collect();
        let (name, array) = named(&style.file("Float64", &words(&floats), &doubles)).unwrap();
        prop_assert_eq!(&name, "A & B");
        prop_assert_eq!(array.values, Values::Float(floats.clone()));

        let singles: Vec<u8> =
            floats.iter().flat_map(|&x| if big { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() }).collect();
        let expected: Vec<f64> = floats.iter().map(|&x| f64::from(x as f32)).collect();
        let array = read(&style.file("Float32", &words(&expected), &singles)).unwrap();
        prop_assert_eq!(array.values, Values::Float(expected));

        let narrow: Vec<u8> = ints.iter().flat_map(|x| if big { x.to_be_bytes() } else { x.to_le_bytes() }).collect();
        let wide: Vec<i64> = ints.iter().map(|&x| i64::from(x)).collect();
        let array = read(&style.file("Int32", &words(&ints), &narrow)).unwrap();
        prop_assert_eq!(array.into_ints(), Some(wide.clone()));
        let long: Vec<u8> = wide.iter().flat_map(|x| if big { x.to_be_bytes() } else { x.to_le_bytes() }).collect();
        let array = read(&style.file("Int64", &words(&ints), &long)).unwrap();
        prop_assert_eq!(array.into_ints(), Some(wide));
    }

    #[test]
    fn damaged_files_give_an_error_or_values_but_never_panic(
        style in style(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let data: Vec<u8> = (0..160).collect();
        let mut bytes = style.file("UInt8", "1 2 3", &data);
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = read(&bytes);
    }

    #[test]
    fn any_bytes_give_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(read(&bytes).is_err());
    }
}

#[test]
fn cut_data_is_told_apart_from_damaged_data() {
    let style = Style { big_endian: false, wide: false, zlib: true, place: 2 };
    let data: Vec<u8> = (0..160).collect();
    let bytes = style.file("UInt8", "", &data);
    let cut = &bytes[..bytes.len() - 60];
    assert!(matches!(read(cut), Err(VtkError::ArrayCutShort { .. })));
    let inline = Style { place: 1, ..style }.file("UInt8", "", &data);
    assert!(matches!(read(&inline[..inline.len() - 60]), Err(VtkError::CutShort | VtkError::Xml { .. })));
    assert!(matches!(read(b""), Err(VtkError::Empty)));
    assert!(matches!(read(b"<html></html>"), Err(VtkError::NotVtk { .. })));
    assert!(matches!(read(b"<VTKFile type=\"ImageData\"></VTKFile>"), Err(VtkError::WrongFileType { .. })));
    let lz4 = b"<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"></VTKFile>";
    assert!(matches!(read(lz4), Err(VtkError::UnknownLayout { attribute: "compressor", .. })));
}

#[test]
fn a_false_length_allocates_nothing() {
    let style = Style { big_endian: false, wide: true, zlib: false, place: 2 };
    let mut bytes = style.file("UInt8", "", &[1, 2, 3]);
    let at = bytes.windows(4).position(|w| w == b"_xyz").unwrap() + 4;
    bytes[at..at + 8].copy_from_slice(&(u64::MAX / 2).to_le_bytes());
    assert!(matches!(read(&bytes), Err(VtkError::ArrayCutShort { .. })));
}

#[test]
fn header_encoded_apart_from_uncompressed_data() {
    let text = STANDARD.encode(3_u32.to_le_bytes()) + &STANDARD.encode([7_u8, 8, 9]);
    let file = format!(
        "<VTKFile type=\"PolyData\"><PolyData><DataArray type=\"UInt8\" format=\"binary\">{text}</DataArray></PolyData>\
         </VTKFile>"
    );
    assert_eq!(read(file.as_bytes()).unwrap().into_ints(), Some(vec![7, 8, 9]));
}
