//! Lumens a watt.

/// Lumens a watt of white light of equal energy at all visible wavelengths, lm/W: what Radiance multiplies Y by to have
/// luminance in cd/m² from radiance in W/(sr·m²).
pub const WHITE_EFFICACY: f64 = 179.0;

/// The same for the rods' response V'(λ) of CIE 1951, lm/W.
pub const WHITE_SCOTOPIC_EFFICACY: f64 = 412.0;

/// The same for the melanopic response of CIE S 026, lm/W: Radiance takes that of [`WHITE_EFFICACY`].
pub const WHITE_MELANOPIC_EFFICACY: f64 = WHITE_EFFICACY;

/// Lumens a watt of light of 540 THz, lm/W: the SI's definition of the candela (BIPM 2019).
pub const LUMINOUS_EFFICACY: f64 = 683.0;
