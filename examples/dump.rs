use nephoscope::{gpu::*, render::*, scene::*};
fn main() {
    let gpu = Gpu::software().unwrap();
    let mut r = Renderer::new(&gpu).unwrap();
    let scene = Scene::default();
    let mut q = Quality::level(QualityLevel::Preview);
    q.update = UpdateFraction::Full;
    r.render(&Frame { scene: &scene, quality: &q, size: [64, 36], time_secs: 0.0, output: Output::Linear }).unwrap();
    let l = r.linear().unwrap();
    println!("{} {:?}", l.candela_per_unit, l.size);
    for y in (0..36).step_by(5) { println!("{:?} {:?}", l.rgba[y * 64 + 10], l.distance_m[y*64+10]); }
    for y in (0..36).step_by(5) { println!("{:?}", r.clouds().unwrap()[y * 64 + 10]); }
}
