//! A still taken apart into what each light adds to it. Light adds up, so a layer is what is missing when its light is left
//! out: pictures with more and more of it forced off, each less the next. The layers sum to the whole by construction.

use super::still::Proceed;
use super::truth::TruthPicture;
use super::{LinearImage, RenderError, Renderer};
use crate::plan::{Effect, Forced};
use crate::scene::param::Colour;
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
const PARTS: [Part; 8] = [
    // Streaks are made of the finished picture, so they go first.
    Part { name: "shafts", effect: Some(Effect::Sunshafts) },
    Part { name: "glow", effect: Some(Effect::Glow) },
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
    /// A finished still of the frame, as [`Renderer::still_while`] makes it, and its layers; `None` if it was given up. Layers of
    /// unlike samples would not sum, so none ends before the others: [`Proceed::WithWhatIsDone`] is [`Proceed::On`] here.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn layers(
        &mut self,
        frame: &Frame<'_>,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<Layers>, RenderError> {
        let wanted = self.forced();
        let layers = self.take_apart(frame, wanted, proceed);
        self.force(wanted);
        layers
    }

    fn take_apart(
        &mut self,
        frame: &Frame<'_>,
        wanted: Forced,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<Layers>, RenderError> {
        let pictures = 1.0 + PARTS.len() as f32;
        let (mut scene, mut quality) = (frame.scene.clone(), frame.quality.clone());
        let mut forced = wanted;
        let whole = self.picture_with(frame, (&scene, &quality), forced, &mut |share| proceed(share / pictures))?;
        let Some(whole) = whole else { return Ok(None) };
        let transmittance = whole.clouds.iter().map(|cloud| cloud[3]).collect();
        let mut before: Vec<[f32; 3]> = whole.image.rgba.iter().map(light).collect();
        let mut lights = Vec::new();
        for (index, part) in PARTS.into_iter().enumerate() {
            match part.effect {
                Some(effect) => forced = forced.with(effect, Some(false)),
                None if part.name == "multiple" => quality.octaves = 0,
                None => scene.scattering.ambient_bottom = Colour(0.0, 0.0, 0.0),
            }
            let done = 1.0 + index as f32;
            let mut told = |share: f32| proceed((done + share) / pictures);
            let next = self.picture_with(frame, (&scene, &quality), forced, &mut told)?;
            let Some(next) = next else { return Ok(None) };
            let next: Vec<[f32; 3]> = next.image.rgba.iter().map(light).collect();
            if next != before {
                let missing = before.iter().zip(&next).map(|(more, less)| std::array::from_fn(|c| more[c] - less[c]));
                lights.push((part.name, missing.collect()));
            }
            before = next;
        }
        lights.push((BACKDROP, before));
        Ok(Some(Layers { beauty: whole.image, lights, transmittance }))
    }

    fn picture_with(
        &mut self,
        frame: &Frame<'_>,
        (scene, quality): (&Scene, &Quality),
        forced: Forced,
        proceed: &mut dyn FnMut(f32) -> Proceed,
    ) -> Result<Option<TruthPicture>, RenderError> {
        self.force(forced);
        let mut wholly = |share| match proceed(share) {
            Proceed::WithWhatIsDone => Proceed::On,
            asked => asked,
        };
        let still = self.still_while(&Frame { scene, quality, ..*frame }, &mut wholly)?;
        still.map(|still| still.picture(self)).transpose()
    }
}

fn light(pixel: &[f32; 4]) -> [f32; 3] {
    [pixel[0], pixel[1], pixel[2]]
}
