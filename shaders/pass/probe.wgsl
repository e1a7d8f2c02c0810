// The clouds at one place, read as the truths read them.
#import "pass/cloud_field.wgsl"

// In: the place in x, y and z. Out: densities of the layers, and extinction in 1/m in x of the third.
@group(2) @binding(0) var<storage, read_write> probe: array<vec4f, 3>;

@compute @workgroup_size(1)
fn main() {
  let densities = densities_at(probe[0].xyz, Reading(0.0, true, 0.0, vec3f(0.0)));
  probe[1] = densities;
  probe[2] = vec4f(extinction_of(densities), 0.0, 0.0, 0.0);
}
