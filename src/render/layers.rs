//! A still taken apart into what each light adds to it. Light adds up, so a layer is what is missing when its light is left
//! out: pictures with more and more of it forced off, each less the next. The layers sum to the whole by construction.

use super::{LinearImage, RenderError, Renderer};
use crate::plan::{Effect, Forced};
use crate::scene::{Frame, Quality, Scene};

/// Light of a picture, in the order in which a compositor piles it up, and beside it the clouds' transmittance.
#[derive(Clone, Debug)]
pub struct Layers {
    /// The whole.
    pub beauty: LinearImage,
    /// Name and light of each layer, in working units; those that a scene does not have are not there.
    pub lights: Vec<(&'static str, Vec<[f32; 3]>)>,
    /// What of the light behind them the clouds let through, 0 to 1.
    pub transmittance: Vec<f32>,
}

/// What is left out for the next picture, and the layer that is missing then.
struct Part {
    name: &'static str,
    /// `None` where the picture changes by its scene or its quality.
    effect: Option<Effect>,
}

/// From the whole picture to the bare sky.
const PARTS: [Part; 7] = [
    // Streaks are made of the finished picture, so they go first.
    Part { name: "shafts", effect: Some(Effect::Sunshafts) },
    Part { name: "multiple", effect: None },
    Part { name: "direct", effect: Some(Effect::KeyLight) },
    Part { name: "bounce", effect: None },
    Part { name: "ambient", effect: Some(Effect::Ambient) },
    Part { name: "air", effect: Some(Effect::Air) },
    Part { name: "disc", effect: Some(Effect::SunDisc) },
];
/// What is left: sky, stars, moon and ground, with their own air, as the clouds let them through.
const BACKDROP: &str = "backdrop";

impl Renderer {
    /// A finished still of the frame, as [`Renderer::still`] makes it, and its layers.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn layers(&mut self, frame: &Frame<'_>) -> Result<Layers, RenderError> {
        let wanted = self.forced();
        let layers = self.take_apart(frame, wanted);
        self.force(wanted);
        layers
    }

    fn take_apart(&mut self, frame: &Frame<'_>, wanted: Forced) -> Result<Layers, RenderError> {
        let (mut scene, mut quality) = (frame.scene.clone(), frame.quality.clone());
        let mut forced = wanted;
        let whole = self.picture_with(frame, (&scene, &quality), forced)?;
        let transmittance = whole.clouds.iter().map(|cloud| cloud[3]).collect();
        let mut before: Vec<[f32; 3]> = whole.image.rgba.iter().map(light).collect();
        let mut lights = Vec::new();
        for part in PARTS {
            match part.effect {
                Some(effect) => forced = forced.with(effect, Some(false)),
                None if part.name == "multiple" => quality.octaves = 0,
                None => scene.scattering.ambient_bottom = crate::scene::param::Colour(0.0, 0.0, 0.0),
            }
            let next = self.picture_with(frame, (&scene, &quality), forced)?.image;
            let next: Vec<[f32; 3]> = next.rgba.iter().map(light).collect();
            if next != before {
                let missing = before.iter().zip(&next).map(|(more, less)| std::array::from_fn(|c| more[c] - less[c]));
                lights.push((part.name, missing.collect()));
            }
            before = next;
        }
        lights.push((BACKDROP, before));
        Ok(Layers { beauty: whole.image, lights, transmittance })
    }

    fn picture_with(
        &mut self,
        frame: &Frame<'_>,
        (scene, quality): (&Scene, &Quality),
        forced: Forced,
    ) -> Result<super::truth::TruthPicture, RenderError> {
        self.force(forced);
        let still = self.still(&Frame { scene, quality, ..*frame })?;
        still.picture(self)
    }
}

fn light(pixel: &[f32; 4]) -> [f32; 3] {
    [pixel[0], pixel[1], pixel[2]]
}
