// Draws egui's triangles in gamma space, as egui blends them. Colours come with alpha multiplied in.

struct Screen {
    // Width and height in points.
    size: vec2f,
}

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
    @location(1) colour: vec4f,
}

@group(0) @binding(0) var<uniform> screen: Screen;
@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(1) var image_sampler: sampler;

@vertex
fn vertex(@location(0) point: vec2f, @location(1) uv: vec2f, @location(2) colour: vec4f) -> Corner {
    let clip = vec2f(2.0, -2.0) * point / screen.size + vec2f(-1.0, 1.0);
    return Corner(vec4f(clip, 0.0, 1.0), uv, colour);
}

@fragment
fn fragment(corner: Corner) -> @location(0) vec4f {
    return corner.colour * textureSampleLevel(image, image_sampler, corner.uv, 0.0);
}
