//! The shape of the source: imports point one way, low modules know nothing of clouds, and files stay short.
#![allow(missing_docs, reason = "tests")]

use std::fs;
use std::path::{Path, PathBuf};

/// Each module of `src/` and the modules it may import, itself left out.
const LAYERS: [(&str, &[&str]); 13] = [
    ("shader", &[]),
    ("gpu", &["shader"]),
    ("images", &[]),
    ("scene", &[]),
    ("plan", &["scene"]),
    ("render", &["plan", "scene", "gpu", "shader", "images"]),
    // Twins take the structs that shaders take.
    ("reference", &["render"]),
    ("export", &["images"]),
    ("files", &["scene", "export", "images", "plan", "render", "gpu"]),
    ("lab", &["scene", "plan", "render", "gpu", "reference", "images"]),
    // The plan, the timings, the light and the lab's results are read, never made; of the editor, what it shows and what it is
    // told.
    (
        "ui",
        &[
            "scene",
            "plan",
            "gpu",
            "lab",
            "render::meter",
            "render::probe",
            "app::action",
            "app::document",
            "app::preferences",
        ],
    ),
    ("cli", &["app", "export", "files", "gpu", "images", "lab", "plan", "render", "scene", "shader", "ui"]),
    ("app", &["export", "files", "gpu", "images", "lab", "plan", "render", "scene", "shader", "ui"]),
];

const LONGEST_FILE: usize = 600;

fn root(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)
}

/// All files below a folder with one of the endings: path relative to the crate, and text.
fn files(folder: &str, endings: &[&str]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut folders = vec![root(folder)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("the folder can be listed") {
            let path = entry.expect("the entry can be read").path();
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
            if path.is_dir() {
                folders.push(path);
            } else if endings.contains(&ending) {
                let text = fs::read_to_string(&path).expect("source is text");
                let name = path.strip_prefix(root("")).expect("it lies in the crate").display().to_string();
                found.push((name, text));
            }
        }
    }
    found.sort();
    found
}

/// The lines that ship: without comments, and without the tests at the end of the file.
fn shipped(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let tests = text.find("#[cfg(test)]\nmod ").unwrap_or(text.len());
    text[..tests].lines().enumerate().map(|(index, line)| (index + 1, line.split("//").next().unwrap_or_default()))
}

/// The paths in this crate that a line names, without the leading `crate::`.
fn imports(line: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for (at, prefix) in line.match_indices("crate::") {
        let rest = &line[at + prefix.len()..];
        let group = rest.strip_prefix('{').map(|group| group.split('}').next().unwrap_or_default());
        for path in group.map_or_else(|| vec![rest], |group| group.split(',').map(str::trim).collect()) {
            let end = path.find(|c: char| !c.is_alphanumeric() && !"_:".contains(c)).unwrap_or(path.len());
            // Macros are exported at the top and belong to nobody.
            if !path[end..].starts_with('!') {
                found.push(&path[..end]);
            }
        }
    }
    found
}

/// Whether a path leads into one of the modules.
fn leads_into(path: &str, module: &str) -> bool {
    path.strip_prefix(module).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
}

#[test]
fn imports_point_one_way() {
    let modules: Vec<&str> = LAYERS.iter().map(|(module, _)| *module).collect();
    let mut failures = Vec::new();
    for (path, text) in files("src", &["rs"]) {
        let place: Vec<&str> = path.split('/').collect();
        if place.len() < 3 {
            continue;
        }
        let Some((module, allowed)) = LAYERS.iter().find(|(module, _)| *module == place[1]) else {
            failures.push(format!("{path}: no layer is stated for {}; add it to tests/layering.rs", place[1]));
            continue;
        };
        // A file of tests may look anywhere.
        if place.last() == Some(&"tests.rs") {
            continue;
        }
        for (number, line) in shipped(&text) {
            for import in imports(line) {
                let known = modules.iter().any(|known| known != module && leads_into(import, known));
                if known && !allowed.iter().any(|allowed| leads_into(import, allowed)) {
                    failures.push(format!("{path}:{number}: {module} must not import {import}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn no_two_modules_import_each_other() {
    for (module, allowed) in LAYERS {
        for (other, theirs) in LAYERS {
            assert!(!(allowed.contains(&other) && theirs.contains(&module)), "{module} and {other} import each other");
        }
    }
}

#[test]
fn what_the_panels_share_with_the_editor_knows_no_panel() {
    for (path, text) in files("src/app", &["rs"]) {
        if path.ends_with("action.rs") || path.ends_with("document.rs") {
            let looks_up = shipped(&text).any(|(_, line)| imports(line).iter().any(|import| leads_into(import, "ui")));
            assert!(!looks_up, "{path} must not import ui");
        }
    }
}

#[test]
fn the_test_sees_what_it_looks_for() {
    assert_eq!(imports("use crate::{choices, gpu::Gpu};"), ["choices", "gpu::Gpu"]);
    assert_eq!(imports("    crate::render::Renderer::new()"), ["render::Renderer::new"]);
    assert_eq!(imports("crate::params! {"), Vec::<&str>::new());
    assert!(leads_into("gpu::Gpu", "gpu") && !leads_into("gpu_struct", "gpu"), "whole names are compared");
    assert_eq!(shipped("use a; // crate::b\n#[cfg(test)]\nmod tests { crate::c }").count(), 1, "tests do not ship");
}

#[test]
fn device_and_composer_never_mention_clouds() {
    let mut failures = Vec::new();
    for folder in ["src/gpu", "src/shader"] {
        for (path, text) in files(folder, &["rs"]) {
            // The table of embedded files names files.
            for (number, line) in shipped(&text).filter(|_| !path.ends_with("embedded.rs")) {
                if ["cloud", "weather"].iter().any(|word| line.to_lowercase().contains(word)) {
                    failures.push(format!("{path}:{number}: {}", line.trim()));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn only_passes_and_tests_bind() {
    let mut failures = Vec::new();
    for (path, text) in files("shaders", &["wgsl"]) {
        if path.starts_with("shaders/pass/") || path.starts_with("shaders/test/") {
            continue;
        }
        for (number, line) in shipped(&text) {
            if line.contains("@group") || line.contains("@compute") {
                failures.push(format!("{path}:{number}: bindings and entry points belong into shaders/pass/"));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn no_file_is_too_long() {
    let folders = [("src", "rs"), ("tests", "rs"), ("examples", "rs"), ("shaders", "wgsl")];
    let all = folders.into_iter().flat_map(|(folder, ending)| files(folder, &[ending]));
    let long: Vec<String> = all
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|(_, lines)| *lines > LONGEST_FILE)
        .map(|(path, lines)| format!("{path} has {lines} lines; the most is {LONGEST_FILE}"))
        .collect();
    assert!(long.is_empty(), "{}", long.join("\n"));
}
