//! Every file of `shaders/`, embedded in the program.

macro_rules! files {
    ($($path:literal,)*) => {
        /// Path (relative to `shaders/`) and text of every shader file, sorted by path.
        pub const FILES: &[(&str, &str)] =
            &[$(($path, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path))),)*];
    };
}

files! {
    "cloud/automaton.wgsl",
    "cloud/bound.wgsl",
    "cloud/costa.wgsl",
    "cloud/map_field.wgsl",
    "cloud/phase.wgsl",
    "cloud/phase_sample.wgsl",
    "cloud/product.wgsl",
    "cloud/profile.wgsl",
    "cloud/scatter.wgsl",
    "cloud/shapes.wgsl",
    "cloud/thesis.wgsl",
    "cloud/voxels.wgsl",
    "cloud/weather.wgsl",
    "common/camera.wgsl",
    "common/ground_cover.wgsl",
    "common/math.wgsl",
    "common/random.wgsl",
    "common/shell.wgsl",
    "common/spiral.wgsl",
    "common/tonemap.wgsl",
    "common/trilinear.wgsl",
    "common/update.wgsl",
    "light/air.wgsl",
    "light/air_march.wgsl",
    "light/sky.wgsl",
    "noise/curl.wgsl",
    "noise/fractal.wgsl",
    "noise/perlin.wgsl",
    "noise/worley.wgsl",
    "pass/automaton_advance.wgsl",
    "pass/automaton_bound.wgsl",
    "pass/automaton_drift.wgsl",
    "pass/automaton_favour.wgsl",
    "pass/automaton_greatest.wgsl",
    "pass/automaton_smooth.wgsl",
    "pass/background.wgsl",
    "pass/background_plain.wgsl",
    "pass/bake_curl.wgsl",
    "pass/bake_detail.wgsl",
    "pass/bake_mip.wgsl",
    "pass/bake_octave.wgsl",
    "pass/bake_shape.wgsl",
    "pass/bake_terrain.wgsl",
    "pass/bake_voxels.wgsl",
    "pass/bake_worley.wgsl",
    "pass/clear_air.wgsl",
    "pass/clear_cells.wgsl",
    "pass/clear_row.wgsl",
    "pass/clear_spread.wgsl",
    "pass/clear_way.wgsl",
    "pass/cloud_field.wgsl",
    "pass/cloud_light.wgsl",
    "pass/cloud_shadow.wgsl",
    "pass/cloud_shapes.wgsl",
    "pass/composed.wgsl",
    "pass/composite.wgsl",
    "pass/converged.wgsl",
    "pass/majorant.wgsl",
    "pass/map_view.wgsl",
    "pass/march.wgsl",
    "pass/march_clear.wgsl",
    "pass/march_state.wgsl",
    "pass/meter.wgsl",
    "pass/paint_dabs.wgsl",
    "pass/paint_keep.wgsl",
    "pass/paint_smooth.wgsl",
    "pass/paint_warp.wgsl",
    "pass/painted.wgsl",
    "pass/path_state.wgsl",
    "pass/path_trace.wgsl",
    "pass/probe.wgsl",
    "pass/shafts_blur.wgsl",
    "pass/shafts_mask.wgsl",
    "pass/shapes_distance.wgsl",
    "pass/sky_aerial.wgsl",
    "pass/sky_ambient.wgsl",
    "pass/sky_multiscatter.wgsl",
    "pass/sky_transmittance.wgsl",
    "pass/sky_view.wgsl",
    "pass/solids.wgsl",
    "pass/sun_depth.wgsl",
    "pass/sun_grid.wgsl",
    "pass/sun_sweep.wgsl",
    "pass/temporal.wgsl",
    "pass/terrain.wgsl",
    "pass/tonemap.wgsl",
    "pass/truth_resolve.wgsl",
    "pass/voxel_bound.wgsl",
    "pass/watch.wgsl",
    "pass/weather_blend.wgsl",
    "pass/weather_bound.wgsl",
    "pass/weather_flow.wgsl",
    "pass/weather_grow.wgsl",
    "pass/weather_map.wgsl",
    "pass/weather_paint.wgsl",
    "test/eval_clear.wgsl",
    "test/eval_density.wgsl",
    "test/eval_field.wgsl",
    "test/eval_io.wgsl",
    "test/eval_majorant.wgsl",
    "test/eval_math.wgsl",
    "test/eval_noise.wgsl",
    "test/eval_phase.wgsl",
    "test/eval_phase_sample.wgsl",
    "test/eval_random.wgsl",
    "test/eval_shapes.wgsl",
    "test/eval_shell.wgsl",
    "test/eval_sky.wgsl",
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::FILES;

    fn collect(folder: &Path, prefix: &str, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
            if entry.file_type().unwrap().is_dir() {
                collect(&entry.path(), &format!("{name}/"), found);
            } else {
                found.push(name);
            }
        }
    }

    #[test]
    fn the_table_lists_every_file_of_the_folder_in_order() {
        let mut found = Vec::new();
        collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), "", &mut found);
        found.sort();
        let listed: Vec<&str> = FILES.iter().map(|(path, _)| *path).collect();
        assert_eq!(listed, found, "list every file of shaders/ in src/shader/embedded.rs, sorted by path");
    }
}
