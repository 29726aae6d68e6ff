//! Eq. 5 applied to the reference pictures of the paper's experiment, against the values published
//! with them.

use radsight_sensor::{BitDepth, ExposureUnit, PowerLaw, PowerLawDescription};
use std::path::Path;

/// Mean, minimum and maximum grey value, from `noise.txt`.
const EXPECTED: [(&str, f64, f64, f64); 6] = [
    ("t8", 13.647, 12.00, 31.76),
    ("t9", 20.893, 12.00, 118.52),
    ("t10", 20.926, 12.00, 118.45),
    ("t11", 29.422, 14.52, 110.10),
    ("t13", 28.906, 12.00, 110.25),
    ("t14", 28.947, 14.52, 110.11),
];

/// Values of a little-endian grey PFM of 192 × 165 pixels.
fn exposures(name: &str) -> Vec<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/gripps/truth").join(format!("{name}.pfm"));
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let header = b"Pf\n192 165\n-1.0\n";
    assert_eq!(&bytes[..header.len()], header);
    bytes[header.len()..].chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
}

#[test]
fn grey_values_of_the_reference_pictures_are_the_published_ones() {
    let sensor = PowerLaw::new(&PowerLawDescription {
        k: 33844.0,
        gamma: 0.85,
        grey_background: 12.0,
        grey_max: 161.0,
        exposure_unit: ExposureUnit::MicrojoulePerSquareCentimetre,
        bits: BitDepth::EIGHT,
    })
    .unwrap();
    for (name, mean, least, largest) in EXPECTED {
        let greys: Vec<f64> = exposures(name).iter().map(|&exposure| sensor.exact_grey(exposure)).collect();
        assert_eq!(greys.len(), 192 * 165);
        assert!((greys.iter().sum::<f64>() / greys.len() as f64 - mean).abs() < 6e-4, "{name}: mean");
        assert!((greys.iter().fold(f64::MAX, |a, &b| a.min(b)) - least).abs() < 6e-3, "{name}: least");
        assert!((greys.iter().fold(0.0f64, |a, &b| a.max(b)) - largest).abs() < 6e-3, "{name}: largest");
    }
}
