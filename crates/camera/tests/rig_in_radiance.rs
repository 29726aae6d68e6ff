//! The light ring, loaded and traced by real Radiance, against the formulas that it stands for.

use glam::DVec3;
use radsight_camera::{CameraFile, LedEmission, Rig};
use radsight_diag::SourceMap;
use radsight_loader::MemoryLoader;
use radsight_test_support::Radiance;
use std::fmt::Write as _;

/// The first band of what `rtrace` answers for rays of origin and direction.
fn trace(radiance: &Radiance, scene: &str, options: &[&str], rays: &[(DVec3, DVec3)]) -> Vec<f64> {
    let folder = tempfile::tempdir().unwrap();
    let octree = folder.path().join("scene.oct");
    std::fs::write(&octree, radiance.run(folder.path(), "oconv", &["-"], scene.as_bytes())).unwrap();
    let mut input = String::new();
    for (o, d) in rays {
        writeln!(input, "{} {} {} {} {} {}", o.x, o.y, o.z, d.x, d.y, d.z).unwrap();
    }
    let arguments = [&["-h", "-w", "-ab", "0"], options, &[octree.to_str().unwrap()]].concat();
    let answer = String::from_utf8(radiance.run(folder.path(), "rtrace", &arguments, input.as_bytes())).unwrap();
    answer.lines().map(|line| line.split_whitespace().next().unwrap().parse().unwrap()).collect()
}

const HLMP_8104: &str = "angle_deg,relative_intensity\n0,1.0\n1,0.96\n2,0.84\n3,0.62\n3.5,0.5\n4,0.39\n5,0.22\n6,0.13\n7,0.08\n\
                         8,0.055\n10,0.03\n12,0.018\n15,0.010\n20,0.005\n30,0.001\n90,0\n";

/// Frames of cameras: straight down, along an axis, and tilted, in other scene units.
const CAMERAS: [(&str, &str, &str); 4] = [
    ("[0, 0, -1]", "[0, 1, 0]", "1"),
    ("[0, 1, 0]", "[0, 0, 1]", "1"),
    ("[0, 0, 1]", "[1, 0, 0]", "0.001"),
    ("[0.3, -0.5, -0.8]", "[0.1, 0.9, 0.2]", "0.0254"),
];

fn rig(camera: (&str, &str, &str), emission: &str, table: &str) -> Rig {
    let (direction, up, unit) = camera;
    let text = format!(
        "[camera]\nposition_m = [0.1, -0.2, 0.48]\ndirection = {direction}\nup = {up}\npixels = [192, 165]\n\
         pixel_pitch_um = [13.75, 16.0]\nfocal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\nexposure_ms = 10\n\
         scene_unit_m = {unit}\n[rig]\nleds = 12\nring_diameter_mm = 25.4\nled_diameter_mm = 5.0\n\
         led_intensity_w_per_sr = 0.055\n{emission}\n"
    );
    let mut sources = SourceMap::default();
    let loader = MemoryLoader::default().with("led.csv", table);
    CameraFile::read("camera.toml", text.as_bytes(), &mut sources, &loader).unwrap().rig.unwrap()
}

/// Rays that hit LED 2 of the rig at its centre from many angles, in scene units, with the angle in
/// radians from its axis.
fn rays_at_led(rig: &Rig, angles_deg: &[f64]) -> Vec<(f64, DVec3, DVec3)> {
    let camera = &rig.camera;
    let unit = camera.scene_unit_m();
    let centre = rig.led_centre_m(2);
    let ray = |(turn, angle): (usize, &f64)| {
        let (sin, cos) = angle.to_radians().sin_cos();
        let (up, right) = (2.4 * turn as f64).sin_cos();
        let from_led = camera.direction() * cos + (camera.right() * right + camera.up() * up) * sin;
        (angle.to_radians(), (centre + from_led * 0.3) / unit, -from_led)
    };
    angles_deg.iter().enumerate().map(ray).collect()
}

#[test]
fn a_table_gives_the_stated_radiance_at_every_angle() {
    let Some(radiance) = Radiance::find() else { return };
    let mut long = String::from("angle_deg,relative_intensity\n");
    for step in 0..=450 {
        let angle = f64::from(step) * 0.2;
        writeln!(long, "{angle},{}", (-angle * 0.1).exp() * (90.0 - angle) / 90.0).unwrap();
    }
    let mut angles: Vec<f64> = vec![0.0, 1e-7, 1e-5, 1e-3, 0.5, 0.999999, 1.0, 1.000001];
    angles.extend((0..880).map(|step| 0.1 + f64::from(step) * 0.1013));
    for table in [HLMP_8104, &long] {
        for camera in CAMERAS {
            let rig = rig(camera, "led_table = \"led.csv\"", table);
            let LedEmission::Table(lobe) = &rig.emission else { panic!("a table was asked for") };
            let rays = rays_at_led(&rig, &angles);
            let traced = trace(
                &radiance,
                &rig.scene_text(),
                &[],
                &rays.iter().map(|&(_, origin, direction)| (origin, direction)).collect::<Vec<_>>(),
            );
            assert_eq!(traced.len(), rays.len());
            for (&(angle, ..), traced) in rays.iter().zip(&traced) {
                let expected = rig.axial_radiance() * lobe.intensity(angle) / angle.cos();
                // rtrace holds radiance in single precision.
                assert!(
                    (traced - expected).abs() <= 3e-7 * rig.axial_radiance() * lobe.intensity(angle) + 1e-6 * expected,
                    "{camera:?}, {} degrees: {traced} against {expected}",
                    angle.to_degrees()
                );
            }
        }
    }
}

#[test]
fn a_cone_has_uniform_radiance_inside_and_none_outside() {
    let Some(radiance) = Radiance::find() else { return };
    for camera in CAMERAS {
        let rig = rig(camera, "led_cone_deg = 7.0", "");
        let rays = rays_at_led(&rig, &[0.0, 1.0, 3.0, 3.4999, 3.5001, 4.0, 20.0, 80.0]);
        let rays: Vec<_> = rays.into_iter().map(|(_, origin, direction)| (origin, direction)).collect();
        let traced = trace(&radiance, &rig.scene_text(), &[], &rays);
        for (index, traced) in traced.iter().enumerate() {
            let expected = if index < 4 { rig.axial_radiance() } else { 0.0 };
            assert!((traced - expected).abs() <= 1e-6 * rig.axial_radiance(), "{camera:?}, ray {index}: {traced}");
        }
    }
}

/// Irradiance of a plane that faces the camera at `point` (metres), by summing over each disk.
fn irradiance(rig: &Rig, point: DVec3) -> f64 {
    let camera = &rig.camera;
    let axis = camera.direction();
    let (rings, turns) = (60, 90);
    let mut sum = 0.0;
    for led in 0..rig.leds {
        for index in 0..rings * turns {
            let radius = 0.5 * rig.led_diameter_m * ((f64::from(index / turns) + 0.5) / f64::from(rings)).sqrt();
            let (sin, cos) = (std::f64::consts::TAU * f64::from(index % turns) / f64::from(turns)).sin_cos();
            let emitter = rig.led_centre_m(led) + (camera.right() * cos + camera.up() * sin) * radius;
            let way = point - emitter;
            let cosine = way.dot(axis) / way.length();
            let angle = way.cross(axis).length().atan2(way.dot(axis));
            let relative = match &rig.emission {
                LedEmission::Cone { full_angle_deg } => f64::from(u8::from(2.0 * angle.to_degrees() < *full_angle_deg)),
                LedEmission::Table(table) => table.intensity(angle) / cosine,
                _ => panic!("an emission that this test does not know"),
            };
            sum += relative * cosine * cosine / way.length_squared();
        }
    }
    sum * rig.led_intensity_w_per_sr / f64::from(rings * turns)
}

#[test]
fn the_ring_gives_the_stated_irradiance_on_a_facing_plane() {
    let Some(radiance) = Radiance::find() else { return };
    for emission in ["led_cone_deg = 20.0", "led_table = \"led.csv\""] {
        for camera in CAMERAS {
            let rig = rig(camera, emission, HLMP_8104);
            let frame = &rig.camera;
            let points: Vec<DVec3> = [(0.0, 0.0), (0.01, 0.004), (-0.02, 0.01), (0.0, -0.015)]
                .map(|(x, y)| frame.position_m() + frame.direction() * 0.48 + frame.right() * x + frame.up() * y)
                .to_vec();
            let rays: Vec<_> = points.iter().map(|&p| (p / frame.scene_unit_m(), -frame.direction())).collect();
            let options = ["-I", "-ds", "0.0005", "-dj", "0", "-dt", "0", "-dc", "1"];
            let traced = trace(&radiance, &rig.scene_text(), &options, &rays);
            for (&point, traced) in points.iter().zip(traced) {
                let expected = irradiance(&rig, point);
                assert!(
                    (traced / expected - 1.0).abs() < 2e-3,
                    "{emission}, {camera:?}, {point}: {traced} against {expected}"
                );
            }
        }
    }
}
