//! The world around the clouds: its shape, the ground, and the eye.

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

params! {
    /// The eye.
    pub struct Camera ("Camera") {
        /// How directions map onto the picture.
        projection: Projection = Projection::Perspective;
        /// Position towards the east.
        east_m: f32 = 0.0, -1_000_000.0..=1_000_000.0, Metres;
        /// Height above sea level, or above the ground where that is higher.
        height_m: f32 = 20.0, 1.0..=60_000.0, Metres, logarithmic;
        /// Position towards the south.
        south_m: f32 = 0.0, -1_000_000.0..=1_000_000.0, Metres;
        /// Direction of view, clockwise from north.
        heading_deg: f32 = 0.0, 0.0..=360.0, Degrees;
        /// Direction of view above the horizon.
        pitch_deg: f32 = 14.0, -90.0..=90.0, Degrees;
        /// Vertical field of view.
        field_of_view_deg: f32 = 50.0, 1.0..=150.0, Degrees;
    }
}

choices! {
    /// How light becomes display colour.
    pub enum ToneMap {
        /// `AgX`, as Blender's default: soft, hue-keeping.
        Agx ("AgX"),
        /// Khronos PBR Neutral: colours as given, highlights compressed.
        Neutral ("Khronos Neutral"),
        /// No curve; what is too bright clips.
        Linear ("Linear"),
    }
}

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
