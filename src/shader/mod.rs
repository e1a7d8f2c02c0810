//! Shaders: one WGSL module is composed from files, flags and generated structs, then validated with naga.
//!
//! The dialect has four directives, each on a line of its own, and nothing else:
//!
//! ```text
//! #import "cloud/phase.wgsl"      the file's text, once per module; "generated/<Name>.wgsl" is a GPU struct
//! #if FLAG                        FLAG must be in the caller's closed list
//! #else
//! #endif
//! ```
//!
//! Anything else that begins with `#`, an unknown file and an unknown flag are errors with file and line.

mod compose;
mod embedded;
mod validate;

use std::path::PathBuf;

pub use compose::{ShaderSource, compose, compose_with};
pub use embedded::FILES;
pub use validate::validate;

/// The environment variable that names a folder to read shaders from in place of the embedded ones.
pub const SHADER_FOLDER_VARIABLE: &str = "NEPHOSCOPE_SHADERS";

/// Why a shader could not be composed or is not valid; every message begins with `file:line`.
#[derive(Debug, thiserror::Error)]
pub enum ShaderError {
    /// An entry file or an import that exists neither in the shader folder nor among the generated structs.
    #[error(
        "{file}:{line}: no shader is named {import:?}; paths are relative to shaders/, generated structs to generated/"
    )]
    UnknownImport {
        /// The importing file (the entry itself when `line` is 0).
        file: String,
        /// One-based line of the import; 0 for the entry.
        line: usize,
        /// The path that was asked for.
        import: String,
    },
    /// A flag that is not in the caller's list.
    #[error("{file}:{line}: unknown flag {flag:?}; known flags: {known}")]
    UnknownFlag {
        /// The file with the `#if`, or the entry when the flag was passed by the caller.
        file: String,
        /// One-based line of the `#if`; 0 when the flag was passed by the caller.
        line: usize,
        /// The flag that is not known.
        flag: String,
        /// The closed list, comma separated.
        known: String,
    },
    /// A directive that is unknown, malformed or not paired.
    #[error("{file}:{line}: {message}")]
    Directive {
        /// The file with the directive.
        file: String,
        /// One-based line of the directive.
        line: usize,
        /// What is wrong and what would be right.
        message: &'static str,
    },
    /// A shader file of the development folder exists but cannot be read.
    #[error("cannot read the shader {path}: {source}; check the folder named by {SHADER_FOLDER_VARIABLE}")]
    Unreadable {
        /// The path on disk.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// naga rejects the composed text.
    #[error("{file}:{line}: {message}")]
    Invalid {
        /// The file the offending line came from.
        file: String,
        /// One-based line in that file; 0 when naga names no place.
        line: usize,
        /// naga's message with its causes and its other labels.
        message: String,
    },
}

/// The WGSL structs a caller offers to `#import "generated/<Name>.wgsl"`: pairs of name and text.
pub type Generated<'a> = &'a [(&'a str, &'a str)];
