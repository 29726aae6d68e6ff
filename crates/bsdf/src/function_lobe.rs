//! The scattering functions of `plasfunc`, `plasdata` and similar materials, and of `BRTDfunc`.
//!
//! Radiance evaluates them for light sources only; indirect light is scattered diffusely.

use glam::DVec3;
use radsight_cal::{Host, Scratch, channel};
use radsight_ir::DataGrid;
use radsight_texture::{Function, FunctionView, SurfaceInteraction, spread};

/// Cosines and values below this count as zero (Radiance's).
const TINY: f64 = 1e-6;

/// Largest dimension of a data file; coordinates are kept on the stack.
const MAX_COORDINATES: usize = 16;

/// A scattering function at one shading point.
#[derive(Clone, Copy, Debug)]
pub struct FunctionLobe<'a, const BANDS: usize> {
    /// Source of the values.
    pub source: LobeFunction<'a>,
    /// Variables of the function.
    pub surroundings: Surroundings<'a>,
    /// Factors of the function for light from the viewer's side and from the other side.
    pub factors: [[f64; BANDS]; 2],
    /// Diffuse albedo for indirect light, for both sides.
    pub ambient: [[f64; BANDS]; 2],
}

/// Source of a scattering function's values.
#[derive(Clone, Copy, Debug)]
pub enum LobeFunction<'a> {
    /// The first root gives all bands.
    Grey(&'a Function),
    /// Three consecutive roots, beginning with this one, give red, green and blue.
    Color(&'a Function, usize),
    /// The first root, given the table's value and the incident direction, gives all bands; the
    /// other roots are the table's coordinates.
    Table(&'a Function, &'a DataGrid),
}

/// Variables of a material's functions.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// The ray at the surface.
    pub interaction: &'a SurfaceInteraction,
    /// `NxP`…: unit shading normal on the viewer's side, textures included.
    pub normal: DVec3,
    /// `RdotP`: cosine between the outgoing direction and that normal.
    pub cosine: f64,
    /// `CrP`…: colour of the material or pattern.
    pub color: [f64; 3],
}

/// A [`FunctionView`] with the additional variables of Radiance's materials.
pub struct MaterialView<'a> {
    view: FunctionView<'a>,
    surroundings: &'a Surroundings<'a>,
}

impl<'a> Surroundings<'a> {
    /// View for evaluating one function.
    pub fn view(&'a self, function: &'a Function) -> MaterialView<'a> {
        MaterialView { view: function.view(self.interaction), surroundings: self }
    }

    /// Value of a root without arguments; zero if evaluation fails.
    pub fn value(&self, function: &Function, root: usize, scratch: &mut Scratch) -> f64 {
        function.program.eval(root, &[], &self.view(function), scratch).unwrap_or(0.0)
    }
}

impl Host for MaterialView<'_> {
    fn channel(&self, n: u32) -> f64 {
        const NORMAL_END: u32 = channel::NXP + 2;
        const COLOR_END: u32 = channel::CRP + 2;
        let index = |first: u32| (n - first) as usize;
        match n {
            channel::NXP..=NORMAL_END => self.view.in_function(self.surroundings.normal)[index(channel::NXP)],
            channel::RDOTP => self.surroundings.cosine,
            channel::CRP..=COLOR_END => self.surroundings.color[index(channel::CRP)],
            _ => self.view.channel(n),
        }
    }
}

impl<const BANDS: usize> FunctionLobe<'_, BANDS> {
    /// Whether indirect light needs another diffuse component than direct light.
    pub fn has_ambient(&self) -> bool {
        self.ambient.iter().flatten().any(|band| *band > 0.0)
    }

    /// `f·|cos θ_i|`, 1/sr, for light from a source of the given solid angle (sr).
    pub fn eval(&self, incident: DVec3, solid_angle: f64, scratch: &mut Scratch) -> [f64; BANDS] {
        let cosine = self.surroundings.normal.dot(incident);
        let factor = self.factors[usize::from(cosine < 0.0)];
        if cosine.abs() <= TINY || factor.iter().all(|band| *band <= TINY) {
            return [0.0; BANDS];
        }
        let values: [f64; BANDS] = spread(self.values(incident, solid_angle, scratch).unwrap_or([0.0; 3]));
        std::array::from_fn(|band| {
            let value = values[band] * factor[band] * cosine.abs();
            if value.is_finite() { value.max(0.0) } else { 0.0 }
        })
    }

    fn values(&self, incident: DVec3, solid_angle: f64, scratch: &mut Scratch) -> Option<[f64; 3]> {
        let arguments = |view: &MaterialView<'_>| {
            let DVec3 { x, y, z } = view.view.in_function(incident);
            [x, y, z, solid_angle]
        };
        match self.source {
            LobeFunction::Grey(function) => {
                let view = self.surroundings.view(function);
                Some([function.program.eval(0, &arguments(&view), &view, scratch).ok()?; 3])
            }
            LobeFunction::Color(function, first) => {
                let view = self.surroundings.view(function);
                let mut values = [0.0; 3];
                for (band, value) in values[..BANDS.min(3)].iter_mut().enumerate() {
                    *value = function.program.eval(first + band, &arguments(&view), &view, scratch).ok()?;
                }
                Some(values)
            }
            LobeFunction::Table(function, grid) => {
                let view = self.surroundings.view(function);
                let [x, y, z, solid_angle] = arguments(&view);
                let axes = grid.axes.len().min(MAX_COORDINATES);
                let mut coordinates = [0.0; MAX_COORDINATES];
                for (axis, coordinate) in coordinates[..axes].iter_mut().enumerate() {
                    *coordinate = function.program.eval(1 + axis, &[x, y, z, solid_angle], &view, scratch).ok()?;
                }
                let value = grid.value(&coordinates[..axes]);
                Some([function.program.eval(0, &[value, x, y, z, solid_angle], &view, scratch).ok()?; 3])
            }
        }
    }
}
