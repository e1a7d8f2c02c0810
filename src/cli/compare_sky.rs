//! `compare-sky`: how like a photograph skies are, in figures.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;
use serde_json::json;

use super::error::Usage;
use super::{Device, Edits, args, print};
use crate::files;
use crate::gpu::Gpu;
use crate::images::FloatImage;
use crate::images::map::{read_picture, srgb_decoded};
use crate::lab::realism::{Distances, Realism, smaller, upper_half};
use crate::lab::table::{Cell, Table};
use crate::render::Renderer;
use crate::scene::builtin::BUILTINS;
use crate::scene::{Frame, Output, Projection, UpdateFraction};

/// Widest picture that is compared; wider ones are made smaller first.
const WIDEST_PX: u32 = 512;

#[derive(Debug, Args)]
#[command(
    after_help = "A photograph twice as wide as high is taken for a panorama, of which the upper half is the sky; skies are \
    then rendered in all directions. Any other one is compared as a whole with what the sky's own camera sees.\n\
    Distances are in stops: 0 is alike, 1 is twice the contrast, or another colour by a stop. Exposure does not matter."
)]
pub(super) struct CompareSkyArgs {
    /// The photograph: .exr or .hdr of linear light, or .png as shown.
    #[arg(long, value_name = "FILE")]
    reference: PathBuf,
    /// Skies: presets (.ron), exported pictures, or names of built-in ones; all built-in ones if none is given.
    skies: Vec<PathBuf>,
    /// Quality: draft, preview, high, final, or a .ron file.
    #[arg(long)]
    quality: Option<String>,
    /// Print one line of JSON for each sky.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    edits: Edits,
    #[command(flatten)]
    device: Device,
}

/// The photograph as it is compared.
struct Photograph {
    size: [u32; 2],
    is_panorama: bool,
    /// Whether it is what a screen shows, rather than linear light.
    is_shown: bool,
    realism: Realism,
}

impl Photograph {
    fn read(path: &Path) -> Result<Self> {
        let (image, is_shown) = read_picture(path)?;
        let is_panorama = image.width == 2 * image.height;
        let image = smaller(&image, image.width.max(image.height).div_ceil(WIDEST_PX));
        let is_panorama = is_panorama && image.width >= 2;
        let size = [image.width, image.height];
        let sky = if is_panorama { upper_half(&image) } else { image };
        let realism = Realism::of(&sky);
        if realism.structures.is_empty() {
            let said = format!("{} is too small to compare: 16 pixels a side at least, of sky", path.display());
            return Err(Usage(said).into());
        }
        Ok(Self { size, is_panorama, is_shown, realism })
    }

    /// What is measured of a sky that is rendered as the photograph was taken.
    fn measure(&self, renderer: &mut Renderer, args: &CompareSkyArgs, path: &Path) -> Result<Realism> {
        let sky = files::open(path)?;
        let mut quality = args::quality(args.quality.as_deref(), &sky)?;
        (quality.update, quality.resolution_scale) = (UpdateFraction::Full, 1.0);
        let mut preset = sky.preset;
        preset.set_all(&args.edits.sets, &mut quality)?;
        preset.play(sky.time_secs);
        if self.is_panorama {
            preset.scene.camera.projection = Projection::Equirect;
        }
        let output = if self.is_shown { Output::Display } else { Output::Linear };
        let (scene, time_secs) = (&preset.scene, sky.time_secs);
        let frame = Frame { scene, quality: &quality, size: self.size, time_secs, output, window: None };
        let failed = || format!("{} could not be rendered", path.display());
        let still = renderer.still(&frame).with_context(failed)?;
        let rgba = if self.is_shown {
            let (_, bytes) = renderer.rgba8_of(&still.into_display()).with_context(failed)?;
            let light = |byte: u8| srgb_decoded(f32::from(byte) / 255.0);
            bytes.chunks_exact(4).map(|p| [light(p[0]), light(p[1]), light(p[2]), 1.0]).collect()
        } else {
            still.picture(renderer).with_context(failed)?.image.rgba
        };
        let image = FloatImage { width: self.size[0], height: self.size[1], rgba, depth: None, crop: None };
        Ok(Realism::of(&if self.is_panorama { upper_half(&image) } else { image }))
    }
}

const COLUMNS: [&str; 9] =
    ["sky", "luminance", "red", "blue", "structures", "5 to 95 %, stops", "finest", "middle", "largest"];

pub(super) fn run(args: &CompareSkyArgs) -> Result<()> {
    let photograph = Photograph::read(&args.reference)?;
    let all = || BUILTINS.iter().map(|builtin| builtin.name.into()).collect();
    let skies: Vec<PathBuf> = if args.skies.is_empty() { all() } else { args.skies.clone() };
    let gpu = Gpu::headless(&args.device.choice())?;
    let mut renderer = Renderer::new(&gpu)?;
    let mut table = Table::new(format!("Distances from {}, in stops", args.reference.display()), &COLUMNS);
    table.rows.push(row("the photograph", None, &photograph.realism));
    for path in &skies {
        let seen = photograph.measure(&mut renderer, args, path)?;
        let distances = seen.distances(&photograph.realism);
        let name = path.display().to_string();
        if args.json {
            let Distances { luminance, red, blue, structures } = distances;
            let line = json!({
                "sky": name, "luminance": luminance, "red": red, "blue": blue, "structures": structures,
                "contrasts": seen.structures, "contrasts_of_reference": photograph.realism.structures,
            });
            print(&format!("{line}\n"))?;
        }
        table.rows.push(row(&name, Some(distances), &seen));
    }
    if args.json { Ok(()) } else { print(&table.plain()) }
}

fn row(name: &str, distances: Option<Distances>, realism: &Realism) -> Vec<Cell> {
    let far = |of: fn(Distances) -> f64| Cell::Number(distances.map(of), 2);
    let contrast = |level: usize| Cell::Number(realism.structures.get(level).copied(), 3);
    let last = realism.structures.len().saturating_sub(1);
    let spread = realism.luminance.quantile(0.95) - realism.luminance.quantile(0.05);
    vec![
        Cell::text(name),
        far(|far| far.luminance),
        far(|far| far.red),
        far(|far| far.blue),
        far(|far| far.structures),
        Cell::Number(Some(spread), 1),
        contrast(0),
        contrast(last / 2),
        contrast(last),
    ]
}
