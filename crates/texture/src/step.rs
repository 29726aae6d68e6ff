//! One pattern or texture, evaluated where a ray meets a surface.

use crate::appearance::Appearance;
use crate::bands::{Bands, spread};
use crate::function::{Function, MAX_COORDINATES};
use crate::interaction::SurfaceInteraction;
use crate::lettering::Lettering;
use crate::spectral_pattern::{SpectralData, SpectralFunction};
use glam::DVec3;
use radsight_cal::Scratch;
use radsight_ir::{DataGrid, Handle, PictureData, Rgb, Scene};

/// A pattern or a texture.
#[derive(Clone, Debug)]
pub enum Step {
    /// The same values everywhere.
    Constant(Bands),
    /// One value multiplies all bands.
    Brightness(Function),
    /// Three values multiply red, green and blue.
    Color(Function),
    /// One value from a grid.
    BrightnessData(Function, Handle<DataGrid>),
    /// Three values from three grids.
    ColorData(Function, [Handle<DataGrid>; 3]),
    /// Three values from a picture.
    Picture(Function, Handle<PictureData>),
    /// One colour on letters, another beside them.
    Text {
        /// The letters.
        lettering: Lettering,
        /// Where there is ink.
        foreground: Rgb,
        /// Elsewhere.
        background: Rgb,
    },
    /// A spectrum from a function of the wavelength.
    SpectralFunction(SpectralFunction),
    /// A spectrum from a grid whose last axis is the wavelength.
    SpectralData(SpectralData),
    /// Three values added to the normal.
    Texture(Function),
    /// Three values from three grids added to the normal.
    TextureData(Function, [Handle<DataGrid>; 3]),
    /// Part of one list of patterns and textures, and the rest of another.
    Mixture(Box<MixedSteps>),
}

/// Two lists of patterns and textures, and how much of the first.
#[derive(Clone, Debug)]
pub struct MixedSteps {
    /// How much of the foreground.
    pub share: Share,
    /// What has that share.
    pub foreground: Vec<Step>,
    /// What has the rest.
    pub background: Vec<Step>,
}

/// How much of a mixture's foreground there is.
#[derive(Clone, Debug)]
pub enum Share {
    /// One root.
    Function(Function),
    /// One value from a grid.
    Data(Function, Handle<DataGrid>),
    /// One value of a picture's colour.
    Picture(Function, Handle<PictureData>),
    /// All of it on letters.
    Text(Lettering),
}

impl Share {
    /// In 0…1; none after a fault of the function, where Radiance leaves the mixture out.
    pub fn at(&self, scene: &Scene, interaction: &SurfaceInteraction, scratch: &mut Scratch) -> Option<f64> {
        let share = match self {
            Share::Function(function) => {
                let mut value = [0.0];
                function.program.eval_all(&[], &function.view(interaction), scratch, &mut value).ok()?;
                value[0]
            }
            Share::Data(function, grid) => from_grids(scene, function, &[*grid], interaction, scratch)?[0],
            Share::Picture(function, picture) => {
                from_picture::<1>(&scene.pictures[*picture], function, interaction, scratch)?[0]
            }
            Share::Text(lettering) => f64::from(u8::from(lettering.has_ink(interaction.object_point()))),
        };
        Some(if share > 0.0 { share.min(1.0) } else { 0.0 })
    }
}

impl Step {
    /// Whether it can give red, green and blue different values.
    pub fn is_colored(&self) -> bool {
        match self {
            Step::Constant(bands) => !bands.is_grey(),
            Step::Text { foreground, background, .. } => !(foreground.is_grey() && background.is_grey()),
            Step::Mixture(mixed) => mixed.foreground.iter().chain(&mixed.background).any(Step::is_colored),
            Step::Color(_)
            | Step::ColorData(..)
            | Step::Picture(..)
            | Step::SpectralFunction(_)
            | Step::SpectralData(_) => true,
            Step::Brightness(_) | Step::BrightnessData(..) | Step::Texture(_) | Step::TextureData(..) => false,
        }
    }

    /// Whether it can turn the normal.
    pub fn is_texture(&self) -> bool {
        match self {
            Step::Texture(_) | Step::TextureData(..) => true,
            Step::Mixture(mixed) => mixed.foreground.iter().chain(&mixed.background).any(Step::is_texture),
            _ => false,
        }
    }

    /// What a fault of the function spoils is left out, as Radiance does.
    pub fn apply<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
        appearance: &mut Appearance<BANDS>,
    ) {
        match self {
            Step::Constant(bands) => bands.multiply(&mut appearance.color),
            Step::Brightness(function) => {
                let mut value = [0.0];
                if function.program.eval_all(&[], &function.view(interaction), scratch, &mut value).is_ok() {
                    multiply(&mut appearance.color, [value[0]; 3]);
                }
            }
            Step::Color(function) => {
                let mut values = [0.0; 3];
                if function.program.eval_all(&[], &function.view(interaction), scratch, &mut values).is_ok() {
                    multiply(&mut appearance.color, values);
                }
            }
            Step::BrightnessData(function, grid) => {
                if let Some(values) = from_grids(scene, function, &[*grid], interaction, scratch) {
                    multiply(&mut appearance.color, [values[0]; 3]);
                }
            }
            Step::ColorData(function, grids) => {
                if let Some(values) = from_grids(scene, function, grids, interaction, scratch) {
                    multiply(&mut appearance.color, values);
                }
            }
            Step::Picture(function, picture) => {
                if let Some(values) = from_picture(&scene.pictures[*picture], function, interaction, scratch) {
                    multiply(&mut appearance.color, values);
                }
            }
            Step::Text { lettering, foreground, background } => {
                let color = if lettering.has_ink(interaction.object_point()) { foreground } else { background };
                multiply(&mut appearance.color, color.0);
            }
            Step::SpectralFunction(pattern) => pattern.apply(interaction, scratch, &mut appearance.color),
            Step::SpectralData(pattern) => pattern.apply(scene, interaction, scratch, &mut appearance.color),
            Step::Texture(function) => {
                let mut vector = [0.0; 3];
                if function.program.eval_all(&[], &function.view(interaction), scratch, &mut vector).is_ok() {
                    appearance.perturbation += function.in_scene(interaction, DVec3::from_array(vector));
                }
            }
            Step::TextureData(function, grids) => {
                if let Some(vector) = from_grids(scene, function, grids, interaction, scratch) {
                    appearance.perturbation += function.in_scene(interaction, DVec3::from_array(vector));
                }
            }
            Step::Mixture(mixed) => mixed.apply(scene, interaction, scratch, appearance),
        }
    }
}

impl MixedSteps {
    /// Both lists go on from what is there; the results are mixed.
    fn apply<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
        appearance: &mut Appearance<BANDS>,
    ) {
        let Some(share) = self.share.at(scene, interaction, scratch) else { return };
        let before = *appearance;
        *appearance = Appearance { color: [0.0; BANDS], perturbation: DVec3::ZERO };
        for (weight, steps) in [(share, &self.foreground), (1.0 - share, &self.background)] {
            if weight > 0.0 {
                let mut part = before;
                steps.iter().for_each(|step| step.apply(scene, interaction, scratch, &mut part));
                appearance.perturbation += part.perturbation * weight;
                for (sum, band) in appearance.color.iter_mut().zip(part.color) {
                    *sum += band * weight;
                }
            }
        }
    }
}

fn multiply<const BANDS: usize>(color: &mut [f64; BANDS], by: [f64; 3]) {
    for (band, factor) in color.iter_mut().zip(spread::<BANDS>(by)) {
        *band *= factor;
    }
}

/// Values from grids, through the functions that the primitive names: roots are first the functions, then the coordinates.
fn from_grids(
    scene: &Scene,
    function: &Function,
    grids: &[Handle<DataGrid>],
    interaction: &SurfaceInteraction,
    scratch: &mut Scratch,
) -> Option<[f64; 3]> {
    let view = function.view(interaction);
    let functions = grids.len();
    let axes = scene.grids[grids[0]].axes.len().min(MAX_COORDINATES);
    let mut coordinates = [0.0; MAX_COORDINATES];
    for (axis, coordinate) in coordinates[..axes].iter_mut().enumerate() {
        *coordinate = function.program.eval(functions + axis, &[], &view, scratch).ok()?;
    }
    let mut raw = [0.0; 3];
    for (value, grid) in raw.iter_mut().zip(grids) {
        *value = scene.grids[*grid].value(&coordinates[..axes]);
    }
    let mut values = [0.0; 3];
    for (root, value) in values[..functions].iter_mut().enumerate() {
        *value = function.program.eval(root, &raw[..functions], &view, scratch).ok()?;
    }
    Some(values)
}

/// Values from a picture's colour: roots are first `VALUES` functions of red, green and blue, then u and v.
fn from_picture<const VALUES: usize>(
    picture: &PictureData,
    function: &Function,
    interaction: &SurfaceInteraction,
    scratch: &mut Scratch,
) -> Option<[f64; VALUES]> {
    let view = function.view(interaction);
    let u = function.program.eval(VALUES, &[], &view, scratch).ok()?;
    let v = function.program.eval(VALUES + 1, &[], &view, scratch).ok()?;
    let color = picture.value(u, v);
    let mut values = [0.0; VALUES];
    for (root, value) in values.iter_mut().enumerate() {
        *value = function.program.eval(root, &color, &view, scratch).ok()?;
    }
    Some(values)
}
