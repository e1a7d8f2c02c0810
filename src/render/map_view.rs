//! The weather map as a picture, for whoever wants to see or paint all of it.

use super::context::Extent;
use super::passes::view_of;
use super::uniforms::field_uniforms;
use super::uniforms::other::MapViewUniforms;
use super::weather::SIDE;
use super::{RenderError, Renderer};
use crate::gpu::{ProgramKey, Texture, job};
use crate::scene::{CloudLayer, DensityModel, Frame};

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

impl Renderer {
    /// The weather map of the last picture as the frame's [`Scene::layer_on_map`](crate::scene::Scene::layer_on_map) reads it, coverage included but for that of a
    /// front that comes: `Rgba8Unorm`, north upwards. The one before while a picture is under way or the shader is compiled;
    /// `None` where there is none.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if the device fails.
    pub fn map_view(&mut self, frame: &Frame<'_>) -> Result<Option<&Texture>, RenderError> {
        let visible = frame.scene.visible_layers().position(CloudLayer::reads_map);
        let (Some(index), Some(map)) = (visible, self.weather.map()) else {
            self.map_view.made = None;
            return Ok(None);
        };
        let layer = field_uniforms(frame).layers[index];
        let is_texture =
            frame.scene.visible_layers().nth(index).is_some_and(|layer| layer.model == DensityModel::Texture);
        let how = MapViewUniforms {
            form: layer.form,
            cover: glam::Vec2::new(layer.body_scale, layer.body_bias),
            is_texture: f32::from(u8::from(is_texture)),
            pad0: 0.0,
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

    /// Lets go of that picture.
    pub fn close_map_view(&mut self) {
        self.map_view = MapView::default();
    }
}
