//! Captures of a white sheet under lamps with sharp cones, compared with a closed form: the overlap
//! of each lamp's disk with the circle that the cone of a point draws in the lamps' plane.
//!
//! On coarse sensors and with narrow cones, the lit spots are a few pixels wide, so an interpolation
//! that does not know where the edges of cones are misses them.

use crate::pictures::{Difference, exposure_file};
use crate::program::{Folder, gripps, radsight};
use radsight_picture::Image;

/// Distance of the sheet, focal distance, radii of pinhole, lamps and ring, metres.
const DISTANCE: f64 = 0.48;
const FOCAL: f64 = 6.75e-3;
const PINHOLE: f64 = 0.05e-3;
const LAMP: f64 = 2.5e-3;
const RING: f64 = 12.7e-3;
const LAMPS: u32 = 12;

/// Side of the sensor of the figures, micrometres.
const SENSOR: f64 = 2640.0;

struct Rig {
    columns: usize,
    rows: usize,
    cone_degrees: f64,
    pinhole_model: &'static str,
}

impl Rig {
    fn pitch(&self) -> [f64; 2] {
        [SENSOR / self.columns as f64, SENSOR / self.rows as f64]
    }

    fn camera(&self) -> String {
        let [x, y] = self.pitch();
        let text = std::fs::read_to_string(gripps("fig08.toml")).expect("a file of the repository");
        text.replace("[192, 165]", &format!("[{}, {}]", self.columns, self.rows))
            .replace("[13.75, 16.0]", &format!("[{x}, {y}]"))
            .replace("led_cone_deg = 7.0", &format!("led_cone_deg = {:?}", self.cone_degrees))
            .replace("\"point\"", &format!("\"{}\"", self.pinhole_model))
    }

    /// The exposure of a pixel in arbitrary units, by the midpoint rule over pixel and pinhole.
    fn exposure(&self, column: usize, row: usize) -> f64 {
        let (steps, rings) = if self.pinhole_model == "point" { (16, 0) } else { (8, 6) };
        let middle = |step: u32, steps: u32| (f64::from(step) + 0.5) / f64::from(steps);
        let mut holes = vec![[0.0; 2]];
        if rings > 0 {
            let point = |ring: u32, turn: u32| {
                let (sin, cos) = (std::f64::consts::TAU * middle(turn, 12)).sin_cos();
                let radius = PINHOLE * middle(ring, rings).sqrt() * (1.0 + DISTANCE / FOCAL);
                [radius * cos, radius * sin]
            };
            holes = (0..rings).flat_map(|ring| (0..12).map(move |turn| point(ring, turn))).collect();
        }
        let [width, height] = self.pitch().map(|pitch| pitch * 1e-6);
        let mut sum = 0.0;
        for (u, v) in (0..steps).flat_map(|u| (0..steps).map(move |v| (u, v))) {
            let x = (column as f64 + middle(u, steps) - 0.5 * self.columns as f64) * width;
            let y = (row as f64 + middle(v, steps) - 0.5 * self.rows as f64) * height;
            let cos_squared = FOCAL * FOCAL / (FOCAL * FOCAL + x * x + y * y);
            let scale = DISTANCE / FOCAL;
            let light = holes.iter().map(|[a, b]| self.radiance(x * scale + a, y * scale + b)).sum::<f64>();
            sum += cos_squared * cos_squared * light / holes.len() as f64;
        }
        sum
    }

    /// The radiance of a point of the sheet in arbitrary units.
    fn radiance(&self, x: f64, y: f64) -> f64 {
        let reach = DISTANCE * (0.5 * self.cone_degrees).to_radians().tan();
        let of_lamp = |lamp: u32| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(lamp) / f64::from(LAMPS)).sin_cos();
            let offset = (x - RING * cos).hypot(y - RING * sin);
            overlap(LAMP, reach, offset) / (DISTANCE * DISTANCE + offset * offset).powi(2)
        };
        (0..LAMPS).map(of_lamp).sum()
    }

    /// The correct picture in arbitrary units.
    fn truth(&self) -> Vec<f64> {
        let pixels = (0..self.rows).flat_map(|row| (0..self.columns).map(move |column| (column, row)));
        pixels.map(|(column, row)| self.exposure(column, row)).collect()
    }
}

fn picture([columns, rows]: [usize; 2], value: impl Fn(usize) -> f64) -> Image<f32> {
    Image::new(columns, rows, 1, (0..columns * rows).map(|pixel| value(pixel) as f32).collect()).expect("a picture")
}

/// The means of blocks of 4 × 4 pixels.
fn blocks(image: &Image<f32>) -> Image<f32> {
    let size = [image.width() / 4, image.height() / 4];
    let pixel = |x: usize, y: usize| f64::from(image.data()[y * image.width() + x]);
    picture(size, |block| {
        let (x, y) = (4 * (block % size[0]), 4 * (block / size[0]));
        (0..4).flat_map(|down| (0..4).map(move |right| (right, down))).map(|(i, j)| pixel(x + i, y + j)).sum::<f64>()
            / 16.0
    })
}

/// The requested error is that of single pixels; blocks are at least as accurate.
fn check(rig: &Rig) {
    const ASKED: f64 = 0.005;
    let folder = Folder::new();
    let correct = rig.truth();
    let (camera, out) = (folder.file("rig.toml", rig.camera()), folder.word("x.pfm"));
    for seed in 1..=4 {
        let sheet = gripps("sheet-lambertian.rad");
        let (asked, seed) = (ASKED.to_string(), seed.to_string());
        radsight(&["capture", &camera, &sheet, "--error", &asked, "--seed", &seed, "--exposure", &out]).done();
        let captured = exposure_file(&folder.path("x.pfm"));
        let scale = captured.data().iter().map(|value| f64::from(*value)).sum::<f64>() / correct.iter().sum::<f64>();
        let truth = picture([rig.columns, rig.rows], |pixel| scale * correct[pixel]);
        let pixels = Difference::new(&captured, &truth);
        let in_blocks = Difference::new(&blocks(&captured), &blocks(&truth));
        println!("{}° seed {seed}: {pixels:?}, in blocks {in_blocks:?}", rig.cone_degrees);
        assert!(pixels.rms < 1.15 * ASKED && in_blocks.rms < ASKED, "seed {seed}: {pixels:?}, in blocks {in_blocks:?}");
    }
}

#[test]
fn a_few_coarse_pixels_across_a_spot() {
    check(&Rig { columns: 48, rows: 41, cone_degrees: 2.0, pinhole_model: "point" });
}

#[test]
fn spots_narrower_than_the_lamps() {
    check(&Rig { columns: 100, rows: 85, cone_degrees: 0.5, pinhole_model: "point" });
}

#[test]
fn wide_spots_on_a_coarse_sensor() {
    check(&Rig { columns: 48, rows: 41, cone_degrees: 5.0, pinhole_model: "point" });
}

#[test]
fn spots_blurred_by_the_pinhole() {
    check(&Rig { columns: 48, rows: 41, cone_degrees: 2.0, pinhole_model: "finite" });
}

/// Area of the overlap of two disks.
fn overlap(a: f64, b: f64, distance: f64) -> f64 {
    if distance >= a + b {
        return 0.0;
    }
    if distance <= (a - b).abs() {
        return std::f64::consts::PI * a.min(b).powi(2);
    }
    let segment = |radius: f64, other: f64| {
        let to_chord = (distance * distance + radius * radius - other * other) / (2.0 * distance);
        radius * radius * (to_chord / radius).clamp(-1.0, 1.0).acos()
            - to_chord * (radius * radius - to_chord * to_chord).max(0.0).sqrt()
    };
    segment(a, b) + segment(b, a)
}
