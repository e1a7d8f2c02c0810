//! The header of `NumPy`'s `.npy` (NEP 1): a Python dictionary of three entries, of which only plain values are understood.

use std::io::{self, Read, Write};

use super::{Fault, Header};

/// Longest header that is read; `NumPy` itself writes about a hundred bytes.
const MAX_HEADER: u32 = 1 << 16;

/// The header behind the first four bytes of the magic.
pub(super) fn header(file: &mut impl Read) -> Result<Header, Fault> {
    let mut rest = [0; 4];
    file.read_exact(&mut rest)?;
    let length = match rest {
        [b'P', b'Y', 1, _] => {
            let mut length = [0; 2];
            file.read_exact(&mut length)?;
            u32::from(u16::from_le_bytes(length))
        }
        [b'P', b'Y', 2 | 3, _] => {
            let mut length = [0; 4];
            file.read_exact(&mut length)?;
            u32::from_le_bytes(length)
        }
        _ => {
            return Err(Fault::Header("its version of the .npy format is unknown; save it with numpy.save".to_owned()));
        }
    };
    if length > MAX_HEADER {
        return Err(Fault::Header(format!("its header of {length} bytes is none that NumPy writes; save it again")));
    }
    let mut bytes = vec![0; length as usize];
    file.read_exact(&mut bytes)?;
    parse(&String::from_utf8_lossy(&bytes)).map_err(Fault::Header)
}

fn parse(text: &str) -> Result<Header, String> {
    let kind = entry(text, "descr").ok_or("its header has no descr; save it with numpy.save")?;
    let kind = kind.trim_matches(['\'', '"']);
    if kind != "<f4" {
        return Err(format!("its values are of the type '{kind}'; save array.astype('<f4')"));
    }
    if entry(text, "fortran_order") != Some("False") {
        return Err("its first index runs fastest; save numpy.ascontiguousarray(array)".to_owned());
    }
    let shape = text.split_once("'shape'").or_else(|| text.split_once("\"shape\"")).map(|(_, rest)| rest);
    let shape = shape.and_then(|rest| rest.split_once('(')?.1.split_once(')')).map(|(shape, _)| shape);
    let shape = shape.ok_or("its header has no shape; save it with numpy.save")?;
    let sides: Option<Vec<u64>> =
        shape.split(',').map(str::trim).filter(|side| !side.is_empty()).map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some([z, y, x]) => Ok(Header { size: [*x, *y, *z], bounds: None }),
        _ => Err(format!("its shape is ({shape}), but an array of three indices [z][y][x] is needed")),
    }
}

/// The value of an entry, up to the next comma.
fn entry<'t>(text: &'t str, name: &str) -> Option<&'t str> {
    let rest = ['\'', '"'].iter().find_map(|quote| Some(text.split_once(&format!("{quote}{name}{quote}"))?.1))?;
    let value = rest.trim_start().strip_prefix(':')?;
    value.split([',', '}']).next().map(str::trim)
}

/// The whole beginning of a file; the values follow at a multiple of 64 bytes.
pub(super) fn write_header([x, y, z]: [u32; 3], to: &mut impl Write) -> io::Result<()> {
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({z}, {y}, {x}), }}");
    let unpadded = 10 + text.len() + 1;
    text.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    to.write_all(b"\x93NUMPY\x01\x00")?;
    to.write_all(&u16::try_from(text.len()).unwrap_or(u16::MAX).to_le_bytes())?;
    to.write_all(text.as_bytes())
}
