//! The passes of one frame, each from what the plan says to jobs. Their order is in [`super::Renderer`].

use super::context::{Bound, Context, Extent};
use super::targets::{CloudTarget, Targets};
use crate::gpu::{GpuError, Job, ProgramKey, Texture};
use crate::plan::{FramePlan, MarchVariant};
use crate::scene::ToneMap;

/// The buffers that several passes read.
#[derive(Debug)]
pub(super) struct FrameBuffers {
    pub(super) view: wgpu::Buffer,
    pub(super) scene: wgpu::Buffer,
    pub(super) ground: wgpu::Buffer,
    pub(super) display: wgpu::Buffer,
    pub(super) plain: Option<wgpu::Buffer>,
    pub(super) shafts: Option<wgpu::Buffer>,
    pub(super) shapes: Option<wgpu::Buffer>,
    pub(super) glow: Option<wgpu::Buffer>,
}

impl FrameBuffers {
    pub(super) fn resources(&self) -> Bound<'_> {
        let mut bound: Bound<'_> = vec![
            ("view", self.view.as_entire_binding()),
            ("scene", self.scene.as_entire_binding()),
            ("ground", self.ground.as_entire_binding()),
            ("display", self.display.as_entire_binding()),
        ];
        let optional =
            [("plain", &self.plain), ("shafts", &self.shafts), ("shapes", &self.shapes), ("glow", &self.glow)];
        bound.extend(optional.iter().filter_map(|(name, buffer)| Some((*name, buffer.as_ref()?.as_entire_binding()))));
        bound
    }
}

/// What one frame's passes read and write.
pub(super) struct Passes<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) plan: &'a FramePlan,
    pub(super) targets: &'a Targets,
    /// Bakes, sky tables and weather map, by name.
    pub(super) shared: Bound<'a>,
    pub(super) buffers: &'a FrameBuffers,
    pub(super) jobs: Vec<Job>,
}

pub(super) fn view_of(texture: &Texture) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(&texture.view)
}

pub(super) fn field_key(file: &'static str, march: MarchVariant) -> ProgramKey {
    ProgramKey::plain(file)
        .with_flags(march.field_flags())
        .with_constant("DOMAIN", march.domain_index())
        .with_constant("LAYERS", march.layers)
}

/// The march of a variant.
pub(super) fn march_key(march: MarchVariant) -> ProgramKey {
    field_key("pass/march.wgsl", march).with_flags(march.flags()).with_constant("OCTAVES", march.octaves)
}

/// What is written where no cloud can be.
fn clear_key(march: MarchVariant) -> ProgramKey {
    let flags = march.flags().filter(|flag| matches!(*flag, "FLOAT" | "DISTANCE"));
    ProgramKey::plain("pass/march_clear.wgsl").with_flags(flags)
}

/// The programs a plan needs for every frame, bakes left out.
pub(super) fn programs(plan: &FramePlan, with_history: bool) -> Vec<ProgramKey> {
    let mut keys = vec![background_key(plan, false), tonemap_key(plan)];
    if plan.ground.is_some_and(|ground| ground.open_rows > 0) {
        keys.push(background_key(plan, true));
    }
    if let Some(march) = plan.march {
        if plan.has_clouds() {
            keys.push(march_key(march));
            keys.push(clear_key(march));
        }
        if plan.ground.is_some_and(|ground| ground.shadow_px.is_some()) {
            keys.push(field_key("pass/cloud_shadow.wgsl", march));
        }
    }
    if plan.temporal.is_some() {
        keys.push(temporal_key(false));
        if with_history {
            keys.push(temporal_key(true));
        }
    }
    if plan.sunshafts.is_some() {
        keys.push(ProgramKey::plain("pass/shafts_blur.wgsl"));
        keys.push(shafts_mask_key(plan));
    }
    if plan.float {
        keys.push(composite_key(plan));
    }
    keys
}

/// The background with whatever the plan says of the ground, or of rows that lie above it.
fn background_key(plan: &FramePlan, is_open: bool) -> ProgramKey {
    let Some(sky) = plan.sky else {
        return ProgramKey::plain("pass/background_plain.wgsl").with_flags(plan.float.then_some("FLOAT"));
    };
    let ground = plan.ground.filter(|_| !is_open);
    let on = [
        ("GROUND", ground.is_some()),
        ("TERRAIN", ground.is_some_and(|ground| ground.terrain)),
        ("SHADOW", ground.is_some_and(|ground| ground.shadow_px.is_some())),
        ("SOLIDS", ground.is_some_and(|ground| ground.solids)),
        ("OPEN", is_open),
        ("STARS", sky.stars),
        ("SUN_DISC", sky.sun_disc),
        ("MOON_DISC", sky.moon_disc),
        ("FLOAT", plan.float),
    ];
    ProgramKey::plain("pass/background.wgsl").with_flags(on.into_iter().filter_map(|(flag, on)| on.then_some(flag)))
}

pub(super) fn composed_flags(plan: &FramePlan) -> impl Iterator<Item = &'static str> {
    [("CLOUDS", plan.has_clouds()), ("SHAFTS", plan.sunshafts.is_some()), ("GLOW", plan.glow)]
        .into_iter()
        .filter_map(|(flag, on)| on.then_some(flag))
}

fn composite_key(plan: &FramePlan) -> ProgramKey {
    let alone = plan.alone && plan.has_clouds();
    ProgramKey::plain("pass/composite.wgsl")
        .with_flags(composed_flags(plan))
        .with_flags(alone.then_some("ALONE"))
        .with_flags(samples_flag(plan))
}

fn tonemap_key(plan: &FramePlan) -> ProgramKey {
    let curve = match plan.tone_map {
        ToneMap::Agx => 0,
        ToneMap::Neutral => 1,
        ToneMap::Linear => 2,
        ToneMap::FalseColour => 3,
        ToneMap::Aces => 4,
    };
    ProgramKey::plain("pass/tonemap.wgsl")
        .with_flags(composed_flags(plan))
        .with_flags(samples_flag(plan))
        .with_flags(plan.graded.then_some("GRADED"))
        .with_constant("TONE_MAP", curve)
        .with_constant("STRIPES", plan.stripes.into())
}

fn samples_flag(plan: &FramePlan) -> Option<&'static str> {
    (plan.pixel_samples > 1).then_some("SAMPLES")
}

fn temporal_key(with_history: bool) -> ProgramKey {
    ProgramKey::plain("pass/temporal.wgsl").with_flags(with_history.then_some("HISTORY"))
}

fn shafts_mask_key(plan: &FramePlan) -> ProgramKey {
    ProgramKey::plain("pass/shafts_mask.wgsl")
        .with_flags(plan.ground.is_some().then_some("GROUND"))
        .with_flags(plan.has_clouds().then_some("CLOUDS"))
}

impl<'a> Passes<'a> {
    pub(super) fn bound(&self, own: &[(&'static str, wgpu::BindingResource<'a>)]) -> Bound<'a> {
        let mut bound = self.shared.clone();
        bound.extend(self.buffers.resources());
        bound.extend_from_slice(own);
        bound
    }

    /// Sunlight through the clouds on a map of the ground.
    pub(super) fn cloud_shadow(&mut self) -> Result<(), GpuError> {
        let (Some(target), Some(march)) = (&self.targets.cloud_shadow, self.plan.march) else {
            return Ok(());
        };
        let bound = self.bound(&[("shadow_out", view_of(target))]);
        let key = field_key("pass/cloud_shadow.wgsl", march);
        self.jobs.extend(self.context.banded("cloud_shadow", &key, &bound, Extent::image(target.size()))?);
        Ok(())
    }

    /// Sky and ground behind the clouds.
    pub(super) fn background(&mut self) -> Result<(), GpuError> {
        let targets = self.targets;
        let mut own = vec![("background_out", view_of(&targets.background))];
        if let Some(distance) = &targets.ground_distance {
            own.push(("ground_distance_out", view_of(distance)));
        }
        if let Some(shadow) = &targets.cloud_shadow {
            own.push(("cloud_shadow", view_of(shadow)));
        }
        let bound = self.bound(&own);
        let [width, height] = targets.size();
        let open = self.plan.ground.map_or(0, |ground| ground.open_rows.min(height));
        for (rows, is_open) in [(0..open, true), (open..height, false)] {
            let key = background_key(self.plan, is_open);
            let extent = Extent::image([width, rows.end]).below(rows.start);
            self.jobs.extend(self.context.banded("background", &key, &bound, extent)?);
        }
        Ok(())
    }

    /// The clouds along this frame's rays; `counters` makes it count its work.
    pub(super) fn march(&mut self, counters: Option<&'a wgpu::Buffer>) -> Result<Option<&'a CloudTarget>, GpuError> {
        let targets = self.targets;
        let (Some(marched), Some(march)) = (&targets.marched, self.plan.march) else {
            return Ok(None);
        };
        let mut own: Bound<'a> = marched.outputs().collect();
        if let Some(distance) = &targets.ground_distance {
            own.push(("ground_distance", view_of(distance)));
        }
        let mut key = march_key(march);
        if let Some(counters) = counters {
            key = key.with_flags(["COUNT"]);
            own.push(("counters", counters.as_entire_binding()));
        }
        let bound = self.bound(&own);
        let [across, down] = marched.light.size();
        let block = self.plan.temporal.map_or(1, |pattern| pattern.block()[1]);
        let (first, end) = (self.plan.cloud_rows.start / block, self.plan.cloud_rows.end.div_ceil(block).min(down));
        let band = |rows: std::ops::Range<u32>| Extent::image([across, rows.end]).below(rows.start);
        for rows in [0..first, end..down] {
            self.jobs.extend(self.context.banded("march", &clear_key(march), &bound, band(rows))?);
        }
        self.jobs.extend(self.context.banded("march", &key, &bound, band(first..end))?);
        Ok(Some(marched))
    }

    /// The full picture from fresh rays and the picture before, `history` if it is of any use.
    pub(super) fn temporal(
        &mut self,
        fresh: &'a CloudTarget,
        history: Option<&'a Texture>,
        result: &'a Texture,
    ) -> Result<(), GpuError> {
        let mut own = vec![("fresh_cloud", view_of(&fresh.light)), ("cloud_out", view_of(result))];
        own.extend(fresh.distance.iter().map(|distance| ("fresh_distance", view_of(distance))));
        if let Some(history) = history {
            own.push(("history_cloud", view_of(history)));
        }
        let bound = self.bound(&own);
        let key = temporal_key(history.is_some());
        self.jobs.extend(self.context.banded("temporal", &key, &bound, Extent::image(self.targets.size()))?);
        Ok(())
    }

    /// Streaks of light: mask, then blur; they are added where the picture is composed.
    pub(super) fn sunshafts(&mut self, cloud: Option<&'a Texture>) -> Result<(), GpuError> {
        let Some([mask, shafts]) = &self.targets.shafts else {
            return Ok(());
        };
        let mut own = vec![("mask_out", view_of(mask))];
        own.extend(cloud.map(|cloud| ("cloud", view_of(cloud))));
        if let Some(distance) = &self.targets.ground_distance {
            own.push(("ground_distance", view_of(distance)));
        }
        let extent = Extent::image(mask.size());
        let key = shafts_mask_key(self.plan);
        self.jobs.push(self.context.whole("sunshafts", &key, &self.bound(&own), extent)?);
        let own = [("shafts_mask", view_of(mask)), ("shafts_out", view_of(shafts))];
        let key = ProgramKey::plain("pass/shafts_blur.wgsl");
        self.jobs.push(self.context.whole("sunshafts", &key, &self.bound(&own), extent)?);
        Ok(())
    }

    /// [`Self::finish`] with each of the two means, or twice the same where pixels have a single sample. The jobs before it
    /// must have been taken.
    pub(super) fn finish_into_either(&mut self, cloud: Option<&'a Texture>) -> Result<[Vec<Job>; 2], GpuError> {
        let mut either = [Vec::new(), Vec::new()];
        for (side, jobs) in either.iter_mut().enumerate() {
            self.finish(cloud, &self.targets.display[0], side)?;
            *jobs = std::mem::take(&mut self.jobs);
        }
        Ok(either)
    }

    /// Linear light for a file, and the picture for the screen. Where pixels have several samples, `side` says which of
    /// the two means this one goes into.
    pub(super) fn finish(
        &mut self,
        cloud: Option<&'a Texture>,
        display: &'a Texture,
        side: usize,
    ) -> Result<(), GpuError> {
        let targets = self.targets;
        let mut own = vec![("background", view_of(&targets.background)), ("display_out", view_of(display))];
        if let Some(cloud) = cloud {
            own.push(("cloud", view_of(cloud)));
        }
        if let Some([_, shafts]) = &targets.shafts {
            own.push(("shafts_light", view_of(shafts)));
        }
        if let Some(linear) = targets.linear(side) {
            own.push(("linear_out", view_of(linear)));
        }
        if let Some(means) = &targets.means {
            own.extend([("shown_before", view_of(&means[1 - side].shown)), ("shown_out", view_of(&means[side].shown))]);
            own.extend(targets.linear(1 - side).map(|before| ("linear_before", view_of(before))));
        }
        let bound = self.bound(&own);
        let extent = Extent::image(targets.size());
        if self.plan.float {
            self.jobs.push(self.context.whole("composite", &composite_key(self.plan), &bound, extent)?);
        }
        self.jobs.extend(self.context.banded("tonemap", &tonemap_key(self.plan), &bound, extent)?);
        Ok(())
    }
}
