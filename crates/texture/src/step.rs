//! A pattern or texture, evaluated at an intersection.

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
    /// Constant factors.
    Constant(Bands),
    /// One factor for all bands, from a function.
    Brightness(Function),
    /// Factors of red, green and blue, from a function.
    Color(Function),
    /// One factor for all bands, interpolated in a grid.
    BrightnessData(Function, Handle<DataGrid>),
    /// Factors of red, green and blue, interpolated in three grids.
    ColorData(Function, [Handle<DataGrid>; 3]),
    /// Factors of red, green and blue, from a picture.
    Picture(Function, Handle<PictureData>),
    /// Text: one colour on letters, another beside them.
    Text {
        /// The typeset text.
        lettering: Lettering,
        /// Colour of the letters.
        foreground: Rgb,
        /// Colour of the background.
        background: Rgb,
    },
    /// A spectrum from a function of the wavelength.
    SpectralFunction(SpectralFunction),
    /// A spectrum from a grid whose last axis is the wavelength.
    SpectralData(SpectralData),
    /// Perturbation of the normal by a function's three values.
    Texture(Function),
    /// Perturbation of the normal by values of three grids.
    TextureData(Function, [Handle<DataGrid>; 3]),
    /// Mixture of two lists of patterns and textures.
    Mixture(Box<MixedSteps>),
    /// Steps that see a surface that was turned inside out as it was before.
    InsideOut(Vec<Step>),
}

/// Two lists of patterns and textures, and the weight of the first.
#[derive(Clone, Debug)]
pub struct MixedSteps {
    /// Weight of the foreground.
    pub share: Share,
    /// Steps of the foreground.
    pub foreground: Vec<Step>,
    /// Steps of the background.
    pub background: Vec<Step>,
}

/// Weight of a mixture's foreground.
#[derive(Clone, Debug)]
pub enum Share {
    /// Value of a function.
    Function(Function),
    /// Value interpolated in a grid.
    Data(Function, Handle<DataGrid>),
    /// Value of a function of a picture's colour.
    Picture(Function, Handle<PictureData>),
    /// One on letters, zero beside them.
    Text(Lettering),
}

impl Share {
    /// The weight, 0…1; none if the function fails, where Radiance leaves the mixture out.
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
    /// Whether it can have different factors for red, green and blue.
    pub fn is_colored(&self) -> bool {
        match self {
            Step::Constant(bands) => !bands.is_grey(),
            Step::Text { foreground, background, .. } => !(foreground.is_grey() && background.is_grey()),
            Step::Mixture(mixed) => mixed.foreground.iter().chain(&mixed.background).any(Step::is_colored),
            Step::InsideOut(steps) => steps.iter().any(Step::is_colored),
            Step::Color(_)
            | Step::ColorData(..)
            | Step::Picture(..)
            | Step::SpectralFunction(_)
            | Step::SpectralData(_) => true,
            Step::Brightness(_) | Step::BrightnessData(..) | Step::Texture(_) | Step::TextureData(..) => false,
        }
    }

    /// Whether it can perturb the normal.
    pub fn is_texture(&self) -> bool {
        match self {
            Step::Texture(_) | Step::TextureData(..) => true,
            Step::Mixture(mixed) => mixed.foreground.iter().chain(&mixed.background).any(Step::is_texture),
            Step::InsideOut(steps) => steps.iter().any(Step::is_texture),
            _ => false,
        }
    }

    /// Applies the step. If its function fails, nothing changes, as in Radiance.
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
            Step::InsideOut(steps) => {
                let interaction = SurfaceInteraction { behind: !interaction.behind, ..*interaction };
                appearance.perturbation = -appearance.perturbation;
                steps.iter().for_each(|step| step.apply(scene, &interaction, scratch, appearance));
                appearance.perturbation = -appearance.perturbation;
            }
        }
    }
}

impl MixedSteps {
    /// Applies both lists to the same input and mixes the results.
    fn apply<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        scratch: &mut Scratch,
        appearance: &mut Appearance<BANDS>,
    ) {
        let Some(share) = self.share.at(scene, interaction, scratch) else { return };
        let before = *appearance;
        *appearance = Appearance { color: [0.0; BANDS], perturbation: DVec3::ZERO, ..before };
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

/// Values from grids, passed through the primitive's functions: the first roots are the functions,
/// the others the coordinates.
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

/// Values from a picture's colour: the first `VALUES` roots are functions of red, green and blue,
/// the others u and v.
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
