//! The eye, in f64 in the world and in f32 relative to the sea-level point below it.

use glam::{DVec3, Vec3};

use super::scene::CameraUniforms;
use crate::scene::{Camera, Projection, direction};

/// Where the eye is and what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Eye {
    /// Position in the world in metres: east, height, south.
    pub(crate) position: DVec3,
    /// Direction of view in degrees: heading and pitch.
    pub(crate) heading_pitch_deg: [f32; 2],
}

impl Eye {
    pub(crate) fn new(camera: &Camera) -> Self {
        let position = DVec3::new(camera.east_m.into(), camera.height_m.into(), camera.south_m.into());
        Self { position, heading_pitch_deg: [camera.heading_deg, camera.pitch_deg] }
    }
}

/// The camera as shaders take it, `eye` seen from the sea-level point below `origin`.
pub(crate) fn camera_uniforms(camera: &Camera, size: [u32; 2], eye: &Eye, origin: &Eye) -> CameraUniforms {
    let [heading_deg, pitch_deg] = eye.heading_pitch_deg;
    let forward = direction(pitch_deg, heading_deg);
    let right = direction(0.0, heading_deg + 90.0);
    let up = right.cross(forward);
    let aspect = size[0] as f32 / size[1] as f32;
    let tan = (camera.field_of_view_deg * 0.5).to_radians().tan();
    let (scale_right, scale_up) = match camera.projection {
        Projection::Perspective => (tan * aspect, tan),
        Projection::Equirect | Projection::Dome => (1.0, 1.0),
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
    }
}
