//! The weather map as a picture, for whoever wants to see or paint all of it.

use super::context::Extent;
use super::passes::view_of;
use super::tables::TableKind;
use super::uniforms::field_uniforms;
use super::uniforms::other::MapViewUniforms;
use super::weather::SIDE;
use super::{RenderError, Renderer};
use crate::gpu::{ProgramKey, Texture, job};
use crate::scene::{DensityModel, Frame};

/// The last picture, and what it shows: the count of the map, and how it was read.
#[derive(Debug, Default)]
pub(super) struct MapView {
    made: Option<(u64, MapViewUniforms, Texture)>,
}

impl MapView {
    /// Device memory in bytes.
    pub(super) fn bytes(&self) -> u64 {
        self.made.as_ref().map_or(0, |(.., picture)| picture.bytes())
    }
}

/// The program that draws it.
pub fn programs() -> [ProgramKey; 1] {
    [ProgramKey::plain("pass/map_view.wgsl")]
}

/// How a layer of all reads the map, if it has cloud and does.
fn reading(frame: &Frame<'_>, layer: usize) -> Option<MapViewUniforms> {
    let (at, (_, of)) = frame.scene.numbered_layers().enumerate().find(|(_, (index, _))| *index == layer)?;
    let uniforms = field_uniforms(frame).layers[at];
    of.reads_map().then(|| MapViewUniforms {
        form: uniforms.form,
        cover: glam::Vec2::new(uniforms.body_scale, uniforms.body_bias),
        is_texture: f32::from(u8::from(of.model == DensityModel::Texture)),
        pad0: 0.0,
    })
}

impl Renderer {
    /// The weather map of the last picture as the frame's [`Scene::layer_on_map`](crate::scene::Scene::layer_on_map) reads
    /// it, coverage included but for that of a front that comes: `Rgba8Unorm`, north upwards. The one before while a picture is
    /// under way or the shader is compiled; `None` where there is none.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn map_view(&mut self, frame: &Frame<'_>) -> Result<Option<&Texture>, RenderError> {
        let layer = frame.scene.layer_on_map().map(|(index, _)| index);
        let (Some(how), Some(map)) = (layer.and_then(|layer| reading(frame, layer)), self.weather.map()) else {
            self.map_view.made = None;
            return Ok(None);
        };
        let count = self.weather.count();
        let is_made = self.map_view.made.as_ref().is_some_and(|(of, by, _)| (*of, *by) == (count, how));
        let [key] = programs();
        if !is_made && self.pending.is_none() && self.programs.ready_or_start(&key)? {
            let picture = match self.map_view.made.take() {
                Some((.., picture)) => picture,
                None => Texture::new_2d(&self.gpu, "map_view", [SIDE; 2], wgpu::TextureFormat::Rgba8Unorm)?,
            };
            let uniforms = self.gpu.uniform("map_view", bytemuck::bytes_of(&how));
            let bound = vec![
                ("map_view", uniforms.as_entire_binding()),
                ("weather_map", view_of(map)),
                ("picture_out", view_of(&picture)),
            ];
            let draw = self.context_apart().whole("map_view", &key, &bound, Extent::image([SIDE; 2]))?;
            job::submit(&self.gpu, &[draw]);
            self.map_view.made = Some((count, how, picture));
        }
        Ok(self.map_view.made.as_ref().map(|(.., picture)| picture))
    }

    /// How deep inside of cloud the weather map of a frame is at each of its texels, 0 to 1, row by row, as a layer of all reads
    /// it; `None` where it does not.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn map_bodies(&mut self, frame: &Frame<'_>, layer: usize) -> Result<Option<Vec<f32>>, RenderError> {
        let Some(how) = reading(frame, layer) else { return Ok(None) };
        let body = |[r, g, b, _]: [f32; 4]| {
            let field = if how.is_texture > 0.0 { r } else { r + g + b };
            (field * how.cover.x + how.cover.y).clamp(0.0, 1.0)
        };
        let map = self.table(frame, TableKind::WeatherMap)?;
        Ok(map.map(|map| map.rgba.into_iter().map(body).collect()))
    }

    /// Lets go of that picture.
    pub fn close_map_view(&mut self) {
        self.map_view = MapView::default();
    }
}
