//! What `verify` checks of the whole program, here on the software driver.

use nephoscope::lab::verify::{Check, hard_cases, skies};

use crate::common::sky::renderer;

fn failed(checks: &[Check]) -> Vec<String> {
    checks.iter().filter(|check| !check.holds).map(Check::line).collect()
}

#[test]
fn all_hard_cases_hold() {
    let checks = hard_cases(&mut renderer()).unwrap_or_else(|error| panic!("{error}"));
    assert!(checks.len() > 15 && failed(&checks).is_empty(), "{}", failed(&checks).join("\n"));
}

#[test]
fn a_hundred_skies_that_nobody_made_are_pictures() {
    const KINDS: u64 = 12;
    let (mut faults, mut telling) = (Vec::new(), 0);
    for index in (0..KINDS).flat_map(|kind| (0..100).filter(move |index| index % KINDS == kind)) {
        let drawn = skies::draw(index, KINDS);
        let shown = skies::show(&mut renderer(), &drawn).unwrap_or_else(|error| panic!("sky {index}: {error}"));
        telling += u32::from((0.05..=0.95).contains(&shown.cloudy));
        faults.extend(shown.fault.map(|fault| format!("sky {index}: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(telling >= 40, "{telling} of 100 show clouds and sky");
}
