//! The presets there are to choose from, and their pictures.

use std::path::{Path, PathBuf};

use crate::export::png::{PngPixels, write_png};
use crate::images::sha256_hex;
use crate::scene::Preset;
use crate::scene::builtin::BUILTINS;
use crate::ui::{Entry, Library, Thumbnail};

/// Longest side of a picture that is kept of a preset.
const LONGEST_PX: u32 = 256;

/// Lists the built-in presets and those in the user's folder; files that are no presets are left out.
pub(super) fn library(folder: &Path, pictures: &Path) -> Library {
    let builtin = BUILTINS.iter().filter_map(|builtin| {
        let preset = builtin.preset().ok()?;
        Some(Entry {
            name: preset.name,
            description: preset.description,
            tags: preset.tags,
            source: builtin.name.into(),
            is_builtin: true,
            thumbnail: Some(Thumbnail::Within(builtin.picture)),
        })
    });
    let mut user: Vec<Entry> = Vec::new();
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = file.path();
        if path.extension().is_some_and(|ending| ending == "ron")
            && let Ok(preset) = Preset::load(&path)
        {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = if preset.name.is_empty() { stem } else { preset.name };
            let picture = picture_of(pictures, &path).filter(|picture| picture.is_file());
            user.push(Entry {
                name,
                description: preset.description,
                tags: preset.tags,
                source: path,
                is_builtin: false,
                thumbnail: picture.map(Thumbnail::File),
            });
        }
    }
    user.sort_by(|one, other| one.name.cmp(&other.name));
    Library::of(builtin.collect(), user, folder.to_owned())
}

/// Where the picture of a preset's file lies: by what the file holds, so that it is never that of another sky.
fn picture_of(pictures: &Path, preset: &Path) -> Option<PathBuf> {
    let text = std::fs::read(preset).ok()?;
    Some(pictures.join(format!("{}.png", &sha256_hex(&text)[..24])))
}

/// Keeps a picture of a preset, made smaller, and says where. Whoever has no picture sees a name.
pub(super) fn keep_picture(pictures: &Path, preset: &Path, (size, rgba8): ([u32; 2], &[u8])) -> Option<PathBuf> {
    let path = picture_of(pictures, preset)?;
    let (small, pixels) = shrunk(size, rgba8);
    // Without it the list shows the name alone.
    std::fs::create_dir_all(pictures).ok().filter(|()| !pixels.is_empty())?;
    write_png(&path, small, PngPixels::Rgb8(&pixels), &[]).ok()?;
    Some(path)
}

/// The picture with its longest side at most [`LONGEST_PX`], each pixel the mean of those it covers.
fn shrunk([width, height]: [u32; 2], rgba8: &[u8]) -> ([u32; 2], Vec<u8>) {
    if width == 0 || height == 0 || rgba8.len() < 4 * width as usize * height as usize {
        return ([0, 0], Vec::new());
    }
    let by = width.max(height).div_ceil(LONGEST_PX);
    let small = [(width / by).max(1), (height / by).max(1)];
    let mut pixels = Vec::with_capacity(3 * small[0] as usize * small[1] as usize);
    for y in 0..small[1] {
        for x in 0..small[0] {
            let mut sums = [0_u32; 3];
            let mut count = 0;
            for (v, u) in (y * by..((y + 1) * by).min(height))
                .flat_map(|v| (x * by..((x + 1) * by).min(width)).map(move |u| (v, u)))
            {
                let at = 4 * (v as usize * width as usize + u as usize);
                for (sum, value) in sums.iter_mut().zip(&rgba8[at..]) {
                    *sum += u32::from(*value);
                }
                count += 1;
            }
            pixels.extend(sums.map(|sum| u8::try_from(sum / count.max(1)).unwrap_or(u8::MAX)));
        }
    }
    (small, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_picture_belongs_to_what_the_file_holds() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let pictures = folder.path().join("pictures");
        let preset = folder.path().join("mine.ron");
        Preset::new("Mine", crate::scene::Scene::default()).save(&preset).expect("saved");
        let grey = [90_u8, 100, 110, 255].repeat(600 * 300);
        let kept = keep_picture(&pictures, &preset, ([600, 300], &grey));
        assert!(kept.is_some_and(|path| path.is_file()), "it is there");
        let entries = library(folder.path(), &pictures).user;
        assert!(matches!(entries[0].thumbnail, Some(Thumbnail::File(_))), "{entries:?}");
        assert_eq!(shrunk([600, 300], &grey), ([200, 100], [90, 100, 110].repeat(200 * 100)));
        assert_eq!(shrunk([600, 300], &grey[1..]), ([0, 0], vec![]), "too few pixels");
        Preset::new("Another", crate::scene::Scene::default()).save(&preset).expect("saved");
        assert!(library(folder.path(), &pictures).user[0].thumbnail.is_none(), "another sky");
    }
}
