//! The header of Mitsuba's grid volumes, version 3: encoding, size, channels and box.

use std::io::{self, Read, Write};

use super::{Bounds, Fault, Header};

const FLOAT: i32 = 1;

/// The header behind the magic and the version.
pub(super) fn header(file: &mut impl Read, version: u8) -> Result<Header, Fault> {
    if version != 3 {
        return Err(Fault::Header(format!("it is a .vol of version {version}, but only version 3 can be read")));
    }
    let [encoding, x, y, z, channels] = numbers(file, i32::from_le_bytes)?;
    if encoding != FLOAT {
        return Err(Fault::Header(format!("its encoding is {encoding}, but only 1, float32, can be read")));
    }
    if channels != 1 {
        return Err(Fault::Header(format!("it has {channels} channels, but a density has one")));
    }
    let size = [x, y, z].map(u64::try_from);
    let [Ok(x), Ok(y), Ok(z)] = size else {
        return Err(Fault::Header(format!("its size is {x} x {y} x {z}, which holds no voxel")));
    };
    let [a, b, c, d, e, f] = numbers(file, f32::from_le_bytes)?;
    Ok(Header { size: [x, y, z], bounds: Some([[a, b, c], [d, e, f]]) })
}

fn numbers<T: Copy + Default, const N: usize>(
    file: &mut impl Read,
    from_bytes: fn([u8; 4]) -> T,
) -> Result<[T; N], Fault> {
    let mut all = [T::default(); N];
    for number in &mut all {
        let mut bytes = [0; 4];
        file.read_exact(&mut bytes)?;
        *number = from_bytes(bytes);
    }
    Ok(all)
}

/// The whole beginning of a file.
pub(super) fn write_header(size: [u32; 3], bounds: Bounds, to: &mut impl Write) -> io::Result<()> {
    to.write_all(b"VOL\x03")?;
    to.write_all(&FLOAT.to_le_bytes())?;
    size.iter().try_for_each(|side| to.write_all(&side.to_le_bytes()))?;
    to.write_all(&1_i32.to_le_bytes())?;
    bounds.as_flattened().iter().try_for_each(|side| to.write_all(&side.to_le_bytes()))
}
