//! Tests mksource on environments with known light, and against the real program.

mod oracle;

use std::process::{Command, Stdio};

use oracle::{Radiance, words};
use radsight_scene_generators::{EnvironmentRadiance, Error, mksource};

/// Two round lights on a dim background: direction, radius in degrees, radiance.
const LIGHTS: [([f64; 3], f64, [f64; 3]); 2] =
    [([0.48, 0.6, 0.64], 3.0, [900.0, 1000.0, 1100.0]), ([-0.8, 0.0, 0.6], 5.0, [300.0, 200.0, 100.0])];

fn environment(direction: [f64; 3]) -> [f64; 3] {
    for (centre, degrees, radiance) in LIGHTS {
        let cosine: f64 = (0..3).map(|axis| centre[axis] * direction[axis]).sum();
        if cosine >= degrees.to_radians().cos() {
            return radiance;
        }
    }
    [0.5; 3]
}

/// Direction, angular diameter in degrees, and radiance of each source.
fn sources(text: &str) -> Vec<([f64; 3], f64, [f64; 3])> {
    let numbers: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| line.starts_with("3 ") || line.starts_with("4 "))
        .map(|line| line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect())
        .collect();
    numbers
        .chunks(2)
        .map(|pair| ([pair[1][0], pair[1][1], pair[1][2]], pair[1][3], [pair[0][0], pair[0][1], pair[0][2]]))
        .collect()
}

fn open(_: Option<&str>) -> Result<Box<EnvironmentRadiance<'static>>, Error> {
    Ok(Box::new(environment))
}

/// Light of a source or a disk: radiance times solid angle, in the green band.
fn light(degrees_across: f64, radiance: [f64; 3]) -> f64 {
    2.0 * std::f64::consts::PI * (1.0 - (degrees_across / 2.0).to_radians().cos()) * radiance[1]
}

/// `tolerance` is relative to the light of a source.
fn expect_lights(found: &[([f64; 3], f64, [f64; 3])], tolerance: f64) {
    assert_eq!(found.len(), 2, "{found:?}");
    for ((centre, degrees, radiance), (direction, across, source)) in LIGHTS.iter().zip(found) {
        let cosine: f64 = (0..3).map(|axis| centre[axis] * direction[axis]).sum();
        assert!(cosine > 0.5f64.to_radians().cos(), "{direction:?}");
        let (true_light, found_light) = (light(2.0 * degrees, *radiance), light(*across, *source));
        assert!((found_light / true_light - 1.0).abs() < tolerance, "{found_light} {true_light}");
    }
}

#[test]
fn lights_are_found_with_their_whole_light() {
    let output = mksource(&words("mksource -t 50 sky.oct"), &open).unwrap();
    expect_lights(&sources(&String::from_utf8(output.standard_output).unwrap()), 0.03);
}

#[test]
fn the_real_program_finds_the_same_lights() {
    let Some(radiance) = Radiance::find() else { return };
    // One glow over the sphere, since the real program does not see sources that light the scene.
    let mut functions = String::new();
    for (band, name) in ["red", "green", "blue"].iter().enumerate() {
        let mut value = "0.5".to_owned();
        for ([x, y, z], degrees, radiance) in LIGHTS {
            let cosine = degrees.to_radians().cos();
            value = format!("if(({x})*Dx+({y})*Dy+({z})*Dz-{cosine:.12},{},{value})", radiance[band]);
        }
        functions += &format!("{name}={value};\n");
    }
    std::fs::write(std::env::temp_dir().join("radsight-generate-lights.cal"), functions).unwrap();
    let scene = "void colorfunc lights\n4 red green blue radsight-generate-lights.cal\n0\n0\n\
                 lights glow sky\n0\n0\n4 1 1 1 0\nsky source all\n0\n0\n4 0 0 1 360\n";
    let octree = std::env::temp_dir().join("radsight-generate-mksource.oct");
    let file = std::fs::File::create(&octree).unwrap();
    let oconv = radiance.library().map_or("oconv".into(), |library| library.with_file_name("bin").join("oconv"));
    let scene_file = std::env::temp_dir().join("radsight-generate-mksource.rad");
    std::fs::write(&scene_file, scene).unwrap();
    let made = Command::new(oconv).arg(&scene_file).stdout(file).stderr(Stdio::null()).status();
    assert!(made.is_ok_and(|status| status.success()));
    let argv = words(&format!("mksource -t 50 {}", octree.display()));
    let real = radiance.run(&argv, b"", Some(&std::env::temp_dir()));
    if real.standard_output.is_empty() {
        println!("skipped: this Radiance has no working mksource: {}", real.standard_error);
        return;
    }
    // Its samples are random.
    expect_lights(&sources(&real.standard_output), 0.06);
}

#[test]
fn a_dark_surrounding_has_no_sources() {
    let dark = |_: Option<&str>| -> Result<Box<EnvironmentRadiance<'static>>, Error> { Ok(Box::new(|_| [0.0; 3])) };
    let output = mksource(&words("mksource -d 1000"), &dark).unwrap();
    assert_eq!(String::from_utf8(output.standard_output).unwrap(), "# mksource -d 1000\n");
    let message = mksource(&words("mksource -d 2"), &dark).unwrap_err().to_string();
    assert!(message.starts_with("mksource: samples (-d) is 2, expected at least 4"));
}
