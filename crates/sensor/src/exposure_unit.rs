//! Units of energy per area.

/// The unit of E in Eq. 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExposureUnit {
    /// J/m², the SI unit.
    JoulePerSquareMetre,
    /// mJ/m².
    MillijoulePerSquareMetre,
    /// µJ/m².
    MicrojoulePerSquareMetre,
    /// nJ/m².
    NanojoulePerSquareMetre,
    /// J/cm².
    JoulePerSquareCentimetre,
    /// mJ/cm².
    MillijoulePerSquareCentimetre,
    /// µJ/cm².
    MicrojoulePerSquareCentimetre,
    /// nJ/cm².
    NanojoulePerSquareCentimetre,
}

use ExposureUnit::{
    JoulePerSquareCentimetre, JoulePerSquareMetre, MicrojoulePerSquareCentimetre, MicrojoulePerSquareMetre,
    MillijoulePerSquareCentimetre, MillijoulePerSquareMetre, NanojoulePerSquareCentimetre, NanojoulePerSquareMetre,
};

impl ExposureUnit {
    /// All units, for messages and tests.
    pub const ALL: [ExposureUnit; 8] = [
        JoulePerSquareMetre,
        MillijoulePerSquareMetre,
        MicrojoulePerSquareMetre,
        NanojoulePerSquareMetre,
        JoulePerSquareCentimetre,
        MillijoulePerSquareCentimetre,
        MicrojoulePerSquareCentimetre,
        NanojoulePerSquareCentimetre,
    ];

    /// Name in a camera file: `uJ/cm2`, `J/m2`, ….
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            JoulePerSquareMetre => "J/m2",
            MillijoulePerSquareMetre => "mJ/m2",
            MicrojoulePerSquareMetre => "uJ/m2",
            NanojoulePerSquareMetre => "nJ/m2",
            JoulePerSquareCentimetre => "J/cm2",
            MillijoulePerSquareCentimetre => "mJ/cm2",
            MicrojoulePerSquareCentimetre => "uJ/cm2",
            NanojoulePerSquareCentimetre => "nJ/cm2",
        }
    }

    /// Unit of a name; `µ` and `²` are accepted too.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let plain = name.replace(['µ', 'μ'], "u").replace('²', "2");
        ExposureUnit::ALL.into_iter().find(|unit| unit.name() == plain)
    }

    /// Number of this unit in 1 J/m².
    #[must_use]
    pub fn per_joule_per_square_metre(self) -> f64 {
        match self {
            JoulePerSquareMetre => 1.0,
            MillijoulePerSquareMetre => 1e3,
            MicrojoulePerSquareMetre => 1e6,
            NanojoulePerSquareMetre => 1e9,
            JoulePerSquareCentimetre => 1e-4,
            MillijoulePerSquareCentimetre => 0.1,
            MicrojoulePerSquareCentimetre => 100.0,
            NanojoulePerSquareCentimetre => 1e5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_joule_per_square_metre_is_100_microjoule_per_square_centimetre() {
        assert_eq!(MicrojoulePerSquareCentimetre.per_joule_per_square_metre(), 100.0);
        assert_eq!(ExposureUnit::from_name("µJ/cm²"), Some(MicrojoulePerSquareCentimetre));
    }

    #[test]
    fn names_round_trip_and_prefixes_are_thousands() {
        for unit in ExposureUnit::ALL {
            assert_eq!(ExposureUnit::from_name(unit.name()), Some(unit));
        }
        for pair in ExposureUnit::ALL.windows(2).filter(|pair| pair[1] != JoulePerSquareCentimetre) {
            let ratio = pair[1].per_joule_per_square_metre() / pair[0].per_joule_per_square_metre();
            assert!((ratio / 1e3 - 1.0).abs() < 1e-12);
        }
        assert_eq!(ExposureUnit::from_name("erg/in2"), None);
    }
}
