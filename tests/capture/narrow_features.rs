//! Captures in small pictures of bright features that few rays of the first ones meet: the spot of a narrow
//! lamp, and highlights on a glossy sphere. They are compared with plain sampling by other random numbers.

use crate::pictures::{Difference, exposure_file};
use crate::program::{Folder, gripps, radsight, root};
use radsight_picture::Image;

/// A lamp with half of its light within about 1.8 degrees.
const NARROW_LAMP: &str =
    "angle_deg,relative_intensity\n0,1\n1,.8\n2,.4\n3,.12\n4,.03\n6,.008\n10,.002\n30,.0005\n90,0\n";

/// Side of the sensor of the figures, micrometres.
const SENSOR: f64 = 2640.0;

/// The camera of Figure 14 with one narrow lamp, fewer pixels and another pinhole.
fn narrow_rig(folder: &Folder, [columns, rows]: [u32; 2], pinhole_mm: f64) -> String {
    let table = folder.file("narrow.csv", NARROW_LAMP);
    let pitch = [columns, rows].map(|count| SENSOR / f64::from(count));
    let text = format!(
        "[camera]\nposition_m = [0.0, 0.0, 0.48]\ndirection = [0.0, 0.0, -1.0]\nup = [0.0, 1.0, 0.0]\n\
         pixels = [{columns}, {rows}]\npixel_pitch_um = {pitch:?}\nfocal_distance_mm = 6.75\n\
         pinhole_diameter_mm = {pinhole_mm:?}\npinhole_model = \"finite\"\nexposure_ms = 10.0\n\
         wavelength_nm = 650.0\n[rig]\nleds = 1\nring_diameter_mm = 20.0\nled_diameter_mm = 5.0\n\
         led_intensity_w_per_sr = 0.055\nled_table = {table:?}\n"
    );
    folder.file("rig.toml", text)
}

fn captured(folder: &Folder, [camera, scene]: [&str; 2], effort: [&str; 2], seed: u32) -> Image<f32> {
    let (out, seed) = (folder.word("x.pfm"), seed.to_string());
    radsight(&["capture", camera, scene, effort[0], effort[1], "--seed", &seed, "--exposure", &out]).done();
    exposure_file(&folder.path("x.pfm"))
}

/// The rms error of captures by some seeds, each at most twice the requested error: half of it is the truth's.
fn check_spot(size: [u32; 2], pinhole_mm: f64, asked: &str, seeds: &[u32]) {
    let folder = Folder::new();
    let (camera, sheet) = (narrow_rig(&folder, size, pinhole_mm), gripps("sheet-retro.rad"));
    let truth = captured(&folder, [&camera, &sheet], ["--samples", "256"], 99);
    let most = 2.0 * asked.parse::<f64>().expect("a number");
    for seed in seeds {
        let difference = Difference::new(&captured(&folder, [&camera, &sheet], ["--error", asked], *seed), &truth);
        println!("{size:?}, {pinhole_mm} mm, seed {seed}: {difference:?}");
        assert!(difference.rms < most, "{size:?}, {pinhole_mm} mm, seed {seed}: {difference:?}");
    }
}

/// The lattice ended after its first pass, where nodes beside the border count more than their areas.
#[test]
fn a_narrow_spot_is_not_left_unfinished() {
    check_spot([40, 32], 0.3, "0.02", &[7, 11]);
    check_spot([40, 32], 0.2, "0.02", &[6, 7]);
}

/// A point beyond a cell has weight in its interpolation, and shows what the cell's own points do not.
#[test]
fn a_narrow_spot_is_not_interpolated_to_the_border() {
    check_spot([64, 50], 0.3, "0.02", &[1, 3, 4, 8]);
}

/// Twelve highlights fill a sixteenth of a pixel.
#[test]
fn highlights_on_a_glossy_sphere_are_found() {
    let folder = Folder::new();
    let sheet = std::fs::read_to_string(gripps("sheet-retro.rad")).expect("a file of the repository");
    let dome = "\nvoid plastic glossy 0 0 5 .2 .2 .2 .05 .02\nglossy sphere dome 0 0 4 .03 .012 0 .012\n";
    let scene = folder.file("dome.rad", sheet + dome);
    let camera = root().join("tests/gripps/part.toml").to_string_lossy().into_owned();
    let highlight = |picture: &Image<f32>| {
        let pixels = || picture.data().iter().map(|value| f64::from(*value));
        let mean = pixels().sum::<f64>() / pixels().count() as f64;
        let near = (8..12).flat_map(|row| (10..14).map(move |column| row * picture.width() + column));
        near.map(|pixel| f64::from(picture.data()[pixel])).sum::<f64>() / (16.0 * mean)
    };
    // By 4 × 512 samples: 0.0609, with a standard error of 0.0007. Without highlights it is 0.036.
    for seed in 0..4 {
        let found = highlight(&captured(&folder, [&camera, &scene], ["--error", "0.005"], seed));
        println!("seed {seed}: {found}");
        assert!((found - 0.0609).abs() < 0.008, "seed {seed}: {found}");
    }
}

/// A sheet that is painted half dark, up to a line through the middles of pixels.
const PAINTED: &str = "void brightfunc half 2 if(Py,.1,1) . 0 0\nhalf plastic white 0 0 5 .8 .8 .8 0 0\n\
                       white polygon sheet 0 0 12 -.3 -.3 0 .3 -.3 0 .3 .3 0 -.3 .3 0\n";

/// On the two sides of the line a ray through each point of the pinhole met one or the other, and the difference
/// was taken for the slope of pixels that see no line.
#[test]
fn a_line_through_the_middle_of_pixels_is_no_slope() {
    let folder = Folder::new();
    let sheet = folder.file("sheet.rad", PAINTED);
    let camera = folder.file(
        "camera.toml",
        "[camera]\nposition_m = [0.0, 0.0, 0.48]\ndirection = [0.0, 0.0, -1.0]\nup = [0.0, 1.0, 0.0]\n\
         pixels = [48, 41]\npixel_pitch_um = [40.0, 40.0]\nfocal_distance_mm = 6.75\n\
         pinhole_diameter_mm = 0.15\npinhole_model = \"finite\"\nexposure_ms = 10.0\nwavelength_nm = 650.0\n\
         [rig]\nleds = 1\nring_diameter_mm = 40.0\nled_diameter_mm = 5.0\nled_intensity_w_per_sr = 0.055\n\
         led_cone_deg = 50.0\n",
    );
    let truth = captured(&folder, [&camera, &sheet], ["--samples", "256"], 99);
    for seed in [0, 1, 7] {
        let difference = Difference::new(&captured(&folder, [&camera, &sheet], ["--error", "0.02"], seed), &truth);
        println!("seed {seed}: {difference:?}");
        // The truth has half of it.
        assert!(difference.rms < 0.008, "seed {seed}: {difference:?}");
    }
}
