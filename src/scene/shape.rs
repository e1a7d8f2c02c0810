//! Shapes by signed distance: bodies of cloud for layers of that model, and solid things that clouds surround (Thomann 2020,
//! chapter 4; Costa 2023, section 2.2).

use super::param::Colour;
use crate::{choices, params};

/// Most shapes one scene may hold.
pub const MAX_SHAPES: usize = 64;

choices! {
    /// What a shape is.
    pub enum ShapeKind {
        /// As wide as it is, in all directions.
        Sphere ("Sphere"),
        /// A sphere with a width, length and tallness of its own.
        Ellipsoid ("Ellipsoid"),
        /// A box, with rounded edges if wanted.
        Box ("Box"),
        /// An upright cylinder of its width and tallness.
        Cylinder ("Cylinder"),
        /// An upright cylinder with a half sphere on both ends, of its width and tallness.
        Capsule ("Capsule"),
    }
}

choices! {
    /// What a shape consists of.
    pub enum ShapeRole {
        /// Cloud, in layers whose model is *Shapes*.
        Cloud ("Cloud"),
        /// A solid thing, with shadows.
        Solid ("Solid"),
    }
}

choices! {
    /// How a shape joins those of its role before it.
    pub enum ShapeJoin {
        /// What is in either.
        Union ("Added"),
        /// What is in those before and not in this one.
        Difference ("Taken away"),
        /// What is in both.
        Intersection ("Common to both"),
    }
}

impl Shape {
    /// Most from side to side, and from bottom to top.
    pub const WIDEST_M: f32 = 100_000.0;
    /// The same upwards.
    pub const TALLEST_M: f32 = 20_000.0;
}

params! {
    /// A body with a place in the world.
    pub struct Shape ("Shape") {
        /// What it is.
        kind: ShapeKind = ShapeKind::Ellipsoid;
        /// What it consists of.
        role: ShapeRole = ShapeRole::Cloud;
        /// How it joins the shapes of its role before it.
        join: ShapeJoin = ShapeJoin::Union;
        /// Over what distance it melts into those before it.
        blend_m: f32 = 0.0, 0.0..=5000.0, Metres;
        /// Its middle, east of the world's origin.
        east_m: f32 = 0.0, -200_000.0..=200_000.0, Metres;
        /// Its middle, south of the world's origin; negative is north.
        south_m: f32 = -4000.0, -200_000.0..=200_000.0, Metres;
        /// Height of its middle above sea level.
        height_m: f32 = 1900.0, -5000.0..=20_000.0, Metres;
        /// Its extent from west to east.
        width_m: f32 = 2400.0, 0.0..=Self::WIDEST_M, Metres;
        /// Its extent from north to south.
        length_m: f32 = 2400.0, 0.0..=Self::WIDEST_M, Metres;
        /// Its extent from bottom to top.
        tall_m: f32 = 1400.0, 0.0..=Self::TALLEST_M, Metres;
        /// How far it is turned clockwise, seen from above.
        heading_deg: f32 = 0.0, -180.0..=180.0, Degrees;
        /// How far its top leans towards its heading.
        tilt_deg: f32 = 0.0, -180.0..=180.0, Degrees;
        /// Radius of a box's edges.
        rounding_m: f32 = 0.0, 0.0..=5000.0, Metres;
        /// Colour of a solid thing.
        colour: Colour = Colour(0.45, 0.43, 0.40);
    }
}
