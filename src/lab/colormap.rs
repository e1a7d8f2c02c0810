//! Colours for pictures of numbers: errors, and signed differences.

/// What is shown where there is no number. Neither map holds it.
pub const NOT_A_NUMBER: [u8; 3] = [255, 0, 255];

/// Viridis by Nathaniel Smith and Stéfan van der Walt (2015, matplotlib, CC0): every eighth colour of its 256. Linear
/// between them it is at most two levels off.
const VIRIDIS: [[u8; 3]; 33] = [
    [68, 1, 84],
    [71, 13, 96],
    [72, 24, 106],
    [72, 35, 116],
    [71, 45, 123],
    [69, 54, 129],
    [66, 64, 134],
    [63, 73, 137],
    [59, 82, 139],
    [55, 90, 141],
    [51, 99, 141],
    [47, 106, 142],
    [44, 114, 142],
    [41, 122, 142],
    [38, 129, 142],
    [35, 137, 142],
    [33, 144, 140],
    [31, 152, 139],
    [31, 159, 136],
    [33, 166, 133],
    [40, 174, 128],
    [49, 181, 123],
    [62, 188, 116],
    [76, 194, 108],
    [93, 201, 99],
    [110, 206, 88],
    [130, 211, 76],
    [150, 216, 63],
    [171, 220, 50],
    [192, 223, 36],
    [213, 226, 26],
    [234, 229, 26],
    [253, 231, 37],
];

/// Cool to warm after Kenneth Moreland, "Diverging Color Maps for Scientific Visualization" (2009): his construction in
/// polar CIELAB, from the blue (59, 76, 192) over white of M = 88 to the red (180, 4, 38). Linear between the colours it
/// is at most five levels off, in the last step to red.
const COOL_WARM: [[u8; 3]; 33] = [
    [59, 76, 192],
    [68, 90, 204],
    [78, 104, 215],
    [88, 117, 225],
    [98, 130, 234],
    [108, 142, 241],
    [119, 154, 247],
    [130, 165, 251],
    [141, 176, 254],
    [152, 185, 255],
    [163, 194, 255],
    [174, 201, 253],
    [184, 208, 249],
    [194, 213, 244],
    [204, 217, 238],
    [213, 219, 230],
    [221, 221, 221],
    [229, 216, 209],
    [236, 211, 198],
    [241, 204, 185],
    [245, 196, 173],
    [247, 187, 160],
    [247, 177, 148],
    [247, 166, 135],
    [244, 154, 123],
    [241, 141, 111],
    [236, 127, 99],
    [229, 112, 87],
    [222, 97, 76],
    [213, 80, 66],
    [203, 62, 56],
    [192, 40, 47],
    [180, 4, 38],
];

/// The colour of a number from 0 to 1: dark violet, blue, green, yellow. Lightness rises evenly, so that equal steps of
/// the number look equal, also to the colour-blind and in print without colour.
///
/// Numbers outside have the colour of the nearer end, NaN has [`NOT_A_NUMBER`].
pub fn viridis(value: f32) -> [u8; 3] {
    between(&VIRIDIS, value)
}

/// The colour of a signed number from −1 to 1: blue below 0, light grey at 0, red above. Equally far on both sides is
/// equally dark.
///
/// Numbers outside have the colour of the nearer end, NaN has [`NOT_A_NUMBER`].
pub fn diverging(value: f32) -> [u8; 3] {
    between(&COOL_WARM, 0.5 + 0.5 * value)
}

fn between(colours: &[[u8; 3]; 33], value: f32) -> [u8; 3] {
    if value.is_nan() {
        return NOT_A_NUMBER;
    }
    let place = value.clamp(0.0, 1.0) * 32.0;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 ..= 31")]
    let below = place.floor().min(31.0) as usize;
    let (low, high) = (colours[below], colours[below + 1]);
    let share = place - below as f32;
    std::array::from_fn(|channel| {
        let (low, high) = (f32::from(low[channel]), f32::from(high[channel]));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two bytes")]
        let level = (low + (high - low) * share).round() as u8;
        level
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::colour::{WhiteRelative, linear_from_srgb};
    use super::*;

    fn lab(colour: [u8; 3]) -> DVec3 {
        let linear = colour.map(|level| linear_from_srgb(f64::from(level) / 255.0));
        WhiteRelative::new().lab_from_rgb(DVec3::from_array(linear))
    }

    fn off(seen: [u8; 3], expected: [u8; 3]) -> u8 {
        (0..3).map(|channel| seen[channel].abs_diff(expected[channel])).max().unwrap_or(0)
    }

    #[test]
    fn viridis_is_that_of_matplotlib() {
        // Entries 0, 37, 100, 128, 200 and 255 of its table.
        let published: [(u8, [u8; 3]); 6] = [
            (0, [68, 1, 84]),
            (37, [70, 51, 127]),
            (100, [42, 118, 142]),
            (128, [33, 145, 140]),
            (200, [112, 207, 87]),
            (255, [253, 231, 37]),
        ];
        for (entry, expected) in published {
            let seen = viridis(f32::from(entry) / 255.0);
            assert!(off(seen, expected) <= 2, "entry {entry}: {seen:?} beside {expected:?}");
        }
    }

    #[test]
    fn lightness_of_viridis_rises_evenly() {
        let light: Vec<f64> = (0..=16_u8).map(|step| lab(viridis(f32::from(step) / 16.0)).x).collect();
        let mean = (light[16] - light[0]) / 16.0;
        for pair in light.windows(2) {
            let rise = (pair[1] - pair[0]) / mean;
            assert!((0.75..1.25).contains(&rise), "a step of {rise} mean steps in {light:?}");
        }
    }

    #[test]
    fn signs_differ_in_colour_and_not_in_lightness() {
        assert_eq!([-1.0, 0.0, 1.0].map(diverging), [[59, 76, 192], [221, 221, 221], [180, 4, 38]]);
        for step in 1..=20_u8 {
            let value = f32::from(step) / 20.0;
            let (below, above) = (lab(diverging(-value)), lab(diverging(value)));
            assert!((below.x - above.x).abs() < 1.5, "at ±{value}: lightness {} and {}", below.x, above.x);
            assert!(below.z < above.z - 5.0 * f64::from(value), "at ±{value}: blue {below}, red {above}");
        }
        // Moreland's formula itself at places between the entries of the table.
        for (value, expected) in [(-0.77, [95, 126, 231]), (-0.3, [176, 203, 252]), (0.6, [238, 133, 104])] {
            let seen = diverging(value);
            assert!(off(seen, expected) <= 2, "{value}: {seen:?} beside {expected:?}");
        }
    }

    #[test]
    fn whatever_is_not_in_range_has_a_colour() {
        assert_eq!(viridis(f32::NEG_INFINITY), viridis(0.0));
        assert_eq!(viridis(7.0), viridis(1.0));
        assert_eq!(diverging(-9.0), diverging(-1.0));
        assert_eq!(diverging(f32::INFINITY), diverging(1.0));
        assert_eq!([viridis(f32::NAN), diverging(f32::NAN)], [NOT_A_NUMBER; 2]);
        assert!(!VIRIDIS.iter().chain(&COOL_WARM).any(|colour| off(*colour, NOT_A_NUMBER) < 40), "it stands out");
    }
}
