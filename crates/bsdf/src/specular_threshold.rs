//! Highlights that are too weak to be sampled: Radiance's `-st`.
//!
//! Direct light meets such a highlight like any other. Indirect light meets its albedo as a part of
//! the diffuse component, if there is one: that takes no rays and adds no noise.

/// Unsampled highlights of a shading point, for light from the viewer's side and from the other
/// side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BelowThreshold<const BANDS: usize> {
    /// Albedo added to the diffuse component; none if the highlight is sampled or absent.
    sides: [Option<[f64; BANDS]>; 2],
}

/// A highlight on one side.
#[derive(Clone, Copy, Debug)]
pub struct LobeStrength<const BANDS: usize> {
    /// Estimated albedo, which is compared with the threshold.
    pub share: f64,
    /// Albedo by band.
    pub color: [f64; BANDS],
    /// Albedo of the diffuse component that it would join.
    pub diffuse: f64,
}

/// Albedos up to this count as zero (Radiance's).
const TINY: f64 = 1e-6;

impl<const BANDS: usize> BelowThreshold<BANDS> {
    /// All highlights are sampled.
    pub const NOTHING: Self = BelowThreshold { sides: [None; 2] };

    /// Selects the highlights that do not exceed the threshold.
    pub fn new(threshold: f64, sides: [LobeStrength<BANDS>; 2]) -> Self {
        let weak = |side: LobeStrength<BANDS>| {
            let is_weak = side.share > 0.0 && side.share <= threshold + TINY && threshold > 0.0;
            is_weak.then_some(if side.diffuse > TINY { side.color } else { [0.0; BANDS] })
        };
        BelowThreshold { sides: sides.map(weak) }
    }

    /// Whether the highlight is left unsampled, for light from each side.
    pub fn is_left_out(&self) -> [bool; 2] {
        self.sides.map(|side| side.is_some())
    }

    /// Albedo that indirect light from each side meets diffusely.
    pub fn as_diffuse(&self) -> [[f64; BANDS]; 2] {
        self.sides.map(|side| side.unwrap_or([0.0; BANDS]))
    }

    /// Whether any highlight is left unsampled.
    pub fn has_any(&self) -> bool {
        self.sides.iter().flatten().flatten().any(|band| *band > 0.0)
    }
}

impl<const BANDS: usize> LobeStrength<BANDS> {
    /// No highlight.
    pub const NONE: Self = LobeStrength { share: 0.0, color: [0.0; BANDS], diffuse: 0.0 };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(share: f64, diffuse: f64) -> LobeStrength<1> {
        LobeStrength { share, color: [0.5 * share], diffuse }
    }

    #[test]
    fn a_highlight_at_the_threshold_joins_the_diffuse_component() {
        let below_threshold = BelowThreshold::new(0.15, [candidate(0.15, 0.7), candidate(0.2, 0.7)]);
        assert_eq!(below_threshold.is_left_out(), [true, false]);
        assert_eq!(below_threshold.as_diffuse(), [[0.075], [0.0]]);
    }

    #[test]
    fn without_a_diffuse_component_a_weak_highlight_is_lost() {
        let below_threshold = BelowThreshold::new(0.15, [candidate(0.1, 0.0), LobeStrength::NONE]);
        assert_eq!((below_threshold.is_left_out(), below_threshold.has_any()), ([true, false], false));
    }

    #[test]
    fn a_threshold_of_zero_samples_every_highlight() {
        assert_eq!(BelowThreshold::new(0.0, [candidate(1e-7, 0.7), candidate(0.1, 0.7)]), BelowThreshold::NOTHING);
    }
}
