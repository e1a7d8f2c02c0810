//! Twins of `common/math.wgsl`, in `f64`.

/// Largest finite half float, what an `rgba16float` texture can hold.
pub const MAX_HALF: f64 = 65504.0;

/// Where `x` lies between `a` and `b`, clamped to 0..1; a step at `b` when `a >= b`.
#[must_use]
pub fn remap01(x: f64, a: f64, b: f64) -> f64 {
    ((x - a) / (b - a).max(1e-4)).clamp(0.0, 1.0)
}

/// (1 − exp(−x)) / x for an optical depth `x >= 0`; 1 at 0.
#[must_use]
pub fn absorption_weight(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { absorbed(x) / x }
}

/// 1 − exp(−x), the share that an optical depth `x >= 0` takes out of a ray.
#[must_use]
pub fn absorbed(x: f64) -> f64 {
    -(-x).exp_m1()
}

/// Non-finite values become 0, the others are clamped to 0..65504.
#[must_use]
pub fn sanitise(x: f64) -> f64 {
    if x.is_finite() { x.clamp(0.0, MAX_HALF) } else { 0.0 }
}

/// Luminance of linear Rec.709 (ITU-R BT.709-6, item 3.2).
#[must_use]
pub fn luminance709(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degenerate_ranges_are_steps() {
        assert_eq!((remap01(1.0, 2.0, 2.0), remap01(2.1, 2.0, 2.0)), (0.0, 1.0));
        assert_eq!((remap01(3.0, 4.0, 2.0), remap01(5.0, 4.0, 2.0)), (0.0, 1.0));
        assert_eq!(remap01(0.5, 0.0, 2.0), 0.25);
    }

    #[test]
    fn absorption_has_its_limits() {
        assert_eq!((absorbed(0.0), absorbed(1e4), absorption_weight(0.0)), (0.0, 1.0, 1.0));
        assert!((absorption_weight(1e-9) - 1.0).abs() < 1e-9, "W is 1 - x/2 near 0");
    }
}
