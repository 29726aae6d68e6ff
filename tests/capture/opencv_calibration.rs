//! OpenCV, an independent program, finds simulated targets and recovers the camera that rendered
//! them.
//!
//! Needs Python with OpenCV (`pip install opencv-python`): the program named by `RADSIGHT_PYTHON`,
//! else `python3`. Without it the tests print a note and pass.

use std::path::Path;
use std::process::{Command, Output};

const COLUMNS: u32 = 9;
const ROWS: u32 = 6;
const SPACING: f64 = 0.025;

/// fx, fy, cx, cy, k1, k2 of the camera to be recovered; pixels are not square, and the principal
/// point is off the centre.
const CAMERA: [f64; 6] = [420.0, 430.0, 165.3, 116.4, -0.20, 0.05];

const MATRIX: &str = "image_width: 320\nimage_height: 240\ndistortion_model: plumb_bob\n\
    camera_matrix: {rows: 3, cols: 3, data: [420.0, 0, 165.3, 0, 430.0, 116.4, 0, 0, 1]}\n\
    distortion_coefficients: {rows: 1, cols: 5, data: [-0.20, 0.05, 0, 0, 0]}\n";

/// Camera positions (metres) about the target, each with the point of interest and the up
/// direction.
const POSES: [([f64; 3], [f64; 2], [f64; 2]); 10] = [
    ([0.00, 0.00, 0.45], [0.00, 0.00], [0.0, 1.0]),
    ([0.20, 0.02, 0.38], [0.01, 0.00], [0.1, 1.0]),
    ([-0.20, -0.03, 0.38], [-0.02, 0.01], [-0.1, 1.0]),
    ([0.02, 0.20, 0.38], [0.00, 0.02], [0.0, 1.0]),
    ([-0.03, -0.20, 0.38], [0.01, -0.02], [0.2, 1.0]),
    ([0.15, 0.15, 0.40], [0.03, 0.02], [-0.2, 1.0]),
    ([-0.15, 0.16, 0.40], [-0.03, 0.02], [0.15, 1.0]),
    ([0.16, -0.15, 0.40], [0.03, -0.02], [0.3, 1.0]),
    ([-0.14, -0.15, 0.42], [-0.04, -0.03], [-0.3, 1.0]),
    ([0.05, 0.05, 0.60], [0.06, 0.04], [0.0, 1.0]),
];

fn radsight(folder: &Path, words: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_radsight")).current_dir(folder).args(words).output().unwrap();
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn camera_text([x, y, z]: [f64; 3], [at_x, at_y]: [f64; 2], [up_x, up_y]: [f64; 2]) -> String {
    format!(
        "[camera]\nposition_m = [{x}, {y}, {z}]\ndirection = [{}, {}, {}]\nup = [{up_x}, {up_y}, 0.0]\n\
         camera_matrix = \"camera.yaml\"\nfocal_distance_mm = 4.0\npinhole_diameter_mm = 0.1\npinhole_model = \"point\"\n\
         exposure_ms = 10.0\n[sensor]\nresponse = \"power-law\"\nk = 4.0e7\ngamma = 1.0\ngrey_background = 8\n\
         grey_max = 250\nexposure_unit = \"J/m2\"\n",
        at_x - x,
        at_y - y,
        -z
    )
}

/// Python, if it has OpenCV. Checked before any picture is rendered.
fn python_with_opencv() -> Option<Command> {
    let python = std::env::var_os("RADSIGHT_PYTHON").unwrap_or_else(|| "python3".into());
    let has_opencv = Command::new(&python).args(["-c", "import cv2, numpy"]).output();
    if !has_opencv.is_ok_and(|output| output.status.success()) {
        eprintln!("no Python with OpenCV: not tested (set RADSIGHT_PYTHON)");
        return None;
    }
    Some(Command::new(python))
}

/// Value and standard deviation of each number, the rms error and the number of pictures; `None`
/// without OpenCV.
fn calibrated(pattern: &str) -> Option<(Vec<[f64; 2]>, f64, f64)> {
    let mut python = python_with_opencv()?;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |name: &str, text: &[u8]| std::fs::write(folder.join(name), text).unwrap();
    let counts = [COLUMNS.to_string(), ROWS.to_string(), SPACING.to_string()];
    let [columns, rows, spacing] = &counts;
    let sizes = ["--columns", columns, "--rows", rows, "--spacing", spacing, "--radiance", "1.0"];
    let target = radsight(folder, &[&["target", pattern][..], &sizes].concat());
    write("target.rad", &target.stdout);
    write("camera.yaml", MATRIX.as_bytes());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/opencv/calibrate.py");
    python.current_dir(folder).arg(script).arg(pattern).args(&counts);
    for (number, (position, at, up)) in POSES.into_iter().enumerate() {
        let (camera, picture) = (format!("{number}.toml"), format!("{number}.png"));
        write(&camera, camera_text(position, at, up).as_bytes());
        radsight(folder, &["capture", &camera, "target.rad", "--samples", "16", "-o", &picture]);
        python.arg(picture);
    }
    let found = python.output().unwrap();
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    let text = String::from_utf8(found.stdout).unwrap();
    let number = |word: &str| word.parse::<f64>().unwrap();
    let pairs: Vec<[f64; 2]> = text
        .lines()
        .map(|line| {
            let (first, second) = line.split_once(' ').unwrap();
            [number(first), number(second)]
        })
        .collect();
    let [error, pictures] = pairs[6];
    Some((pairs[..6].to_vec(), error, pictures))
}

/// OpenCV's estimates are within three of its own standard deviations of the camera.
#[test]
fn opencv_finds_the_camera_that_made_pictures_of_a_chessboard() {
    let Some((found, error, pictures)) = calibrated("chessboard") else { return };
    println!("{found:?}, rms {error} of {pictures} pictures");
    assert!(pictures >= 9.0, "the chessboard was found in {pictures} pictures");
    assert!(error < 0.1, "rms reprojection error {error} pixels");
    for (name, ([value, deviation], truth)) in
        ["fx", "fy", "cx", "cy", "k1", "k2"].into_iter().zip(found.into_iter().zip(CAMERA))
    {
        assert!((value - truth).abs() < 3.0 * deviation, "{name} is {value} ± {deviation}, expected {truth}");
    }
}

/// Centres of perspective ellipses are not the images of the dots' centres, which OpenCV ignores:
/// at this size the difference is below its deviations.
#[test]
fn opencv_finds_the_camera_that_made_pictures_of_dots() {
    let Some((found, error, pictures)) = calibrated("dots") else { return };
    println!("{found:?}, rms {error} of {pictures} pictures");
    assert!(pictures >= 9.0, "the dots were found in {pictures} pictures");
    assert!(error < 0.1, "rms reprojection error {error} pixels");
    for (name, ([value, deviation], truth)) in ["fx", "fy", "cx", "cy"].into_iter().zip(found.into_iter().zip(CAMERA)) {
        assert!((value - truth).abs() < 3.0 * deviation, "{name} is {value} ± {deviation}, expected {truth}");
    }
}
