//! The faces of a cube map.
//!
//! Names and turns are those that graphics interfaces share (Vulkan 1.3, "Cube Map Face Selection") for a world of x east,
//! y up and z north: six files named after them load as a cube map that answers a direction (east, up, north) with its
//! light. Each face is an ordinary picture with a field of view of 90°.

use glam::Vec3;

use super::{Camera, FieldOfViewAxis, Projection};

/// One face of a cube map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeFace {
    /// The axis that it looks along: `px` is east, `py` up, `pz` north.
    pub name: &'static str,
    /// The same in the scene's axes.
    pub forward: Vec3,
    /// What is up in the picture.
    pub up: Vec3,
}

/// All faces in the usual order.
pub const CUBE_FACES: [CubeFace; 6] = [
    CubeFace { name: "px", forward: Vec3::X, up: Vec3::Y },
    CubeFace { name: "nx", forward: Vec3::NEG_X, up: Vec3::Y },
    CubeFace { name: "py", forward: Vec3::Y, up: Vec3::Z },
    CubeFace { name: "ny", forward: Vec3::NEG_Y, up: Vec3::NEG_Z },
    CubeFace { name: "pz", forward: Vec3::NEG_Z, up: Vec3::Y },
    CubeFace { name: "nz", forward: Vec3::Z, up: Vec3::Y },
];

impl Camera {
    /// The same eye looking at a face of a cube.
    pub fn at_face(&self, face: &CubeFace) -> Self {
        let mut camera = self.clone();
        camera.projection = Projection::Perspective;
        camera.field_of_view_deg = 90.0;
        camera.field_of_view_axis = FieldOfViewAxis::Vertical;
        camera.look(face.forward, face.up);
        camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The face and the place on it that answer a direction (east, up, north), from the table in the specification.
    fn selected([x, y, z]: [f32; 3]) -> (usize, [f32; 2]) {
        let major = x.abs().max(y.abs()).max(z.abs());
        let (face, s, t) = if x.abs() == major {
            if x > 0.0 { (0, -z, -y) } else { (1, z, -y) }
        } else if y.abs() == major {
            if y > 0.0 { (2, x, z) } else { (3, x, -z) }
        } else if z > 0.0 {
            (4, x, -y)
        } else {
            (5, -x, -y)
        };
        (face, [0.5 * (s / major + 1.0), 0.5 * (t / major + 1.0)])
    }

    #[test]
    fn a_direction_is_answered_by_the_pixel_that_shows_it() {
        let camera = Camera { heading_deg: 77.0, pitch_deg: -3.0, roll_deg: 5.0, ..Camera::default() };
        for direction in
            [[0.9, 0.2, 0.3], [-0.8, -0.5, 0.1], [0.1, 0.9, -0.4], [0.3, -0.7, 0.2], [0.2, 0.3, 0.8], [-0.3, 0.1, -0.9]]
        {
            let (index, [u, v]) = selected(direction);
            let [east, up, north] = direction;
            let towards = Vec3::new(east, up, -north).normalize();
            let point = camera.at_face(&CUBE_FACES[index]).point_of(towards, [256, 256]).expect("it is in view");
            assert!(
                (point[0] - u).abs() < 1e-4 && (point[1] - v).abs() < 1e-4,
                "{direction:?} on {}: {point:?} instead of {u}, {v}",
                CUBE_FACES[index].name
            );
        }
    }
}
