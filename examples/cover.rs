use nephoscope::{gpu::*, render::*, scene::*};
fn main() {
    let gpu = Gpu::software().unwrap();
    let mut r = Renderer::new(&gpu).unwrap();
    let mut q = Quality::level(QualityLevel::Preview);
    q.update = UpdateFraction::Full;
    for share in [0.2f32, 0.5, 0.8] { for fray in [0.35f32] { for c in [0.1f32, 0.2, 0.3, 0.45, 0.6, 0.8] {
        let mut cover = 0.0; let mut n = 0.0;
        for seed in [1u32, 5] {
            let mut s = Scene::default();
            s.ground.visible = false; s.weather.coverage = c; s.weather.layers[0].seed = seed;
            s.weather.layers[0].small_share = share; s.weather.layers[0].fray = fray;
            s.camera.height_m = 60000.0; s.camera.pitch_deg = -90.0; s.camera.field_of_view_deg = 22.6; s.domain.kind = DomainKind::Flat;
            s.camera.east_m = 5000.0 * seed as f32;
            r.render(&Frame { scene: &s, quality: &q, size: [64, 64], time_secs: 0.0, output: Output::Display }).unwrap();
            for p in r.clouds().unwrap() { cover += f64::from(1.0 - p[3]); n += 1.0; }
        }
        print!("{c}:{:.2}  ", cover / n);
    } println!(" share {share} fray {fray}"); } }
}
