//! Scattering materials other than `plastic` and `metal`.
//!
//! Each becomes a [`Bsdf`](crate::Bsdf) for everything that is spread over directions, and at most
//! two perfectly specular rays: mirror reflection and straight-through transmission.

use crate::ashikhmin::AshikhminKind;
use crate::context::{BsdfContext, SurfaceScattering};
use crate::functions::{BrtdKind, ScatteringKind};
use crate::measured::MeasuredKind;
use crate::sheet::Sheet;
use crate::ward_function::WardFunctionKind;
use radsight_cal::Scratch;
use radsight_ir::Scene;
use radsight_texture::{Appearance, SurfaceInteraction, shading_normal};

/// A scattering material.
#[derive(Clone, Debug)]
pub enum Scatterer {
    /// `trans`, `plastic2`, `metal2`, `trans2`.
    Sheet(Sheet),
    /// `ashik2`.
    Ashikhmin(AshikhminKind),
    /// `WGMDfunc`.
    WardFunction(WardFunctionKind),
    /// `plasfunc`, `metfunc`, `transfunc`, `plasdata`, `metdata`, `transdata`.
    Function(ScatteringKind),
    /// `BRTDfunc`.
    Brtd(BrtdKind),
    /// `BSDF` and `aBSDF`.
    Measured(MeasuredKind),
}

impl Scatterer {
    /// BSDF of the material at the intersection, and its perfectly specular rays.
    pub fn bsdf_at<'a, const BANDS: usize>(
        &'a self,
        context: &BsdfContext<'a, BANDS>,
        scratch: &mut Scratch,
    ) -> SurfaceScattering<'a, BANDS> {
        match self {
            Scatterer::Sheet(sheet) => sheet.bsdf_at(context, scratch),
            Scatterer::Ashikhmin(kind) => kind.bsdf_at(context, scratch),
            Scatterer::WardFunction(kind) => kind.bsdf_at(context, scratch),
            Scatterer::Function(kind) => kind.bsdf_at(context),
            Scatterer::Brtd(kind) => kind.bsdf_at(context, scratch),
            Scatterer::Measured(kind) => kind.bsdf_at(context, scratch),
        }
    }

    /// Whether shadow rays can pass straight through.
    pub fn lets_through(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.lets_through(),
            Scatterer::WardFunction(kind) => kind.lets_through(),
            Scatterer::Brtd(kind) => kind.lets_through(),
            Scatterer::Measured(kind) => kind.lets_through(),
            Scatterer::Ashikhmin(_) | Scatterer::Function(_) => false,
        }
    }

    /// Whether some of the light may be reflected or transmitted in a single direction. Measured data
    /// may have peaks that are as narrow.
    pub fn may_be_specular(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.may_be_specular(),
            Scatterer::WardFunction(kind) => kind.may_be_specular(),
            Scatterer::Brtd(kind) => kind.may_be_specular(),
            Scatterer::Measured(_) => true,
            Scatterer::Ashikhmin(_) | Scatterer::Function(_) => false,
        }
    }

    /// Straight-through transmittance for a shadow ray, by band.
    pub fn passage<const BANDS: usize>(
        &self,
        scene: &Scene,
        interaction: &SurfaceInteraction,
        appearance: Appearance<BANDS>,
        scratch: &mut Scratch,
    ) -> Option<[f64; BANDS]> {
        if let Scatterer::Measured(kind) = self
            && kind.is_passed_by_shadows(interaction, scratch)
        {
            return Some([1.0; BANDS]);
        }
        let normal = shading_normal(interaction, appearance.perturbation);
        let turned = interaction.turned();
        let context = BsdfContext { scene, interaction, turned: &turned, appearance, normal, threshold: 0.0 };
        self.bsdf_at(&context, scratch).straight.map(|straight| straight.weight)
    }

    /// Whether the surface is hit from behind even if back faces are invisible.
    pub fn has_a_back(&self) -> bool {
        matches!(self, Scatterer::Brtd(_))
    }

    /// Whether the material's own parameters are the same in every band.
    pub fn is_grey(&self) -> bool {
        match self {
            Scatterer::Sheet(sheet) => sheet.is_grey(),
            Scatterer::Ashikhmin(kind) => kind.is_grey(),
            Scatterer::WardFunction(kind) => kind.is_grey(),
            Scatterer::Function(kind) => kind.is_grey(),
            Scatterer::Brtd(kind) => kind.is_grey(),
            Scatterer::Measured(kind) => kind.is_grey(),
        }
    }
}
