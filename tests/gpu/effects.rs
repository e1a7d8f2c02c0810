//! The two proofs of every effect, over the plan's own list: what does not run leaves no trace, and leaving it out where
//! the plan calls it needless does not change the picture; and a scene in which it does.

mod scenes;

use std::collections::BTreeSet;

use nephoscope::gpu::readback;
use nephoscope::lab::verify::{anywhere, skies};
use nephoscope::plan::{Effect, Forced, FramePlan, Need};
use nephoscope::render::{programs, shaders::TABLE};
use nephoscope::scene::Output;
use nephoscope::scene::builtin::BUILTINS;

use crate::common::sky::{frame, quick, renderer};
use crate::common::thorough;
use scenes::{Change, Example, SIZE, Setup, borders, scenes};

/// All flags and all bindings of the programs a plan may ask for.
fn traces(plan: &FramePlan) -> (BTreeSet<String>, BTreeSet<String>) {
    let (mut flags, mut bindings) = (BTreeSet::new(), BTreeSet::new());
    for key in programs(plan) {
        flags.extend(key.flags.iter().map(|flag| (*flag).to_owned()));
        let (_, used) = TABLE.compose(&key).unwrap_or_else(|error| panic!("{key}: {error}"));
        bindings.extend(used.into_iter().map(|binding| binding.name));
    }
    (flags, bindings)
}

#[test]
fn absent_means_no_flag_and_no_binding() {
    let mut failures = Vec::new();
    for effect in Effect::ALL {
        let info = effect.info();
        let Example { on, off, .. } = scenes(*effect);
        let (on, off) = (Setup::new(on).plan(Forced::default()), Setup::new(off).plan(Forced::default()));
        if !on.runs(*effect) || off.runs(*effect) {
            failures.push(format!("{}: {} / {}", info.name, on.verdict(*effect).line(), off.verdict(*effect).line()));
        }
        let ((flags, bindings), (left_flags, left_bindings)) = (traces(&on), traces(&off));
        for (names, there, left) in [(info.flags, &flags, &left_flags), (info.bindings, &bindings, &left_bindings)] {
            for name in names {
                if !there.contains(*name) {
                    failures.push(format!("{}: its scene has no {name}", info.name));
                }
                if left.contains(*name) {
                    failures.push(format!("{}: absent, but {name} is left", info.name));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// What a picture is made of: light for a file, if it is for one, and the display's bytes.
#[derive(PartialEq)]
struct Picture {
    light: Vec<[f32; 4]>,
    display: Vec<u8>,
}

impl Picture {
    /// Greatest difference of a value, relative to it or to a hundredth of the mean.
    fn difference(&self, other: &Self) -> f32 {
        let mean = self.light.iter().flatten().sum::<f32>() / (4 * self.light.len().max(1)) as f32;
        let of_light = self.light.iter().flatten().zip(other.light.iter().flatten());
        let of_display = self.display.iter().zip(&other.display);
        let relative = |a: f32, b: f32, floor: f32| (a - b).abs() / a.abs().max(b.abs()).max(floor);
        let light = of_light.map(|(a, b)| relative(*a, *b, 0.01 * mean)).fold(0.0, f32::max);
        of_display.map(|(a, b)| f32::from(a.abs_diff(*b)) / 255.0).fold(light, f32::max)
    }
}

fn picture(setup: &Setup, forced: Forced) -> Picture {
    let mut renderer = renderer();
    renderer.force(forced);
    let plan = setup.plan(forced);
    let made = renderer.render_as_planned(&frame(&setup.scene, &setup.quality, SIZE, setup.output), plan);
    let display = renderer.display().expect("a picture").clone();
    let display = readback::texture(renderer.gpu(), &display).expect("it can be read");
    let light = renderer.linear().expect("it can be read").rgba;
    renderer.force(Forced::default());
    made.unwrap_or_else(|error| panic!("{error}"));
    Picture { light, display }
}

#[test]
fn absent_changes_nothing() {
    let mut failures = Vec::new();
    for effect in Effect::ALL {
        for (index, change) in scenes(*effect).needless.iter().enumerate() {
            let setup = Setup::new(*change);
            let force = Forced::default().with(*effect, Some(true));
            let name = format!("{}, scene {index}", effect.info().name);
            let verdict = setup.plan(Forced::default()).verdict(*effect).clone();
            if verdict.need != Need::Needless || !setup.plan(force).runs(*effect) {
                failures.push(format!("{name}: not needless, or not forced: {}", verdict.line()));
                continue;
            }
            let (without, with) = (picture(&setup, Forced::default()), picture(&setup, force));
            let difference = without.difference(&with);
            let may_differ = effect.info().may_differ;
            if difference > may_differ || (may_differ == 0.0 && without != with) {
                failures.push(format!("{name}: changes by {difference}, {}", verdict.line()));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn each_effect_is_seen_somewhere() {
    /// Of a value; more than any tolerance above.
    const VISIBLE: f32 = 0.01;
    let mut failures = Vec::new();
    for effect in Effect::ALL {
        let Example { on, is_seen, .. } = scenes(*effect);
        assert!(!is_seen || effect.info().can_be_off, "{effect:?}");
        if !is_seen {
            continue;
        }
        let setup = Setup::new(on);
        let force = Forced::default().with(*effect, Some(false));
        assert!(!setup.plan(force).runs(*effect), "{effect:?}");
        let difference = picture(&setup, Forced::default()).difference(&picture(&setup, force));
        if difference < VISIBLE {
            failures.push(format!("{}: {difference}", effect.info().name));
        }
    }
    assert!(failures.is_empty(), "forced off, these change nothing:\n{}", failures.join("\n"));
}

#[test]
fn each_effect_runs_up_to_its_border() {
    let mut failures = Vec::new();
    for effect in Effect::ALL {
        for (index, change) in borders(*effect).iter().enumerate() {
            let setup = Setup::new(*change);
            let verdict = setup.plan(Forced::default()).verdict(*effect).clone();
            let off = Forced::default().with(*effect, Some(false));
            if !verdict.runs || picture(&setup, Forced::default()) == picture(&setup, off) {
                failures.push(format!("{}, border {index}: {}", effect.info().name, verdict.line()));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn absent_passes_do_not_run() {
    let mut failures = Vec::new();
    // Many effects share a scene.
    let mut known: Vec<(Setup, Vec<&'static str>)> = Vec::new();
    let mut ran = |change: Change| {
        let setup = Setup::new(change);
        if let Some((_, passes)) = known.iter().find(|(known, _)| *known == setup) {
            return passes.clone();
        }
        // A renderer that holds nothing yet but programs.
        let mut renderer = renderer();
        renderer.forget_everything().unwrap_or_else(|error| panic!("{error}"));
        let made = renderer.render(&frame(&setup.scene, &setup.quality, SIZE, setup.output));
        let passes = made.unwrap_or_else(|error| panic!("{error}")).passes;
        known.push((setup, passes.iter().map(|time| time.pass).collect()));
        known[known.len() - 1].1.clone()
    };
    for effect in Effect::ALL.iter().filter(|effect| !effect.info().passes.is_empty()) {
        let Example { on, off, .. } = scenes(*effect);
        let (with, without) = (ran(on), ran(off));
        for pass in effect.info().passes {
            if !with.contains(pass) || without.contains(pass) {
                failures.push(format!("{}: {pass} in {with:?}, not in {without:?}", effect.info().name));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Built-in skies from places that nobody chose, and skies that nobody made: all that is needless, forced on at once. A
/// third of them, unless the tests are to be thorough.
#[test]
fn leaving_everything_needless_out_changes_nothing() {
    let builtin = (0..).zip(BUILTINS).map(|(index, builtin)| {
        let scene = builtin.preset().unwrap_or_else(|error| panic!("{error}")).scene;
        let scene = if index % 3 == 0 { scene } else { anywhere(&scene, index) };
        (builtin.name.to_owned(), scene)
    });
    let (every, draws) = if thorough() { (1, 24) } else { (3, 8) };
    // Another one of each three: a third of those kept look from where their makers did.
    let builtin = builtin.enumerate().filter(|(index, _)| (index + index / every) % every == 0).map(|(_, sky)| sky);
    let drawn = (0..draws).map(|index| (format!("sky {index}"), skies::draw(index, 8).scene));
    let mut failures = Vec::new();
    for (name, scene) in builtin.chain(drawn) {
        let setup = Setup { scene, quality: quick(), output: Output::Linear };
        let planned = setup.plan(Forced::default());
        let needless = planned.verdicts.iter().filter(|verdict| verdict.need == Need::Needless);
        let (mut forced, mut may_differ) = (Forced::default(), 0.0_f32);
        for verdict in needless {
            forced = forced.with(verdict.effect, Some(true));
            may_differ = may_differ.max(verdict.effect.info().may_differ);
        }
        let difference = picture(&setup, Forced::default()).difference(&picture(&setup, forced));
        if difference > may_differ {
            failures.push(format!("{name}: {difference} > {may_differ}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
