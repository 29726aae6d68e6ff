//! The antimatter subtraction of a ray.

mod antimatter;

use radsight_accel::ShaderId;

/// The shaders that are subtracted for a ray, and the volumes around it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subtraction {
    /// Shaders of the subtracted surfaces, ascending.
    gone: Vec<ShaderId>,
    /// For shaders that any antimatter cuts: number of fronts minus number of backs that the ray
    /// has passed. Ascending, never zero.
    passed: Vec<(ShaderId, i32)>,
}

/// Identifies a subtraction of the current ray; the first subtracts nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SubtractionId(u32);

/// The effect of antimatter on a ray at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AntimatterEvent {
    /// The surface is subtracted. The ray continues with this subtraction.
    Nothing(SubtractionId),
    /// The surface exists. Rays through it continue with this subtraction.
    Surface(SubtractionId),
}

impl Subtraction {
    fn pass(&mut self, shader: ShaderId, step: i32) {
        match self.passed.binary_search_by_key(&shader, |(shader, _)| *shader) {
            Ok(index) if self.passed[index].1 + step == 0 => {
                self.passed.remove(index);
            }
            Ok(index) => self.passed[index].1 += step,
            Err(index) => self.passed.insert(index, (shader, step)),
        }
    }

    fn add(&mut self, shader: ShaderId) {
        if let Err(index) = self.gone.binary_search(&shader) {
            self.gone.insert(index, shader);
        }
    }

    fn is_within_any(&self, shaders: &[ShaderId]) -> bool {
        let passed = self.passed.iter().filter(|(shader, _)| shaders.binary_search(shader).is_ok());
        passed.map(|(_, count)| count).sum::<i32>() > 0
    }
}
