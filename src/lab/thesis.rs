//! Table 4.1 of Koblížek's thesis (2019), measured again.
//!
//! The thesis renders a 2048×1024 texture of the upper hemisphere on a graphics card of 2013 (GT 755M), one sixteenth a
//! frame; so do the cases here: 131,072 rays. Milliseconds of different machines do not compare; what does is how cost
//! grows with coverage and from type to type, so each table is also divided by its first row.

use super::bench::{Case, Row};
use super::table::{Cell, Table};
use crate::plan::Forced;
use crate::scene::{
    CloudLayer, DensityModel, MapLayer, Phase, PhaseKind, Projection, Quality, QualityLevel, Scene, UpdateFraction,
};

/// Width and height of the sky texture of the thesis.
pub const SIZE: [u32; 2] = [2048, 1024];

/// One row of table 4.1, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// The cloud type.
    pub cloud: &'static str,
    /// Coverage, 0 to 1.
    pub coverage: f32,
    /// Update speed: the march of one sixteenth.
    pub update_ms: f64,
    /// Total speed: with cloud map, reprojection and sunshafts.
    pub total_ms: f64,
}

const fn published(cloud: &'static str, coverage: f32, update_ms: f64, total_ms: f64) -> Published {
    Published { cloud, coverage, update_ms, total_ms }
}

/// Table 4.1.
pub const PUBLISHED: [Published; 9] = [
    published("stratus", 0.3, 2.05, 4.15),
    published("stratus", 0.5, 2.81, 4.91),
    published("stratus", 1.0, 3.98, 6.08),
    published("stratocumulus", 0.3, 3.02, 5.12),
    published("stratocumulus", 0.5, 3.86, 5.96),
    published("stratocumulus", 1.0, 4.69, 6.79),
    published("cumulus", 0.3, 3.34, 5.44),
    published("cumulus", 0.5, 5.45, 7.55),
    published("cumulus", 1.0, 6.31, 8.41),
];

/// The passes that the thesis counts, under its own headings.
const MARCH: &str = "march";
const CLOUD_MAP: &str = "weather_map";
const REPROJECTION: &str = "temporal";
const SUNSHAFTS: &str = "sunshafts";

/// Whose settings a table is measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Settings {
    /// The thesis's own model: 64 × 6 steps, four-channel noise, 500 to 2000 m, g 0.7.
    Thesis,
    /// The defaults of this program.
    Defaults,
}

impl Settings {
    fn title(self) -> &'static str {
        match self {
            Self::Thesis => "The thesis's model, 64 × 6 steps",
            Self::Defaults => "The program's defaults",
        }
    }
}

/// The nine cases of the table.
pub fn cases(settings: Settings) -> Vec<Case> {
    PUBLISHED
        .iter()
        .map(|row| {
            let (scene, quality) = (scene(settings, row), quality(settings));
            Case {
                name: format!("{} {}", row.cloud, row.coverage),
                scene,
                quality,
                size: SIZE,
                forced: Forced::default(),
            }
        })
        .collect()
}

fn scene(settings: Settings, row: &Published) -> Scene {
    let mut scene = Scene::default();
    let weight = |cloud| f32::from(u8::from(row.cloud == cloud));
    let [cumulus, stratus, stratocumulus] = ["cumulus", "stratus", "stratocumulus"].map(weight);
    scene.weather.layers = vec![MapLayer { cumulus, stratus, stratocumulus, ..MapLayer::default() }];
    scene.weather.coverage = row.coverage;
    scene.sunshafts.strength = 1.0;
    scene.camera.projection = Projection::Dome;
    scene.camera.pitch_deg = 0.0;
    if settings == Settings::Thesis {
        scene.layers = vec![CloudLayer {
            model: DensityModel::Thesis,
            base_m: 500.0,
            top_m: 2000.0,
            // Each sample reads the map and two 3D textures (section 3.1); the curl noise would be a third.
            curl_m: 0.0,
            // The thesis states no coefficient. This one is a choice: at the 0.08 of this program's own clouds most rays
            // are opaque after a few steps, and cost falls with coverage.
            scattering_per_m: 0.02,
            shadow_extinction_scale: 0.4,
            phase: Phase { kind: PhaseKind::HenyeyGreenstein, g: 0.7, ..Phase::default() },
            ..CloudLayer::default()
        }];
    }
    scene
}

/// The thesis takes 64 equal steps through the layer. Steps here grow with distance instead; these lengths take 46
/// through the layer overhead and 64 or more from 10° above the horizon down.
fn quality(settings: Settings) -> Quality {
    let defaults = Quality { update: UpdateFraction::Sixteenth, ..Quality::level(QualityLevel::Preview) };
    match settings {
        Settings::Defaults => defaults,
        Settings::Thesis => Quality {
            view_steps: 64,
            step_m: 12.0,
            step_growth: 0.018,
            step_depth: 2.5,
            empty_stride: 2.0,
            // The thesis has no map of where the air is clear.
            skip_clear: false,
            light_steps: 6,
            light_reach_m: 1500.0,
            light_growth: 1.8,
            light_detail_steps: 6,
            light_share: 0.0,
            octaves: 0,
            ..defaults
        },
    }
}

/// The measured rows beside the published ones. `rows` are those of [`cases`], in order.
pub fn table(settings: Settings, rows: &[Row], source: &str) -> Table {
    let columns = [
        "type",
        "coverage",
        "update",
        "cloud map",
        "reprojection",
        "sunshafts",
        "total",
        "update / first",
        "thesis update",
        "thesis total",
        "thesis update / first",
    ];
    let title = format!("{}, 131,072 rays upwards a frame, ms ({source})", settings.title());
    let mut table = Table::new(title, &columns);
    let first = rows.first().and_then(|row| row.median(MARCH));
    for (row, published) in rows.iter().zip(PUBLISHED) {
        let passes = [MARCH, CLOUD_MAP, REPROJECTION, SUNSHAFTS].map(|pass| row.median(pass));
        let [update, map, reprojection, shafts] = passes;
        let total = update.map(|_| passes.iter().flatten().sum());
        table.rows.push(vec![
            Cell::text(published.cloud),
            Cell::Number(Some(f64::from(published.coverage)), 1),
            Cell::millis(update),
            Cell::millis(map),
            Cell::millis(reprojection),
            Cell::millis(shafts),
            Cell::millis(total),
            Cell::millis(update.zip(first).map(|(own, first)| own / first)),
            Cell::millis(Some(published.update_ms)),
            Cell::millis(Some(published.total_ms)),
            Cell::millis(Some(published.update_ms / PUBLISHED[0].update_ms)),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::super::bench::PassSamples;
    use super::*;
    use crate::scene::edit::faults;

    #[test]
    fn the_cases_are_sound_and_march_the_rays_of_the_thesis() {
        for settings in [Settings::Thesis, Settings::Defaults] {
            for case in cases(settings) {
                assert!(faults(&case.scene).is_empty() && faults(&case.quality).is_empty(), "{}", case.name);
                assert!(case.scene.problems().is_empty(), "{}", case.name);
                assert_eq!(case.quality.update, UpdateFraction::Sixteenth);
            }
        }
        assert_eq!(SIZE[0] * SIZE[1] / 16, 131_072);
    }

    #[test]
    fn totals_and_ratios_add_up() {
        let row = |march: f64| Row {
            each_frame: vec![
                PassSamples { pass: MARCH, millis: vec![march] },
                PassSamples { pass: CLOUD_MAP, millis: vec![0.5] },
            ],
            ..Row::default()
        };
        let rows: Vec<Row> = (1..=9).map(|index| row(f64::from(index))).collect();
        let table = table(Settings::Thesis, &rows, "GPU timestamps");
        assert_eq!(table.rows.len(), 9);
        assert_eq!(table.rows[8][6], Cell::millis(Some(9.5)), "march and map");
        assert_eq!(table.rows[8][7], Cell::millis(Some(9.0)), "nine times the first");
        assert_eq!(table.rows[8][5], Cell::millis(None), "no shafts were measured");
    }

    #[test]
    fn the_published_totals_are_update_map_reprojection_and_shafts() {
        for row in PUBLISHED {
            // Section 4.2: map 0.8 ms, reprojection 1 ms, sunshafts 0.3 ms.
            assert!((row.total_ms - row.update_ms - 2.1).abs() < 1e-9, "{row:?}");
        }
    }
}
