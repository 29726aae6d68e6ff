//! Compares the views of the shift method, as real Radiance's `vwrays` reads them, with the
//! camera's own rays.

use radsight_pinhole::shift::ShiftPattern;
use radsight_pinhole::{CameraDescription, PinholeCamera, PinholeModel, Rays, View};
use radsight_test_support::Radiance;

fn camera() -> PinholeCamera {
    PinholeCamera::new(&CameraDescription {
        position_m: [0.1, -0.2, 0.48],
        direction: [0.3, -0.4, -0.7],
        up: [0.1, 1.0, 0.3],
        pixels: [48, 33],
        pixel_pitch_m: [55e-6, 80e-6],
        focal_distance_m: 6.75e-3,
        pinhole_diameter_m: 0.3e-3,
        pinhole_model: PinholeModel::Finite,
        exposure_s: 0.01,
        wavelength_m: None,
        scene_unit_m: 0.0254,
    })
    .unwrap()
}

/// Origin and direction of each pixel's centre, from the top left.
fn rays_of_view(radiance: &Radiance, view: &View) -> Vec<[f64; 6]> {
    let [columns, rows] = view.pixels.map(|count| count.to_string());
    let output = radiance
        .command("vwrays", &["-fd", "-pa", "0", "-x", &columns, "-y", &rows])
        .args(view.to_string().split(' '))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let numbers: Vec<f64> =
        output.stdout.chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().unwrap())).collect();
    numbers.chunks_exact(6).map(|ray| ray.try_into().unwrap()).collect()
}

fn largest_difference(a: [f64; 6], b: [f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_cameras_view_has_the_rays_of_its_pixels_middles() {
    let Some(radiance) = Radiance::find() else { return };
    let camera = camera().with_pinhole_model(PinholeModel::Point);
    let rays = Rays::new(&camera, 1, 0);
    let of_view = rays_of_view(&radiance, &View::through_pinhole(&camera, [0.0, 0.0], [0, 0]));
    assert_eq!(of_view.len(), 48 * 33);
    for (pixel, of_view) in (0..).zip(of_view) {
        let ray = rays.ray(pixel, [0.5; 4]);
        let [o, d] = [ray.origin.to_array(), ray.direction.to_array()];
        let difference = largest_difference(of_view, [o[0], o[1], o[2], d[0], d[1], d[2]]);
        assert!(difference < 1e-9, "pixel {pixel}: {difference}");
    }
}

#[test]
fn a_shifted_picture_shows_what_the_sensor_pixel_sees_through_that_point_of_the_hole() {
    let Some(radiance) = Radiance::find() else { return };
    let camera = camera();
    let pattern = ShiftPattern::new(&camera, 2).unwrap();
    assert!(pattern.samples().len() >= 9, "{} points", pattern.samples().len());
    let (margin, focal) = (pattern.margin().map(i64::from), camera.focal_distance_m());
    for sample in pattern.samples() {
        let view = pattern.view(&camera, sample);
        let of_view = rays_of_view(&radiance, &view);
        let hole = camera.position_m() + camera.right() * sample.offset_m[0] + camera.up() * sample.offset_m[1];
        for row in 0..33i64 {
            for column in 0..48i64 {
                let [x, y] = [(column as f64 - 23.5) * 55e-6, (16.0 - row as f64) * 80e-6];
                let sensor_point =
                    camera.position_m() - camera.direction() * focal - camera.right() * x - camera.up() * y;
                let d = (hole - sensor_point).normalize();
                let o = hole / camera.scene_unit_m();
                let shifted_column = column + margin[0] + i64::from(sample.offset_pixels[0]);
                let shifted_row = row + margin[1] - i64::from(sample.offset_pixels[1]);
                let found = of_view[(shifted_row * i64::from(view.pixels[0]) + shifted_column) as usize];
                let difference = largest_difference(found, [o.x, o.y, o.z, d.x, d.y, d.z]);
                assert!(difference < 1e-9, "{:?}, pixel {column} {row}: {difference}", sample.offset_pixels);
            }
        }
    }
}
