//! `OpenVDB` files (format version 224) of voxel grids, written without the library: one fog volume in a tree of 5, 4 and 3
//! bits, zipped, sparse by leaves of 8³ voxels. What the library reads is what `tests/fixtures/vdb.py` checks.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;

use super::{Bounds, VoxelGrid};

/// Which way is up in the file's world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// x east, y north, z up: Blender's.
    Z,
    /// x east, y up, z south: Houdini's, Maya's, and this program's.
    Y,
}

/// How a grid is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VdbOptions {
    /// Which way is up.
    pub up: UpAxis,
    /// Whether values are rounded to half floats.
    pub is_half: bool,
}

const MAGIC: i64 = 0x5644_4220;
const FORMAT_VERSION: u32 = 224;
/// The version of the library whose files these are like.
const LIBRARY_VERSION: [u32; 2] = [10, 0];
/// Values are zipped; masks are not used to leave values out, as noughts zip well.
const ZIP: u32 = 1;
/// Said before the values of a node: all of them follow.
const ALL_VALUES: u8 = 6;
/// Bits of a coordinate below a leaf, below the lower and below the upper inner nodes.
const LEAF: u32 = 3;
const LOWER: u32 = 4;
const UPPER: u32 = 5;
/// Voxels along the side of a lower inner node. The root's only child is an upper one with its corner at 0: no grid is larger.
const LOWER_SIDE: u32 = 1 << (LEAF + LOWER);

/// A leaf: its place in units of leaves, and its values.
struct Leaf {
    place: [u32; 3],
    values: Vec<f32>,
}

impl Leaf {
    /// Number of the lower inner node that it is in.
    fn lower(&self) -> u32 {
        index(self.place.map(|place| place / (LOWER_SIDE >> LEAF)), UPPER)
    }

    /// Its number in that node.
    fn within(&self) -> u32 {
        index(self.place.map(|place| place % (LOWER_SIDE >> LEAF)), LOWER)
    }
}

impl VoxelGrid {
    /// Writes the grid as a fog volume named `density`, in a box of the world (x east, y up, z south, metres). One unit of the
    /// file is a metre, and the density is the grid's value, such as an extinction in 1/m.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_vdb(&self, bounds: Bounds, options: VdbOptions, to: &mut impl Write) -> io::Result<()> {
        to.write_all(&file(self, bounds, options)?)
    }

    /// The value at a place of the file: its axes are those of [`UpAxis`].
    fn at(&self, up: UpAxis, [x, y, z]: [u32; 3]) -> f32 {
        let [across, height, deep] = self.size;
        let (y, z) = match up {
            UpAxis::Y => (y, z),
            // North is away from south.
            UpAxis::Z => (z, deep - 1 - y),
        };
        let index = (u64::from(z) * u64::from(height) + u64::from(y)) * u64::from(across) + u64::from(x);
        usize::try_from(index).ok().and_then(|index| self.values.get(index)).copied().unwrap_or(0.0)
    }

    /// Its size along the file's axes.
    fn turned_size(&self, up: UpAxis) -> [u32; 3] {
        let [x, y, z] = self.size;
        if up == UpAxis::Y { [x, y, z] } else { [x, z, y] }
    }
}

/// The leaves that hold anything, in the order in which the tree is walked.
fn leaves(grid: &VoxelGrid, up: UpAxis) -> Vec<Leaf> {
    let size = grid.turned_size(up);
    let side = 1 << LEAF;
    let counts = size.map(|voxels| voxels.div_ceil(side));
    let mut leaves = Vec::new();
    for (x, y, z) in places(counts) {
        let corner = [x, y, z].map(|place| place * side);
        let mut values = Vec::with_capacity(512);
        for (i, j, k) in places([side; 3]) {
            let at = [corner[0] + i, corner[1] + j, corner[2] + k];
            let is_inside = at.iter().zip(size).all(|(at, size)| *at < size);
            values.push(if is_inside { grid.at(up, at) } else { 0.0 });
        }
        if values.iter().any(|value| *value != 0.0) {
            leaves.push(Leaf { place: [x, y, z], values });
        }
    }
    leaves.sort_by_key(|leaf| (leaf.lower(), leaf.within()));
    leaves
}

/// All places of a box, z fastest.
fn places([x, y, z]: [u32; 3]) -> impl Iterator<Item = (u32, u32, u32)> {
    (0..x).flat_map(move |i| (0..y).flat_map(move |j| (0..z).map(move |k| (i, j, k))))
}

/// The file, put together in memory: its header says where its parts lie.
fn file(grid: &VoxelGrid, bounds: Bounds, options: VdbOptions) -> io::Result<Vec<u8>> {
    let mut out = Bytes(Vec::new());
    out.put(&MAGIC.to_le_bytes());
    out.number(FORMAT_VERSION);
    LIBRARY_VERSION.into_iter().for_each(|part| out.number(part));
    // Grids may be read alone.
    out.put(&[1]);
    // The same grid has the same file, so the name of the file is that of its kind.
    out.put(b"00000000-0000-4000-8000-000000000000");
    out.metadata(&[("creator", Value::Text("nephoscope"))]);
    out.number(1);
    out.text("density");
    out.text(if options.is_half { "Tree_float_5_4_3_HalfFloat" } else { "Tree_float_5_4_3" });
    out.text("");
    let offsets_at = out.0.len();
    out.put(&[0; 24]);
    let grid_at = out.0.len();

    out.number(ZIP);
    let leaves = leaves(grid, options.up);
    let voxels = leaves.iter().flat_map(|leaf| &leaf.values).filter(|value| **value != 0.0).count();
    let size = grid.turned_size(options.up);
    out.metadata(&[
        ("class", Value::Text("fog volume")),
        ("file_bbox_max", Value::Place(size.map(|voxels| i32::try_from(voxels).unwrap_or(i32::MAX) - 1))),
        ("file_bbox_min", Value::Place([0; 3])),
        ("file_compression", Value::Text("zip")),
        ("file_voxel_count", Value::Count(i64::try_from(voxels).unwrap_or(i64::MAX))),
        ("is_saved_as_half_float", Value::Switch(options.is_half)),
        ("name", Value::Text("density")),
        ("value_type", Value::Text("float")),
    ]);
    transform(&mut out, size, turned(bounds, options.up));
    out.number(1);
    topology(&mut out, &leaves, options.is_half)?;
    let blocks_at = out.0.len();
    for leaf in &leaves {
        out.put(&mask(leaf.values.iter().map(|value| *value != 0.0)));
        out.values(&leaf.values, options.is_half)?;
    }
    let end = out.0.len();
    for (index, place) in [grid_at, blocks_at, end].into_iter().enumerate() {
        let at = offsets_at + 8 * index;
        out.0[at..at + 8].copy_from_slice(&(place as u64).to_le_bytes());
    }
    Ok(out.0)
}

/// A box along the file's axes.
fn turned([low, high]: Bounds, up: UpAxis) -> [[f64; 3]; 2] {
    let [low, high] = [low, high].map(|corner| corner.map(f64::from));
    match up {
        UpAxis::Y => [low, high],
        UpAxis::Z => [[low[0], -high[2], low[1]], [high[0], -low[2], high[1]]],
    }
}

/// From numbers of voxels to the world: a voxel's value belongs to its middle.
fn transform(out: &mut Bytes, size: [u32; 3], [low, high]: [[f64; 3]; 2]) {
    let scale: [f64; 3] = std::array::from_fn(|axis| (high[axis] - low[axis]) / f64::from(size[axis].max(1)));
    let middle: [f64; 3] = std::array::from_fn(|axis| low[axis] + 0.5 * scale[axis]);
    let is_uniform = scale.iter().all(|side| (side / scale[0] - 1.0).abs() < 1e-9);
    let scale = if is_uniform { [scale[0]; 3] } else { scale };
    out.text(if is_uniform { "UniformScaleTranslateMap" } else { "ScaleTranslateMap" });
    let inverse = scale.map(|side| 1.0 / side);
    let parts =
        [middle, scale, scale.map(f64::abs), inverse, inverse.map(|side| side * side), inverse.map(|side| 0.5 * side)];
    for number in parts.into_iter().flatten() {
        out.put(&number.to_le_bytes());
    }
}

/// The tree without its voxels: one upper inner node, lower ones, and the masks of leaves.
fn topology(out: &mut Bytes, leaves: &[Leaf], is_half: bool) -> io::Result<()> {
    // The root: what is outside, no tile, and a child where there is anything.
    out.put(&0.0_f32.to_le_bytes());
    out.number(0);
    out.number(u32::from(!leaves.is_empty()));
    if leaves.is_empty() {
        return Ok(());
    }
    out.put(&[0; 12]);
    let mut lowers: Vec<u32> = leaves.iter().map(Leaf::lower).collect();
    lowers.dedup();
    inner(out, UPPER, |child| lowers.binary_search(&child).is_ok(), is_half)?;
    for own in leaves.chunk_by(|one, other| one.lower() == other.lower()) {
        let places: Vec<u32> = own.iter().map(Leaf::within).collect();
        inner(out, LOWER, |child| places.binary_search(&child).is_ok(), is_half)?;
        for leaf in own {
            out.put(&mask(leaf.values.iter().map(|value| *value != 0.0)));
        }
    }
    Ok(())
}

/// An inner node: which children it has, that no tile is on, and as many noughts as it has places.
fn inner(out: &mut Bytes, bits: u32, has_child: impl Fn(u32) -> bool, is_half: bool) -> io::Result<()> {
    let count = 1_u32 << (3 * bits);
    out.put(&mask((0..count).map(has_child)));
    out.put(&mask((0..count).map(|_| false)));
    out.values(&vec![0.0; count as usize], is_half)
}

/// Number of a place in a node with so many bits to a side.
fn index([x, y, z]: [u32; 3], bits: u32) -> u32 {
    (x << (2 * bits)) | (y << bits) | z
}

/// Bits, the first in the lowest of the first byte.
fn mask(bits: impl Iterator<Item = bool>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (index, bit) in bits.enumerate() {
        if index % 8 == 0 {
            bytes.push(0);
        }
        if let (true, Some(byte)) = (bit, bytes.last_mut()) {
            *byte |= 1 << (index % 8);
        }
    }
    bytes
}

/// A value of the metadata.
enum Value<'t> {
    Text(&'t str),
    Switch(bool),
    Count(i64),
    Place([i32; 3]),
}

struct Bytes(Vec<u8>);

impl Bytes {
    fn put(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn number(&mut self, number: u32) {
        self.put(&number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.number(u32::try_from(text.len()).unwrap_or(0));
        self.put(text.as_bytes());
    }

    fn metadata(&mut self, entries: &[(&str, Value<'_>)]) {
        self.number(u32::try_from(entries.len()).unwrap_or(0));
        for (name, value) in entries {
            self.text(name);
            match value {
                Value::Text(text) => {
                    self.text("string");
                    self.text(text);
                }
                Value::Switch(on) => {
                    self.text("bool");
                    self.number(1);
                    self.put(&[u8::from(*on)]);
                }
                Value::Count(count) => {
                    self.text("int64");
                    self.number(8);
                    self.put(&count.to_le_bytes());
                }
                Value::Place(place) => {
                    self.text("vec3i");
                    self.number(12);
                    place.iter().for_each(|part| self.put(&part.to_le_bytes()));
                }
            }
        }
    }

    /// Values of a node, zipped, or as they are where that is shorter.
    fn values(&mut self, values: &[f32], is_half: bool) -> io::Result<()> {
        self.put(&[ALL_VALUES]);
        let plain: Vec<u8> = if is_half {
            values.iter().flat_map(|value| f16::from_f32(*value).to_le_bytes()).collect()
        } else {
            values.iter().flat_map(|value| value.to_le_bytes()).collect()
        };
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&plain)?;
        let zipped = encoder.finish()?;
        let length = |bytes: &[u8]| i64::try_from(bytes.len()).unwrap_or(0);
        if zipped.len() < plain.len() {
            self.put(&length(&zipped).to_le_bytes());
            self.put(&zipped);
        } else {
            self.put(&(-length(&plain)).to_le_bytes());
            self.put(&plain);
        }
        Ok(())
    }
}
