use nephoscope::{gpu::*, render::*, scene::*, files};
fn pct(v: &mut Vec<(f64, f64)>, p: f64) -> f64 { v.sort_by(|a, b| a.0.total_cmp(&b.0)); let tot: f64 = v.iter().map(|x| x.1).sum(); let mut acc = 0.0; for x in v.iter() { acc += x.1; if acc >= p / 100.0 * tot { return x.0; } } v.last().unwrap().0 }
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let gpu = Gpu::software().unwrap();
    let mut r = Renderer::new(&gpu).unwrap();
    let sky = files::open(std::path::Path::new(&a[1])).unwrap();
    let mut s = sky.preset.scene;
    let mut q = Quality::level(QualityLevel::High);
    q.update = UpdateFraction::Full;
    s.camera.projection = Projection::Equirect; s.sun.elevation_deg = 48.0;
    nephoscope::scene::edit::apply(&a[2..].to_vec(), &mut s, &mut q).unwrap();
    let (w, h) = (512u32, 256u32);
    r.render(&Frame { scene: &s, quality: &q, size: [w, h], time_secs: 0.0, output: Output::Linear }).unwrap();
    let (sz, px) = r.display_rgba8().unwrap();
    image::save_buffer("/tmp/shots/pano.png", &px, sz[0], sz[1], image::ColorType::Rgba8).unwrap();
    let l = r.linear().unwrap();
    let sun = s.towards_sun();
    let (mut lum, mut rb) = (vec![], vec![]);
    for y in 0..h / 2 { for x in 0..w {
        let el = (0.5 - (y as f64 + 0.5) / h as f64) * std::f64::consts::PI;
        let az = ((x as f64 + 0.5) / w as f64 - 0.5) * 2.0 * std::f64::consts::PI + (s.camera.heading_deg as f64).to_radians();
        let d = glam::DVec3::new(el.cos() * az.sin(), el.sin(), -el.cos() * az.cos());
        if d.dot(sun.as_dvec3()) > 3f64.to_radians().cos() { continue; }
        let c = l.rgba[(y * w + x) as usize];
        lum.push(((0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]) as f64, el.cos()));
        rb.push(((c[0] / c[2].max(1e-9)) as f64, el.cos()));
    } }
    let m = pct(&mut lum, 50.0);
    println!("lum/median  target 1:.27 5:.30 25:.58 75:1.61 95:2.89 99:5.48   median {:.0} cd/m2", m * l.candela_per_unit as f64);
    for p in [1.0, 5.0, 25.0, 75.0, 95.0, 99.0] { print!("{p}:{:.2} ", pct(&mut lum, p) / m); }
    let w95 = pct(&mut rb, 95.0);
    println!("\nr/b  target 5:.32 25:.41 50:.50 75:.86");
    for p in [5.0, 25.0, 50.0, 75.0] { print!("{p}:{:.2} ", pct(&mut rb, p) / w95); }
    println!();
}
