//! Camera, ring and average together on the paper's plain sheet, against the truth pictures: the
//! sheet's radiance is computed here from the ring's definition, without a renderer.

use glam::DVec3;
use radsight_camera::{CameraFile, LedEmission, Rig};
use radsight_diag::SourceMap;
use radsight_loader::MemoryLoader;
use radsight_pinhole::{PixelAverage, Rays};
use radsight_sampling::{DimensionSet, unit_disk};
use std::f64::consts::PI;
use std::path::Path;

const SAMPLES: u32 = 64;

/// The reflected radiance per radiance and projected solid angle, as a function of the cosine at
/// the sheet and of δ, the angle between incident and viewing direction.
type Reflectance = fn(cosine: f64, observation_angle: f64) -> f64;

/// A white Lambertian sheet.
fn lambertian(_: f64, _: f64) -> f64 {
    1.0 / PI
}

/// Eq. 6 of the paper with its numbers for the sheeting.
fn paper_1991(cosine: f64, observation_angle: f64) -> f64 {
    let (rho, alpha) = (0.086f64, 0.00612f64);
    rho * (-(observation_angle / (2.0 * alpha)).powi(2)).exp() / (4.0 * PI * alpha * alpha * cosine)
}

fn truth(name: &str) -> Vec<f64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/gripps/truth").join(format!("{name}.pfm"));
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let header = b"Pf\n192 165\n-1.0\n";
    assert_eq!(&bytes[..header.len()], header);
    let values: Vec<f64> =
        bytes[header.len()..].chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect();
    // The file has the bottom row first.
    values.chunks(192).rev().flatten().copied().collect()
}

fn camera_file(model: &str, emission: &str) -> CameraFile {
    let text = format!(
        "[camera]\nposition_m = [0.0, 0.0, 0.48]\ndirection = [0.0, 0.0, -1.0]\nup = [0.0, 1.0, 0.0]\n\
         pixels = [192, 165]\npixel_pitch_um = [13.75, 16.0]\nfocal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\n\
         pinhole_model = \"{model}\"\nexposure_ms = 10.0\n[rig]\nleds = 12\nring_diameter_mm = 25.4\n\
         led_diameter_mm = 5.0\nled_intensity_w_per_sr = 0.055\n{emission}\n"
    );
    let table = "angle_deg,relative_intensity\n0,1.0\n1,0.96\n2,0.84\n3,0.62\n3.5,0.5\n4,0.39\n5,0.22\n6,0.13\n7,0.08\n\
                 8,0.055\n10,0.03\n12,0.018\n15,0.010\n20,0.005\n30,0.001\n90,0\n";
    let loader = MemoryLoader::default().with("hlmp-8104.csv", table);
    CameraFile::read("camera.toml", text.as_bytes(), &mut SourceMap::default(), &loader).unwrap()
}

/// Radiance from the sheet z = 0 along one ray, each LED by one point of its disk.
fn sheet_radiance(rig: &Rig, reflectance: Reflectance, origin: DVec3, direction: DVec3, on_disk: (f64, f64)) -> f64 {
    let hit = origin + direction * (origin.z / -direction.z);
    let offset = DVec3::new(on_disk.0, on_disk.1, 0.0) * 0.5 * rig.led_diameter_m;
    let area = PI / 4.0 * rig.led_diameter_m * rig.led_diameter_m;
    let of_led = |led: u32| {
        let way = rig.led_centre_m(led) + offset - hit;
        let incident = way.normalize();
        let cosine = incident.z;
        let angle = 2.0 * (0.5 * (incident - DVec3::Z).length()).asin();
        let emitted = match &rig.emission {
            LedEmission::Cone { full_angle_deg } => f64::from(u8::from(2.0 * angle.to_degrees() <= *full_angle_deg)),
            LedEmission::Table(table) => table.intensity(angle) / cosine,
            _ => panic!("an emission that this test does not know"),
        };
        let observation_angle = 2.0 * (0.5 * (incident + direction).length()).asin();
        emitted * reflectance(cosine, observation_angle) * cosine * cosine / way.length_squared()
    };
    (0..rig.leds).map(of_led).sum::<f64>() * rig.axial_radiance() * area
}

/// Asserts bounds on rms(E − T)/mean(T), and on the error of the mean, which has far less noise.
fn compare(name: &str, model: &str, emission: &str, reflectance: Reflectance, largest_error: f64) {
    let file = camera_file(model, emission);
    let rig = file.rig.as_ref().unwrap();
    let rays = Rays::new(&file.camera, SAMPLES, 1);
    let truth = truth(name);
    let (mut squares, mut sum) = (0.0, 0.0);
    for (pixel, truth) in (0..).zip(&truth) {
        let mut average = PixelAverage::default();
        for sample in 0..SAMPLES {
            let ray = rays.of_sample(pixel, sample);
            let u = rays.sampler(pixel, sample).take(DimensionSet::render(0));
            average.add(ray.cos4, sheet_radiance(rig, reflectance, ray.origin, ray.direction, unit_disk(u[0], u[1])));
        }
        let exposure = average.exposure(&file.camera);
        squares += (exposure - truth).powi(2);
        sum += exposure;
    }
    let mean = truth.iter().sum::<f64>() / truth.len() as f64;
    let error = (squares / truth.len() as f64).sqrt() / mean;
    let of_mean = sum / truth.len() as f64 / mean - 1.0;
    println!("{name}: rms error {error:.5} of the mean, mean off by {of_mean:.6}");
    assert!(error < largest_error, "{name}: rms error {error} of the mean");
    assert!(of_mean.abs() < 5e-4, "{name}: the mean is off by {of_mean}");
}

#[test]
fn figure_8_lambertian_sheet_point_pinhole_cone() {
    compare("t8", "point", "led_cone_deg = 7.0", lambertian, 0.02);
}

#[test]
fn figure_9_retroreflector_point_pinhole_cone() {
    compare("t9", "point", "led_cone_deg = 7.0", paper_1991, 0.03);
}

#[test]
fn figure_10_retroreflector_finite_pinhole_cone() {
    compare("t10", "finite", "led_cone_deg = 7.0", paper_1991, 0.045);
}

#[test]
fn figure_11_retroreflector_finite_pinhole_table() {
    compare("t11", "finite", "led_table = \"hlmp-8104.csv\"", paper_1991, 0.01);
}
