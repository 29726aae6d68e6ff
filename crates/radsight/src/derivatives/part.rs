//! Parts whose pose is a parameter.

use super::parameter::{Parameter, PartParameter};
use crate::error::Error;
use crate::part_move::{PartMove, moved_surfaces, regions};
use glam::{DMat3, DVec3};
use radsight_capture::{Motion, PartMotion, Region};
use radsight_diag::Diagnostic;
use radsight_ir::{Scene, SurfaceHandle, Transform};
use radsight_pinhole::PinholeCamera;

/// Motion of the outline between the two sides of a step, in pixels.
const OUTLINE_STEP: f64 = 0.1;

/// Largest step of an angle, degrees. A wall that a camera sees at a grazing angle appears and
/// vanishes within a degree, and mirrors turn light by twice their own angle.
const MAX_TURN_STEP: f64 = 0.1;

/// A part of a scene, and a degree of freedom of its pose.
pub(super) struct MovingPart<'p> {
    parameter: &'p PartParameter,
    surfaces: Vec<SurfaceHandle>,
    /// Middle of its bounding box, scene units.
    middle: DVec3,
    /// Half the diagonal of the box, scene units.
    radius: f64,
    /// Metres.
    scene_unit_m: f64,
}

impl<'p> MovingPart<'p> {
    pub(super) fn find(
        scene: &Scene,
        parameter: &'p PartParameter,
        scene_unit_m: f64,
    ) -> Result<MovingPart<'p>, Diagnostic> {
        let still = PartMove::rigid(&parameter.surfaces, Transform::IDENTITY);
        let surfaces = moved_surfaces(scene, [&still])?;
        let Some(regions) = regions(scene, &surfaces) else {
            let message = format!("\"{}\" has no bounds: a distant source cannot be moved", parameter.surfaces);
            return Err(Diagnostic::error(message));
        };
        let region = regions.iter().fold(Region::EMPTY, |all, region| all.union(region));
        let middle = 0.5 * (region.low + region.high);
        Ok(MovingPart { parameter, surfaces, middle, radius: region.high.distance(middle), scene_unit_m })
    }

    /// The step: it moves the outline by a tenth of a pixel.
    pub(super) fn step(&self, parameter: &Parameter, camera: &PinholeCamera) -> Result<f64, Error> {
        let distance = (self.middle * self.scene_unit_m - camera.position_m()).dot(camera.direction());
        if distance <= 0.0 {
            return Err(parameter.wrong("the part is behind the camera"));
        }
        let [across, down] = camera.pixel_pitch_m();
        let step_m = OUTLINE_STEP * across.min(down) * distance / camera.focal_distance_m();
        let turn = (step_m / (self.radius * self.scene_unit_m)).to_degrees().min(MAX_TURN_STEP);
        Ok(if self.parameter.turns { turn } else { step_m })
    }

    /// The pose changed by an amount, metres or degrees.
    pub(super) fn moved(&self, amount: f64) -> PartMove {
        let PartParameter { surfaces, axis, turns } = self.parameter;
        let transform = if *turns {
            let rotation = DMat3::from_axis_angle(*axis, amount.to_radians());
            Transform { rotation, translation: self.middle - rotation * self.middle, ..Transform::IDENTITY }
        } else {
            Transform { translation: *axis * (amount / self.scene_unit_m), ..Transform::IDENTITY }
        };
        PartMove::rigid(surfaces, transform)
    }

    /// Its motion per unit of the parameter.
    pub(super) fn motion(&self) -> Motion {
        let PartParameter { axis, turns, .. } = *self.parameter;
        let (shift, turn) =
            if turns { (DVec3::ZERO, axis * 1f64.to_radians()) } else { (axis / self.scene_unit_m, DVec3::ZERO) };
        let surfaces = self.surfaces.iter().map(|surface| surface.index()).collect();
        Motion::Part(PartMotion { surfaces, shift, turn, pivot: self.middle })
    }
}
