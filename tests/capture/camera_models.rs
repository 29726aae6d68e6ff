//! Camera models beyond the pinhole, and sensors, through the program.

use crate::pictures::{exposure_file, greys};
use crate::program::{Folder, Run, command, radsight_with, run_with};

const CAMERA: &str = "[camera]\nposition_m = [0.0, 0.0, 0.48]\ndirection = [0.0, 0.0, -1.0]\nup = [0.0, 1.0, 0.0]\npixels = [24, 20]\n\
    pixel_pitch_um = [100, 110]\nexposure_ms = 10.0\nwavelength_nm = 650.0\n";
const HOLE: &str = "focal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\n";
const LINEAR: &str = "[sensor]\nresponse = \"emva1288\"\nquantum_efficiency = 0.6\ngain_dn_per_e = 0.2\nfull_well_e = 15000\n\
    read_noise_e = 8\ndark_offset_dn = 50\nbits = 12\n";
/// A lamp over a floor of two colours, with their edge in the picture.
const SCENE: &str = "void plastic red 0 0 5 .6 .2 .1 0 0\nvoid plastic blue 0 0 5 .05 .2 .7 0 0\nvoid light lamp 0 0 3 900 900 900\n\
    red polygon left 0 0 12 -1 -1 0 .013 -1 0 .013 1 0 -1 1 0\nblue polygon right 0 0 12 .013 -1 0 1 -1 0 1 1 0 .013 1 0\n\
    lamp sphere bulb 0 0 4 .3 .2 .9 .02\n";

fn folder(files: &[(&str, String)]) -> Folder {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    files.iter().for_each(|(name, text)| drop(folder.file(name, text)));
    folder
}

fn run(folder: &Folder, words: &[&str], input: &[u8]) -> Run {
    run_with(command(words).current_dir(folder.path("")), input)
}

/// The chain of programs gives the bits of the single command, for every camera model.
#[test]
fn rays_tracing_and_averaging_apart_give_the_exposure_of_capture() {
    let matrix =
        "camera_matrix: [20, 0, 11, 0, 21, 10, 0, 0, 1]\ndistortion_model: fisheye\nD: [0.05, 0.01, 0, 0]\n".to_owned();
    let cameras = [
        format!("{CAMERA}{HOLE}pinhole_model = \"diffraction\"\nobject_distance_m = 0.48\n"),
        format!(
            "{CAMERA}{HOLE}pinhole_model = \"diffraction\"\nobject_distance_m = 0.48\nband_wavelengths_nm = [620, 540, 460]\n"
        ),
        format!(
            "{CAMERA}{HOLE}pinhole_model = \"diffraction\"\nobject_distance_m = 0.48\n{LINEAR}mosaic = \"RGGB\"\n[alignment]\nsensor_tilt_deg = [0.2, -0.3]\n"
        ),
        format!(
            "{CAMERA}lens_focal_length_mm = 6.0\nf_number = 2.0\nfocus_distance_m = 0.4\nfront_stop_mm = [8.0, 4.0]\n"
        ),
        format!("{}{HOLE}camera_matrix = \"matrix.yaml\"\n", CAMERA.replace("pixel_pitch_um = [100, 110]\n", "")),
        format!("{CAMERA}{HOLE}[alignment]\nsensor_tilt_deg = [5.0, -3.0]\ncamera_turn_deg = [1.0, 2.0, 3.0]\n"),
    ];
    for camera in cameras {
        let folder = folder(&[("camera.toml", camera.clone()), ("matrix.yaml", matrix.clone())]);
        let words = ["capture", "camera.toml", "scene.rad", "--samples", "8", "--exposure", "fused.mtx"];
        run(&folder, &words, b"").done();
        let rays = run(&folder, &["pinhole", "rays", "camera.toml", "--samples", "8"], b"").done();
        let radiances = run(&folder, &["rtrace", "-h", "-fdd", "-ab", "0", "scene.rad"], &rays).done();
        let average = run(&folder, &["pinhole", "average", "camera.toml", "--samples", "8"], &radiances).done();
        let fused = std::fs::read(folder.path("fused.mtx")).unwrap();
        let numbers = |bytes: &[u8]| bytes[bytes.len() - 24 * 20 * 4..].to_vec();
        assert_eq!(numbers(&fused), numbers(&average), "{camera}");
        assert!(numbers(&fused).iter().any(|byte| *byte != 0), "{camera}");
    }
}

#[test]
fn a_sampled_specimen_can_be_captured_again() {
    let tolerances = "[tolerances]\nspecimen = 3\ncamera_turn_deg = 1.0\nsensor_shift_um = 80\nled_tilt_deg = 2\nled_intensity_percent = 10\n";
    let rig = "[rig]\nleds = 6\nring_diameter_mm = 30\nled_diameter_mm = 5\nled_intensity_w_per_sr = 0.05\nled_cone_deg = 40\n";
    let drawn = format!("{CAMERA}{HOLE}{rig}{tolerances}{LINEAR}");
    let folder = folder(&[("drawn.toml", drawn), ("plain.toml", format!("{CAMERA}{HOLE}"))]);
    let words =
        ["capture", "drawn.toml", "scene.rad", "--samples", "4", "-o", "drawn.png", "--specimen", "specimen.toml"];
    run(&folder, &[&words[..], &["--exposure", "drawn.mtx"]].concat(), b"").done();
    let specimen = std::fs::read_to_string(folder.path("specimen.toml")).unwrap();
    folder.file("again.toml", format!("{CAMERA}{HOLE}{rig}{LINEAR}{specimen}"));
    run(&folder, &["capture", "again.toml", "scene.rad", "--samples", "4", "--exposure", "again.mtx"], b"").done();
    let [drawn, again] = ["drawn.mtx", "again.mtx"].map(|name| std::fs::read(folder.path(name)).unwrap());
    assert_eq!(drawn[drawn.len() - 24 * 20 * 4..], again[again.len() - 24 * 20 * 4..]);
    assert!(String::from_utf8_lossy(&drawn).contains("ALIGNMENT= [alignment]; camera_shift_mm = ["));
    let refused = run(&folder, &["capture", "plain.toml", "scene.rad", "--exposure", "x", "--specimen", "s"], b"");
    assert_eq!(refused.code, 1);
    assert!(refused.messages.contains("neither [alignment] nor [tolerances]"), "{}", refused.messages);
    assert!(!folder.path("x").exists() && !folder.path("s").exists());
}

#[test]
fn colours_behind_a_mosaic_come_back() {
    let camera =
        format!("{CAMERA}{HOLE}pinhole_model = \"point\"\n{LINEAR}mosaic = \"RGGB\"\n").replace("= 650.0", "= 550.0");
    let folder = folder(&[("camera.toml", camera), ("plain.toml", format!("{CAMERA}{HOLE}{LINEAR}"))]);
    let words = ["capture", "camera.toml", "scene.rad", "--samples", "64", "-o", "raw.png", "--color", "color.png"];
    run(&folder, &words, b"").done();
    let png = radsight_picture::read_png(&std::fs::read(folder.path("color.png")).unwrap()).unwrap();
    assert_eq!((png.bits, png.values.components()), (16, 3));
    let image = png.values;
    // The centre of the left half is red, that of the right half blue, in the ratios of the paints
    // above the dark level.
    let mean = |columns: std::ops::Range<usize>, color: usize| {
        let pixels = (4..16).flat_map(|row| columns.clone().map(move |column| (row, column)));
        let values: Vec<f64> =
            pixels.map(|(row, column)| f64::from(image.data()[3 * (24 * row + column) + color])).collect();
        values.iter().sum::<f64>() / values.len() as f64 - 50.0
    };
    let (left, right) = ([0, 1, 2].map(|color| mean(2..9, color)), [0, 1, 2].map(|color| mean(17..22, color)));
    assert!((left[0] / left[1] / 3.0 - 1.0).abs() < 0.1, "{left:?}");
    assert!((right[2] / right[1] / 3.5 - 1.0).abs() < 0.1, "{right:?}");
    run(&folder, &["capture", "camera.toml", "scene.rad", "--samples", "64", "--color", "alone.png"], b"").done();
    let alone = radsight_picture::read_png(&std::fs::read(folder.path("alone.png")).unwrap()).unwrap();
    assert_eq!(alone.values, image, "the grey picture need not be asked for");
    let refused = run(&folder, &["capture", "plain.toml", "scene.rad", "-o", "a.png", "--color", "b.png"], b"");
    assert_eq!(refused.code, 1);
    assert!(refused.messages.contains("has no colour filter mosaic"), "{}", refused.messages);
}

#[test]
fn a_sensor_is_measured_with_table_and_page() {
    let power = "[sensor]\nresponse = \"power-law\"\nk = 1\ngamma = 1\ngrey_background = 0\ngrey_max = 9\nexposure_unit = \"J/m2\"\n";
    let folder =
        folder(&[("linear.toml", format!("{CAMERA}{HOLE}{LINEAR}")), ("power.toml", format!("{CAMERA}{HOLE}{power}"))]);
    let words = ["sensor", "linear.toml", "--characterise", "--report", "page.html", "--stack", "20"];
    let table = run(&folder, &words, b"").text();
    let row = table.lines().find(|line| line.starts_with("\"quantum efficiency\"")).unwrap();
    let numbers: Vec<f64> = row.split(',').skip(2).map(|word| word.parse().unwrap()).collect();
    assert!((numbers[1]..=numbers[2]).contains(&0.6) && numbers[2] - numbers[1] < 0.1, "{row}");
    let page = std::fs::read_to_string(folder.path("page.html")).unwrap();
    assert_eq!((page.matches("<svg").count(), page.matches("</svg>").count()), (5, 5));
    let cut = format!("{CAMERA}{HOLE}{}", LINEAR.replace("dark_offset_dn = 50", "dark_offset_dn = 0"));
    folder.file("cut.toml", cut);
    let run_short = |camera| run(&folder, &["sensor", camera, "--characterise", "--steps", "10", "--stack", "6"], b"");
    assert!(run_short("cut.toml").messages.contains("hint: a larger dark_offset_dn"));
    assert_eq!(run_short("linear.toml").messages, "");
    let refused = run(&folder, &["sensor", "power.toml", "--characterise"], b"");
    assert_eq!(refused.code, 1);
    assert!(refused.messages.contains("hint: response = \"emva1288\""), "{}", refused.messages);
    assert_eq!(run(&folder, &["sensor", "linear.toml", "--report", "x.html"], b"").code, 2);
}

#[test]
fn a_calibration_says_its_intervals_and_draws_its_plot() {
    let pairs: Vec<String> = (0..40)
        .map(|k| {
            let exposure = 2.5e-3 * f64::from(k) / 39.0;
            let wobble = 0.3 * f64::from(k * 7 % 5 - 2);
            format!("{exposure},{}", (33844.0 * exposure.powf(0.85) + 12.0).min(161.0) + wobble)
        })
        .collect();
    let folder = folder(&[("data.csv", pairs.join("\n"))]);
    let text = run(&folder, &["calibrate", "data.csv", "--plot", "fit.svg"], b"").text();
    for name in ["k", "gamma", "grey_background", "grey_max"] {
        assert!(text.contains(&format!("# {name}: from ")), "{text}");
    }
    let plot = std::fs::read_to_string(folder.path("fit.svg")).unwrap();
    assert_eq!(plot.matches("<circle").count(), 40);
}

#[test]
fn a_capture_says_why_each_ray_draws_the_whole_diffraction_pattern() {
    let hole = format!("{CAMERA}{HOLE}pinhole_model = \"diffraction\"\n[alignment]\n");
    let slight = ("slight.toml", format!("{hole}sensor_tilt_deg = [0.2, -0.3]\n"));
    let folder = folder(&[slight, ("tilted.toml", format!("{hole}sensor_tilt_deg = [5.0, -3.0]\n"))]);
    let of = |camera: &str| {
        let words = ["capture", camera, "scene.rad", "--samples", "2", "--exposure", "e.mtx", "--record", "r.json"];
        let run = run(&folder, &words, b"");
        assert_eq!(run.code, 0, "{}", run.messages);
        (run.messages, std::fs::read_to_string(folder.path("r.json")).unwrap())
    };
    let (messages, record) = of("tilted.toml");
    assert!(messages.contains("many more rays: the sensor is tilted too much"), "{messages}");
    assert!(record.contains("many more rays: the sensor is tilted too much"), "{record}");
    let (messages, record) = of("slight.toml");
    assert!(!messages.contains("whole diffraction pattern") && !record.contains("whole diffraction pattern"));
}

/// The lit pixels of a capture and of a picture of the same view type.
#[test]
fn projections_are_the_view_types_of_rpict() {
    let balls = [(0.2, 0.1), (0.6, -0.4), (-0.9, 0.3), (1.1, 0.0), (-0.2, -1.1), (0.1, 0.8)];
    let ball = |(index, (azimuth, altitude)): (usize, &(f64, f64))| {
        let [x, y, z] = [azimuth.sin() * altitude.cos(), azimuth.cos() * altitude.cos(), altitude.sin()]
            .map(|part: f64| 3.0 * part);
        format!("white sphere ball{index} 0 0 4 {x} {y} {z} .3\n")
    };
    let scene: String = balls.iter().enumerate().map(ball).collect();
    let folder = Folder::new();
    folder.file("balls.rad", format!("void glow white 0 0 4 1 1 1 0\n{scene}"));
    let half = 70f64.to_radians();
    for (projection, letter, extent) in [
        ("perspective", "v", half.tan()),
        ("equidistant", "a", half),
        ("orthographic", "h", half.sin()),
        ("stereographic", "s", 2.0 * (0.5 * half).tan()),
        ("cylindrical", "c", half),
    ] {
        // 64 pixels of 10 um cover the extent on both sides of the axis.
        let focal_mm = 0.32 / extent;
        folder.file(
            "camera.toml",
            format!(
                "[camera]\nposition_m = [0, 0, 0]\ndirection = [0, 1, 0]\nup = [0, 0, 1]\npixels = [64, 64]\n\
                 pixel_pitch_um = [10, 10]\nfocal_distance_mm = {focal_mm}\npinhole_diameter_mm = 0.01\n\
                 pinhole_model = \"point\"\nexposure_ms = 10\nwavelength_nm = 650\nprojection = \"{projection}\"\n"
            ),
        );
        let words = ["capture", "camera.toml", "balls.rad", "--samples", "64", "--exposure", "e.mtx"];
        run(&folder, &words, b"").done();
        // A cylinder is as high as it is wide.
        let vertical = if letter == "c" { 2.0 * extent.atan().to_degrees() } else { 140.0 };
        let view =
            format!("-vt{letter} -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 140 -vv {vertical} -x 64 -y 64 -pa 1 --samples 64");
        let words = [&["rpict"][..], &view.split(' ').collect::<Vec<_>>(), &["balls.rad"]].concat();
        let picture = run(&folder, &words, b"").done();
        let values = run(&folder, &["pvalue", "-h", "-H", "-df", "-b"], &picture).done();
        let lit =
            |bytes: &[u8]| -> Vec<bool> { bytes.as_chunks().0.iter().map(|v| f32::from_le_bytes(*v) > 0.0).collect() };
        let exposure = folder.read("e.mtx");
        let [capture, picture] = [&exposure[exposure.len() - 64 * 64 * 4..], &values[..]].map(lit);
        assert_eq!(picture.len(), 64 * 64);
        let differing = capture.iter().zip(&picture).filter(|(one, other)| one != other).count();
        let all = picture.iter().filter(|lit| **lit).count();
        // Pixels at edges differ, where a ball covers about one sample of 64.
        assert!(all > 100 && 10 * differing < all, "{projection}: {differing} of {all} pixels differ");
    }
}

#[test]
fn an_orthographic_fisheye_exposes_a_uniform_sky_uniformly() {
    let folder = Folder::new();
    folder.file("sky.rad", "void glow white 0 0 4 1 1 1 0\nwhite source sky 0 0 4 0 1 0 180\n");
    folder.file(
        "camera.toml",
        "[camera]\nposition_m = [0, 0, 0]\ndirection = [0, 1, 0]\nup = [0, 0, 1]\npixels = [32, 32]\n\
         pixel_pitch_um = [10, 10]\nfocal_distance_mm = 0.25\npinhole_diameter_mm = 0.01\npinhole_model = \"point\"\n\
         exposure_ms = 10\nwavelength_nm = 650\nprojection = \"orthographic\"\n",
    );
    run(&folder, &["capture", "camera.toml", "sky.rad", "--samples", "16", "--exposure", "e.mtx"], b"").done();
    let bytes = folder.read("e.mtx");
    let numbers = bytes[bytes.len() - 32 * 32 * 4..].as_chunks().0.iter().map(|v| f64::from(f32::from_le_bytes(*v)));
    // τ·A/f² for a radiance of 1.
    let expected = 0.01 * std::f64::consts::PI * 0.005f64.powi(2) / 0.25f64.powi(2);
    assert!(numbers.into_iter().all(|value| (value / expected - 1.0).abs() < 1e-5));
}

/// An exposure of another width than the camera's has the rows of its own.
#[test]
fn rows_of_any_exposure_have_offsets_of_their_own() {
    let folder = Folder::new();
    let camera = folder.file(
        "camera.toml",
        "[camera]\nposition_m = [0, 0, 1]\ndirection = [0, 0, -1]\nup = [0, 1, 0]\npixels = [64, 64]\n\
         pixel_pitch_um = [5, 5]\nfocal_distance_mm = 8\npinhole_diameter_mm = 0.1\npinhole_model = \"finite\"\n\
         exposure_ms = 10\nwavelength_nm = 550\n[sensor]\nresponse = \"emva1288\"\nquantum_efficiency = 0.5\n\
         gain_dn_per_e = 0.1\ndark_offset_dn = 100\nbits = 12\nfull_well_e = 20000\nread_noise_e = 1\n\
         dark_current_e_per_s = 0\ndsnu_row_e = 100\nspecimen = 1\n",
    );
    let row_means = |columns: usize, rows: usize| -> Vec<f64> {
        let header = format!("#?RADIANCE\nNROWS={rows}\nNCOLS={columns}\nNCOMP=1\nFORMAT=ascii\n\n");
        let dark = "0 ".repeat(columns) + "\n";
        let picture = radsight_with(&["sensor", &camera], (header + &dark.repeat(rows)).as_bytes()).done();
        let values = greys(&picture).into_data();
        values
            .chunks(columns)
            .map(|row| row.iter().map(|grey| f64::from(*grey)).sum::<f64>() / columns as f64)
            .collect()
    };
    let (whole, part) = (row_means(64, 64), row_means(16, 32));
    let apart = whole.iter().zip(&part).map(|(whole, part)| (whole - part).abs()).fold(0.0, f64::max);
    assert!(apart < 1.0, "{apart}: {whole:?} {part:?}");
    assert!(part.windows(2).filter(|pair| (pair[0] - pair[1]).abs() > 1.0).count() > 20, "{part:?}");
}

/// The number of a pinhole at the distance of what its rays meet, whatever lights the scene from behind.
#[test]
fn the_note_on_diffraction_is_for_what_the_camera_sees() {
    let folder = folder(&[("camera.toml", format!("{CAMERA}{HOLE}"))]);
    let lamp = |z: &str| format!("void light lamp 0 0 3 900 900 900\nlamp sphere bulb 0 0 4 .3 .2 {z} .02\n");
    let floor = "void plastic red 0 0 5 .6 .2 .1 0 0\nred polygon f 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";
    let note = |scene: &str| {
        folder.file("scene.rad", scene);
        let words = ["capture", "camera.toml", "scene.rad", "--samples", "1", "--exposure", "e.pfm"];
        let run = run(&folder, &words, b"");
        assert_eq!(run.code, 0, "{run:?}");
        run.messages.lines().find(|line| line.contains("Fresnel number")).map(str::to_owned)
    };
    // (0.05 mm)² (1/6.75 mm + 1/480 mm) / 650 nm.
    for z in ["0.2", "0.9", "0.482", "7"] {
        let found = note(&format!("{floor}{}", lamp(z)));
        assert!(found.as_ref().is_some_and(|note| note.contains("Fresnel number is 0.58:")), "{z}: {found:?}");
    }
    assert_eq!(note(&lamp("9")), None);
}

/// What only shows beside a scene is shown in the camera file.
#[test]
fn weights_for_another_number_of_bands_are_shown_in_the_camera_file() {
    let sensor = LINEAR.replace("bits = 12", "bits = 12\nband_weights = [1, 2]");
    let folder = folder(&[("camera.toml", format!("{CAMERA}{HOLE}{sensor}"))]);
    let words = ["capture", "camera.toml", "scene.rad", "--samples", "1", "-o", "o.png"];
    let run = run(&folder, &words, b"");
    assert_eq!(run.code, 1);
    assert!(run.messages.contains("camera.toml:19:16: error: 3 bands but 2 band weights\n"), "{}", run.messages);
}

/// Every LED of the ring is seen in the ball as a point of a thousandth of a pixel: in the focus of the lens all of its
/// points see it through the same point of the pixel, out of focus through few of them each.
#[test]
fn a_polished_ball_shows_every_led_to_a_lens_in_focus_and_out_of_focus() {
    let ball = "void metal chrome 0 0 5 .8 .8 .8 1 0 chrome sphere ball 0 0 4 .0004 .0002 .006 .006";
    let rig = "[rig]\nleds = 4\nring_diameter_mm = 24\nled_diameter_mm = 9\nled_intensity_w_per_sr = 0.05\nled_cone_deg = 40\n";
    for focus in [0.471, 0.468, 0.44] {
        let camera = CAMERA.replace("[24, 20]", "[8, 6]").replace("[100, 110]", "[14, 16]");
        let lens = format!("lens_focal_length_mm = 8\nf_number = 2\nfocus_distance_m = {focus}\n");
        let folder = folder(&[("camera.toml", format!("{camera}{lens}{rig}")), ("ball.rad", ball.to_owned())]);
        let exposure = |asked: [&str; 2]| {
            let words = ["capture", "camera.toml", "ball.rad", asked[0], asked[1], "--exposure", "x.pfm"];
            run(&folder, &words, b"").done();
            exposure_file(&folder.path("x.pfm")).data().iter().map(|value| f64::from(*value)).collect::<Vec<_>>()
        };
        // Rays that meet LEDs by chance.
        let (found, expected) = (exposure(["--error", "0.01"]), exposure(["--samples", "65536"]));
        let [sum, expected_sum] = [&found, &expected].map(|values| values.iter().sum::<f64>());
        assert!((sum / expected_sum - 1.0).abs() < 0.06, "{sum} for {expected_sum} in focus at {focus} m");
        let brightest = expected.iter().copied().fold(0.0, f64::max);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 0.1 * brightest, "{found} for {expected} in focus at {focus} m");
        }
    }
}

/// By rounding, a ray that is aimed at an image may pass beside it: its light is 0, and so is its density.
#[test]
fn no_pixel_of_a_picture_of_mirrored_lamps_is_not_a_number() {
    let mirror =
        "void metal chrome 0 0 5 .8 .8 .8 1 0 chrome polygon m 0 0 12 -.02 -.02 0 .02 -.02 0 .02 .02 0 -.02 .02 0";
    let rig = "[rig]\nleds = 4\nring_diameter_mm = 24\nled_diameter_mm = 0.5\nled_intensity_w_per_sr = 0.05\nled_cone_deg = 40\n";
    let camera = CAMERA.replace("[24, 20]", "[48, 40]").replace("[100, 110]", "[14, 16]");
    let lens = "lens_focal_length_mm = 8\nf_number = 2\nfocus_distance_m = 0.48\n";
    let folder = folder(&[("camera.toml", format!("{camera}{lens}{rig}")), ("mirror.rad", mirror.to_owned())]);
    let sum = |seed: u32| {
        let words = ["capture", "camera.toml", "mirror.rad", "--error", "0.02", "--exposure", "x.pfm", "--seed"];
        run(&folder, &[&words[..], &[&seed.to_string()]].concat(), b"").done();
        exposure_file(&folder.path("x.pfm")).data().iter().map(|value| f64::from(*value)).sum::<f64>()
    };
    let sums: Vec<f64> = (1..9).map(sum).collect();
    assert!(sums.iter().all(|sum| (sum / sums[0] - 1.0).abs() < 0.05), "{sums:?}");
}
