//! The program as a user meets it: exit codes, streams and messages.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_nephoscope");

/// A program in a folder of its own, on the software driver and without a display.
fn command(program: &str, folder: &TempDir) -> Command {
    let mut command = Command::new(program);
    command
        .current_dir(folder.path())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env("NEPHOSCOPE_ADAPTER", "llvmpipe")
        .env("NO_COLOR", "1");
    command
}

fn nephoscope(folder: &TempDir, args: &[&str]) -> Output {
    command(PROGRAM, folder).args(args).output().expect("the program starts")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs, and expects this exit code, all these words on stderr, nothing on stdout and no panic.
#[track_caller]
fn refuses(folder: &TempDir, args: &[&str], code: i32, words: &[&str]) {
    let output = nephoscope(folder, args);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {message}");
    assert!(!message.contains("panicked"), "{args:?}: {message}");
    for word in words {
        // clap wraps lines to the terminal's width.
        let joined = message.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(joined.contains(word), "{args:?} should say {word:?}: {message}");
    }
    assert_eq!(stdout(&output), "", "{args:?}: errors do not belong on stdout");
}

fn write(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).expect("a file in a temporary folder");
}

const TINY: [&str; 4] = ["--size", "64x36", "--quality", "draft"];

fn render<'a>(scene: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", scene, "-o", output][..], &TINY, more].concat()
}

#[test]
fn bad_presets_are_refused_with_place_parameter_and_range() {
    let folder = folder();
    for (name, text, words) in [
        ("broken.ron", "(version: 2,\n scene: (sun: (disc: true)", &["broken.ron:2:27:", "end of the file"][..]),
        ("type.ron", "(version: 2, scene: (sun: (disc: 5)))", &["type.ron:1:34:", "sun.disc", "true or false"]),
        (
            "nan.ron",
            "(version: 2, scene: (layers: [(base_m: NaN)]))",
            &["nan.ron:1:40:", "layers.0.base_m = NaN", "15000 m"],
        ),
        (
            "range.ron",
            "(version: 2, scene: (layers: [(base_m: -5)]))",
            &["layers.0.base_m = -5 m is outside 0 m ..= 15000 m"],
        ),
        (
            "field.ron",
            "(version: 2, scene: (sun: (elevaton_deg: 5)))",
            &["1:28:", "sun.elevaton_deg", "did you mean elevation_deg?"],
        ),
        ("newer.ron", "(version: 99)", &["version 99 is newer than this program"]),
        (
            "rule.ron",
            "(version: 2, scene: (layers: [(top_m: 20)]))",
            &["rule.ron:1:39:", "layers.0.top_m = 20 m lies below"],
        ),
    ] {
        write(&folder, name, text);
        refuses(&folder, &render(name, "a.png", &[]), 4, words);
        refuses(&folder, &["presets", "validate", name], 4, words);
    }
    assert!(!folder.path().join("a.png").exists(), "nothing was written");
}

#[test]
fn missing_and_foreign_files_are_refused() {
    let folder = folder();
    refuses(&folder, &render("nowhere.ron", "a.png", &[]), 4, &["nowhere.ron", "no such file"]);
    refuses(&folder, &["verify", "nowhere.ron"], 4, &["nowhere.ron", "no such file"]);
    refuses(&folder, &render("fair_wether", "a.png", &[]), 4, &["did you mean fair_weather?", "presets list"]);
    std::fs::write(folder.path().join("bytes.ron"), [0_u8, 255, 254]).expect("written");
    refuses(&folder, &render("bytes.ron", "a.png", &[]), 4, &["bytes.ron", "not a text file"]);
    write(&folder, "text.exr", "this is no picture");
    refuses(&folder, &render("text.exr", "a.png", &[]), 4, &["text.exr", "neither an OpenEXR nor a PNG"]);
    let bare = folder.path().join("bare.exr");
    let image = nephoscope::images::FloatImage { width: 2, height: 2, rgba: vec![[0.5; 4]; 4], ..Default::default() };
    let (metadata, options) = (nephoscope::export::exr::ExrMetadata::default(), Default::default());
    nephoscope::export::exr::write_exr(&bare, &image, &metadata, options).expect("written");
    refuses(&folder, &render("bare.exr", "a.png", &[]), 4, &["bare.exr", "holds no sky"]);
}

#[test]
fn a_missing_map_is_named() {
    let folder = folder();
    let text = "(version: 2, scene: (weather: (layers: [(source: Image, image: \"gone.png\")])))";
    write(&folder, "map.ron", text);
    refuses(&folder, &render("map.ron", "a.png", &[]), 4, &["weather.layers.0.image", "gone.png"]);
    assert!(!folder.path().join("a.png").exists(), "nothing was written");
}

#[test]
fn unwritable_outputs_are_refused_at_once() {
    let folder = folder();
    refuses(&folder, &render("thesis", "none/a.png", &[]), 4, &["none/a.png", "no folder none"]);
    std::fs::create_dir(folder.path().join("a.png")).expect("made");
    refuses(&folder, &render("thesis", "a.png", &[]), 4, &["a.png", "a folder or a device"]);
    #[cfg(target_os = "linux")]
    refuses(&folder, &render("thesis", "/dev/full", &[]), 4, &["/dev/full", "a folder or a device"]);
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_standard_output_is_an_error() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("Linux has it");
    let output = Command::new(env!("CARGO_BIN_EXE_nephoscope"))
        .args(["presets", "list"])
        .stdout(full)
        .output()
        .expect("the program starts");
    assert_eq!(output.status.code(), Some(4));
    assert!(stderr(&output).contains("standard output"), "{}", stderr(&output));
}

#[test]
fn wrong_usage_ends_with_2() {
    let folder = folder();
    for (args, words) in [
        (&["render"][..], &["Usage"][..]),
        (&["render", "thesis", "-o", "a.png", "--size", "64"], &["WIDTHxHEIGHT"]),
        (&["render", "thesis", "-o", "a.png", "--size", "0x9"], &["WIDTHxHEIGHT"]),
        (&["render", "thesis", "-o", "a.jpg"], &["a.jpg", ".png", ".exr"]),
        (&["render", "thesis", "-o", "a.png", "--time", "NaN"], &["finite"]),
        (&["render", "thesis", "-o", "a.png", "--set", "nothing"], &["key=value"]),
        (
            &["render", "thesis", "-o", "a.png", "--set", "wether.coverage=1"],
            &["wether.coverage", "did you mean weather.coverage"],
        ),
        (
            &["render", "thesis", "-o", "a.png", "--set", "weather.coverage=2"],
            &["weather.coverage = 2 is outside 0 ..= 1"],
        ),
        (&["render", "thesis", "-o", "a.png", "--set", "quality.view_steps=x"], &["whole number"]),
        (&["render", "thesis", "-o", "a.png", "--camera", "1,2"], &["east,height,south"]),
        (&["render", "thesis", "-o", "a.png", "--camera", "0,-9,0,0,0"], &["camera.height_m = -9 m is outside"]),
        (&["render", "thesis", "-o", "a.png", "--quality", "best"], &["draft, preview, high or final"]),
        (&["render", "thesis", "-o", "a.png", "--frames", "1-3"], &["####"]),
        (&["render", "thesis", "-o", "a.####.png"], &["--frames"]),
        (&["render", "thesis", "-o", "a.####.png", "--frames", "3-1"], &["3-1"]),
        (&["render", "thesis", "-o", "a.png", "--clouds-only"], &[".exr"]),
        (&["render", "thesis", "-o", "a.png", "--depth", "half"], &[".exr"]),
        (&["bench", "--flight", "--suite", "thesis"], &["cannot be used with"]),
        (&["verify", "--fully"], &["unexpected argument '--fully'"]),
        (&["frobnicate", "x", "y"], &[]),
    ] {
        refuses(&folder, args, 2, words);
    }
    assert!(std::fs::read_dir(folder.path()).expect("listed").next().is_none(), "nothing was written");
}

#[test]
fn an_unknown_adapter_ends_with_3() {
    let folder = folder();
    refuses(&folder, &render("thesis", "a.png", &["--adapter", "No Such Card"]), 3, &["No Such Card", "llvmpipe"]);
    refuses(&folder, &["info", "--adapter", "No Such Card"], 3, &["no usable graphics adapter"]);
}

#[test]
fn presets_are_listed_shown_and_validated() {
    let folder = folder();
    let list = nephoscope(&folder, &["presets", "list"]);
    assert!(list.status.success(), "{}", stderr(&list));
    assert!(stdout(&list).lines().count() >= 10 && stdout(&list).starts_with("fair_weather"), "{}", stdout(&list));
    let shown = nephoscope(&folder, &["presets", "show", "moonlit"]);
    write(&folder, "copy.ron", &stdout(&shown));
    let valid = nephoscope(&folder, &["presets", "validate", "copy.ron"]);
    assert_eq!((valid.status.code(), stdout(&valid).as_str()), (Some(0), "copy.ron: Moonlit night is sound\n"));
}

#[test]
fn info_describes_the_machine() {
    let folder = folder();
    let text = nephoscope(&folder, &["info"]);
    assert!(stdout(&text).contains("serialised host time") && stdout(&text).contains("llvmpipe"), "{}", stdout(&text));
    let json = nephoscope(&folder, &["info", "--json"]);
    assert!(stdout(&json).starts_with("{\"version\":"), "{}", stdout(&json));
    let parameters = nephoscope(&folder, &["info", "--parameters"]);
    assert!(stdout(&parameters).contains("`layers.0.base_m`"), "the reference is printed");
}

/// Width and height of a PNG.
fn png_size(path: &Path) -> [u32; 2] {
    let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    [image.width(), image.height()]
}

fn renders(folder: &TempDir, args: &[&str]) -> Output {
    let output = nephoscope(folder, args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    output
}

#[test]
fn a_picture_is_written_and_its_sky_comes_back() {
    let folder = folder();
    let output = renders(&folder, &render("stratus", "a.exr", &["--set", "weather.coverage=0.625", "--json"]));
    assert!(stdout(&output).starts_with("{\"path\":\"a.exr\",\"width\":64,\"height\":36,"), "{}", stdout(&output));
    let again = renders(&folder, &["presets", "show", "a.exr"]);
    assert!(stdout(&again).contains("coverage: 0.625"), "{}", stdout(&again));
    renders(&folder, &render("a.exr", "b.png", &[]));
    assert_eq!(png_size(&folder.path().join("b.png")), [64, 36]);
    let panorama =
        ["render", "a.exr", "-o", "c.png", "--size", "32x16", "--projection", "equirect", "--quality", "draft"];
    renders(&folder, &panorama);
    assert_eq!(png_size(&folder.path().join("c.png")), [32, 16]);
}

#[test]
fn sequences_go_on_where_they_stopped() {
    let folder = folder();
    let frame = |number: u32| -> PathBuf { folder.path().join(format!("f.{number:04}.png")) };
    std::fs::write(frame(3), "kept").expect("written");
    let args = ["--frames", "1-5x2", "--fps", "10"];
    let output = renders(&folder, &render("clear_puffs", "f.####.png", &args));
    assert_eq!(stdout(&output).lines().count(), 2, "{}", stdout(&output));
    assert!(stderr(&output).contains("f.0003.png exists and is kept"), "{}", stderr(&output));
    assert_eq!(std::fs::read(frame(3)).expect("still there"), b"kept");
    assert_eq!([png_size(&frame(1)), png_size(&frame(5))], [[64, 36]; 2]);
    renders(&folder, &render("clear_puffs", "f.####.png", &["--frames", "3", "--overwrite"]));
    assert_eq!(png_size(&frame(3)), [64, 36], "--overwrite renders it");
}

/// The pictures in a folder, each of which has to be whole; and how many other files there are.
#[track_caller]
fn whole_pictures(folder: &TempDir) -> (usize, usize) {
    let files = std::fs::read_dir(folder.path()).expect("a folder").map(|file| file.expect("a file").path());
    let (pictures, others): (Vec<PathBuf>, Vec<PathBuf>) =
        files.partition(|file| file.extension().is_some_and(|ending| ending == "exr"));
    for picture in &pictures {
        exr::prelude::read_first_flat_layer_from_file(picture).unwrap_or_else(|error| panic!("{picture:?}: {error}"));
    }
    (pictures.len(), others.len())
}

#[test]
fn a_killed_sequence_leaves_whole_pictures_and_goes_on() {
    let folder = folder();
    let args = render("clear_puffs", "sky.####.exr", &["--frames", "1-40"]);
    let mut before = 0;
    for wanted in [1, 4, 9] {
        let mut child = command(PROGRAM, &folder).args(&args).stderr(Stdio::null()).spawn().expect("it starts");
        while before < wanted && child.try_wait().expect("it is ours").is_none() {
            before = whole_pictures(&folder).0;
        }
        // No handler runs: this is `kill -9`.
        child.kill().expect("it is ours");
        child.wait().expect("it has ended");
        let (pictures, others) = whole_pictures(&folder);
        assert!((wanted..40).contains(&pictures), "{pictures} pictures when {wanted} were wanted");
        assert!(others <= 3, "at most the one that was being written, each time");
        before = pictures;
    }
    let rest = render("clear_puffs", "sky.####.exr", &["--frames", "1-12"]);
    renders(&folder, &rest);
    assert!(whole_pictures(&folder).0 >= 12, "what is missing is made");
}

#[test]
fn a_disk_that_fills_keeps_what_was_finished_and_says_so() {
    let folder = folder();
    // A process may write files of so many KiB here, which fails as a full disk does: half way through a file.
    let limited = |kibibytes: u32, args: &[&str]| {
        let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", kibibytes * 2);
        let output = command("sh", &folder).args(["-c", &script, PROGRAM]).args(args).output();
        output.expect("a shell starts")
    };
    let sequence = ["render", "clear_puffs", "-o", "sky.####.exr", "--frames", "1-2", "--quality", "draft"];
    let small = limited(2000, &[&sequence[..], &["--size", "32x18"]].concat());
    assert!(small.status.success(), "{}", stderr(&small));
    let large = limited(40, &[&sequence[..], &["--size", "256x144", "--overwrite"]].concat());
    assert_eq!(large.status.code(), Some(4), "{}", stderr(&large));
    assert!(stderr(&large).contains("sky.0001.exr"), "{}", stderr(&large));
    assert_eq!(whole_pictures(&folder), (2, 0), "the small ones are still there, and nothing else");
}

#[test]
fn effects_are_forced_and_refused() {
    let folder = folder();
    renders(&folder, &render("thesis", "plain.png", &[]));
    renders(&folder, &render("thesis", "forced.png", &["--force", "light-march=off", "--force", "stars=on"]));
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
    assert_ne!(read("plain.png"), read("forced.png"), "the clouds are dark");
    refuses(&folder, &render("thesis", "x.png", &["--force", "starz=on"]), 2, &["--force", "stars"]);
}

#[test]
fn without_a_display_the_sky_is_rendered() {
    let folder = folder();
    let output = renders(&folder, &["--set", "camera.pitch_deg=20", "--set", "quality.resolution_scale=0.1"]);
    assert!(
        stderr(&output).contains("no display") && stdout(&output).contains("default-sky.png"),
        "{}",
        stderr(&output)
    );
    assert!(folder.path().join("out/default-sky.png").is_file(), "it is where it said");
}

#[test]
fn bench_prints_the_adapter_the_passes_and_a_banner() {
    let folder = folder();
    let args = ["bench", "--presets", "clear_puffs", "--size", "64x36", "--rounds", "1", "--frames", "1"];
    let output = renders(&folder, &[&args[..], &["--no-full"]].concat());
    for word in ["llvmpipe", "SOFTWARE ADAPTER", "serialised host time", "clear_puffs", "64×36", "total"] {
        assert!(stdout(&output).contains(word), "{word}: {}", stdout(&output));
    }
    let flight = renders(&folder, &[&args[..], &["--flight", "--csv"]].concat());
    assert!(stdout(&flight).contains("frames per second"), "{}", stdout(&flight));
}

#[test]
fn clouds_go_out_as_voxels_and_come_back() {
    let folder = folder();
    let baked = nephoscope(&folder, &["grid", "fair_weather", "--voxels", "8", "--format", "both", "-o", "cloud.json"]);
    assert_eq!(baked.status.code(), Some(0), "{}", stderr(&baked));
    assert!(stdout(&baked).contains("cloud.json, cloud.npy, cloud.vol: 8 x 4 x 8 voxels"), "{}", stdout(&baked));
    let drawn = nephoscope(&folder, &render("cloud.json", "cloud.png", &[]));
    assert_eq!(drawn.status.code(), Some(0), "{}", stderr(&drawn));

    let npy = folder.path().join("cloud.npy");
    let bytes = std::fs::read(&npy).expect("written");
    std::fs::write(&npy, &bytes[..bytes.len() - 6]).expect("written");
    refuses(&folder, &render("cloud.json", "b.png", &[]), 4, &["cloud.npy", "254 voxels", "promises 256"]);
    let mut damaged = bytes;
    let at = damaged.len() - 4;
    damaged[at..].copy_from_slice(&f32::NAN.to_le_bytes());
    std::fs::write(&npy, &damaged).expect("written");
    refuses(&folder, &render("cloud.json", "b.png", &[]), 4, &["cloud.npy", "[z][y][x] = [7][3][7]", "NaN"]);
    let set = ["--set", "domain.kind=Box", "--set", "layers.0.model=Grid"];
    let named = [&set[..], &["--set", "layers.0.grid=nowhere.npy"]].concat();
    refuses(&folder, &render("fair_weather", "b.png", &named), 4, &["layers.0.grid", "nowhere.npy", "no such file"]);
    refuses(&folder, &render("fair_weather", "b.png", &set), 4, &["layers.0.grid", "no file is named"]);
    refuses(&folder, &render("fair_weather", "b.png", &set[2..]), 2, &["domain.kind", "Box"]);
    refuses(&folder, &["grid", "fair_weather", "-o", "cloud.npy"], 2, &["cloud.npy", ".json"]);
    refuses(&folder, &["grid", "fair_weather", "--set", "weather.coverage=0", "-o", "c.json"], 2, &["coverage is 0"]);
    refuses(&folder, &["grid", "fair_weather", "--voxels", "8", "-o", "nowhere/c.json"], 4, &["no folder"]);
}

#[test]
fn clouds_go_out_as_openvdb_and_the_library_reads_the_same() {
    let folder = folder();
    let grid = |output: &str, more: &[&str]| {
        // Sides that are no multiples of a leaf, and a box that is no cube.
        let args = ["grid", "fair_weather", "-o", output, "--voxels", "52", "--set", "domain.box_width_m=9000"];
        renders(&folder, &[&args[..], more].concat());
    };
    grid("plain.json", &[]);
    for (name, up, depth, tolerance) in
        [("z.vdb", "z", "float", "0"), ("y.vdb", "y", "float", "0"), ("half.vdb", "z", "half", "0.0005")]
    {
        grid(name, &["--up", up, "--depth", depth]);
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/vdb.py");
        // Debian's package is for Debian's Python.
        let output = command("/usr/bin/python3", &folder).args([script, name, "plain.json", up, tolerance]).output();
        let output = output.expect("Debian has Python");
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        assert!(stdout(&output).contains("the same"), "{name}: {}", stdout(&output));
    }
    let size = |name: &str| std::fs::metadata(folder.path().join(name)).expect("written").len();
    assert!(size("half.vdb") < size("z.vdb") && size("z.vdb") < size("plain.npy"), "sparse and zipped");
    refuses(&folder, &["grid", "thesis", "-o", "x.obj"], 2, &["neither in .json nor in .vdb"]);
}

#[test]
fn layers_in_a_file_sum_to_its_picture() {
    let folder = folder();
    renders(&folder, &render("broken_sunset", "sky.exr", &["--layers"]));
    let image = exr::prelude::read_first_flat_layer_from_file(folder.path().join("sky.exr")).expect("an EXR");
    let channels = image.layer_data.channel_data.list;
    let values = |name: &str| {
        let channel = channels.iter().find(|channel| channel.name.to_string() == name);
        let channel = channel.unwrap_or_else(|| panic!("{name} is missing"));
        channel.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    for channel in ["R", "G", "B"] {
        let whole = values(channel);
        let suffix = format!(".{channel}");
        let parts: Vec<Vec<f32>> = channels
            .iter()
            .map(|part| part.name.to_string())
            .filter(|name| name.ends_with(&suffix))
            .map(|name| values(&name))
            .collect();
        assert!(parts.len() >= 5, "{} layers", parts.len());
        for (index, pixel) in whole.iter().enumerate() {
            let sum: f32 = parts.iter().map(|part| part[index]).sum();
            let room: f32 = parts.iter().map(|part| part[index].abs() / 1024.0 + 1e-6).sum();
            assert!((sum - pixel).abs() <= room, "pixel {index}: {sum}, not {pixel}, within half floats");
        }
    }
    assert!(values("transmittance.A").iter().all(|value| (0.0..=1.0).contains(value)));
    assert!(values("distance.X").iter().any(|value| *value > 1000.0), "clouds are far");
    refuses(&folder, &render("thesis", "x.png", &["--layers"]), 2, &["--layers needs an .exr"]);
}

#[test]
fn pictures_go_out_in_all_formats_and_shapes() {
    let folder = folder();
    let there = |name: &str| folder.path().join(name);
    renders(&folder, &render("fair_weather", "deep.png", &["--depth", "16"]));
    let bytes = std::fs::read(there("deep.png")).expect("written");
    assert_eq!((png_size(&there("deep.png")), bytes[24]), ([64, 36], 16), "16 bits");
    renders(&folder, &["presets", "validate", "deep.png"]);
    let args = ["pano", "fair_weather", "-o", "all.hdr", "--size", "64x32", "--quality", "draft"];
    renders(&folder, &args);
    assert!(std::fs::read(there("all.hdr")).expect("written").starts_with(b"#?RADIANCE"));
    // The sun, as it is and as other programs can bear it; the sky's name in the file's.
    let brightest = |name: &str, more: &[&str]| {
        let mut args = vec!["pano", "fair_weather", "-o", name, "--size", "256x128", "--quality", "draft"];
        args.extend(more);
        renders(&folder, &args);
        let light = nephoscope::images::map::read_exr(&there(&name.replace("{name}", "fair-weather"))).expect("sound");
        light.rgba.iter().map(|pixel| pixel[0].max(pixel[1]).max(pixel[2])).fold(0.0, f32::max)
    };
    let plain = brightest("{name}.exr", &[]);
    let soft = brightest("soft.exr", &["--brightest", "20"]);
    assert!(plain > 100.0 && soft > 10.0 && soft <= 20.0, "{plain} became {soft}");
    refuses(&folder, &["pano", "fair_weather", "-o", "a.exr", "--brightest", "0"], 2, &["above 0"]);
    let cube = ["--projection", "cube", "--size", "16x16", "--quality", "draft"];
    let output = renders(&folder, &[&["pano", "fair_weather", "-o", "sky.exr"][..], &cube].concat());
    assert!(stdout(&output).contains("sky.nz.exr 16x16"), "{}", stdout(&output));
    for face in ["px", "nx", "py", "ny", "pz", "nz"] {
        renders(&folder, &["presets", "validate", &format!("sky.{face}.exr")]);
    }
    let cross = ["--projection", "cross", "--size", "16x16", "--quality", "draft"];
    renders(&folder, &[&["pano", "fair_weather", "-o", "cross.png"][..], &cross].concat());
    assert_eq!(png_size(&there("cross.png")), [64, 48]);
    refuses(&folder, &render("fair_weather", "a.exr", &["--depth", "16"]), 2, &["--depth 8 and 16 are for .png"]);
    refuses(&folder, &render("fair_weather", "a.hdr", &["--layers"]), 2, &["--layers needs an .exr"]);
    let wide = ["pano", "fair_weather", "-o", "a.exr", "--projection", "cube", "--size", "32x16"];
    refuses(&folder, &wide, 2, &["a face of a cube is square"]);
}

#[test]
fn what_a_sky_is_made_from_goes_out() {
    let folder = folder();
    let export = |what: &'static str, file: &'static str| ["export", "fair_weather", "--what", what, "-o", file];
    for (what, file, size) in [
        ("weather-map", "map.png", "map.png 512x512"),
        ("detail-noise", "noise.exr", "noise.exr 32x1024"),
        ("sky-view", "sky.exr", "sky.exr 256x144"),
    ] {
        let output = renders(&folder, &export(what, file));
        assert!(stdout(&output).contains(size), "{what}: {}", stdout(&output));
    }
    refuses(&folder, &export("wether-map", "a.exr"), 2, &["did you mean weather-map?"]);
    refuses(&folder, &export("curl-noise", "a.exr"), 2, &["has no curl-noise"]);
    refuses(&folder, &export("weather-map", "a.jpg"), 2, &["neither in .exr nor in .png"]);
    refuses(&folder, &export("clear-ways", "a.png"), 4, &["a PNG holds 0 to 1"]);
}

#[test]
fn a_film_follows_the_keys_of_its_sky() {
    let folder = folder();
    let key = |time: f32, value: &str| format!("(time_secs: {time:?}, value: \"{value}\", ease: Linear)");
    let keys = format!("{}, {}", key(0.0, "-5.0"), key(2.0, "60.0"));
    let animation = format!("(duration_secs: 2.0, tracks: [(key: \"sun.elevation_deg\", keys: [{keys}])])");
    write(&folder, "dawn.ron", &format!("(version: 2, scene: (), animation: {animation})"));
    // An ffmpeg that says what it was asked for.
    let tools = folder.path().join("tools");
    std::fs::create_dir(&tools).expect("a folder");
    let script = "#!/bin/sh\n[ \"$1\" = -version ] && exit 0\nfor last; do :; done\ncat \"$9\" > \"$last\"\n";
    std::fs::write(tools.join("ffmpeg"), script).expect("written");
    let film = ["sequence", "dawn.ron", "-o", "f.##.png", "--fps", "1", "--size", "16x9", "--quality", "draft"];
    let run = |path: &Path| {
        let mut command = command(PROGRAM, &folder);
        command.args(film).args(["--video", "film.mp4"]).env("PATH", path);
        command.output().expect("the program starts")
    };
    let without = run(Path::new("/nowhere"));
    refuses(&folder, &[&film[..], &["--video", "no/film.mp4"]].concat(), 4, &["there is no folder"]);
    assert_eq!(without.status.code(), Some(2), "{}", stderr(&without));
    assert!(stderr(&without).contains("install it"), "{}", stderr(&without));
    assert!(!folder.path().join("f.00.png").exists(), "nothing is begun that cannot end");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(tools.join("ffmpeg"), mode).expect("it may run");
        let path = std::env::join_paths([tools.as_path(), Path::new("/usr/bin"), Path::new("/bin")]).expect("a path");
        let output = run(Path::new(&path));
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let list = std::fs::read_to_string(folder.path().join("film.mp4")).expect("the list of frames");
        assert!(list.contains("f.00.png") && list.contains("f.01.png") && !list.contains("f.02.png"), "{list}");
    }
    #[cfg(not(unix))]
    renders(&folder, &film);
    let brightness = |name: &str| {
        let image = image::open(folder.path().join(name)).expect("it was written").to_rgb8();
        image.pixels().map(|pixel| u64::from(pixel[1])).sum::<u64>()
    };
    assert!(brightness("f.01.png") > 2 * brightness("f.00.png"), "the sun has risen");
    // A picture opens at its own time, and what is set holds at all times.
    renders(&folder, &["render", "f.01.png", "-o", "again.png", "--size", "16x9", "--quality", "draft"]);
    let gap = brightness("again.png").abs_diff(brightness("f.01.png"));
    assert!(gap * 50 < brightness("f.01.png"), "{gap}");
    let set = ["--set", "sun.elevation_deg=60", "--time", "0"];
    renders(
        &folder,
        &[&["render", "dawn.ron", "-o", "set.png", "--size", "16x9", "--quality", "draft"], &set[..]].concat(),
    );
    assert!(brightness("set.png") > 2 * brightness("f.00.png"), "keys give way");
}

#[test]
fn a_region_keeps_its_place_in_the_whole() {
    let folder = folder();
    renders(&folder, &render("fair_weather", "part.exr", &["--region", "20x10+30+8"]));
    let image = exr::meta::MetaData::read_from_file(folder.path().join("part.exr"), false).expect("it is sound");
    let (whole, part) = (image.headers[0].shared_attributes.display_window, &image.headers[0]);
    assert_eq!((whole.size.0, whole.size.1), (64, 36), "the display window is the whole");
    assert_eq!((part.layer_size.0, part.layer_size.1), (20, 10));
    let position = part.own_attributes.layer_position;
    assert_eq!((position.0, position.1), (30, 8));
    renders(&folder, &render("fair_weather", "part.png", &["--region", "20x10+30+8"]));
    assert_eq!(png_size(&folder.path().join("part.png")), [20, 10]);
    refuses(
        &folder,
        &render("fair_weather", "a.exr", &["--region", "60x10+30+8"]),
        2,
        &["leaves the picture", "64x36"],
    );
    refuses(&folder, &render("fair_weather", "a.exr", &["--region", "60x10"]), 2, &["WIDTHxHEIGHT+LEFT+TOP"]);
}

#[test]
fn clouds_alone_have_associated_or_straight_alpha() {
    let folder = folder();
    let light = |name: &str, more: &[&'static str]| {
        renders(&folder, &render("fair_weather", name, &[&["--clouds-only", "--depth", "float"], more].concat()));
        nephoscope::images::map::read_exr(&folder.path().join(name)).expect("it is sound").rgba
    };
    let (associated, straight) = (light("clouds.exr", &[]), light("straight.exr", &["--straight"]));
    let mut thin = 0;
    for (own, over) in associated.iter().zip(&straight) {
        assert_eq!(own[3], over[3], "the same opacity");
        assert!((own[1] - over[1] * over[3]).abs() <= 1e-5 * own[1].max(1e-3), "{own:?} {over:?}");
        thin += u32::from(own[3] > 0.01 && own[3] < 0.9);
    }
    assert!(thin > 10, "only {thin} pixels tell the two apart");
    refuses(&folder, &render("fair_weather", "a.exr", &["--straight"]), 2, &["--clouds-only"]);
}

#[test]
fn skies_are_compared_with_photographs() {
    let folder = folder();
    let args = ["pano", "clear_puffs", "-o", "own.exr", "--size", "64x32", "--quality", "draft"];
    renders(&folder, &args);
    let compare = |reference: &str, more: &[&str]| {
        let mut args = vec!["compare-sky", "--reference", reference, "--quality", "draft", "--json"];
        args.extend(more);
        let out = stdout(&renders(&folder, &args));
        let line: serde_json::Value = serde_json::from_str(out.trim()).expect("a line of JSON");
        ["luminance", "red", "blue", "structures"].map(|figure| line[figure].as_f64().expect("a number"))
    };
    let own = compare("own.exr", &["clear_puffs"]);
    assert!(own.iter().all(|distance| *distance < 0.03), "a sky is like its own picture, within half floats: {own:?}");
    let other = compare("own.exr", &["stratus"]);
    assert!(other[0] > 0.2 && other[2] > 0.2, "an overcast is not: {other:?}");
    renders(&folder, &render("clear_puffs", "shown.png", &[]));
    let shown = compare("shown.png", &["clear_puffs", "--set", "camera.height_m=100"]);
    assert!(shown.iter().all(|distance| *distance < 0.2), "what the screen shows: {shown:?}");
    refuses(&folder, &["compare-sky", "--reference", "none.exr", "fair_weather"], 4, &["none.exr"]);
    std::fs::write(folder.path().join("text.png"), "no picture").expect("written");
    refuses(&folder, &["compare-sky", "--reference", "text.png", "fair_weather"], 4, &["text.png"]);
    renders(&folder, &["render", "clear_puffs", "-o", "tiny.png", "--size", "12x12", "--quality", "draft"]);
    refuses(&folder, &["compare-sky", "--reference", "tiny.png", "fair_weather"], 2, &["too small"]);
}
