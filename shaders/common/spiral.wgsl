// Points that are spread in the plane about as a normal distribution is: on a spiral by the golden angle (Vogel 1979), each as
// far out as its quantile, and their opposites, so that their mean is 0. Their mean square along either axis is about 1.

const SPIRAL_COUNT: u32 = 48u;
const GOLDEN_ANGLE: f32 = 2.3999632;

fn spiral(i: u32) -> vec2f {
  let point = f32(i / 2u);
  let quantile = (point + 0.5) / (0.5 * f32(SPIRAL_COUNT));
  let angle = point * GOLDEN_ANGLE;
  let there = sqrt(-2.0 * log(1.0 - quantile)) * vec2f(cos(angle), sin(angle));
  return select(there, -there, i % 2u == 1u);
}
