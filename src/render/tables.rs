//! What a sky is made from, read back: its weather map, noises and tables of light.

use super::{RenderError, Renderer};
use crate::choices;
use crate::gpu::{Texture, job, readback};
use crate::plan::FramePlan;
use crate::scene::Frame;

choices! {
    /// A map, a noise or a table.
    pub enum TableKind {
        /// Amounts of cumulus, stratus and stratocumulus, and in alpha how they vary from place to place; or coverage, height and
        /// altitude of a weather texture.
        WeatherMap ("weather-map"),
        /// The large noise, in slices from south to north.
        ShapeNoise ("shape-noise"),
        /// Cells of the thesis's model, in slices.
        WorleyNoise ("worley-noise"),
        /// One octave of Perlin (red, blue) and Voronoi noise (green, alpha), slice by slice, of the model of their product.
        OctaveNoise ("octave-noise"),
        /// Density of the automaton's cells, in slices from north to south: of this generation, of the next, and of the run before.
        Automaton ("automaton"),
        /// The small noise, in slices.
        DetailNoise ("detail-noise"),
        /// The noise that stirs the small one.
        CurlNoise ("curl-noise"),
        /// The ground's relief.
        Relief ("relief"),
        /// Distance to the next cloud on a map of heights, for long steps.
        ClearWays ("clear-ways"),
        /// Logarithm of one more than the key light's optical depth, about the eye.
        SunDepths ("sun-depths"),
        /// What the air lets through: by the cosine of the zenith angle and the height.
        SkyTransmittance ("sky-transmittance"),
        /// Light scattered more than once: by the sun's height and the height.
        SkyMultiscatter ("sky-multiscatter"),
        /// The clear sky from the eye: azimuth across, elevation down.
        SkyView ("sky-view"),
    }
}

/// Values of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Width and height in texels; slices of a volume lie below each other.
    pub size: [u32; 2],
    /// Its values; a single one is in all of red, green and blue.
    pub rgba: Vec<[f32; 4]>,
}

impl Renderer {
    /// Makes what the frame's sky is made from, and reads one part back; `None` if the frame does not need it.
    ///
    /// # Errors
    /// [`RenderError`] as for [`Self::render`].
    pub fn table(&mut self, frame: &Frame<'_>, kind: TableKind) -> Result<Option<Table>, RenderError> {
        self.finish_interactive()?;
        let plan = FramePlan::forced(frame, self.forced);
        let bakes = self.schedule_bakes(frame, &plan, None)?;
        job::run(&self.gpu, &bakes)?;
        let sky = self.sky.as_ref();
        let baked =
            |pass: &str| self.bakes.textures().find(|(made_by, _)| *made_by == pass).map(|(_, texture)| texture);
        let texture = match kind {
            TableKind::WeatherMap => self.weather.map(),
            TableKind::ShapeNoise => baked("bake_shape"),
            TableKind::WorleyNoise => baked("bake_worley"),
            TableKind::OctaveNoise => baked("bake_octave"),
            TableKind::Automaton => self.living.textures().next().map(|(_, texture)| texture),
            TableKind::DetailNoise => baked("bake_detail"),
            TableKind::CurlNoise => baked("bake_curl"),
            TableKind::Relief => baked("bake_terrain"),
            TableKind::ClearWays => self.clearance.texture(),
            TableKind::SunDepths => self.sun_grid.texture(),
            TableKind::SkyTransmittance => sky.map(|sky| &sky.transmittance),
            TableKind::SkyMultiscatter => sky.map(|sky| &sky.multiscatter),
            TableKind::SkyView => sky.map(|sky| &sky.view),
        };
        texture.map(|texture| self.read_table(texture)).transpose()
    }

    fn read_table(&self, texture: &Texture) -> Result<Table, RenderError> {
        let size = texture.texture.size();
        let rgba = match texture.texture.format().components() {
            1 => readback::scalars(&self.gpu, texture)?.into_iter().map(|value| [value, value, value, 1.0]).collect(),
            _ => readback::rgba(&self.gpu, texture)?,
        };
        Ok(Table { size: [size.width, size.height * size.depth_or_array_layers], rgba })
    }
}
