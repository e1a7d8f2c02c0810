//! The world around the clouds: its shape, the ground, and the eye.

use glam::Vec3;

use super::direction;
use super::param::Colour;
use crate::{choices, params};

choices! {
    /// The shape of the space that holds clouds.
    pub enum DomainKind {
        /// A shell round a planet.
        Shell ("Planet shell"),
        /// An infinite flat slab.
        Flat ("Flat slab"),
        /// An axis-aligned box; the layers' heights are its bottom and top.
        Box ("Box"),
    }
}

params! {
    /// The space that holds clouds.
    pub struct Domain ("Domain") {
        /// Shape of the space.
        kind: DomainKind = DomainKind::Shell;
        /// Radius of the planet.
        planet_radius_m: f32 = 6_360_000.0, 100_000.0..=100_000_000.0, Metres, logarithmic;
        /// Middle of the box, towards the east.
        box_east_m: f32 = 0.0, -100_000.0..=100_000.0, Metres;
        /// Middle of the box, towards the south.
        box_south_m: f32 = -8000.0, -100_000.0..=100_000.0, Metres;
        /// Size of the box from west to east.
        box_width_m: f32 = 8000.0, 10.0..=200_000.0, Metres, logarithmic;
        /// Size of the box from north to south.
        box_length_m: f32 = 8000.0, 10.0..=200_000.0, Metres, logarithmic;
    }
}

params! {
    /// The ground, with hills and mountains.
    pub struct Ground ("Ground") {
        /// Whether ground is drawn below the horizon.
        visible: bool = true;
        /// Colour of lit ground (albedo) in the plains.
        albedo: Colour = Colour(0.062, 0.075, 0.036);
        /// Colour of rock and heights.
        rock: Colour = Colour(0.12, 0.11, 0.10);
        /// Height of the mountains. 0 leaves a plain.
        mountains_m: f32 = 0.0, 0.0..=5000.0, Metres;
        /// Distance from one range to the next.
        mountain_size_m: f32 = 6000.0, 1000.0..=100_000.0, Metres, logarithmic;
        /// Height of the hills between them.
        hills_m: f32 = 60.0, 0.0..=1000.0, Metres;
        /// Seed of the terrain.
        seed: u32 = 3, 0..=999_999, None;
        /// Strength of the shadows that clouds cast on the ground. 0 removes the pass.
        cloud_shadows: f32 = 0.85, 0.0..=1.0, None;
    }
}

choices! {
    /// How directions map onto the picture.
    pub enum Projection {
        /// As a lens does.
        Perspective ("Perspective"),
        /// All directions: longitude across, latitude down; the middle looks along the camera's heading.
        Equirect ("Equirectangular"),
        /// The upper half of all directions: longitude across, the zenith at the top, the horizon at the bottom.
        Dome ("Sky dome"),
    }
}

choices! {
    /// The side of a picture that the field of view spans.
    pub enum FieldOfViewAxis {
        /// From its lower to its upper edge.
        Vertical ("Vertical"),
        /// From its left to its right edge.
        Horizontal ("Horizontal"),
    }
}

/// The eye is no farther to the east, west, north or south.
pub const FARTHEST_M: f32 = 1_000_000.0;

params! {
    /// The eye.
    pub struct Camera ("Camera") {
        /// How directions map onto the picture.
        projection: Projection = Projection::Perspective;
        /// Position towards the east.
        east_m: f32 = 0.0, -FARTHEST_M..=FARTHEST_M, Metres;
        /// Height above sea level, or above the ground where that is higher.
        height_m: f32 = 20.0, 1.0..=60_000.0, Metres, logarithmic;
        /// Position towards the south.
        south_m: f32 = 0.0, -FARTHEST_M..=FARTHEST_M, Metres;
        /// Direction of view, clockwise from north.
        heading_deg: f32 = 0.0, 0.0..=360.0, Degrees;
        /// Direction of view above the horizon.
        pitch_deg: f32 = 14.0, -90.0..=90.0, Degrees;
        /// Tilt about the direction of view; positive lowers the right side. Only a lens tilts.
        roll_deg: f32 = 0.0, -180.0..=180.0, Degrees;
        /// Field of view of a lens.
        field_of_view_deg: f32 = 50.0, 1.0..=150.0, Degrees;
        /// The side of the picture that the field of view spans.
        field_of_view_axis: FieldOfViewAxis = FieldOfViewAxis::Vertical;
    }
}

impl Ground {
    /// Greatest height of ranges and hills relative to what the parameters say.
    pub const RELIEF_BOUND: [f32; 2] = [1.25, 1.15];

    /// No ground is higher than this above the sea.
    pub fn highest_m(&self) -> f32 {
        let [ranges, hills] = Self::RELIEF_BOUND;
        self.mountains_m * ranges + self.hills_m * hills
    }
}

impl Camera {
    /// Tangents of half the angles that a lens spans, across and up a picture of this size.
    pub fn half_tangents(&self, [width, height]: [u32; 2]) -> [f32; 2] {
        let tangent = (self.field_of_view_deg * 0.5).to_radians().tan();
        let aspect = width as f32 / height as f32;
        match self.field_of_view_axis {
            FieldOfViewAxis::Vertical => [tangent * aspect, tangent],
            FieldOfViewAxis::Horizontal => [tangent, tangent / aspect],
        }
    }

    /// Unit vectors into the middle of the picture, to its right and up.
    pub fn axes(&self) -> [Vec3; 3] {
        let forward = direction(self.pitch_deg, self.heading_deg);
        let level = direction(0.0, self.heading_deg + 90.0);
        let upright = level.cross(forward);
        if self.projection != Projection::Perspective || self.roll_deg == 0.0 {
            return [forward, level, upright];
        }
        let (sine, cosine) = self.roll_deg.to_radians().sin_cos();
        [forward, level * cosine - upright * sine, upright * cosine + level * sine]
    }

    /// Unit direction through a point of a picture of this size; the point is 0 to 1 from the top left.
    pub fn direction_through(&self, [u, v]: [f32; 2], size: [u32; 2]) -> Vec3 {
        match self.projection {
            Projection::Perspective => {
                let [forward, right, up] = self.axes();
                let [across, high] = self.half_tangents(size);
                (forward + right * (across * (2.0 * u - 1.0)) + up * (high * (1.0 - 2.0 * v))).normalize()
            }
            Projection::Equirect => direction(90.0 - 180.0 * v, self.heading_deg + 360.0 * (u - 0.5)),
            Projection::Dome => direction(90.0 - 90.0 * v, self.heading_deg + 360.0 * (u - 0.5)),
        }
    }

    /// The point of a picture of this size that shows a direction, 0 to 1 from the top left; `None` if none does: behind a lens,
    /// or below a dome. The inverse of [`Self::direction_through`].
    pub fn point_of(&self, towards: Vec3, size: [u32; 2]) -> Option<[f32; 2]> {
        if self.projection == Projection::Perspective {
            let [forward, right, up] = self.axes();
            let [across, high] = self.half_tangents(size);
            let ahead = towards.dot(forward);
            let point =
                [0.5 + 0.5 * towards.dot(right) / (ahead * across), 0.5 - 0.5 * towards.dot(up) / (ahead * high)];
            return (ahead > 1e-4).then_some(point);
        }
        let elevation = towards.y.clamp(-1.0, 1.0).asin().to_degrees();
        let azimuth = towards.x.atan2(-towards.z).to_degrees();
        let u = 0.5 + ((azimuth - self.heading_deg + 180.0).rem_euclid(360.0) - 180.0) / 360.0;
        match self.projection {
            Projection::Dome => (elevation >= 0.0).then_some([u, (90.0 - elevation) / 90.0]),
            _ => Some([u, (90.0 - elevation) / 180.0]),
        }
    }

    /// Turns it towards a direction, with `up` as near to the picture's up as can be. Neither may be zero.
    pub fn look(&mut self, forward: Vec3, up: Vec3) {
        let forward = forward.normalize();
        self.pitch_deg = forward.y.clamp(-1.0, 1.0).asin().to_degrees();
        let is_vertical = forward.x.hypot(forward.z) < 1e-6;
        let heading = if is_vertical { 0.0 } else { forward.x.atan2(-forward.z).to_degrees() };
        self.heading_deg = heading.rem_euclid(360.0);
        self.roll_deg = 0.0;
        let [_, right, upright] = self.axes();
        self.roll_deg = up.dot(right).atan2(up.dot(upright)).to_degrees();
    }
}

choices! {
    /// How light becomes display colour.
    pub enum ToneMap {
        /// `AgX`, as Blender's default: soft, hue-keeping.
        Agx ("AgX"),
        /// Khronos PBR Neutral: colours as given, highlights compressed.
        Neutral ("Khronos Neutral"),
        /// The fit of the Academy's film curve that engines use: contrasty, bright colours turn white and blues violet.
        Aces ("ACES fit"),
        /// No curve; what is too bright clips.
        Linear ("Linear"),
        /// Stops above and below middle grey as colours, to judge exposure by: grey is grey, red is about to clip.
        FalseColour ("False colour"),
    }
}

/// The bands of [`ToneMap::FalseColour`]: stops relative to middle grey where each ends, and its colour as displayed. The same
/// table is in `common/tonemap.wgsl`.
pub const FALSE_COLOURS: [(f32, [u8; 3]); 11] = [
    (-6.0, [38, 10, 64]),
    (-4.0, [40, 50, 160]),
    (-2.0, [30, 120, 200]),
    (-1.0, [30, 150, 150]),
    (-0.5, [40, 140, 70]),
    (0.5, [128, 128, 128]),
    (1.0, [120, 190, 80]),
    (2.0, [220, 220, 70]),
    (3.0, [240, 160, 50]),
    (4.5, [220, 60, 40]),
    (f32::INFINITY, [255, 255, 255]),
];

params! {
    /// How light becomes the picture on the screen. Never part of an EXR.
    pub struct Display ("Display") {
        /// Exposure value at ISO 100 that is rendered as middle tones; 15 suits a sunny day, −3 a moonlit night.
        exposure_ev: f32 = 13.5, -12.0..=24.0, Stops;
        /// Colour temperature of the light that is shown as white.
        white_kelvin: f32 = 5500.0, 2000.0..=20_000.0, Kelvin, logarithmic;
        /// How light becomes display colour.
        tone_map: ToneMap = ToneMap::Agx;
        /// Saturation of the tone-mapped picture.
        saturation: f32 = 1.12, 0.0..=2.0, None;
        /// Contrast of the tone-mapped picture.
        contrast: f32 = 1.12, 0.5..=2.0, None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_looks_where_it_is_told() {
        let mut camera = Camera::default();
        for (forward, up) in [
            (Vec3::new(0.3, -0.2, -0.8), Vec3::Y),
            (Vec3::new(-0.5, 0.1, 0.7), Vec3::Z),
            (Vec3::NEG_Y, Vec3::X),
            (Vec3::Y, Vec3::new(1.0, 0.0, 1.0)),
            (Vec3::X, Vec3::NEG_Y),
        ] {
            camera.look(forward, up);
            let [ahead, right, upright] = camera.axes();
            assert!(ahead.abs_diff_eq(forward.normalize(), 1e-6), "{ahead} instead of {forward}");
            let wanted = (up - ahead * up.dot(ahead)).normalize();
            assert!(upright.abs_diff_eq(wanted, 1e-5), "{upright} instead of {wanted}");
            assert!(right.cross(ahead).abs_diff_eq(upright, 1e-6), "right-handed: {right}");
            assert!((0.0..=360.0).contains(&camera.heading_deg), "{}", camera.heading_deg);
        }
        camera.look(Vec3::NEG_Z, Vec3::new(0.5, 1.0, 0.0));
        assert!(camera.roll_deg > 0.0 && camera.axes()[1].y < 0.0, "a tilt to the right lowers the right side");
    }

    #[test]
    fn corners_of_pictures_are_where_they_belong() {
        let mut camera = Camera { pitch_deg: 0.0, field_of_view_deg: 90.0, ..Camera::default() };
        let [forward, right, up] = camera.axes();
        let corner = camera.direction_through([1.0, 0.0], [200, 100]);
        assert!(corner.abs_diff_eq((forward + right * 2.0 + up).normalize(), 1e-6), "{corner}");
        camera.projection = Projection::Equirect;
        assert!(camera.direction_through([0.5, 0.5], [2, 1]).abs_diff_eq(forward, 1e-6), "the middle");
        assert!(camera.direction_through([0.75, 0.5], [2, 1]).abs_diff_eq(right, 1e-6), "a quarter to the right");
        assert!(camera.direction_through([0.1, 1.0], [2, 1]).abs_diff_eq(Vec3::NEG_Y, 1e-6), "straight down");
        camera.projection = Projection::Dome;
        assert!(camera.direction_through([0.5, 1.0], [2, 1]).abs_diff_eq(forward, 1e-6), "the horizon");
    }

    #[test]
    fn points_and_directions_are_inverse() {
        let mut camera = Camera {
            heading_deg: 350.0,
            pitch_deg: 20.0,
            roll_deg: 12.0,
            field_of_view_deg: 70.0,
            ..Camera::default()
        };
        for projection in [Projection::Perspective, Projection::Equirect, Projection::Dome] {
            camera.projection = projection;
            for point in [[0.5, 0.5], [0.1, 0.2], [0.9, 0.95]] {
                let found = camera.point_of(camera.direction_through(point, [300, 200]), [300, 200]);
                let [u, v] = found.expect("it is in the picture");
                assert!((u - point[0]).abs() < 1e-4 && (v - point[1]).abs() < 1e-4, "{projection:?}: {u} {v}");
            }
        }
        camera.projection = Projection::Perspective;
        assert_eq!(camera.point_of(-camera.axes()[0], [3, 2]), None, "behind");
    }

    #[test]
    fn the_field_of_view_spans_the_side_it_names() {
        let mut camera = Camera { field_of_view_deg: 90.0, ..Camera::default() };
        assert!((camera.half_tangents([200, 100])[1] - 1.0).abs() < 1e-6, "up");
        camera.field_of_view_axis = FieldOfViewAxis::Horizontal;
        let [across, up] = camera.half_tangents([200, 100]);
        assert!((across - 1.0).abs() < 1e-6 && (up - 0.5).abs() < 1e-6, "across: {across}, {up}");
    }
}
