//! Shapes as shaders take them.

use bytemuck::Zeroable as _;
use glam::{Quat, Vec3, Vec4};

use super::camera::Eye;
use super::other::{ShapeUniforms, ShapesUniforms};
use crate::plan::{KeyLight, Lighting};
use crate::scene::{DomainKind, MAX_SHAPES, Scene, Shape, ShapeJoin, ShapeKind, ShapeRole};

/// Half the least extent, so that distances over it are numbers.
const LEAST_HALF_M: f32 = 0.01;

/// All shapes: clouds, then solid things.
pub(crate) fn shapes_uniforms(scene: &Scene, lighting: &Lighting, eye: &Eye) -> ShapesUniforms {
    let mut list = [ShapeUniforms::zeroed(); MAX_SHAPES];
    let of = |role: ShapeRole| scene.shapes.iter().take(MAX_SHAPES).filter(move |shape| shape.role == role);
    for (slot, shape) in list.iter_mut().zip(of(ShapeRole::Cloud).chain(of(ShapeRole::Solid))) {
        *slot = shape_uniforms(shape, eye);
    }
    let radius_deg = if lighting.key == KeyLight::Moon { scene.moon.radius_deg } else { scene.sun.radius_deg };
    ShapesUniforms {
        clouds: of(ShapeRole::Cloud).count() as u32,
        solids: of(ShapeRole::Solid).count() as u32,
        per_edge: 1.0 / scene.shape_edge_m,
        light_radius: radius_deg.to_radians(),
        per_radius: if scene.domain.kind == DomainKind::Shell { 1.0 / scene.domain.planet_radius_m } else { 0.0 },
        pad0: 0.0,
        pad1: 0.0,
        pad2: 0.0,
        list,
    }
}

fn shape_uniforms(shape: &Shape, eye: &Eye) -> ShapeUniforms {
    let (heading, tilt) = (shape.heading_deg.to_radians(), shape.tilt_deg.to_radians());
    let world_from_local = Quat::from_rotation_y(-heading) * Quat::from_rotation_x(-tilt);
    let half = 0.5 * Vec3::new(shape.width_m, shape.tall_m, shape.length_m);
    ShapeUniforms {
        centre: Vec3::new(
            (f64::from(shape.east_m) - eye.position.x) as f32,
            shape.height_m,
            (f64::from(shape.south_m) - eye.position.z) as f32,
        ),
        kind: match shape.kind {
            ShapeKind::Sphere => 0,
            ShapeKind::Ellipsoid => 1,
            ShapeKind::Box => 2,
            ShapeKind::Cylinder => 3,
            ShapeKind::Capsule => 4,
        },
        half_size: half.max(Vec3::splat(LEAST_HALF_M)),
        blend_m: shape.blend_m,
        local_from_world: Vec4::from(world_from_local.conjugate()),
        colour: shape.colour.vec(),
        join: match shape.join {
            ShapeJoin::Union => 0,
            ShapeJoin::Difference => 1,
            ShapeJoin::Intersection => 2,
        },
        rounding_m: shape.rounding_m,
        pad0: 0.0,
        pad1: 0.0,
        pad2: 0.0,
    }
}
