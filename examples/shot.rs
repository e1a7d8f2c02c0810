use nephoscope::{gpu::*, render::*, scene::*};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let gpu = Gpu::software().unwrap();
    let mut r = Renderer::new(&gpu).unwrap();
    let text = if a[1] == "-" { String::new() } else { std::fs::read_to_string(&a[1]).unwrap() };
    let scene: Scene = if text.is_empty() { Scene::default() } else { ron::from_str(&text).unwrap() };
    let level = match a.get(4).map(String::as_str) { Some("final") => QualityLevel::Final, Some("preview") => QualityLevel::Preview, _ => QualityLevel::High };
    let mut q = Quality::level(level);
    q.update = UpdateFraction::Full;
    let (w, h): (u32, u32) = { let s: Vec<u32> = a[3].split('x').map(|v| v.parse().unwrap()).collect(); (s[0], s[1]) };
    let time = a.get(5).map_or(0.0, |t| t.parse().unwrap());
    let rep = r.render(&Frame { scene: &scene, quality: &q, size: [w, h], time_secs: time, output: Output::Display }).unwrap();
    for p in &rep.passes { println!("{:24} {:8.1} ms", p.pass, p.millis.unwrap_or(-1.0)); }
    println!("total {:.0} ms", rep.total_ms);
    let (s, px) = r.display_rgba8().unwrap();
    image::save_buffer(&a[2], &px, s[0], s[1], image::ColorType::Rgba8).unwrap();
}
