//! Materials with a scattering function of the direction to a light: `plasfunc` and similar
//! materials, and `BRTDfunc`.
//!
//! As in Radiance, only direct light meets the function. `plasfunc` and similar materials scatter
//! indirect light as if the function were Lambertian; `BRTDfunc` has separate diffuse, mirror and
//! straight-through parameters.

use crate::bsdf::{Bsdf, Highlight};
use crate::context::{BsdfContext, SpecularBounce, SurfaceScattering};
use crate::frame::Frame;
use crate::function_lobe::{FunctionLobe, LobeFunction, Surroundings};
use crate::transmission_lobe::Transmission;
use radsight_cal::Scratch;
use radsight_ir::{DataGrid, Handle, Rgb, ScatteringRole};
use radsight_texture::{Function, bands, spread};
use std::ops::Range;

/// `plasfunc`, `metfunc`, `transfunc`, `plasdata`, `metdata`, `transdata`.
#[derive(Clone, Debug)]
pub struct ScatteringKind {
    /// The material type, one of six.
    pub role: ScatteringRole,
    /// The scattering function; for a `…data` material also the coordinates.
    pub function: Function,
    /// Table of a `…data` material.
    pub grid: Option<Handle<DataGrid>>,
    /// Colour of the material, before patterns.
    pub color: Rgb,
    /// Fraction of the light that the function scatters, 0…1.
    pub specularity: f64,
    /// Fraction of the remaining light that is transmitted, 0…1.
    pub transmissivity: f64,
    /// Fraction of the transmitted light that is specular, 0…1.
    pub transmitted_specularity: f64,
}

impl ScatteringKind {
    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        self.color.is_grey()
    }

    /// BSDF of the material at the intersection, and its perfectly specular rays.
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
    /// Diffuse reflectance of the front, of the back, and diffuse transmittance.
    pub diffuse: [Rgb; 3],
    /// Whether red, green and blue have the same functions.
    pub has_grey_functions: bool,
}

/// First root of each part.
const MIRROR: usize = 0;
const STRAIGHT: usize = 3;
const SCATTERING: usize = 6;

impl BrtdKind {
    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        self.has_grey_functions && self.diffuse.iter().all(|color| color.is_grey())
    }

    /// Whether there may be a mirror reflection or straight-through transmission.
    pub fn may_be_specular(&self) -> bool {
        self.may_have(MIRROR..SCATTERING)
    }

    /// Whether shadow rays can pass straight through.
    pub fn lets_through(&self) -> bool {
        self.may_have(STRAIGHT..SCATTERING)
    }

    /// Whether some of these roots may differ from 0.
    fn may_have(&self, mut roots: Range<usize>) -> bool {
        roots.any(|root| self.function.program.constant(root) != Some(0.0))
    }

    /// BSDF of the material at the intersection, and its perfectly specular rays.
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
        let straight =
            SpecularBounce::new(context.straight_or_back(), self.coefficients(STRAIGHT, &surroundings, scratch));
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
