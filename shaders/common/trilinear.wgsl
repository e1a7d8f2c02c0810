// A trilinear value of voxels, exact in f32: samplers know a place between two texels to eight bits only. Centres
// lie at (i + 0.5) / n; beyond the outermost ones their value goes on.
fn trilinear(voxels: texture_3d<f32>, uvw: vec3f) -> vec4f {
  let last = vec3i(textureDimensions(voxels)) - 1;
  let at = clamp(uvw * vec3f(last + 1) - 0.5, vec3f(0.0), vec3f(last));
  let low = vec3i(at);
  let high = min(low + 1, last);
  let f = at - vec3f(low);
  let near = mix(
    mix(textureLoad(voxels, low, 0), textureLoad(voxels, vec3i(high.x, low.yz), 0), f.x),
    mix(textureLoad(voxels, vec3i(low.x, high.y, low.z), 0), textureLoad(voxels, vec3i(high.xy, low.z), 0), f.x), f.y);
  let far = mix(
    mix(textureLoad(voxels, vec3i(low.xy, high.z), 0), textureLoad(voxels, vec3i(high.x, low.y, high.z), 0), f.x),
    mix(textureLoad(voxels, vec3i(low.x, high.yz), 0), textureLoad(voxels, high, 0), f.x), f.y);
  return mix(near, far, f.z);
}
