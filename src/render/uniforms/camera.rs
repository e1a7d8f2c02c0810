//! The eye, in f64 in the world and in f32 relative to the sea-level point below it.

use glam::{DVec3, Vec2, Vec3};

use super::scene::CameraUniforms;
use crate::scene::{Camera, Frame, Projection};

/// Where the eye is and what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    /// Position in the world in metres: east, height, south.
    pub(crate) position: DVec3,
    /// Direction of view in degrees: heading, pitch and roll.
    pub(crate) turned_deg: [f32; 3],
}

impl Eye {
    pub(crate) fn new(camera: &Camera) -> Self {
        let position = DVec3::new(camera.east_m.into(), camera.height_m.into(), camera.south_m.into());
        Self { position, turned_deg: [camera.heading_deg, camera.pitch_deg, camera.roll_deg] }
    }
}

/// The frame's camera as shaders take it, `eye` seen from the sea-level point below `origin`.
#[allow(clippy::cast_possible_truncation, reason = "rounding to single precision is meant")]
pub(crate) fn camera_uniforms(frame: &Frame<'_>, eye: &Eye, origin: &Eye) -> CameraUniforms {
    let camera = &frame.scene.camera;
    let (offset_share, size_share) = frame.window_shares();
    let [heading_deg, pitch_deg, roll_deg] = eye.turned_deg;
    let [forward, right, up] = Camera { heading_deg, pitch_deg, roll_deg, ..camera.clone() }.axes();
    let [scale_right, scale_up] = match camera.projection {
        Projection::Perspective => camera.half_tangents(frame.whole_size()),
        Projection::Equirect | Projection::Dome => [1.0, 1.0],
    };
    let offset = eye.position - origin.position;
    CameraUniforms {
        eye: Vec3::new(offset.x as f32, eye.position.y as f32, offset.z as f32),
        projection: match camera.projection {
            Projection::Perspective => 0,
            Projection::Equirect => 1,
            Projection::Dome => 2,
        },
        forward,
        heading_rad: heading_deg.to_radians(),
        right: right * scale_right,
        pad0: 0.0,
        up: up * scale_up,
        pad1: 0.0,
        window_offset: Vec2::from_array(offset_share.map(|share| share as f32)),
        window_size: Vec2::from_array(size_share.map(|share| share as f32)),
    }
}
