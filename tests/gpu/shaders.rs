//! Every embedded shader composes and is valid WGSL.

use std::collections::BTreeSet;

use nephoscope::shader::{FILES, compose, validate};

#[test]
fn every_function_file_and_test_shader_is_valid() {
    let mut failures = Vec::new();
    for (path, _) in FILES.iter().filter(|(path, _)| !path.starts_with("pass/")) {
        let known: Vec<&str> = Vec::new();
        let result = compose(path, &BTreeSet::new(), &known, &[]).and_then(|source| validate(&source));
        if let Err(error) = result {
            failures.push(error.to_string());
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
