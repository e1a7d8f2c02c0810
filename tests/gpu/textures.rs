//! Baked textures: each repeats without a seam, and the weather map covers what coverage asks for.

use crate::common::field::{Field, map_uniforms, read, weather_map};

/// Texel and its neighbour along each axis of a texture of `side` texels along `axes` axes.
fn differences(texels: &[[f32; 4]], side: usize, axes: u32, channel: usize) -> (Differences, Differences) {
    let (mut inner, mut seam) = (Differences::default(), Differences::default());
    for axis in 0..axes {
        let stride = side.pow(axis);
        for (index, texel) in texels.iter().enumerate() {
            let at = index / stride % side;
            let is_last = at + 1 == side;
            let next = if is_last { index - at * stride } else { index + stride };
            let difference = (texels[next][channel] - texel[channel]).abs();
            if is_last { seam.add(difference) } else { inner.add(difference) }
        }
    }
    (inner, seam)
}

#[derive(Debug, Default)]
struct Differences {
    sum: f64,
    count: f64,
    greatest: f32,
}

impl Differences {
    fn add(&mut self, difference: f32) {
        self.sum += f64::from(difference);
        self.count += 1.0;
        self.greatest = self.greatest.max(difference);
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }
}

#[test]
fn every_baked_texture_repeats_without_a_seam() {
    let field = Field::baked();
    let textures = [
        ("shape", &field.shape, 128, 3),
        ("worley", &field.worley, 64, 3),
        ("detail", &field.detail, 32, 3),
        ("curl", &field.curl, 128, 2),
        ("relief", &field.relief, 512, 2),
        ("weather map", &field.map, 512, 2),
    ];
    for (name, texture, side, axes) in textures {
        let texels = read(texture);
        assert_eq!(texels.len(), usize::pow(side, axes), "{name} is read whole");
        assert!(texels.iter().flatten().all(|value| value.is_finite()), "{name} is finite");
        for channel in 0..4 {
            let (inner, seam) = differences(&texels, side, axes, channel);
            // A type of cloud may end at the seam as it may inside, so means are compared where values jump.
            let mean = (seam.mean(), inner.mean() * 1.5 + 1e-3);
            assert!(
                mean.0 <= mean.1,
                "{name} {channel}: mean difference at the seam {} and inside {}",
                mean.0,
                inner.mean()
            );
            let greatest = inner.greatest * 1.05 + 1e-3;
            assert!(
                seam.greatest <= greatest,
                "{name} {channel}: {} at the seam, {} inside",
                seam.greatest,
                inner.greatest
            );
        }
    }
}

#[test]
fn textures_fill_the_range_that_the_models_expect() {
    let field = Field::baked();
    for (name, texture, channels) in
        [("shape", &field.shape, 4), ("worley", &field.worley, 4), ("detail", &field.detail, 4)]
    {
        let texels = read(texture);
        for channel in 0..channels {
            let values = texels.iter().map(|texel| texel[channel]);
            let (low, high) = values.fold((f32::MAX, f32::MIN), |(low, high), v| (low.min(v), high.max(v)));
            assert!(low >= 0.0 && high <= 1.0, "{name} {channel}: {low} to {high} leaves 0 to 1");
            assert!(high - low > 0.4, "{name} {channel}: {low} to {high} is flat");
        }
    }
}

/// Share of the map whose body is above a half, for a coverage and an edge softness.
fn covered(texels: &[[f32; 4]], coverage: f32, softness: f32) -> f64 {
    let body = |texel: &[f32; 4]| (texel[0] + texel[1] + texel[2] - 1.0 + coverage * (1.0 + softness)) / softness;
    texels.iter().filter(|texel| body(texel) > 0.5).count() as f64 / texels.len() as f64
}

#[test]
fn the_covered_share_grows_with_coverage() {
    let mut rows = Vec::new();
    for seed in [1, 2, 77] {
        let texels = read(&weather_map(&map_uniforms(seed)));
        let shares: Vec<f64> = (0..=20).map(|step| covered(&texels, step as f32 / 20.0, 0.26)).collect();
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]), "seed {seed}: {shares:?}");
        assert!(shares[0] < 1e-6 && shares[20] > 1.0 - 1e-6, "seed {seed}: {shares:?}");
        rows.push(format!("seed {seed}: {:.3} at 0.2, {:.3} at 0.5, {:.3} at 0.8", shares[4], shares[10], shares[16]));
        for (asked, share) in [(0.2, shares[4]), (0.5, shares[10]), (0.8, shares[16])] {
            assert!((share - asked).abs() < 0.25, "seed {seed}: {share} of the map is covered at coverage {asked}");
        }
        let other = read(&weather_map(&map_uniforms(seed + 1)));
        assert_ne!(texels, other, "another seed is another map");
    }
    println!("covered share\n{}", rows.join("\n"));
}
