//! Joins WGSL files: `#import "path"` once per file, `#if FLAG` / `#else` / `#endif`, and nothing else.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::Path;

use super::{FILES, Generated, SHADER_FOLDER_VARIABLE, ShaderError};

/// One composed WGSL module and, for each of its lines, the file and the one-based line it came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderSource {
    /// The module's text.
    pub code: String,
    /// `origins[i]` is where line `i + 1` of `code` came from.
    pub origins: Vec<(String, usize)>,
}

impl ShaderSource {
    /// File and line that the one-based line `line` of the composed text came from, or `None` outside of it.
    #[must_use]
    pub fn origin(&self, line: usize) -> Option<(&str, usize)> {
        let (file, origin_line) = self.origins.get(line.checked_sub(1)?)?;
        Some((file, *origin_line))
    }
}

/// Composes the module whose root is `entry` (a path relative to `shaders/`).
///
/// `flags` are the flags that are on, `known_flags` the closed list of all flags this program has, `generated` the
/// structs behind `generated/<Name>.wgsl`. Files come from the folder that `NEPHOSCOPE_SHADERS` names, so that shaders
/// can be edited while the program runs, or else from the table embedded in the program.
///
/// # Errors
/// [`ShaderError`] names file and line of an unknown import, an unknown flag or a wrong directive.
pub fn compose(
    entry: &str,
    flags: &BTreeSet<&'static str>,
    known_flags: &[&str],
    generated: Generated<'_>,
) -> Result<ShaderSource, ShaderError> {
    match std::env::var_os(SHADER_FOLDER_VARIABLE) {
        Some(folder) => {
            let read = |path: &str| read_from_folder(Path::new(&folder), path);
            compose_with(&read, entry, flags, known_flags, generated)
        }
        None => compose_with(&read_embedded, entry, flags, known_flags, generated),
    }
}

/// What [`compose_with`] reads files through: `Ok(None)` when there is no such file.
pub(super) type Reader<'a> = dyn Fn(&str) -> Result<Option<Cow<'static, str>>, ShaderError> + 'a;

/// As [`compose`], with files from `read`, which answers `Ok(None)` for a file that does not exist.
///
/// # Errors
/// As [`compose`], and whatever `read` reports.
pub fn compose_with(
    read: &Reader<'_>,
    entry: &str,
    flags: &BTreeSet<&'static str>,
    known_flags: &[&str],
    generated: Generated<'_>,
) -> Result<ShaderSource, ShaderError> {
    let mut composer =
        Composer { read, flags, known_flags, generated, seen: BTreeSet::new(), out: ShaderSource::default() };
    for flag in flags {
        composer.check_flag(flag, entry, 0)?;
    }
    composer.append(entry, (entry, 0))?;
    Ok(composer.out)
}

fn read_embedded(path: &str) -> Result<Option<Cow<'static, str>>, ShaderError> {
    let found = FILES.binary_search_by_key(&path, |(name, _)| name);
    Ok(found.ok().map(|index| Cow::Borrowed(FILES[index].1)))
}

fn read_from_folder(folder: &Path, path: &str) -> Result<Option<Cow<'static, str>>, ShaderError> {
    let path = folder.join(path);
    match std::fs::read_to_string(&path) {
        Ok(text) => Ok(Some(Cow::Owned(text))),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(source) => Err(ShaderError::Unreadable { path, source }),
    }
}

struct Composer<'a> {
    read: &'a Reader<'a>,
    flags: &'a BTreeSet<&'static str>,
    known_flags: &'a [&'a str],
    generated: Generated<'a>,
    seen: BTreeSet<String>,
    out: ShaderSource,
}

/// One open `#if`: whether its current branch is taken, and where it was opened.
struct Branch {
    taken: bool,
    has_else: bool,
    line: usize,
}

impl Composer<'_> {
    /// Appends `file` unless it is already in; `from` is the importing file and line.
    fn append(&mut self, file: &str, from: (&str, usize)) -> Result<(), ShaderError> {
        if !self.seen.insert(file.to_owned()) {
            return Ok(());
        }
        let text = self.text_of(file, from)?;
        let mut branches: Vec<Branch> = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            let active = branches.iter().all(|branch| branch.taken);
            if let Some(directive) = line.trim_start().strip_prefix('#') {
                let import = self.directive(directive, (file, line_number), &mut branches)?;
                if let Some(import) = import.filter(|_| active) {
                    self.append(import, (file, line_number))?;
                }
            } else if active {
                self.out.code.push_str(line);
                self.out.code.push('\n');
                self.out.origins.push((file.to_owned(), line_number));
            }
        }
        match branches.last() {
            Some(branch) => Err(wrong((file, branch.line), "#if without #endif")),
            None => Ok(()),
        }
    }

    /// Obeys one directive (without its `#`); answers with the path when it is an import.
    fn directive<'line>(
        &self,
        directive: &'line str,
        at: (&str, usize),
        branches: &mut Vec<Branch>,
    ) -> Result<Option<&'line str>, ShaderError> {
        let directive = directive.split("//").next().unwrap_or_default().trim();
        let (keyword, argument) = directive.split_once(char::is_whitespace).unwrap_or((directive, ""));
        let argument = argument.trim();
        match (keyword, argument) {
            ("import", _) => {
                let path = argument.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
                let path = path.filter(|path| !path.is_empty());
                return path.map(Some).ok_or_else(|| wrong(at, "an import is written #import \"folder/file.wgsl\""));
            }
            ("if", flag) => {
                self.check_flag(flag, at.0, at.1)?;
                branches.push(Branch { taken: self.flags.contains(flag), has_else: false, line: at.1 });
            }
            ("else", "") => match branches.last_mut() {
                Some(branch) if !branch.has_else => {
                    branch.taken = !branch.taken;
                    branch.has_else = true;
                }
                Some(_) => return Err(wrong(at, "a second #else for the same #if")),
                None => return Err(wrong(at, "#else without #if")),
            },
            ("endif", "") => {
                branches.pop().ok_or_else(|| wrong(at, "#endif without #if"))?;
            }
            _ => return Err(wrong(at, "unknown directive; there are #import \"path\", #if FLAG, #else and #endif")),
        }
        Ok(None)
    }

    fn check_flag(&self, flag: &str, file: &str, line: usize) -> Result<(), ShaderError> {
        if self.known_flags.contains(&flag) {
            return Ok(());
        }
        let (file, flag, known) = (file.to_owned(), flag.to_owned(), self.known_flags.join(", "));
        Err(ShaderError::UnknownFlag { file, line, flag, known })
    }

    fn text_of(&self, file: &str, from: (&str, usize)) -> Result<Cow<'static, str>, ShaderError> {
        let generated = file.strip_prefix("generated/").and_then(|name| name.strip_suffix(".wgsl"));
        let text = match generated {
            Some(name) => {
                let found = self.generated.iter().find(|(known, _)| *known == name);
                found.map(|(_, text)| Cow::Owned((*text).to_owned()))
            }
            None => (self.read)(file)?,
        };
        text.ok_or_else(|| ShaderError::UnknownImport {
            file: from.0.to_owned(),
            line: from.1,
            import: file.to_owned(),
        })
    }
}

fn wrong(at: (&str, usize), message: &'static str) -> ShaderError {
    ShaderError::Directive { file: at.0.to_owned(), line: at.1, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: &[&str] = &["FOG", "RAIN"];

    fn run(files: &[(&'static str, &'static str)], flags: &[&'static str]) -> Result<ShaderSource, String> {
        let read = |path: &str| {
            let found = files.iter().find(|(name, _)| *name == path);
            Ok(found.map(|(_, text)| Cow::Borrowed(*text)))
        };
        let flags = flags.iter().copied().collect();
        compose_with(&read, "main.wgsl", &flags, KNOWN, &[("Sun", "struct Sun {\n}\n")]).map_err(|e| e.to_string())
    }

    #[test]
    fn imports_are_joined_once_and_lines_remember_their_origin() {
        let files = [
            ("main.wgsl", "#import \"a.wgsl\"\n#import \"b.wgsl\"\n#import \"generated/Sun.wgsl\"\nmain\n"),
            ("a.wgsl", "#import \"b.wgsl\" // first\na\n"),
            ("b.wgsl", "b\r\n#import \"main.wgsl\"\n"),
        ];
        let source = run(&files, &[]).unwrap();
        assert_eq!(source.code, "b\na\nstruct Sun {\n}\nmain\n");
        assert_eq!(source.origin(1), Some(("b.wgsl", 1)));
        assert_eq!(source.origin(2), Some(("a.wgsl", 2)));
        assert_eq!(source.origin(4), Some(("generated/Sun.wgsl", 2)));
        assert_eq!(source.origin(5), Some(("main.wgsl", 4)));
        assert_eq!((source.origin(0), source.origin(6)), (None, None));
    }

    #[test]
    fn flags_choose_branches_and_nest() {
        let text = "#if FOG\n fog\n #if RAIN\n both\n #else\n dry\n #endif\n#else\nclear\n#import \"x.wgsl\"\n#endif\n";
        let files = [("main.wgsl", text), ("x.wgsl", "x\n")];
        assert_eq!(run(&files, &["FOG", "RAIN"]).unwrap().code, " fog\n both\n");
        assert_eq!(run(&files, &["FOG"]).unwrap().code, " fog\n dry\n");
        assert_eq!(run(&files, &["RAIN"]).unwrap().code, "clear\nx\n");
    }

    #[test]
    fn every_mistake_names_file_and_line() {
        let cases: [(&'static str, &str); 11] = [
            ("\n#include \"a\"\n", "main.wgsl:2: unknown directive"),
            ("#else\n", "main.wgsl:1: #else without #if"),
            ("#endif\n", "main.wgsl:1: #endif without #if"),
            ("\n#if FOG\n#else\n#else\n#endif", "main.wgsl:4: a second #else"),
            ("\n#if FOG\n", "main.wgsl:2: #if without #endif"),
            ("#if SNOW\n#endif\n", "main.wgsl:1: unknown flag \"SNOW\"; known flags: FOG, RAIN"),
            ("#if FOG\n#if !RAIN\n#endif\n#endif\n", "main.wgsl:2: unknown flag \"!RAIN\""),
            ("#import phase.wgsl\n", "main.wgsl:1: an import is written"),
            ("\n\n#import \"no.wgsl\"\n", "main.wgsl:3: no shader is named \"no.wgsl\""),
            ("#import \"generated/Moon.wgsl\"\n", "main.wgsl:1: no shader is named \"generated/Moon.wgsl\""),
            ("#endif FOG\n", "main.wgsl:1: unknown directive"),
        ];
        for (text, expected) in cases {
            let message = run(&[("main.wgsl", text)], &[]).unwrap_err();
            assert!(message.starts_with(expected), "{text:?} gave {message:?}, expected {expected:?}");
        }
        assert!(run(&[("main.wgsl", "")], &["HAIL"]).unwrap_err().starts_with("main.wgsl:0: unknown flag \"HAIL\""));
        assert!(run(&[], &[]).unwrap_err().starts_with("main.wgsl:0: no shader is named \"main.wgsl\""));
    }

    #[test]
    fn a_folder_gives_what_is_embedded() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
        for (path, text) in FILES {
            assert_eq!(read_from_folder(&folder, path).unwrap().as_deref(), Some(*text), "{path} from the folder");
            assert_eq!(read_embedded(path).unwrap().as_deref(), Some(*text), "{path} from the table");
        }
        assert!(read_from_folder(&folder, "no.wgsl").unwrap().is_none(), "a missing file is not an error here");
        let message = read_from_folder(&folder, "common").unwrap_err().to_string();
        assert!(message.contains("common") && message.contains(SHADER_FOLDER_VARIABLE), "{message}");
    }
}
