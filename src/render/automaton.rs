//! The cellular automaton of a layer: the generations that a time asks for, from clear air or from what is kept of the way.
//!
//! See [`crate::scene::Automaton`] for how times and runs belong together, and `shaders/cloud/automaton.wgsl` for the rules.

use std::collections::BTreeMap;

use super::context::{Bound, Context, Extent};
use super::passes::view_of;
use super::uniforms::automaton_uniforms;
use crate::gpu::{Gpu, GpuError, Job, ProgramKey, Texture};
use crate::plan::{Effect, FramePlan};
use crate::scene::{Automaton, AutomatonMoment, DensityModel, Frame, Generation, Scene, Wind};

/// Cells of the bound: across the map, upwards, and across again.
const BOUND_CELLS: [u32; 3] = [64, 16, 64];
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Of all generations on the way one of so many is kept, so that going back is a short way.
const KEPT_EVERY: u32 = 16;

/// What makes one automaton differ from another, time apart.
#[derive(Clone, Debug, PartialEq)]
struct Rules {
    automaton: Automaton,
    /// The wind that carries the tops on, where it does.
    shear: Option<Wind>,
}

/// The states of one run that are kept, by generation; each is of all cells.
#[derive(Debug)]
struct Run {
    epoch: i64,
    states: BTreeMap<u32, wgpu::Buffer>,
}

/// Everything about one automaton.
#[derive(Debug)]
struct Made {
    rules: Rules,
    /// Favourable air, and the chapter it is of.
    favour: Option<(i64, wgpu::Buffer)>,
    runs: Vec<Run>,
    /// The generations that are shown, a channel each.
    density: Texture,
    /// Which they are.
    shown: Option<(Generation, Option<Generation>)>,
    /// Their greatest density in each coarse cell, where something asks for it.
    bound: Option<Texture>,
}

/// The automaton of the sky, if it has one.
#[derive(Debug, Default)]
pub(super) struct Living {
    made: Option<Made>,
    /// Densities made so far.
    count: u64,
}

impl Living {
    /// Appends the jobs that bring the automaton to a time; lets go of it where the scene has none.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (frame, plan): (&Frame<'_>, &FramePlan),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        if !plan.march.is_some_and(|march| march.automaton) {
            // Clouds that are out of view come back.
            self.made = self.made.take().filter(|_| plan.march.is_none() && plan.holds_clouds);
            return Ok(());
        }
        let rules = rules(frame.scene, plan.runs(Effect::Shear));
        let moment = living(frame.scene).map_or_else(|| rules.automaton.clone(), Clone::clone).at(frame.time_secs);
        if self.made.as_ref().is_none_or(|made| made.rules != rules) {
            self.made = None;
            self.made = Some(Made::new(context.gpu, rules));
        }
        let Some(made) = &mut self.made else { return Ok(()) };
        if made.show(context, moment, jobs)? {
            self.count += 1;
        }
        made.update_bound(context, is_bounded(plan), jobs)
    }

    /// How many densities there have been: another count is another density.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// The density with the pass that made it.
    pub(super) fn textures(&self) -> impl Iterator<Item = (&'static str, &Texture)> {
        self.made.iter().map(|made| ("automaton_smooth", &made.density))
    }

    /// Everything that exists, by the name shaders give it.
    pub(super) fn resources(&self) -> Bound<'_> {
        let Some(made) = &self.made else { return Vec::new() };
        let bound = made.bound.as_ref().map(|bound| ("automaton_bound", view_of(bound)));
        [("automaton_cells", view_of(&made.density))].into_iter().chain(bound).collect()
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |made| {
            let states = made.runs.iter().flat_map(|run| run.states.values()).map(wgpu::Buffer::size);
            let favour = made.favour.iter().map(|(_, favour)| favour.size());
            states.chain(favour).sum::<u64>() + made.density.bytes() + made.bound.as_ref().map_or(0, Texture::bytes)
        })
    }
}

impl Made {
    fn new(gpu: &Gpu, rules: Rules) -> Self {
        let Automaton { cells, levels, .. } = rules.automaton;
        let density = Texture::new_3d(gpu, "automaton_cells", [cells, levels, cells], (1, FORMAT));
        Self { rules, favour: None, runs: Vec::new(), density, shown: None, bound: None }
    }

    /// Whether the density had to be made anew.
    fn show(&mut self, context: &Context<'_>, moment: AutomatonMoment, jobs: &mut Vec<Job>) -> Result<bool, GpuError> {
        let shown = (moment.now, moment.before);
        if self.shown == Some(shown) {
            return Ok(false);
        }
        let wanted: Vec<Generation> = [Some(moment.now), moment.before].into_iter().flatten().collect();
        self.runs.retain(|run| wanted.iter().any(|generation| generation.epoch == run.epoch));
        let mut states = Vec::new();
        for generation in &wanted {
            states.push(self.bring_to(context, *generation, jobs)?);
        }
        let names = [["cells_now", "cells_next"], ["cells_before", "cells_before_next"]];
        let uniforms = self.uniforms(context.gpu, moment.now);
        let mut bound = vec![("automaton", uniforms.as_entire_binding()), ("density_out", view_of(&self.density))];
        for (names, states) in names.into_iter().zip(&states) {
            bound.extend(names.into_iter().zip(states.iter().map(wgpu::Buffer::as_entire_binding)));
        }
        let key = smooth_key(wanted.len() > 1);
        jobs.extend(context.banded("automaton_smooth", &key, &bound, self.columns())?);
        (self.shown, self.bound) = (Some(shown), None);
        Ok(true)
    }

    /// The states of a generation and of the one after it.
    fn bring_to(
        &mut self,
        context: &Context<'_>,
        wanted: Generation,
        jobs: &mut Vec<Job>,
    ) -> Result<[wgpu::Buffer; 2], GpuError> {
        let index = match self.runs.iter().position(|run| run.epoch == wanted.epoch) {
            Some(index) => index,
            None => {
                let clear = self.cells_buffer(context.gpu);
                self.runs.push(Run { epoch: wanted.epoch, states: BTreeMap::from([(0, clear)]) });
                self.runs.len() - 1
            }
        };
        let nearest = self.runs[index].states.range(..=wanted.index).next_back();
        let (mut at, mut state) =
            nearest.map_or_else(|| (0, self.cells_buffer(context.gpu)), |(at, state)| (*at, state.clone()));
        let mut before = state.clone();
        while at < wanted.index + 1 {
            at += 1;
            before = state;
            state = match self.runs[index].states.get(&at) {
                Some(known) => known.clone(),
                None => self.advance(context, &before, Generation { index: at, ..wanted }, jobs)?,
            };
            self.runs[index].states.insert(at, state.clone());
        }
        let kept = [wanted.index, wanted.index + 1];
        self.runs[index].states.retain(|at, _| at % KEPT_EVERY == 0 || kept.contains(at));
        Ok([before, state])
    }

    /// The state that follows another and is of a generation.
    fn advance(
        &mut self,
        context: &Context<'_>,
        before: &wgpu::Buffer,
        generation: Generation,
        jobs: &mut Vec<Job>,
    ) -> Result<wgpu::Buffer, GpuError> {
        let uniforms = self.uniforms(context.gpu, generation);
        let chapter = self.rules.automaton.chapter(generation);
        if self.favour.as_ref().is_none_or(|(of, _)| *of != chapter) {
            self.favour = Some((chapter, self.favour(context, &uniforms, jobs)?));
        }
        let mut before = before.clone();
        if self.rules.shear.is_some() {
            let drifted = self.cells_buffer(context.gpu);
            let bound = vec![
                ("automaton", uniforms.as_entire_binding()),
                ("cells_before", before.as_entire_binding()),
                ("cells_out", drifted.as_entire_binding()),
            ];
            jobs.extend(context.banded("automaton_drift", &drift_key(), &bound, self.columns())?);
            before = drifted;
        }
        let after = self.cells_buffer(context.gpu);
        let mut bound = vec![
            ("automaton", uniforms.as_entire_binding()),
            ("cells_before", before.as_entire_binding()),
            ("cells_out", after.as_entire_binding()),
        ];
        bound.extend(self.favour.iter().map(|(_, favour)| ("favour", favour.as_entire_binding())));
        jobs.extend(context.banded("automaton_advance", &advance_key(), &bound, self.columns())?);
        Ok(after)
    }

    fn favour(
        &self,
        context: &Context<'_>,
        uniforms: &wgpu::Buffer,
        jobs: &mut Vec<Job>,
    ) -> Result<wgpu::Buffer, GpuError> {
        let Automaton { cells, levels, .. } = self.rules.automaton;
        let favour = storage(context.gpu, "favour", u64::from(cells) * u64::from(cells) * u64::from(levels) * 4);
        let bound = vec![("automaton", uniforms.as_entire_binding()), ("favour_out", favour.as_entire_binding())];
        jobs.extend(context.banded("automaton_favour", &favour_key(), &bound, self.columns())?);
        Ok(favour)
    }

    fn update_bound(&mut self, context: &Context<'_>, wanted: bool, jobs: &mut Vec<Job>) -> Result<(), GpuError> {
        if !wanted {
            self.bound = None;
        } else if self.bound.is_none() {
            let texture = Texture::new_3d(context.gpu, "automaton_bound", BOUND_CELLS, (1, FORMAT));
            let bound = vec![("automaton_cells", view_of(&self.density)), ("bound_out", view_of(&texture))];
            jobs.push(context.whole("automaton_bound", &bound_key(), &bound, Extent::solid(BOUND_CELLS))?);
            self.bound = Some(texture);
        }
        Ok(())
    }

    fn columns(&self) -> Extent {
        Extent::image([self.rules.automaton.cells; 2])
    }

    /// A buffer of all cells, in clear air.
    fn cells_buffer(&self, gpu: &Gpu) -> wgpu::Buffer {
        let Automaton { cells, levels, .. } = self.rules.automaton;
        storage(gpu, "automaton", u64::from(cells) * u64::from(cells) * u64::from(levels.div_ceil(32)) * 16)
    }

    fn uniforms(&self, gpu: &Gpu, generation: Generation) -> wgpu::Buffer {
        gpu.uniform(
            "automaton",
            bytemuck::bytes_of(&automaton_uniforms(&self.rules.automaton, self.rules.shear.as_ref(), generation)),
        )
    }
}

fn storage(gpu: &Gpu, label: &str, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    })
}

/// The rules of the scene's automaton; of a small one where programs want one that no layer is, because they were forced to.
fn rules(scene: &Scene, is_sheared: bool) -> Rules {
    let unused = || Automaton { cells: 16, levels: 8, ..Automaton::default() };
    // Its direction alone counts.
    let wind = Wind { from_deg: scene.wind.from_deg, ..Wind::default() };
    let automaton = living(scene).map_or_else(unused, |automaton| Automaton {
        // How fast generations follow each other changes none of them.
        generation_secs: Automaton::default().generation_secs,
        ..automaton.clone()
    });
    Rules { automaton, shear: is_sheared.then_some(wind) }
}

fn living(scene: &Scene) -> Option<&Automaton> {
    scene.visible_layers().find(|layer| layer.model == DensityModel::Automaton).map(|layer| &layer.automaton)
}

fn favour_key() -> ProgramKey {
    ProgramKey::plain("pass/automaton_favour.wgsl")
}

fn drift_key() -> ProgramKey {
    ProgramKey::plain("pass/automaton_drift.wgsl")
}

fn advance_key() -> ProgramKey {
    ProgramKey::plain("pass/automaton_advance.wgsl")
}

fn smooth_key(hands_over: bool) -> ProgramKey {
    ProgramKey::plain("pass/automaton_smooth.wgsl").with_flags(hands_over.then_some("HANDOVER"))
}

fn bound_key() -> ProgramKey {
    ProgramKey::plain("pass/automaton_bound.wgsl")
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    if !plan.march.is_some_and(|march| march.automaton) {
        return Vec::new();
    }
    let drift = plan.runs(Effect::Shear).then(drift_key);
    let bound = is_bounded(plan).then(bound_key);
    [favour_key(), advance_key(), smooth_key(false), smooth_key(true)].into_iter().chain(drift).chain(bound).collect()
}

/// Whether something asks for the bound of the automaton's density.
fn is_bounded(plan: &FramePlan) -> bool {
    plan.march.is_some_and(|march| march.skip) || (plan.tracks && plan.march.is_some_and(|march| march.baked.is_none()))
}
