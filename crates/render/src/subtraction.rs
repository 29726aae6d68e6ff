//! What antimatter has cut away for a ray.

mod antimatter;

use radsight_accel::ShaderId;

/// What is cut for a ray, and what bodies it is within.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Subtraction {
    /// Shaders of the surfaces that are not there, ascending.
    gone: Vec<ShaderId>,
    /// For shaders that any antimatter cuts: how many more fronts than backs the ray has passed. Ascending, none of them zero.
    passed: Vec<(ShaderId, i32)>,
}

/// Names a cut that the present ray has met; the first is that of nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SubtractionId(u32);

/// What becomes of a ray at a surface, by antimatter alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AntimatterEvent {
    /// The surface is not there. The ray goes on with this cut.
    Nothing(SubtractionId),
    /// The surface is there. What passes through it goes on with this cut.
    Surface(SubtractionId),
}

impl Subtraction {
    fn pass(&mut self, shader: ShaderId, step: i32) {
        match self.passed.binary_search_by_key(&shader, |(shader, _)| *shader) {
            Ok(place) if self.passed[place].1 + step == 0 => {
                self.passed.remove(place);
            }
            Ok(place) => self.passed[place].1 += step,
            Err(place) => self.passed.insert(place, (shader, step)),
        }
    }

    fn add(&mut self, shader: ShaderId) {
        if let Err(place) = self.gone.binary_search(&shader) {
            self.gone.insert(place, shader);
        }
    }

    fn is_within_any(&self, shaders: &[ShaderId]) -> bool {
        let passed = self.passed.iter().filter(|(shader, _)| shaders.binary_search(shader).is_ok());
        passed.map(|(_, count)| count).sum::<i32>() > 0
    }
}
