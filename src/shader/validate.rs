//! Parses and validates composed WGSL with naga before any module is created, and maps errors to file and line.

use std::error::Error;
use std::fmt::Write as _;

use wgpu::naga;

use super::{ShaderError, ShaderSource};

/// Parses and validates `source` with the capabilities every WebGPU device has; returns naga's module and
/// what its analysis found out (which entry point uses which binding).
///
/// # Errors
/// [`ShaderError::Invalid`] with the file and line of the first label, naga's message, its chain of causes and the
/// other labels with their own places.
pub fn validate(source: &ShaderSource) -> Result<(naga::Module, naga::valid::ModuleInfo), ShaderError> {
    let module = naga::front::wgsl::parse_str(&source.code).map_err(|error| {
        let labels = error.labels().map(|(span, text)| (span, text.to_owned())).collect();
        invalid(source, error.message().to_owned(), labels)
    })?;
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::default());
    match validator.validate(&module) {
        Ok(info) => Ok((module, info)),
        Err(error) => {
            let mut message = error.as_inner().to_string();
            let mut cause = error.as_inner().source();
            while let Some(inner) = cause {
                let _ = write!(message, ": {inner}");
                cause = inner.source();
            }
            let labels = error.spans().cloned().collect();
            Err(invalid(source, message, labels))
        }
    }
}

fn invalid(source: &ShaderSource, mut message: String, labels: Vec<(naga::Span, String)>) -> ShaderError {
    let place = |span: naga::Span| {
        let line = span.is_defined().then(|| span.location(&source.code).line_number as usize)?;
        source.origin(line)
    };
    let mut first = None;
    for (span, text) in labels {
        let Some((file, line)) = place(span) else { continue };
        if first.is_none() {
            let _ = write!(message, " ({text})");
            first = Some((file.to_owned(), line));
        } else {
            let _ = write!(message, "; {file}:{line}: {text}");
        }
    }
    let (file, line) = first.unwrap_or_else(|| {
        let entry = source.origins.last().map_or("shader", |(file, _)| file);
        (entry.to_owned(), 0)
    });
    ShaderError::Invalid { file, line, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(parts: &[(&str, &str)]) -> ShaderSource {
        let mut out = ShaderSource::default();
        for (file, text) in parts {
            for (index, line) in text.lines().enumerate() {
                out.code.push_str(line);
                out.code.push('\n');
                out.origins.push(((*file).to_owned(), index + 1));
            }
        }
        out
    }

    fn message(parts: &[(&str, &str)]) -> String {
        validate(&source(parts)).unwrap_err().to_string()
    }

    #[test]
    fn errors_point_at_the_file_they_came_from() {
        let good = ("good.wgsl", "fn one() -> f32 {\n  return 1.0;\n}\n");
        assert!(validate(&source(&[good])).is_ok(), "a valid module passes");
        let parse = message(&[good, ("bad.wgsl", "fn two() -> f32 {\n  return nothing;\n}\n")]);
        assert!(parse.starts_with("bad.wgsl:2: "), "{parse}");
        assert!(parse.contains("nothing"), "{parse}");
        let types = message(&[good, ("bad.wgsl", "\nfn two() -> u32 {\n  return one();\n}\n")]);
        assert!(types.starts_with("bad.wgsl:"), "{types}");
        let layout = "struct S { a: f32, b: array<f32, 4> }\n@group(0) @binding(0) var<uniform> s: S;\n";
        let layout = message(&[good, ("bad.wgsl", layout)]);
        assert!(layout.starts_with("bad.wgsl:"), "{layout}");
    }
}
