//! Painted layers of the weather map: their strokes, drawn as far as they are not there yet.
//!
//! Most dabs change each texel by itself. Those that move or smooth take from other texels, so some of them at a time work on
//! what was there before: a stroke that grows goes back to that, and is the same at the end as one drawn at once.

use glam::{IVec2, UVec2, Vec2, Vec4};
use wgpu::util::DeviceExt as _;

use super::context::{Context, Extent};
use super::uniforms::edge_index;
use super::uniforms::other::PaintUniforms;
use crate::gpu::{Gpu, GpuError, Job, ProgramKey};
use crate::plan::{Effect, FramePlan};
use crate::scene::{Brush, CloudKind, MapEdge, Stroke, Strokes};

/// Dabs that one job draws: it goes through all of them at each texel that any of them reaches.
const MOST_AT_ONCE: usize = 256;
/// Dabs that move or smooth what was there before all of them.
const MOVED_AT_ONCE: usize = 64;
/// How much one dab draws its surroundings apart or together.
const GROWTH: f32 = 0.08;
/// Bytes of a texel of a painted layer.
const TEXEL_BYTES: u64 = 48;

/// One painted layer.
#[derive(Debug)]
pub(super) struct Painting {
    side: u32,
    applied: Strokes,
    /// What lies beyond the map's edge.
    edge: MapEdge,
    buffer: wgpu::Buffer,
    /// What was painted before the last dabs that move or smooth: which stroke's, and the first of them.
    kept: Option<((usize, usize), wgpu::Buffer)>,
}

impl Painting {
    /// A layer of so many texels across, without paint.
    pub(super) fn new(gpu: &Gpu, side: u32) -> Self {
        Self { side, applied: Strokes::default(), edge: MapEdge::Repeat, buffer: clear(gpu, side), kept: None }
    }

    /// What was painted.
    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }

    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.buffer.size() + self.kept.as_ref().map_or(0, |(_, buffer)| buffer.size())
    }

    /// Appends the jobs that draw the strokes. What was only added to is drawn on; all is drawn anew where a stroke is gone.
    pub(super) fn update(
        &mut self,
        context: &Context<'_>,
        (strokes, edge): (&Strokes, MapEdge),
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        if self.edge != edge {
            *self = Self { edge, ..Self::new(context.gpu, self.side) };
        }
        let same = self.applied.0.iter().zip(&strokes.0).take_while(|(old, new)| old == new).count();
        let (rest, wanted) = (&self.applied.0[same..], &strokes.0[same..]);
        // The stroke under the brush grows.
        let drawn = match (rest, wanted) {
            ([], _) => Some(0),
            ([old], [new, ..]) => grown_from(old, new).filter(|drawn| self.can_go_on(same, new, *drawn)),
            _ => None,
        };
        let (first, drawn) = match drawn {
            Some(drawn) => (same, drawn),
            None => {
                (self.buffer, self.kept) = (clear(context.gpu, self.side), None);
                (0, 0)
            }
        };
        for (index, stroke) in strokes.0.iter().enumerate().skip(first) {
            let drawn = if index == first { drawn } else { 0 };
            if stroke.brush.reworks() {
                self.draw_from_before(context, (index, stroke), drawn, jobs)?;
            } else {
                self.draw(context, stroke, drawn, jobs)?;
            }
        }
        // Only a stroke that may grow needs what was before.
        if !strokes.0.last().is_some_and(|stroke| stroke.brush.reworks()) {
            self.kept = None;
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
        self.dispatch(context, (dabs_key(), stroke), (dabs, None), jobs)
    }

    /// Whether what is there of a stroke can be drawn on.
    fn can_go_on(&self, index: usize, stroke: &Stroke, drawn: usize) -> bool {
        let first = drawn - drawn % MOVED_AT_ONCE;
        let is_kept = || self.kept.as_ref().is_some_and(|(of, _)| *of == (index, first));
        !stroke.brush.reworks() || first == drawn || is_kept()
    }

    /// Draws a stroke that moves or smooths from one of its dabs on: those that are done together anew.
    fn draw_from_before(
        &mut self,
        context: &Context<'_>,
        (index, stroke): (usize, &Stroke),
        drawn: usize,
        jobs: &mut Vec<Job>,
    ) -> Result<(), GpuError> {
        let begun = drawn - drawn % MOVED_AT_ONCE;
        for first in (begun..stroke.dabs.len()).step_by(MOVED_AT_ONCE) {
            let kept = match self.kept.take() {
                Some((of, kept)) if of == (index, first) => kept,
                other => {
                    let kept = other.map_or_else(|| clear(context.gpu, self.side), |(_, kept)| kept);
                    self.keep(context, &kept, jobs)?;
                    kept
                }
            };
            let last = (first + MOVED_AT_ONCE).min(stroke.dabs.len());
            // The place before the first of them is where it came from.
            let mut dabs = vec![stroke.dabs[first.saturating_sub(1)]];
            dabs.extend(&stroke.dabs[first..last]);
            let key = ProgramKey::plain(if stroke.brush == Brush::Smooth { SMOOTH } else { WARP });
            self.dispatch(context, (key, stroke), (&dabs, Some(&kept)), jobs)?;
            self.kept = Some(((index, first), kept));
        }
        Ok(())
    }

    /// Keeps what is painted.
    fn keep(&self, context: &Context<'_>, kept: &wgpu::Buffer, jobs: &mut Vec<Job>) -> Result<(), GpuError> {
        let uniforms = PaintUniforms { side: self.side, ..bytemuck::Zeroable::zeroed() };
        let paint = context.gpu.uniform("paint", bytemuck::bytes_of(&uniforms));
        let bound = vec![
            ("paint", paint.as_entire_binding()),
            ("painted", self.buffer.as_entire_binding()),
            ("kept", kept.as_entire_binding()),
        ];
        jobs.push(context.whole("paint", &ProgramKey::plain(KEEP), &bound, Extent::image([self.side; 2]))?);
        Ok(())
    }

    /// Draws dabs of a stroke by a program, with what was there before if it takes from that.
    fn dispatch(
        &self,
        context: &Context<'_>,
        (key, stroke): (ProgramKey, &Stroke),
        (dabs, kept): (&[[f32; 2]], Option<&wgpu::Buffer>),
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
            edge: edge_index(self.edge),
            ..uniforms(stroke, (corner, extent), (dabs.len(), self.side))
        };
        let paint = context.gpu.uniform("paint", bytemuck::bytes_of(&uniforms));
        let places = context.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("dabs"),
            contents: bytemuck::cast_slice(&dabs),
            usage: wgpu::BufferUsages::STORAGE,
        });
        let mut bound = vec![
            ("paint", paint.as_entire_binding()),
            ("dabs", places.as_entire_binding()),
            ("painted", self.buffer.as_entire_binding()),
        ];
        bound.extend(kept.map(|kept| ("kept", kept.as_entire_binding())));
        jobs.push(context.whole("paint", &key, &bound, Extent::image(uniforms.extent.to_array()))?);
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
        size: u64::from(side) * u64::from(side) * TEXEL_BYTES,
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
        Brush::Move | Brush::Grow | Brush::Shrink | Brush::Smooth => (Vec4::ZERO, Vec2::ZERO),
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
        edge: 0,
        grows: match stroke.brush {
            Brush::Grow => GROWTH,
            Brush::Shrink => -GROWTH,
            _ => 0.0,
        },
        pad1: 0,
        pad2: 0,
    }
}

const WARP: &str = "pass/paint_warp.wgsl";
const SMOOTH: &str = "pass/paint_smooth.wgsl";
const KEEP: &str = "pass/paint_keep.wgsl";

fn dabs_key() -> ProgramKey {
    ProgramKey::plain("pass/paint_dabs.wgsl")
}

/// The program that lays a painted layer over those below it.
pub(super) fn blend_key(has_below: bool) -> ProgramKey {
    ProgramKey::plain("pass/weather_paint.wgsl").with_flags(has_below.then_some("BELOW"))
}

/// The programs that make what a plan calls for.
pub(super) fn programs(plan: &FramePlan) -> Vec<ProgramKey> {
    let draws = plan.runs(Effect::Painting).then(|| [dabs_key(), blend_key(true), blend_key(false)]);
    let reworks =
        (plan.runs(Effect::Painting) && plan.map_layers.reworked).then(|| [WARP, SMOOTH, KEEP].map(ProgramKey::plain));
    draws.into_iter().flatten().chain(reworks.into_iter().flatten()).collect()
}
