//! Numbered image sequences: `####` in file names, frame ranges such as `1-100x2,120`, and the frames on the disk.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The most frames one range may name, so that a slip of the keyboard does not fill the disk.
pub const MAX_FRAMES: usize = 1_000_000;

/// What is wrong with a file-name pattern, a frame range or a sequence on the disk.
#[derive(Debug, thiserror::Error)]
pub enum PatternError {
    /// The path has no file name, or one that is not Unicode.
    #[error("`{0}` has no usable file name; give a path such as `sky.####.exr`")]
    NoFileName(PathBuf),
    /// More than one run of `#`.
    #[error("`{0}` has `#` in more than one place; one run, such as `sky.####.exr`, numbers the frames")]
    ManyRuns(String),
    /// A sequence was expected but the name has no `#`.
    #[error("`{0}` has no frame number; put `####` where it belongs, such as `sky.####.exr`")]
    NotASequence(PathBuf),
    /// An empty range, or an empty item between commas.
    #[error("the frame range `{0}` has an empty item; write something like `1-100x2,120`")]
    Empty(String),
    /// An item that is not a number, or too large.
    #[error(
        "`{item}` in the frame range is not understood; frames are whole numbers from 0 to {}, \
         as in `7`, `1-100` or `1-100x2`",
        u32::MAX
    )]
    NotANumber {
        /// The item between two commas.
        item: String,
    },
    /// The last frame comes before the first.
    #[error("the frame range `{item}` runs backwards; write `{last}-{first}`")]
    Backwards {
        /// The item between two commas.
        item: String,
        /// The first frame as written.
        first: u32,
        /// The last frame as written.
        last: u32,
    },
    /// A step of zero never ends.
    #[error("the frame range `{item}` has step 0; the step must be at least 1")]
    ZeroStep {
        /// The item between two commas.
        item: String,
    },
    /// More than [`MAX_FRAMES`].
    #[error("the frame range `{0}` names more than {MAX_FRAMES} frames; split the job")]
    TooMany(String),
    /// The folder of a sequence cannot be listed.
    #[error("cannot list the folder {folder}: {cause}; check the path")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The failure reported by the operating system.
        cause: io::Error,
    },
    /// Not one frame exists.
    #[error("no file matches `{0}`; check the path and the number of `#`")]
    NoFrames(PathBuf),
}

/// A file name in which one run of `#` stands for the frame number, padded with zeros to the length of the run.
/// Only the file name is looked at: `#` in a folder's name means itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    folder: PathBuf,
    before: String,
    /// Digits to pad to; 0 if the name has no frame number.
    digits: usize,
    after: String,
}

impl FramePattern {
    /// Takes `path` apart. A name without `#` is a pattern too, one for a single file.
    ///
    /// # Errors
    /// If there is no Unicode file name, or more than one run of `#`.
    pub fn parse(path: &Path) -> Result<Self, PatternError> {
        let name =
            path.file_name().and_then(|name| name.to_str()).ok_or_else(|| PatternError::NoFileName(path.to_owned()))?;
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        let Some(start) = name.find('#') else {
            return Ok(Self { folder, before: name.to_owned(), digits: 0, after: String::new() });
        };
        let digits = name[start..].bytes().take_while(|&byte| byte == b'#').count();
        let after = &name[start + digits..];
        if after.contains('#') {
            return Err(PatternError::ManyRuns(name.to_owned()));
        }
        Ok(Self { folder, before: name[..start].to_owned(), digits, after: after.to_owned() })
    }

    /// Whether the name has a place for the frame number.
    #[must_use]
    pub fn is_sequence(&self) -> bool {
        self.digits > 0
    }

    /// The file of one frame. A number longer than the run of `#` is written in full.
    #[must_use]
    pub fn path_of(&self, frame: u32) -> PathBuf {
        let Self { folder, before, digits, after } = self;
        if self.is_sequence() { folder.join(format!("{before}{frame:0digits$}{after}")) } else { folder.join(before) }
    }

    /// The frame number of a file name that [`Self::path_of`] could have made.
    fn frame_of(&self, name: &str) -> Option<u32> {
        let number = name.strip_prefix(&self.before)?.strip_suffix(&self.after)?;
        let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
        let is_padded = number.len() == self.digits || (number.len() > self.digits && !number.starts_with('0'));
        if is_number && is_padded { number.parse().ok() } else { None }
    }

    /// The frames that exist on the disk, sorted by number. Gaps are allowed; sub-folders do not count.
    ///
    /// # Errors
    /// If the name has no `#`, the folder cannot be listed, or no frame exists.
    pub fn existing_frames(&self) -> Result<Vec<(u32, PathBuf)>, PatternError> {
        if !self.is_sequence() {
            return Err(PatternError::NotASequence(self.path_of(0)));
        }
        let folder = if self.folder.as_os_str().is_empty() { Path::new(".") } else { &self.folder };
        let listing_failed = |cause| PatternError::Folder { folder: folder.to_owned(), cause };
        let mut frames = Vec::new();
        for entry in fs::read_dir(folder).map_err(listing_failed)? {
            let entry = entry.map_err(listing_failed)?;
            let Some(frame) = entry.file_name().to_str().and_then(|name| self.frame_of(name)) else { continue };
            let path = self.folder.join(entry.file_name());
            // `metadata` of the path follows links, which `DirEntry` would not.
            if fs::metadata(&path).is_ok_and(|metadata| metadata.is_file()) {
                frames.push((frame, path));
            }
        }
        if frames.is_empty() {
            let run = "#".repeat(self.digits);
            return Err(PatternError::NoFrames(self.folder.join(format!("{}{run}{}", self.before, self.after))));
        }
        frames.sort();
        Ok(frames)
    }
}

/// Reads a frame range: items divided by commas, each a frame `7`, a run `1-100`, or a run with a step `1-100x2`.
/// The order is kept as written and a frame named twice is rendered once.
///
/// # Errors
/// If an item is empty, no number, backwards, or has step 0, or if there are more than [`MAX_FRAMES`] frames.
pub fn parse_frame_range(text: &str) -> Result<Vec<u32>, PatternError> {
    let mut frames = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for item in text.split(',').map(str::trim) {
        if item.is_empty() {
            return Err(PatternError::Empty(text.to_owned()));
        }
        let (first, last, step) = parse_item(item)?;
        for frame in (first..=last).step_by(step) {
            if seen.insert(frame) {
                frames.push(frame);
            }
            if frames.len() > MAX_FRAMES {
                return Err(PatternError::TooMany(text.to_owned()));
            }
        }
    }
    Ok(frames)
}

/// First frame, last frame and step of one item.
fn parse_item(item: &str) -> Result<(u32, u32, usize), PatternError> {
    let number = |text: &str| {
        let text = text.trim();
        // `parse` would take a leading plus sign.
        let digits = text.bytes().all(|byte| byte.is_ascii_digit());
        let value = if digits { text.parse::<u32>().ok() } else { None };
        value.ok_or_else(|| PatternError::NotANumber { item: item.to_owned() })
    };
    let Some((first, rest)) = item.split_once('-') else {
        let frame = number(item)?;
        return Ok((frame, frame, 1));
    };
    let (last, step) = match rest.split_once('x') {
        Some((last, step)) => (number(last)?, number(step)?),
        None => (number(rest)?, 1),
    };
    let first = number(first)?;
    if last < first {
        return Err(PatternError::Backwards { item: item.to_owned(), first, last });
    }
    match usize::try_from(step) {
        Ok(step) if step > 0 => Ok((first, last, step)),
        _ => Err(PatternError::ZeroStep { item: item.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(path: &str) -> FramePattern {
        FramePattern::parse(Path::new(path)).unwrap()
    }

    #[test]
    fn numbers_are_padded() {
        assert_eq!(pattern("out/sky.####.exr").path_of(7), Path::new("out/sky.0007.exr"));
        assert_eq!(pattern("sky#.exr").path_of(123), Path::new("sky123.exr"));
        assert_eq!(pattern("take#2/sky.###.png").path_of(1), Path::new("take#2/sky.001.png"));
        assert!(!pattern("sky.exr").is_sequence());
        assert_eq!(pattern("a/sky.exr").path_of(9), Path::new("a/sky.exr"));
    }

    #[test]
    fn bad_names_are_refused() {
        assert!(matches!(FramePattern::parse(Path::new("a#b#.exr")), Err(PatternError::ManyRuns(_))));
        assert!(matches!(FramePattern::parse(Path::new("a/..")), Err(PatternError::NoFileName(_))));
    }

    #[test]
    fn ranges_are_read() {
        let frames = |text| parse_frame_range(text).unwrap();
        assert_eq!(frames("7"), [7]);
        assert_eq!(frames("1-9x4, 120"), [1, 5, 9, 120]);

        assert_eq!(frames("5-6,1-5"), [5, 6, 1, 2, 3, 4], "order kept, repeats dropped");
        assert_eq!(frames("4294967294-4294967295"), [u32::MAX - 1, u32::MAX]);
    }

    #[test]
    fn bad_ranges_say_why() {
        let error = |text| parse_frame_range(text).unwrap_err();
        assert!(matches!(error(""), PatternError::Empty(_)));
        assert!(matches!(error("1,,2"), PatternError::Empty(_)));
        for text in ["a", "1-", "-3", "1-b", "+4", "1x2", "1-5x", "1.5", "4294967296"] {
            assert!(matches!(error(text), PatternError::NotANumber { .. }), "{text}: {}", error(text));
        }
        assert_eq!(error("9-1").to_string(), "the frame range `9-1` runs backwards; write `1-9`");
        assert!(matches!(error("1-5x0"), PatternError::ZeroStep { .. }));
        assert!(matches!(error("0-4294967295"), PatternError::TooMany(_)));
    }

    #[test]
    fn frames_on_the_disk_are_found_in_order() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["map.0010.png", "map.0002.png", "map.12345.png", "map.2.png", "map.00007.png", "map.00a1.png"] {
            fs::write(folder.path().join(name), b"").unwrap();
        }
        fs::create_dir(folder.path().join("map.0003.png")).unwrap();
        let found = FramePattern::parse(&folder.path().join("map.####.png")).unwrap().existing_frames().unwrap();
        let numbers: Vec<_> = found.iter().map(|(frame, _)| *frame).collect();
        assert_eq!(numbers, [2, 10, 12345]);
        assert_eq!(found[0].1, folder.path().join("map.0002.png"));
    }

    #[test]
    fn an_absent_sequence_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let frames = |name: &str| FramePattern::parse(&folder.path().join(name)).unwrap().existing_frames();
        assert!(matches!(frames("map.####.png"), Err(PatternError::NoFrames(_))));
        assert!(matches!(frames("map.png"), Err(PatternError::NotASequence(_))));
        assert!(matches!(frames("gone/map.#.png"), Err(PatternError::Folder { .. })));
    }
}
