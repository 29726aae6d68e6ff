//! The white furnace: in a uniform environment a white surface is no brighter than the environment,
//! from any angle down to grazing, and equally bright if its type conserves energy. (`trans2` is
//! not seen along its narrow axis, where Radiance's formula gains energy.)

use crate::program::{Folder, command, run_with};

/// A white material called `m`, and the smallest albedo that it must have at these angles.
struct White {
    text: &'static str,
    least: f64,
}

const fn white(text: &'static str, least: f64) -> White {
    White { text, least }
}

/// The smallest albedos follow from the types' formulas: a broad highlight loses the part below the
/// surface.
const MATERIALS: &[White] = &[
    white("plastic m 0 0 5 1 1 1 0 0", 0.999),
    white("plastic m 0 0 5 1 1 1 .05 0", 0.999),
    white("plastic m 0 0 5 1 1 1 .1 .1", 0.97),
    white("metal m 0 0 5 1 1 1 1 0", 0.999),
    white("metal m 0 0 5 1 1 1 .9 .2", 0.81),
    white("trans m 0 0 7 1 1 1 0 0 .5 .5", 0.999),
    white("trans m 0 0 7 1 1 1 .05 0 1 1", 0.999),
    white("plastic2 m 4 1 0 0 . 0 6 1 1 1 .1 .05 .3", 0.965),
    white("metal2 m 4 1 0 0 . 0 6 1 1 1 .9 .2 .1", 0.81),
    white("ashik2 m 4 1 0 0 . 0 8 1 1 1 0 0 0 30 200", 0.999),
    white("ashik2 m 4 1 0 0 . 0 8 0 0 0 1 1 1 300 200", 0.54),
    white("trans m 0 0 7 1 1 1 .05 .1 .5 .5", 0.96),
    white("trans m 0 0 7 1 1 1 .05 .3 1 1", 0.85),
    white("trans2 m 4 1 0 0 . 0 8 1 1 1 0 .3 .15 1 1", 0.58),
    white("mirror m 0 0 3 1 1 1", 0.999),
    white("glass m 0 0 3 1 1 1", 0.999),
    white("BRTDfunc m 10 .2 .2 .2 .3 .3 .3 0 0 0 . 0 9 .5 .5 .5 .5 .5 .5 0 0 0", 0.999),
    white("WGMDfunc m 13 void .2 0 0 void .3 0 .1 void 1 .2 0 . 0 9 .5 .5 .5 .5 .5 .5 0 0 0", 0.999),
    white("plasfunc m 2 even even.cal 0 4 1 1 1 .5", 0.999),
    white("metfunc m 2 even even.cal 0 4 1 1 1 1", 0.999),
    white("transfunc m 2 even even.cal 0 6 1 1 1 0 .5 .5", 0.999),
];

/// Angles of the view to the surface, degrees.
const ELEVATIONS: [f64; 6] = [90.0, 60.0, 30.0, 12.0, 5.0, 2.0];

const SURROUNDINGS: &str = "m polygon sheet 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\nvoid glow white 0 0 4 1 1 1 0\n\
                            white source all 0 0 4 0 0 1 360\n";

const RAYS: usize = 2048;

#[test]
fn white_materials_send_on_no_more_than_they_get() {
    let mut wrong = String::new();
    for White { text, least } in MATERIALS {
        let folder = Folder::new();
        folder.file("even.cal", "even(x,y,z,w) = 1/PI;\n");
        folder.file("scene.rad", format!("void {text}\n{SURROUNDINGS}"));
        let view_ray = |elevation: &f64| {
            let (high, wide) = elevation.to_radians().sin_cos();
            format!("{} 0 {high} {} 0 {}\n", -wide, wide, -high).repeat(RAYS)
        };
        let input: String = ELEVATIONS.iter().map(view_ray).collect();
        let words =
            ["rtrace", "-h", "-ab", "1", "-aa", "0", "-ad", "1", "-as", "0", "-st", "0", "-lw", "1e-6", "scene.rad"];
        let found = run_with(command(&words).current_dir(folder.path("")), input.as_bytes()).text();
        let values: Vec<f64> = found
            .lines()
            .map(|line| line.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a number"))
            .collect();
        assert_eq!(values.len(), RAYS * ELEVATIONS.len(), "{text}: a value for each ray");
        let means: Vec<f64> = values.chunks(RAYS).map(|rays| rays.iter().sum::<f64>() / RAYS as f64).collect();
        println!("{text}: {means:.3?}");
        if means.iter().any(|mean| !(*least..1.005).contains(mean)) {
            wrong += &format!("\n{text}: {means:.3?} at {ELEVATIONS:?}°");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
