//! The photon transfer method recovers the simulated sensor's parameters, with the confidence of
//! its intervals.

use radsight_sensor::characterise::{Characterisation, Series, evaluate, measure};
use radsight_sensor::{BitDepth, Emva1288, Emva1288Description, Estimate, EvenLight, NonUniformity, SpatialDeviation};

/// One of the estimated quantities.
type Quantity = fn(&Characterisation) -> Estimate;

const PIXELS: [u32; 2] = [48, 40];
const DSNU: SpatialDeviation = SpatialDeviation { pixel: 5.0, row: 2.5, column: 3.5 };
const PRNU: SpatialDeviation = SpatialDeviation { pixel: 0.01, row: 0.004, column: 0.006 };

fn description() -> Emva1288Description {
    Emva1288Description {
        quantum_efficiency: 0.64,
        gain_dn_per_e: 0.27,
        dark_offset_dn: 70.0,
        dark_current_e_per_s: 900.0,
        read_noise_e: 9.0,
        full_well_e: 11_500.0,
        bits: BitDepth::new(12).unwrap(),
        pixel_area_m2: 34.3e-12,
        wavelength_m: 525e-9,
        exposure_s: 0.01,
    }
}

fn found(description: Emva1288Description, seed: u64) -> Characterisation {
    let uneven = NonUniformity { dsnu_e: DSNU, prnu: PRNU, columns: PIXELS[0], specimen: 1000 + seed };
    let sensor = Emva1288::new(&description).unwrap().with_non_uniformity(uneven).unwrap();
    let series = measure(&EvenLight::new(sensor, PIXELS), &Series { steps: 24, stack: 12 }, seed).unwrap();
    evaluate(&series).unwrap()
}

/// Halves an interval about its value.
fn half(estimate: Estimate) -> Estimate {
    let towards = |end: f64| 0.5 * (end + estimate.value);
    Estimate { low: towards(estimate.low), high: towards(estimate.high), ..estimate }
}

#[test]
fn intervals_contain_the_parameters_for_95_of_100_seeds() {
    let description = description();
    let quantities: [(&str, f64, Quantity); 12] = [
        ("K", description.gain_dn_per_e, |found| found.gain_dn_per_e),
        ("QE", description.quantum_efficiency, |found| found.quantum_efficiency),
        ("dark noise", 9f64.hypot(3.0), |found| found.dark_noise_e),
        ("dark current", description.dark_current_e_per_s, |found| found.dark_current_e_per_s),
        ("DSNU", DSNU.total(), |found| found.dsnu_e.total),
        ("DSNU pixel", DSNU.pixel, |found| found.dsnu_e.pixel),
        ("DSNU row", DSNU.row, |found| found.dsnu_e.row),
        ("DSNU column", DSNU.column, |found| found.dsnu_e.column),
        ("PRNU", PRNU.total(), |found| found.prnu.total),
        ("PRNU row", PRNU.row, |found| found.prnu.row),
        ("PRNU column", PRNU.column, |found| found.prnu.column),
        ("full well", description.full_well_e, |found| found.full_well_e.unwrap()),
    ];
    let all: Vec<Characterisation> = (0..100).map(|seed| found(description, seed)).collect();
    for (name, truth, of) in quantities {
        let within = all.iter().filter(|found| of(found).contains(truth)).count();
        let within_half = all.iter().filter(|found| half(of(found)).contains(truth)).count();
        let mean = all.iter().map(|found| of(found).value).sum::<f64>() / 100.0;
        println!("{name}: {within} of 100, {within_half} in the half interval, mean {mean} for {truth}");
        assert!(within >= 95, "{name}: {within} of 100 within the interval, mean {mean} for {truth}");
        // Intervals twice as wide as they should be would contain all values.
        assert!(within_half < 95, "{name}: {within_half} of 100 within half of the interval");
    }
}

#[test]
fn a_converter_that_saturates_first_gives_no_full_well() {
    let found = found(Emva1288Description { full_well_e: 90_000.0, ..description() }, 3);
    assert_eq!(found.full_well_e, None);
    let reachable = (4095.0 - 70.0) / 0.27;
    assert!((found.saturation_capacity_e / reachable - 1.0).abs() < 0.06, "{}", found.saturation_capacity_e);
}

#[test]
fn uniform_pixels_are_found_uniform() {
    let sensor = Emva1288::new(&description()).unwrap();
    let series = measure(&EvenLight::new(sensor, PIXELS), &Series { steps: 24, stack: 12 }, 5).unwrap();
    let found = evaluate(&series).unwrap();
    assert!(found.dsnu_e.total.low == 0.0 && found.dsnu_e.total.high < 1.0, "{:?}", found.dsnu_e.total);
    assert!(found.prnu.total.high < 2e-3, "{:?}", found.prnu.total);
}

/// Without an offset half of the dark noise is below 0, and the noise is underestimated.
#[test]
fn a_dark_level_that_clips_the_noise_is_detected() {
    let at = |dark_offset_dn: f64| found(Emva1288Description { dark_offset_dn, ..description() }, 3);
    let cut = at(0.0);
    assert!(cut.is_cut_in_the_dark() && cut.dark_at_zero > 0.2, "{}", cut.dark_at_zero);
    assert!(cut.dark_noise_e.high < 9f64.hypot(3.0), "{:?}", cut.dark_noise_e);
    let whole = at(70.0);
    assert!(!whole.is_cut_in_the_dark() && whole.dark_at_zero < 1e-3, "{}", whole.dark_at_zero);
}
