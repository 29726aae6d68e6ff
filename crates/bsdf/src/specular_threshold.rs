//! Highlights that are too weak to look for surroundings in them: Radiance's `-st`.
//!
//! Light of sources meets such a highlight as any other. All other light meets its share as a part of the diffuse component, where there
//! is one, which costs no ray and makes no noise.

/// The undrawn parts of a lit point's highlight, by the side from which light comes: the viewer's, and the other one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BelowThreshold<const BANDS: usize> {
    /// What joins the diffuse component; none where the highlight is drawn from, or where there is none.
    sides: [Option<[f64; BANDS]>; 2],
}

/// A highlight on one side.
#[derive(Clone, Copy, Debug)]
pub struct LobeStrength<const BANDS: usize> {
    /// What it reflects or transmits, about: this is compared.
    pub share: f64,
    /// What it reflects or transmits, by band.
    pub color: [f64; BANDS],
    /// The share of the diffuse component that it would join.
    pub diffuse: f64,
}

/// Shares up to this count as none (Radiance's).
const TINY: f64 = 1e-6;

impl<const BANDS: usize> BelowThreshold<BANDS> {
    /// All highlights are drawn from.
    pub const NOTHING: Self = BelowThreshold { sides: [None; 2] };

    /// What of these highlights is no more than the threshold.
    pub fn new(threshold: f64, sides: [LobeStrength<BANDS>; 2]) -> Self {
        let weak = |side: LobeStrength<BANDS>| {
            let is_weak = side.share > 0.0 && side.share <= threshold + TINY && threshold > 0.0;
            is_weak.then_some(if side.diffuse > TINY { side.color } else { [0.0; BANDS] })
        };
        BelowThreshold { sides: sides.map(weak) }
    }

    /// Whether the highlight for light from each side is left out.
    pub fn is_left_out(&self) -> [bool; 2] {
        self.sides.map(|side| side.is_some())
    }

    /// What is scattered as if diffuse of light from each side that is no source's.
    pub fn as_diffuse(&self) -> [[f64; BANDS]; 2] {
        self.sides.map(|side| side.unwrap_or([0.0; BANDS]))
    }

    /// Whether there is any such light.
    pub fn has_any(&self) -> bool {
        self.sides.iter().flatten().flatten().any(|band| *band > 0.0)
    }
}

impl<const BANDS: usize> LobeStrength<BANDS> {
    /// There is none.
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
    fn a_threshold_of_zero_draws_from_all() {
        assert_eq!(BelowThreshold::new(0.0, [candidate(1e-7, 0.7), candidate(0.1, 0.7)]), BelowThreshold::NOTHING);
    }
}
