//! `prism1` and `prism2`: surfaces that send rays on in directions that functions give.
//!
//! Each of up to two faces has a coefficient and a direction. A ray that looks for a light by way of a prism tells the functions where the
//! light is, as `DxA`, `DyA`, `DzA`; for others these are zero. The light appears where a shear parallel to the prism's plane moves it
//! that makes the middle of the prism send it right: the virtual source of Radiance. From there the way to a near light is looked for (`prism_path`).

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
    /// How many of its faces send light on.
    pub faces: u32,
}

/// A ray at a prism, and where its light is.
struct PrismView<'a> {
    view: FunctionView<'a>,
    /// Unit, in the function's frame; zero for a ray that looks for no light.
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
    /// The material, compiled.
    pub fn new(prism: &Prism) -> PrismKind {
        PrismKind { function: Function::new(&prism.call), faces: if prism.faces == PrismFace::One { 1 } else { 2 } }
    }

    /// Coefficient and unit direction in which a face sends a ray on; `aim` is the unit direction to the light that it looks for, or zero.
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

    /// How far a point appears beside its place, for each unit of its height above the prism's plane, when light along `arriving` that meets
    /// the middle of the prism leaves it as this face says.
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
