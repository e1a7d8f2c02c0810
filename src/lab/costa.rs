//! The sweeps of Costa, "Modeling and rendering of volumetric clouds" (2023), section 4.1, measured again.
//!
//! The dissertation renders clouds of a weather texture in a box of 2000 × 2000 × 500 m, 1500 m above the ground, from a
//! voxel texture of N × N × N/2, at 800×600, with equal steps, on an RTX 2060; it prints its times as figures without
//! numbers. What can be compared are its statements: time grows linearly with eye steps and with light steps; a texture of
//! many values costs more than one of a single cloud; the size of the grid matters little up to 256; time follows the
//! number of pixels for large pictures and hardly for small ones.

use std::path::{Path, PathBuf};

use super::bench::{Case, Row, Stats};
use super::plot::{Plot, Series};
use super::table::{Cell, Table};
use crate::plan::Forced;
use crate::scene::param::FileName;
use crate::scene::{
    Camera, CloudLayer, DensityModel, Domain, DomainKind, MapEdge, MapLayer, MapSource, Phase, PhaseKind, Quality,
    Scene, UpdateFraction, Weather, Wind,
};

const SIZE: [u32; 2] = [800, 600];
const GRID: u32 = 256;
/// Eye and light steps where a figure says nothing of them: the fewest of which the dissertation says that more change
/// little, and what a light march needs to show any shape.
const EYE: u32 = 64;
const LIGHT: u32 = 8;
/// Longest way of a ray through the box, in metres, that the eye steps divide.
const CHORD_M: f32 = 2400.0;

/// The resolutions of table 12.
pub const RESOLUTIONS: [(&str, [u32; 2]); 13] = [
    ("QVGA", [320, 240]),
    ("nHD", [640, 360]),
    ("VGA", [640, 480]),
    ("WVGA", [800, 480]),
    ("SVGA", [800, 600]),
    ("qHD", [960, 540]),
    ("XGA", [1024, 768]),
    ("HD", [1280, 720]),
    ("WXGA", [1366, 768]),
    ("HD+", [1600, 900]),
    ("FHD", [1920, 1080]),
    ("2k", [2048, 1080]),
    ("4k", [3840, 2160]),
];

/// One of the sweeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// Figure 52: eye steps, with one and with 32 light steps, of two textures.
    EyeSteps,
    /// Figure 56: light steps, with 32 and with 64 eye steps, of two textures.
    LightSteps,
    /// Figure 59: voxels across the grid.
    Grid,
    /// Figure 62: resolutions.
    Resolution,
}

impl Sweep {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::EyeSteps, Self::LightSteps, Self::Grid, Self::Resolution];

    fn title(self) -> &'static str {
        match self {
            Self::EyeSteps => "Costa, figure 52: eye steps, 800×600, grid 256",
            Self::LightSteps => "Costa, figure 56: light steps, 800×600, grid 256",
            Self::Grid => "Costa, figure 59: grid size, 800×600, 64 eye and 8 light steps",
            Self::Resolution => "Costa, figure 62: resolution, grid 256, 64 eye and 8 light steps",
        }
    }

    fn label(self) -> &'static str {
        match self {
            Self::EyeSteps => "eye steps",
            Self::LightSteps => "light steps",
            Self::Grid => "voxels across",
            Self::Resolution => "pixels",
        }
    }

    /// The name of its plot's file.
    pub fn file(self) -> &'static str {
        match self {
            Self::EyeSteps => "costa_eye_steps",
            Self::LightSteps => "costa_light_steps",
            Self::Grid => "costa_grid",
            Self::Resolution => "costa_resolution",
        }
    }

    /// Every step of the sweep: the series it belongs to, and what differs.
    fn steps(self) -> Vec<Step> {
        let plain = Step { texture: 0, eye: EYE, light: LIGHT, grid: GRID, size: SIZE };
        let mut steps = Vec::new();
        match self {
            Self::EyeSteps => {
                for (texture, light) in [(0, 1), (0, 32), (1, 1), (1, 32)] {
                    steps.extend([4, 8, 16, 32, 64, 128].map(|eye| Step { texture, eye, light, ..plain }));
                }
            }
            Self::LightSteps => {
                for (texture, eye) in [(0, 32), (0, 64), (1, 32), (1, 64)] {
                    steps.extend([1, 2, 4, 8, 16, 32, 64].map(|light| Step { texture, eye, light, ..plain }));
                }
            }
            Self::Grid => steps.extend([32, 64, 128, 256, 512].map(|grid| Step { grid, ..plain })),
            Self::Resolution => steps.extend(RESOLUTIONS.map(|(_, size)| Step { size, ..plain })),
        }
        steps
    }
}

/// One case of a sweep.
#[derive(Clone, Copy, Debug)]
struct Step {
    texture: usize,
    eye: u32,
    light: u32,
    grid: u32,
    size: [u32; 2],
}

impl Step {
    fn series(self, sweep: Sweep) -> String {
        let texture = self.texture + 1;
        match sweep {
            Sweep::EyeSteps => format!("texture {texture}, {} light", self.light),
            Sweep::LightSteps => format!("texture {texture}, {} eye", self.eye),
            Sweep::Grid | Sweep::Resolution => "texture 1".to_owned(),
        }
    }

    fn x(self, sweep: Sweep) -> f64 {
        f64::from(match sweep {
            Sweep::EyeSteps => self.eye,
            Sweep::LightSteps => self.light,
            Sweep::Grid => self.grid,
            Sweep::Resolution => self.size[0] * self.size[1],
        })
    }
}

/// The images of the two textures in a folder: one round cloud, and many.
pub fn textures(folder: &Path) -> [PathBuf; 2] {
    ["texture_1.png", "texture_2.png"].map(|name| folder.join(name))
}

/// Sides of the two textures, in pixels (table 10).
pub const TEXTURE_SIDE: u32 = 256;

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 255")]
fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// The pixels of the two textures: red, green and blue of each. The first holds one round cloud whose values are all the
/// same (figure 51a). The second stands for the one by Högfeldt, which is not ours to copy: clouds of several sizes,
/// coverages, heights and altitudes.
pub fn texture_pixels() -> [Vec<u8>; 2] {
    /// Place, radius, and coverage, height and altitude of a cloud, in 0 to 1 of the texture.
    const CLOUDS: [([f32; 3], [f32; 3]); 11] = [
        ([0.22, 0.24, 0.17], [1.0, 0.8, 0.1]),
        ([0.62, 0.18, 0.12], [0.8, 0.5, 0.3]),
        ([0.86, 0.30, 0.09], [0.6, 0.4, 0.0]),
        ([0.45, 0.42, 0.15], [0.9, 0.9, 0.0]),
        ([0.75, 0.55, 0.18], [1.0, 0.6, 0.2]),
        ([0.16, 0.58, 0.11], [0.7, 0.3, 0.5]),
        ([0.35, 0.72, 0.13], [0.9, 0.7, 0.1]),
        ([0.58, 0.84, 0.14], [1.0, 0.5, 0.0]),
        ([0.88, 0.82, 0.10], [0.8, 0.6, 0.3]),
        ([0.12, 0.88, 0.09], [0.6, 0.5, 0.1]),
        ([0.52, 0.62, 0.06], [0.5, 0.3, 0.6]),
    ];
    let depth = |x: f32, y: f32, [cx, cy, radius]: [f32; 3]| {
        let t = ((1.0 - (x - cx).hypot(y - cy) / radius) / 0.35).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let side = TEXTURE_SIDE as f32;
    let (mut one, mut many) = (Vec::new(), Vec::new());
    for row in 0..TEXTURE_SIDE {
        for column in 0..TEXTURE_SIDE {
            let (x, y) = ((column as f32 + 0.5) / side, (row as f32 + 0.5) / side);
            let inside = depth(x, y, [0.5, 0.5, 0.38]);
            one.extend([
                byte(inside),
                if inside > 0.0 { byte(0.8) } else { 0 },
                if inside > 0.0 { byte(0.1) } else { 0 },
            ]);
            let deepest = CLOUDS.iter().map(|(place, values)| (depth(x, y, *place), values));
            let (inside, [coverage, height, altitude]) =
                deepest.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, &[0.0; 3]));
            let there = f32::from(u8::from(inside > 0.0));
            many.extend([byte(inside * coverage), byte(there * height), byte(there * altitude)]);
        }
    }
    [one, many]
}

/// The cases of a sweep, with the textures at these paths.
pub fn cases(sweep: Sweep, textures: &[PathBuf; 2]) -> Vec<Case> {
    let case = |step: Step| Case {
        name: format!("{}, {} {}", step.series(sweep), step.x(sweep), sweep.label()),
        scene: scene(&textures[step.texture]),
        quality: quality(step),
        size: step.size,
        forced: Forced::default(),
    };
    sweep.steps().into_iter().map(case).collect()
}

fn scene(texture: &Path) -> Scene {
    Scene {
        layers: vec![CloudLayer {
            model: DensityModel::Texture,
            base_m: 1500.0,
            top_m: 2000.0,
            shape_size_m: 800.0,
            shape_strength: 2.0,
            detail_size_m: 160.0,
            detail_strength: 0.2,
            curl_m: 0.0,
            lean_m: 0.0,
            // The dissertation's coefficients are a user's; these let light through a cloud of its size.
            scattering_per_m: 0.05,
            phase: Phase { kind: PhaseKind::HenyeyGreenstein, g: 0.6, ..Phase::default() },
            ..CloudLayer::default()
        }],
        weather: Weather {
            coverage: 1.0,
            size_m: 2000.0,
            edge: MapEdge::Clear,
            moves: false,
            layers: vec![MapLayer {
                source: MapSource::Image,
                image: FileName(texture.display().to_string()),
                ..MapLayer::default()
            }],
            ..Weather::default()
        },
        wind: Wind { speed_mps: 0.0, rise_mps: 0.0, ..Wind::default() },
        domain: Domain {
            kind: DomainKind::Box,
            box_east_m: 0.0,
            box_south_m: 0.0,
            box_width_m: 2000.0,
            box_length_m: 2000.0,
            ..Domain::default()
        },
        camera: Camera {
            height_m: 1300.0,
            south_m: 2300.0,
            pitch_deg: 10.0,
            field_of_view_deg: 50.0,
            ..Camera::default()
        },
        ..Scene::default()
    }
}

/// Equal steps that all are taken: no early end, nothing skipped, all light steps alike over the whole way.
fn quality(step: Step) -> Quality {
    Quality {
        view_steps: step.eye,
        step_m: CHORD_M / step.eye as f32,
        step_growth: 0.0,
        step_depth: 10_000.0,
        empty_stride: 1.0,
        light_steps: step.light,
        light_growth: 1.0,
        light_detail_steps: 128,
        light_share: 0.0,
        octaves: 0,
        early_exit: 0.0,
        grid_voxels: step.grid,
        update: UpdateFraction::Full,
        ..Quality::default()
    }
}

/// The measured rows of a sweep. `cases` and `rows` are those of [`cases`], in order.
pub fn table(sweep: Sweep, (cases, rows): (&[Case], &[Row]), source: &str) -> Table {
    let columns = ["series", sweep.label(), "size", "march", "p5", "p95", "march / first", "whole frame"];
    let mut table = Table::new(format!("{}, ms ({source})", sweep.title()), &columns);
    let steps = sweep.steps();
    for ((step, case), row) in steps.iter().zip(cases).zip(rows) {
        let series = step.series(sweep);
        let first = steps.iter().zip(rows).find(|(other, _)| other.series(sweep) == series);
        let first = first.and_then(|(_, row)| row.median("march"));
        let march = row.each_frame.iter().find(|samples| samples.pass == "march");
        let stats = march.and_then(|samples| Stats::of(&samples.millis));
        table.rows.push(vec![
            Cell::text(&series),
            Cell::Number(Some(step.x(sweep)), 0),
            Cell::text(case.size_text()),
            Cell::Number(stats.map(|stats| stats.median), 1),
            Cell::Number(stats.map(|stats| stats.p5), 1),
            Cell::Number(stats.map(|stats| stats.p95), 1),
            Cell::millis(stats.zip(first).map(|(stats, first)| stats.median / first)),
            Cell::Number(Stats::of(&row.total).map(|stats| stats.median), 1),
        ]);
    }
    table
}

/// Time over whatever the sweep varies.
pub fn plot(sweep: Sweep, (cases, rows): (&[Case], &[Row]), source: &str) -> Plot {
    let mut series: Vec<Series> = Vec::new();
    for (step, (_, row)) in sweep.steps().iter().zip(cases.iter().zip(rows)) {
        let Some(march) = row.median("march") else { continue };
        let name = step.series(sweep);
        if series.last().is_none_or(|series| series.name != name) {
            series.push(Series { name, points: Vec::new(), joined: true });
        }
        if let Some(series) = series.last_mut() {
            series.points.push([step.x(sweep), march]);
        }
    }
    Plot {
        title: sweep.title().to_owned(),
        x_label: sweep.label().to_owned(),
        y_label: format!("march, ms ({source})"),
        series,
        ..Plot::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::edit::faults;

    #[test]
    fn the_cases_are_sound_and_those_of_the_dissertation() {
        let textures = textures(Path::new("folder"));
        let counts = Sweep::ALL.map(|sweep| {
            let cases = cases(sweep, &textures);
            for case in &cases {
                assert!(faults(&case.scene).is_empty() && faults(&case.quality).is_empty(), "{}", case.name);
                assert!(case.scene.problems().is_empty(), "{}: {:?}", case.name, case.scene.problems());
            }
            cases.len()
        });
        assert_eq!(counts, [24, 28, 5, 13]);
        assert_eq!(RESOLUTIONS[12].1, [3840, 2160]);
    }

    #[test]
    fn altitude_and_height_stay_in_the_box_and_clouds_are_many() {
        for (pixels, values) in texture_pixels().iter().zip([2, 20]) {
            assert_eq!(pixels.len(), 3 * (TEXTURE_SIDE * TEXTURE_SIDE) as usize);
            let texels: Vec<[u8; 3]> = pixels.chunks_exact(3).map(|texel| [texel[0], texel[1], texel[2]]).collect();
            assert!(texels.iter().all(|texel| u32::from(texel[1]) + u32::from(texel[2]) <= 255), "it stays in the box");
            let different: std::collections::BTreeSet<[u8; 2]> =
                texels.iter().map(|texel| [texel[1], texel[2]]).collect();
            assert!(different.len() >= values.min(11), "{} heights and altitudes", different.len());
        }
    }

    #[test]
    fn tables_divide_by_the_first_of_their_series() {
        let textures = textures(Path::new("folder"));
        let cases = cases(Sweep::EyeSteps, &textures);
        let row = |millis: f64| Row {
            each_frame: vec![super::super::bench::PassSamples { pass: "march", millis: vec![millis] }],
            ..Row::default()
        };
        let rows: Vec<Row> = (0..cases.len()).map(|index| row(10.0 + index as f64)).collect();
        let table = table(Sweep::EyeSteps, (&cases, &rows), "a clock");
        assert_eq!(table.rows.len(), 24);
        assert_eq!(table.rows[6][6], Cell::millis(Some(1.0)), "the first of the second series");
        assert_eq!(table.rows[7][6], Cell::millis(Some(17.0 / 16.0)));
        let plot = plot(Sweep::EyeSteps, (&cases, &rows), "a clock");
        assert_eq!((plot.series.len(), plot.series[3].points.len()), (4, 6));
    }
}
