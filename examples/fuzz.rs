//! Feeds broken files and texts to everything that reads what users pass in: `fuzz TARGET [EXECUTIONS [SEED]]`, or `fuzz all`.
//! Inputs are sound ones, and those that once did harm (`tests/fixtures/fuzz`), with bytes changed, lost, repeated and
//! joined. A panic, or an execution of more than two seconds, ends it with the input written to a file. `scripts/fuzz.sh`
//! sets the limit of memory.

use std::error::Error;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use nephoscope::export::preset::read_preset;
use nephoscope::files;
use nephoscope::images::map::decode_map_image;
use nephoscope::images::pattern::{FramePattern, parse_frame_range};
use nephoscope::images::voxels::VoxelGrid;
use nephoscope::scene::builtin::BUILTINS;
use nephoscope::scene::param::Choice as _;
use nephoscope::scene::preset::{quality_from_ron, quality_to_ron};
use nephoscope::scene::random::Stream;
use nephoscope::scene::{Preset, Quality, QualityLevel, Scene, edit};

/// Longest execution.
const LONGEST: Duration = Duration::from_secs(2);
/// Inputs do not grow beyond this.
const LARGEST: usize = 1 << 16;

/// What is fed, the sound inputs it starts from, and words that its grammar knows.
struct Target {
    name: &'static str,
    seeds: Vec<Vec<u8>>,
    words: &'static [&'static str],
    run: fn(&[u8], &Path),
}

const RON: &[&str] = &[
    "(",
    ")",
    "[",
    "]",
    ",",
    ":",
    "scene:",
    "layers:",
    "version: 1",
    "version: 2",
    "version: 99",
    "NaN",
    "inf",
    "-inf",
    "1e39",
    "-1",
    "1e-45",
    "true",
    "None",
    "Some(",
    "\"",
    "\\u{0}",
    "r#\"",
    "/*",
    "*/",
    "//",
    "#![enable(implicit_some)]",
    "\n",
];
const EDIT: &[&str] = &[
    "layers.0.",
    "layers.4.",
    "layers.18446744073709551616.",
    "quality.",
    "weather.",
    ".",
    "=",
    "==",
    "NaN",
    "inf",
    "1e39",
    "(1,2,3)",
    "coverage",
    "base_m",
    "Box",
    "true",
    " ",
    "\t",
    "é",
];
const BINARY: &[&str] = &[
    "\u{0}\u{0}\u{0}\u{0}",
    "(0, 0, 0)",
    "(4294967295, 4294967295, 4294967295)",
    "<f4",
    ">f8",
    "True",
    "IDAT",
    "tEXt",
    "VOL",
];

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Writes an input where a reader of files finds it.
fn as_file(bytes: &[u8], folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap_or_else(|error| panic!("{} cannot be written: {error}", path.display()));
    path
}

fn feed_preset(bytes: &[u8], _: &Path) {
    if let Ok(preset) = Preset::from_ron(&text(bytes), "fuzz.ron") {
        let again = Preset::from_ron(&preset.to_ron(), "again.ron");
        assert!(again.is_ok_and(|again| again == preset), "what was read is written and read again");
    }
}

fn feed_quality(bytes: &[u8], _: &Path) {
    let _ = quality_from_ron(&text(bytes), "fuzz.ron");
}

fn feed_edit(bytes: &[u8], _: &Path) {
    let (mut scene, mut quality) = (Scene::default(), Quality::default());
    if edit::apply(&[text(bytes)], &mut scene, &mut quality).is_ok() {
        assert!(edit::faults(&scene).is_empty() && scene.problems().is_empty(), "an edit keeps all rules");
    }
}

fn feed_names(bytes: &[u8], _: &Path) {
    let text = text(bytes);
    let _ = parse_frame_range(&text);
    if let Ok(pattern) = FramePattern::parse(Path::new(&text)) {
        let _ = (pattern.is_sequence(), pattern.path_of(u32::MAX));
    }
}

fn feed_map(bytes: &[u8], _: &Path) {
    for name in ["map.png", "map.exr"] {
        let _ = decode_map_image(Path::new(name), bytes, 64);
    }
}

fn feed_picture(bytes: &[u8], folder: &Path) {
    let is_png = bytes.starts_with(b"\x89P");
    let _ = read_preset(&as_file(bytes, folder, if is_png { "a.png" } else { "a.exr" }));
}

fn feed_grid(bytes: &[u8], folder: &Path) {
    let is_vol = bytes.starts_with(b"VOL");
    let _ = VoxelGrid::read(&as_file(bytes, folder, if is_vol { "a.vol" } else { "a.npy" }));
}

fn feed_description(bytes: &[u8], folder: &Path) {
    let _ = files::open(&as_file(bytes, folder, "a.json"));
}

/// Sound pictures, small ones: made by the program itself.
fn pictures(folder: &Path) -> Result<[Vec<u8>; 2], Box<dyn Error>> {
    let preset = Preset::new("Fuzz", Scene::default());
    let quality = Quality::default();
    let about = files::About { preset: &preset, quality: &quality, time_secs: 0.0 };
    let (png, exr) = (folder.join("seed.png"), folder.join("seed.exr"));
    files::save_png(&png, [4, 4], &[128; 64], &about)?;
    let image = nephoscope::render::LinearImage {
        size: [4, 4],
        rgba: vec![[0.5; 4]; 16],
        distance_m: vec![1.0; 16],
        candela_per_unit: 1.0,
    };
    files::save_exr(&exr, image, &about, nephoscope::export::exr::ExrOptions::default())?;
    Ok([fs::read(png)?, fs::read(exr)?])
}

fn targets(folder: &Path) -> Result<Vec<Target>, Box<dyn Error>> {
    let presets: Vec<Vec<u8>> = BUILTINS.iter().map(|builtin| builtin.ron.into()).collect();
    let qualities: Vec<Vec<u8>> =
        QualityLevel::ALL.iter().map(|level| quality_to_ron(&Quality::level(*level)).into()).collect();
    let [png, exr] = pictures(folder)?;
    let grid = VoxelGrid::new([3, 2, 2], vec![0.25; 12]).ok_or("a sound grid")?;
    let (mut npy, mut vol) = (Vec::new(), Vec::new());
    grid.write_npy(&mut npy)?;
    grid.write_vol([[0.0; 3], [1.0; 3]], &mut vol)?;
    fs::write(folder.join("ball.npy"), &npy)?;
    let description = br#"{"format":"nephoscope-grid 1","values":"ball.npy","box":[[0,0,0],[1,1,1]],"extinction_scale":2,"sky_radiance":[1,1,1]}"#;
    let target = |name, seeds, words, run| Target { name, seeds, words, run };
    Ok(vec![
        target("preset", presets, RON, feed_preset),
        target("quality", qualities, RON, feed_quality),
        target(
            "edit",
            ["layers.0.base_m=1200", "quality.view_steps=64", "sun.colour=(1,0.5,0.25)", "domain.kind=Box"]
                .map(|text| text.as_bytes().to_vec())
                .into(),
            EDIT,
            feed_edit,
        ),
        target(
            "names",
            ["1-100x2,7", "sky.####.exr", "a/b/##.png"].map(|text| text.as_bytes().to_vec()).into(),
            &["#", "-", "x", ",", "4294967295", "0", "/", "..", "%"],
            feed_names,
        ),
        target("map", vec![png.clone(), exr.clone()], BINARY, feed_map),
        target("picture", vec![png, exr], BINARY, feed_picture),
        target("grid", vec![npy, vol], BINARY, feed_grid),
        target(
            "description",
            vec![description.to_vec()],
            &["{", "}", "[", "1e400", "-1", "null", "\"", "../"],
            feed_description,
        ),
    ])
}

/// One of the inputs, changed in one to eight places.
#[allow(clippy::cast_possible_truncation, reason = "a byte")]
fn mutated(target: &Target, random: &mut Stream) -> Vec<u8> {
    let mut input = target.seeds[random.below(target.seeds.len())].clone();
    for _ in 0..=random.below(8) {
        let at = random.below(input.len() + 1);
        let longest = 1 << random.below(8);
        let end = (at + 1 + random.below(longest)).min(input.len());
        match random.below(8) {
            0 if at < input.len() => input[at] = random.below(256) as u8,
            1 if at < input.len() => input[at] ^= 1 << random.below(8),
            2 if at < input.len() => input[at] = [0, 1, 0x7f, 0x80, 0xff][random.below(5)],
            3 => input.truncate(at),
            4 if at < end => drop(input.drain(at..end)),
            5 if at < end => {
                let again = input[at..end].to_vec();
                input.splice(at..at, again);
            }
            6 => {
                let word = target.words[random.below(target.words.len())];
                input.splice(at..at, word.bytes());
            }
            _ => {
                let other = &target.seeds[random.below(target.seeds.len())];
                let from = random.below(other.len() + 1);
                input.truncate(at);
                input.extend_from_slice(&other[from..]);
            }
        }
        input.truncate(LARGEST);
    }
    input
}

fn fuzz(target: &mut Target, (executions, seed): (u64, u64), folder: &Path) -> Result<(), Box<dyn Error>> {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/fuzz").join(target.name);
    if kept.is_dir() {
        for entry in fs::read_dir(&kept)? {
            target.seeds.push(fs::read(entry?.path())?);
        }
    }
    let mut random = Stream::new(seed);
    let begun = Instant::now();
    let mut slowest = Duration::ZERO;
    let sound = target.seeds.clone().into_iter();
    let mut inputs = sound.map(Some).chain(std::iter::repeat(None));
    for _ in 0..executions {
        let input = inputs.next().flatten().unwrap_or_else(|| mutated(target, &mut random));
        let started = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.run)(&input, folder)));
        slowest = slowest.max(started.elapsed());
        if outcome.is_err() || started.elapsed() > LONGEST {
            let path = std::env::temp_dir().join(format!("fuzz_{}_{}", target.name, random.below(1 << 30)));
            fs::write(&path, &input)?;
            return Err(format!("{}: {} did harm", target.name, path.display()).into());
        }
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "{}: {executions} executions in {seconds:.0} s, the slowest {:.1} ms",
        target.name,
        slowest.as_secs_f64() * 1e3
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "all".to_owned());
    let executions = arguments.next().map_or(Ok(1_000_000), |text| text.parse())?;
    let seed = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let folder = tempfile::tempdir()?;
    let mut targets = targets(folder.path())?;
    let names: Vec<&str> = targets.iter().map(|target| target.name).collect();
    if name != "all" && !names.contains(&name.as_str()) {
        return Err(format!("there is no target {name}; there are {}, or all", names.join(", ")).into());
    }
    for target in targets.iter_mut().filter(|target| name == "all" || target.name == name) {
        fuzz(target, (executions, seed), folder.path())?;
    }
    Ok(())
}
