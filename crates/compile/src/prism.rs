//! `prism1` and `prism2`: light-redirecting surfaces, with directions given by functions.
//!
//! Each of up to two faces has a coefficient and a direction. A shadow ray passes the light's
//! direction to the functions as `DxA`, `DyA`, `DzA`; for other rays these are zero. The virtual
//! source is the light displaced by the shear, parallel to the prism's plane, for which the centre
//! of the prism redirects light correctly (Radiance's `virtuals.c`). For a near light, manifold
//! next-event estimation starts from there (`prism_manifold.rs` of `render`).

use glam::DVec3;
use radsight_cal::{Host, Scratch, channel};
use radsight_ir::{Prism, PrismFace};
use radsight_texture::{Function, FunctionView, SurfaceInteraction};

/// Roots of one face: its coefficient and the components of its direction.
const ROOTS: usize = 4;

/// Coefficients and cosines below this make no virtual source.
const TINY: f64 = 1e-6;

/// A light-redirecting material.
#[derive(Clone, Debug)]
pub struct PrismKind {
    function: Function,
    /// Number of faces that redirect light.
    pub faces: u32,
}

/// A ray at a prism, with the direction of its light.
struct PrismView<'a> {
    view: FunctionView<'a>,
    /// Unit direction to the light, in the function's frame; zero for other rays.
    aim: DVec3,
}

impl Host for PrismView<'_> {
    fn channel(&self, n: u32) -> f64 {
        const END: u32 = channel::DXA + 2;
        match n {
            channel::DXA..=END => self.aim[(n - channel::DXA) as usize],
            _ => self.view.channel(n),
        }
    }
}

impl PrismKind {
    /// Compiles the material.
    pub fn new(prism: &Prism) -> PrismKind {
        PrismKind { function: Function::new(&prism.call), faces: if prism.faces == PrismFace::One { 1 } else { 2 } }
    }

    /// Coefficient and unit direction of a ray redirected by a face; `aim` is the unit direction to
    /// the light, or zero.
    pub fn redirect(
        &self,
        face: u32,
        interaction: &SurfaceInteraction,
        aim: DVec3,
        scratch: &mut Scratch,
    ) -> Option<(f64, DVec3)> {
        let view = self.function.view(interaction);
        let aim = view.in_function(aim);
        let view = PrismView { view, aim };
        let mut values = [0.0; ROOTS];
        for (root, value) in values.iter_mut().enumerate() {
            *value = self.function.program.eval(face as usize * ROOTS + root, &[], &view, scratch).ok()?;
        }
        let [coefficient, x, y, z] = values;
        let direction = self.function.in_scene(interaction, DVec3::new(x, y, z)).try_normalize()?;
        (coefficient > 0.0).then_some((coefficient, direction))
    }

    /// Displacement of a point's image, per unit of its height above the prism's plane, if the face
    /// redirects light along `arriving` at the centre of the prism.
    pub fn shift(
        &self,
        face: u32,
        interaction: &SurfaceInteraction,
        normal: DVec3,
        scratch: &mut Scratch,
    ) -> Option<DVec3> {
        let arriving = interaction.direction;
        let (coefficient, leaving) = self.redirect(face, interaction, DVec3::ZERO, scratch)?;
        let (before, after) = (arriving.dot(normal), leaving.dot(normal));
        if coefficient <= TINY || before.abs() <= TINY || after.abs() <= TINY {
            return None;
        }
        let shear = leaving / after - arriving / before;
        Some(if (before > 0.0) == (after > 0.0) { shear } else { shear - normal * 2.0 })
    }
}
