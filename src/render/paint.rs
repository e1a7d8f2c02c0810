//! Painted layers of the weather map: their strokes, drawn as far as they are not there yet.

use glam::{IVec2, UVec2, Vec2, Vec4};
use wgpu::util::DeviceExt as _;

use super::context::{Context, Extent};
use super::uniforms::other::PaintUniforms;
use crate::gpu::{Gpu, GpuError, Job, ProgramKey};
use crate::plan::{Effect, FramePlan};
use crate::scene::{Brush, CloudKind, Stroke, Strokes};

/// Dabs that one job draws: it goes through all of them at each texel that any of them reaches.
const MOST_AT_ONCE: usize = 256;

/// One painted layer.
#[derive(Debug)]
pub(super) struct Painting {
    side: u32,
    applied: Strokes,
    /// Whether what crosses the map's edge goes on at the other side.
    repeats: bool,
    buffer: wgpu::Buffer,
}

impl Painting {
    /// A layer of so many texels across, without paint.
    pub(super) fn new(gpu: &Gpu, side: u32) -> Self {
        Self { side, applied: Strokes::default(), repeats: true, buffer: clear(gpu, side) }
    }

    /// What was painted.
    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Appends the jobs that draw the strokes. What was only added to is drawn on; all is drawn anew where a stroke is gone.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (strokes, repeats): (&Strokes, bool),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        if self.repeats != repeats {
            *self = Self { repeats, ..Self::new(context.gpu, self.side) };
        }
        let same = self.applied.0.iter().zip(&strokes.0).take_while(|(old, new)| old == new).count();
        let (rest, wanted) = (&self.applied.0[same..], &strokes.0[same..]);
        // The stroke under the brush grows.
        let drawn = match (rest, wanted) {
            ([], _) => Some(0),
            ([old], [new, ..]) => grown_from(old, new),
            _ => None,
        };
        let (first, drawn) = match drawn {
            Some(drawn) => (same, drawn),
            None => {
                self.buffer = clear(context.gpu, self.side);
                (0, 0)
            }
        };
        for (index, stroke) in strokes.0.iter().enumerate().skip(first) {
            let drawn = if index == first { drawn } else { 0 };
            self.draw(context, stroke, drawn, jobs)?;
        }
        self.applied = strokes.clone();
        Ok(())
    }

    /// Draws a stroke from one of its dabs on.
    fn draw(&self, context: &Context<'_>, stroke: &Stroke, drawn: usize, jobs: &mut Vec<Job>) -> Result<(), GpuError> {
        stroke.dabs[drawn..].chunks(MOST_AT_ONCE).try_for_each(|dabs| self.draw_some(context, stroke, dabs, jobs))
    }

    fn draw_some(
        &self,
        context: &Context<'_>,
        stroke: &Stroke,
        dabs: &[[f32; 2]],
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let side = self.side as f32;
        let dabs: Vec<Vec2> = dabs.iter().map(|dab| Vec2::from_array(*dab) * side).collect();
        let Some(first) = dabs.first() else { return Ok(()) };
        let (low, high) = dabs.iter().fold((*first, *first), |(low, high), dab| (low.min(*dab), high.max(*dab)));
        let reach = stroke.radius * side + 1.0;
        let corner = (low - reach).floor();
        let extent = ((high + reach).ceil() - corner).min(Vec2::splat(side));
        let (corner, extent) = (corner.as_ivec2(), extent.as_uvec2());
        let uniforms = PaintUniforms {
            repeats: self.repeats.into(),
            ..uniforms(stroke, (corner, extent), (dabs.len(), self.side))
        };
        let paint = context.gpu.uniform("paint", bytemuck::bytes_of(&uniforms));
        let places = context.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("dabs"),
            contents: bytemuck::cast_slice(&dabs),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let bound = vec![
            ("paint", paint.as_entire_binding()),
            ("dabs", places.as_entire_binding()),
            ("painted", self.buffer.as_entire_binding()),
        ];
        jobs.push(context.whole("paint", &dabs_key(), &bound, Extent::image(uniforms.extent.to_array()))?);
        Ok(())
    }
}

/// How many dabs of a stroke are those of another that it has grown from; `None` if it has not.
fn grown_from(old: &Stroke, new: &Stroke) -> Option<usize> {
    let is_same = new.dabs.starts_with(&old.dabs)
        && Stroke { dabs: Vec::new(), ..old.clone() } == Stroke { dabs: Vec::new(), ..new.clone() };
    is_same.then_some(old.dabs.len())
}

fn clear(gpu: &Gpu, side: u32) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("painted"),
        size: u64::from(side) * u64::from(side) * 32,
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    })
}

#[allow(clippy::cast_possible_truncation, reason = "the dabs of a stroke are few")]
fn uniforms(stroke: &Stroke, (first, extent): (IVec2, UVec2), (count, side): (usize, u32)) -> PaintUniforms {
    let kind = match stroke.kind {
        CloudKind::Cumulus => Vec4::X,
        CloudKind::Stratus => Vec4::Y,
        CloudKind::Stratocumulus => Vec4::Z,
    };
    let (goal, reaches) = match stroke.brush {
        Brush::Add => (kind * stroke.amount, Vec2::X),
        Brush::Erase | Brush::Restore => (Vec4::ZERO, Vec2::X),
        Brush::Raise => (Vec4::W, Vec2::Y),
        Brush::Lower => (Vec4::ZERO, Vec2::Y),
    };
    PaintUniforms {
        goal,
        reaches,
        first,
        extent,
        radius: stroke.radius,
        softness: stroke.softness,
        strength: stroke.strength,
        count: count as u32,
        side,
        restores: u32::from(stroke.brush == Brush::Restore),
        repeats: 1,
        pad0: 0,
        pad1: 0,
        pad2: 0,
    }
}

fn dabs_key() -> ProgramKey {
    ProgramKey::plain("pass/paint_dabs.wgsl")
}

/// The program that lays a painted layer over those below it.
pub(super) fn blend_key(has_below: bool) -> ProgramKey {
    ProgramKey::plain("pass/weather_paint.wgsl").with_flags(has_below.then_some("BELOW"))
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    if plan.runs(Effect::Painting) { vec![dabs_key(), blend_key(true), blend_key(false)] } else { Vec::new() }
}
