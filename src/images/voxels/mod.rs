//! Voxel grids as other programs write them: `NumPy`'s `.npy` and Mitsuba's `.vol`. `docs/grid.md` states both exactly.

mod npy;
mod vdb;
mod vol;

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};

pub use vdb::{UpAxis, VdbOptions};

/// Longest side of a grid, in voxels; every device holds textures that large.
pub const MAX_SIDE: u32 = 2048;
/// Most voxels of a grid: half a gibibyte of them.
pub const MAX_VOXELS: u64 = 1 << 27;

/// Lower and upper corner of a box.
pub type Bounds = [[f32; 3]; 2];

/// Densities at the centres of voxels; x runs fastest, then y, then z: what `NumPy` indexes as `[z][y][x]`.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelGrid {
    size: [u32; 3],
    values: Vec<f32>,
}

/// What can go wrong when a grid is read. Each message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum VoxelError {
    /// The file to be read does not exist.
    #[error("cannot read {path}: there is no such file; check the path")]
    Missing {
        /// The path as given.
        path: PathBuf,
    },
    /// The file exists but cannot be read.
    #[error("cannot read {path}: {cause}; check its permissions")]
    NotReadable {
        /// The path as given.
        path: PathBuf,
        /// The failure reported by the operating system.
        cause: io::Error,
    },
    /// The file is neither an `.npy` nor a `.vol`.
    #[error("{path} is neither NumPy's .npy nor Mitsuba's .vol; only these two can be read")]
    WrongFormat {
        /// The file that was read.
        path: PathBuf,
    },
    /// The header says something that is not supported.
    #[error("{path} cannot be used: {reason}")]
    Header {
        /// The file that was read.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// The file ends before its last voxel, or goes on behind it.
    #[error("{path} holds {found} voxels, but its header promises {promised}; write it again")]
    WrongLength {
        /// The file that was read.
        path: PathBuf,
        /// Voxels that the header speaks of.
        promised: u64,
        /// Whole voxels that follow it, as a phrase.
        found: String,
    },
    /// A density that cannot be one.
    #[error("{path}: the value at [z][y][x] = [{z}][{y}][{x}] is {value}; densities are finite and not negative")]
    Value {
        /// The file that was read.
        path: PathBuf,
        /// Index along the third axis.
        z: u32,
        /// Index along the second axis.
        y: u32,
        /// Index along the first axis.
        x: u32,
        /// The value.
        value: f32,
    },
}

/// What went wrong while reading, before it is known of which file.
enum Fault {
    Io(io::Error),
    Header(String),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Fault {
    fn of(self, path: &Path) -> VoxelError {
        let path = path.to_owned();
        match self {
            Self::Header(reason) => VoxelError::Header { path, reason },
            Self::Io(cause) => match cause.kind() {
                io::ErrorKind::NotFound => VoxelError::Missing { path },
                io::ErrorKind::UnexpectedEof => {
                    VoxelError::Header { path, reason: "it ends within its header; write it again".to_owned() }
                }
                _ => VoxelError::NotReadable { path, cause },
            },
        }
    }
}

/// What a header promises.
struct Header {
    /// Voxels along x, y and z.
    size: [u64; 3],
    /// The box that the file itself speaks of, as lower and upper corner.
    bounds: Option<Bounds>,
}

impl VoxelGrid {
    /// A grid of these voxels; `None` if there are not as many as its size says, or a side is empty or too long.
    pub fn new(size: [u32; 3], values: Vec<f32>) -> Option<Self> {
        let is_sound = check_size(size.map(u64::from)).is_ok();
        (is_sound && values.len() as u64 == count(size.map(u64::from))).then_some(Self { size, values })
    }

    /// Voxels along x, y and z.
    pub fn size(&self) -> [u32; 3] {
        self.size
    }

    /// All voxels, x fastest, then y, then z.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// The greatest value.
    pub fn greatest(&self) -> f32 {
        self.values.iter().copied().fold(0.0, f32::max)
    }

    /// Reads a grid, and the box that a `.vol` speaks of.
    ///
    /// # Errors
    /// If the file is missing, unreadable, of another format, too large, of another length than its header says, or holds
    /// a value that is negative or not finite.
    pub fn read(path: &Path) -> Result<(Self, Option<Bounds>), VoxelError> {
        let file = File::open(path).map_err(|error| Fault::Io(error).of(path))?;
        Self::from_reader(&mut BufReader::new(file), path)
    }

    fn from_reader(file: &mut impl Read, path: &Path) -> Result<(Self, Option<Bounds>), VoxelError> {
        let mut magic = [0; 4];
        let mut known = 0;
        while known < 4 {
            match file.read(&mut magic[known..]).map_err(|error| Fault::Io(error).of(path))? {
                0 => return Err(VoxelError::WrongFormat { path: path.to_owned() }),
                more => known += more,
            }
        }
        let header = match &magic {
            b"\x93NUM" => npy::header(file),
            [b'V', b'O', b'L', version] => vol::header(file, *version),
            _ => return Err(VoxelError::WrongFormat { path: path.to_owned() }),
        };
        let header = header.map_err(|fault| fault.of(path))?;
        let size = check_size(header.size).map_err(|reason| VoxelError::Header { path: path.to_owned(), reason })?;
        let promised = count(header.size);
        let mut bytes = Vec::new();
        file.take(promised * 4 + 1).read_to_end(&mut bytes).map_err(|error| Fault::Io(error).of(path))?;
        if bytes.len() as u64 != promised * 4 {
            let found = match bytes.len() as u64 / 4 {
                all if all == promised => "more".to_owned(),
                fewer => fewer.to_string(),
            };
            return Err(VoxelError::WrongLength { path: path.to_owned(), promised, found });
        }
        let (numbers, _) = bytes.as_chunks();
        let values: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        drop(bytes);
        if let Some(wrong) = values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            let [x, y, z] = place(wrong, size);
            return Err(VoxelError::Value { path: path.to_owned(), z, y, x, value: values[wrong] });
        }
        Ok((Self { size, values }, header.bounds))
    }

    /// Writes the grid as `NumPy` reads it: float32, indexed `[z][y][x]`.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_npy(&self, to: &mut impl Write) -> io::Result<()> {
        npy::write_header(self.size, to)?;
        self.write_values(to)
    }

    /// Writes the grid as Mitsuba's `gridvolume` reads it, in a box.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vol(&self, bounds: Bounds, to: &mut impl Write) -> io::Result<()> {
        vol::write_header(self.size, bounds, to)?;
        self.write_values(to)
    }

    fn write_values(&self, to: &mut impl Write) -> io::Result<()> {
        self.values.iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))
    }
}

fn count([x, y, z]: [u64; 3]) -> u64 {
    x.saturating_mul(y).saturating_mul(z)
}

fn check_size(size: [u64; 3]) -> Result<[u32; 3], String> {
    let [x, y, z] = size;
    if size.contains(&0) {
        return Err(format!("its size is {x} x {y} x {z}, which holds no voxel"));
    }
    let side = |side: u64| u32::try_from(side).ok().filter(|side| *side <= MAX_SIDE);
    match (side(x), side(y), side(z)) {
        (Some(x), Some(y), Some(z)) if count(size) <= MAX_VOXELS => Ok([x, y, z]),
        _ => Err(format!(
            "its size is {x} x {y} x {z}; at most {MAX_SIDE} voxels along a side and {MAX_VOXELS} together can be \
             drawn, resample it"
        )),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "indices within a grid whose sides are checked")]
fn place(index: usize, [x, y, _]: [u32; 3]) -> [u32; 3] {
    let (x, y) = (x as usize, y as usize);
    [(index % x) as u32, (index / x % y) as u32, (index / (x * y)) as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = [[-1.0, 0.0, 2.0], [1.0, 4.0, 3.5]];

    fn grid() -> VoxelGrid {
        VoxelGrid::new([3, 2, 2], (0_u8..12).map(|i| f32::from(i) / 7.0).collect()).expect("sound")
    }

    fn read(bytes: &[u8]) -> Result<(VoxelGrid, Option<Bounds>), VoxelError> {
        VoxelGrid::from_reader(&mut &bytes[..], Path::new("cloud.x"))
    }

    fn written(write: impl FnOnce(&VoxelGrid, &mut Vec<u8>) -> io::Result<()>) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&grid(), &mut bytes).expect("memory takes it");
        bytes
    }

    fn refusal(bytes: &[u8]) -> String {
        read(bytes).expect_err("refused").to_string()
    }

    #[test]
    fn both_formats_come_back() {
        let npy = written(VoxelGrid::write_npy);
        assert_eq!(read(&npy).expect("an npy"), (grid(), None));
        assert_eq!((npy.len() - 48) % 64, 0, "the header is padded");
        let vol = written(|grid, to| grid.write_vol(BOUNDS, to));
        assert_eq!(read(&vol).expect("a vol"), (grid(), Some(BOUNDS)));
        assert_eq!(vol.len(), 48 + 48, "four bytes, five numbers, six numbers, twelve voxels");
    }

    #[test]
    fn numpy_of_other_versions_is_read() {
        let numbers = written(VoxelGrid::write_npy).split_off(128);
        for (version, length) in [(1, 2), (2, 4), (3, 4)] {
            let text = "{'shape': (2, 2, 3,), \"fortran_order\": False, 'descr': '<f4', }\n";
            let mut bytes = vec![0x93, b'N', b'U', b'M', b'P', b'Y', version, 0];
            bytes.extend(&u32::try_from(text.len()).expect("short").to_le_bytes()[..length]);
            bytes.extend(text.as_bytes());
            bytes.extend(&numbers);
            assert_eq!(read(&bytes).map_err(|error| error.to_string()), Ok((grid(), None)), "version {version}");
        }
    }

    #[test]
    fn every_truncation_is_refused() {
        for bytes in [written(VoxelGrid::write_npy), written(|grid, to| grid.write_vol(BOUNDS, to))] {
            for length in 0..bytes.len() {
                assert!(read(&bytes[..length]).is_err(), "{length} bytes");
            }
            assert!(refusal(&bytes[..bytes.len() - 4]).contains("holds 11 voxels, but its header promises 12"));
            let mut longer = bytes.clone();
            longer.push(0);
            assert!(refusal(&longer).contains("holds more voxels"), "{}", refusal(&longer));
        }
    }

    #[test]
    fn damage_is_refused_without_a_panic() {
        for bytes in [written(VoxelGrid::write_npy), written(|grid, to| grid.write_vol(BOUNDS, to))] {
            for index in 0..bytes.len() {
                for flip in [0x01, 0x20, 0x80, 0xFF] {
                    let mut damaged = bytes.clone();
                    damaged[index] ^= flip;
                    // Any answer is good, if it comes without a panic and without much memory.
                    let _ = read(&damaged);
                }
            }
        }
    }

    #[test]
    fn values_that_are_no_densities_are_named() {
        for wrong in [f32::NAN, f32::INFINITY, -0.5] {
            let mut bytes = written(VoxelGrid::write_npy);
            // Of the voxel at x = 1, y = 0, z = 1.
            let at = bytes.len() - 48 + 4 * (6 + 1);
            bytes[at..at + 4].copy_from_slice(&wrong.to_le_bytes());
            assert!(refusal(&bytes).contains("[z][y][x] = [1][0][1]"), "{}", refusal(&bytes));
        }
    }

    #[test]
    fn headers_say_what_is_wrong() {
        let header = |text: &str| {
            let mut bytes = vec![0x93, b'N', b'U', b'M', b'P', b'Y', 1, 0];
            bytes.extend(u16::try_from(text.len()).expect("short").to_le_bytes());
            bytes.extend(text.as_bytes());
            refusal(&bytes)
        };
        let double = header("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2, 3), }");
        assert!(double.contains("'<f8'") && double.contains("astype('<f4')"), "{double}");
        let fortran = header("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2, 3), }");
        assert!(fortran.contains("ascontiguousarray"), "{fortran}");
        let flat = header("{'descr': '<f4', 'fortran_order': False, 'shape': (12,), }");
        assert!(flat.contains("three"), "{flat}");
        let empty = header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 0, 3), }");
        assert!(empty.contains("3 x 0 x 2"), "{empty}");
        let huge = header("{'descr': '<f4', 'fortran_order': False, 'shape': (2000, 2000, 2000), }");
        assert!(huge.contains("resample"), "{huge}");
        let bare = header("{'descr': '<f4', 'fortran_order': False}");
        assert!(bare.contains("no shape"), "{bare}");
        assert!(refusal(b"PK\x03\x04 a zip of arrays").contains("neither"), "an .npz");
    }
}
