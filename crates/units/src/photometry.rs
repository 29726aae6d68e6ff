//! Luminous efficacies.

/// Luminous efficacy of white light of equal energy at all visible wavelengths, lm/W: Radiance's
/// factor from Y in W/(sr·m²) to luminance in cd/m².
pub const WHITE_EFFICACY: f64 = 179.0;

/// The same for scotopic vision, V'(λ) of CIE 1951, lm/W.
pub const WHITE_SCOTOPIC_EFFICACY: f64 = 412.0;

/// The same for the melanopic response of CIE S 026, lm/W: Radiance uses [`WHITE_EFFICACY`].
pub const WHITE_MELANOPIC_EFFICACY: f64 = WHITE_EFFICACY;

/// Luminous efficacy of radiation at 540 THz, lm/W: the SI's definition of the candela (BIPM 2019).
pub const LUMINOUS_EFFICACY: f64 = 683.0;
