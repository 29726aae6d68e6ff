//! Sensors with published data.
//!
//! A preset contains only values that its source states, or that follow from them by the standard's
//! definitions; a camera file gives the rest.

/// Published data of a sensor type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Name in a camera file.
    pub name: &'static str,
    /// Source of the values.
    pub source: &'static str,
    /// Pixel pitch along a row and along a column, metres.
    pub pixel_pitch_m: [f64; 2],
    /// Quantum efficiency in electrons per photon, and its wavelength in metres.
    pub quantum_efficiency: Option<(f64, f64)>,
    /// Full-well capacity, electrons.
    pub full_well_e: f64,
    /// Read noise, electrons.
    pub read_noise_e: f64,
    /// Electrons per grey level of a 16-bit picture.
    pub electrons_per_16_bit_grey: Option<f64>,
}

impl Preset {
    /// All presets.
    pub const ALL: [Preset; 3] = [
        Preset {
            name: "imx174",
            source: "EMVA 1288 figures of a Sony IMX174, quoted at \
                     fhotolab.fherb.de/2016/09/07/sony-exmor-sensoren-dateblattrekonstruktion-imx157",
            pixel_pitch_m: [5.86e-6; 2],
            quantum_efficiency: Some((0.77, 525e-9)),
            full_well_e: 32_691.0,
            read_noise_e: 6.83,
            electrons_per_16_bit_grey: Some(0.51),
        },
        Preset {
            name: "imx250",
            source: "EMVA 1288 figures of the mvBlueFOX3-2051 (Sony IMX250), www.matrix-vision.com/manuals: SNR 40.3 dB, so \
                     a well of 10^4.03 e; dynamic range 71.2 dB = well/(noise + 0.5 e)",
            pixel_pitch_m: [3.45e-6; 2],
            quantum_efficiency: None,
            full_well_e: 10_715.0,
            read_noise_e: 2.45,
            electrons_per_16_bit_grey: None,
        },
        Preset {
            name: "tc211",
            source: "Texas Instruments TC211 in the tracking camera of the SBIG ST-7XE: its operating manual, section 4, \
                     table 4.3, www.easymanua.ls/sbig/st-7xe/manual?p=50 (192 x 164 pixels, 12 e rms, 150 ke)",
            pixel_pitch_m: [13.75e-6, 16e-6],
            quantum_efficiency: None,
            full_well_e: 150_000.0,
            read_noise_e: 12.0,
            electrons_per_16_bit_grey: None,
        },
    ];

    /// Preset of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Preset> {
        Preset::ALL.into_iter().find(|preset| preset.name.eq_ignore_ascii_case(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_derived_follows_from_what_the_source_states() {
        let sony = Preset::from_name("IMX250").unwrap();
        let decibels = |ratio: f64| 20.0 * ratio.log10();
        assert!((decibels(sony.full_well_e.sqrt()) - 40.3).abs() < 0.05);
        assert!((decibels(sony.full_well_e / (sony.read_noise_e + 0.5)) - 71.2).abs() < 0.05);
        // The source of the other sensor states 45.12 dB and 73 dB.
        let other = Preset::from_name("imx174").unwrap();
        assert!((decibels(other.full_well_e.sqrt()) - 45.12).abs() < 0.05);
        assert!((decibels(other.full_well_e / (other.read_noise_e + 0.5)) - 73.0).abs() < 0.1);
    }
}
