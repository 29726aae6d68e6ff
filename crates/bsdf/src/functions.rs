//! Materials whose scattering is a function of the direction to a light: `plasfunc` and its kin, and `BRTDfunc`.
//!
//! As in Radiance, the function meets light from sources alone. Light from elsewhere is scattered by `plasfunc` and its kin as if the
//! function's share were diffuse; `BRTDfunc` states its diffuse, mirror and straight-through shares apart.

use crate::bsdf::{Bsdf, Highlight};
use crate::context::{BsdfContext, SpecularBounce, SurfaceScattering};
use crate::frame::Frame;
use crate::function_lobe::{FunctionLobe, LobeFunction, Surroundings};
use crate::transmission_lobe::Transmission;
use radsight_cal::Scratch;
use radsight_ir::{DataGrid, Handle, Rgb, ScatteringRole};
use radsight_texture::{Function, bands, spread};

/// `plasfunc`, `metfunc`, `transfunc`, `plasdata`, `metdata`, `transdata`.
#[derive(Clone, Debug)]
pub struct ScatteringKind {
    /// Which of the six materials it is.
    pub role: ScatteringRole,
    /// The function, then for data the coordinates.
    pub function: Function,
    /// The table of a `…data` material.
    pub grid: Option<Handle<DataGrid>>,
    /// Of the material, before patterns.
    pub color: Rgb,
    /// Share of light that the function reflects.
    pub specularity: f64,
    /// Share of what is not reflected specularly that goes through, 0…1.
    pub transmissivity: f64,
    /// Share of what goes through that is specular, 0…1.
    pub transmitted_specularity: f64,
}

impl ScatteringKind {
    /// Whether every band is the same, as far as the material itself goes.
    pub fn is_grey(&self) -> bool {
        self.color.is_grey()
    }

    /// What the material makes of a ray: its BSDF there, and the perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(&'a self, context: &BsdfContext<'a, BANDS>) -> SurfaceScattering<'a, BANDS> {
        let color = context.colored(bands(self.color));
        let share = |share: f64| color.map(|band| band * share.max(0.0));
        let transmitted = self.transmissivity * (1.0 - self.specularity);
        let through = transmitted * self.transmitted_specularity;
        let source = match self.grid {
            Some(grid) => LobeFunction::Table(&self.function, &context.scene.grids[grid]),
            None => LobeFunction::Grey(&self.function),
        };
        let reflected = match self.role {
            ScatteringRole::Metal => share(self.specularity),
            ScatteringRole::Plastic | ScatteringRole::Trans => [self.specularity; BANDS],
        };
        let lobe = FunctionLobe {
            source,
            surroundings: Surroundings { interaction: context.turned, ..context.surroundings(color) },
            factors: [reflected, share(through)],
            ambient: [share(self.specularity), share(through)],
        };
        let point = Bsdf {
            diffuse: share(1.0 - transmitted - self.specularity),
            highlight: Highlight::Function(lobe),
            ..Bsdf::new(context.outgoing(), context.interaction.normal, Frame::new(context.normal))
        };
        let transmission = Transmission::new(context.normal, share(transmitted - through), None);
        SurfaceScattering { point: point.with_transmission(transmission), mirror: None, straight: None }
    }
}

/// `BRTDfunc`.
#[derive(Clone, Debug)]
pub struct BrtdKind {
    /// Nine roots: mirror, straight-through and scattering, three bands each.
    pub function: Function,
    /// Front reflected, back reflected, transmitted.
    pub diffuse: [Rgb; 3],
    /// Whether the three bands have the same functions.
    pub has_grey_functions: bool,
}

/// First roots.
const MIRROR: usize = 0;
const STRAIGHT: usize = 3;
const SCATTERING: usize = 6;

impl BrtdKind {
    /// Whether every band is the same, as far as the material itself goes.
    pub fn is_grey(&self) -> bool {
        self.has_grey_functions && self.diffuse.iter().all(|color| color.is_grey())
    }

    /// Whether a shadow ray can go straight through.
    pub fn lets_through(&self) -> bool {
        (STRAIGHT..SCATTERING).any(|root| self.function.program.constant(root) != Some(0.0))
    }

    /// What the material makes of a ray: its BSDF there, and the perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        let surroundings = context.surroundings(context.appearance.color);
        let [front, back, transmitted] = self.diffuse;
        let reflected = if context.interaction.behind { back } else { front };
        let lobe = FunctionLobe {
            source: LobeFunction::Color(&self.function, SCATTERING),
            surroundings,
            factors: [[1.0; BANDS]; 2],
            ambient: [[0.0; BANDS]; 2],
        };
        let point = Bsdf {
            diffuse: context.colored(bands(reflected)),
            highlight: Highlight::Function(lobe),
            ..Bsdf::new(context.outgoing(), context.interaction.normal, Frame::new(context.normal))
        };
        let transmission = Transmission::new(context.normal, context.colored(bands(transmitted)), None);
        let mirror = SpecularBounce::new(point.mirror_direction(), self.coefficients(MIRROR, &surroundings, scratch));
        let straight = SpecularBounce::new(context.straight(), self.coefficients(STRAIGHT, &surroundings, scratch));
        SurfaceScattering { point: point.with_transmission(transmission), mirror, straight }
    }

    fn coefficients<const BANDS: usize>(
        &self,
        first: usize,
        surroundings: &Surroundings<'_>,
        scratch: &mut Scratch,
    ) -> [f64; BANDS] {
        let mut values = [0.0; 3];
        for (band, value) in values[..BANDS.min(3)].iter_mut().enumerate() {
            *value = surroundings.value(&self.function, first + band, scratch);
        }
        spread(values)
    }
}
