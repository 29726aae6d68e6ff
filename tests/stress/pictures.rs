//! Exposures, sensors and sizes at their limits; the same bits for any way of computing them.

use crate::program::{Folder, ROOM, command, run_with};
use crate::table::{count, row};
use radsight_picture::{FileFormat, Header, Image, Picture, read_image, write_image};
use radsight_sensor::{BitDepth, ExposureUnit, PowerLaw, PowerLawDescription};
use std::process::Command;

/// The precision of each format over fifteen orders of magnitude on either side of 1.
#[test]
fn thirty_orders_of_exposure() {
    let values: Vec<f32> = (-15..=15).flat_map(|order| [10f32.powi(order); 3]).collect();
    let image = Image::new(values.len() / 3, 1, 3, values.clone()).expect("an image");
    for (format, name, tolerance) in [
        (FileFormat::Picture, "picture (RGBE)", 0.005),
        (FileFormat::Matrix, "float matrix", 1e-7),
        (FileFormat::Pfm, "PFM", 1e-7),
        (FileFormat::Npy, "NumPy array", 1e-7),
    ] {
        let bytes = write_image(format, &Header::new("RADIANCE"), &image).expect("it can be written");
        let read = read_image(&bytes).expect("it can be read");
        let apart = read.image.data().iter().zip(&values).map(|(found, value)| f64::from((found / value - 1.0).abs()));
        row(
            &format!("30 orders of exposure in a {name}"),
            "value, against what was written",
            tolerance,
            apart.fold(0.0, f64::max),
        );
    }
}

#[test]
fn gammas() {
    for gamma in [0.1, 0.85, 5.0] {
        let sensor = PowerLaw::new(&PowerLawDescription {
            k: 100.0,
            gamma,
            grey_background: 10.0,
            grey_max: 250.0,
            exposure_unit: ExposureUnit::JoulePerSquareMetre,
            bits: BitDepth::EIGHT,
        })
        .expect("a sensor");
        let top = sensor.saturation_exposure();
        row(
            &format!("sensor of γ {gamma}"),
            "grey value at saturation, against the largest",
            1e-9,
            (sensor.exact_grey(top) / 250.0 - 1.0).abs(),
        );
        let mut before = 0;
        let falls = (-300..300)
            .filter(|order| {
                let grey = sensor.grey(10f64.powi(*order));
                let falls = grey < before || !(10..=250).contains(&grey);
                before = grey;
                falls
            })
            .count();
        count(
            &format!("sensor of γ {gamma}"),
            "grey values that fall, or leave their range, over 600 orders",
            600,
            falls,
        );
    }
}

fn rpict(folder: &Folder, program: &mut Command, size: [&str; 2], threads: &str) -> Vec<u8> {
    let words =
        ["rpict", "-vp", "0", ".5", "1.5", "-vd", "0", "1", "0", "-pa", "0", "-ab", "1", "-ad", "16", "-as", "0"];
    program.args(words).args(["-x", size[0], "-y", size[1], "-n", threads, "room.rad"]).current_dir(folder.path(""));
    run_with(program, b"").done()
}

/// The bits without the header, which contains the command line and the time.
fn pixels(bytes: &[u8]) -> &[u8] {
    &bytes[Header::read(bytes).expect("a header").1..]
}

fn room() -> Folder {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder
}

#[test]
fn pictures_of_a_pixel_and_of_a_line() {
    let folder = room();
    for [columns, rows] in [["1", "1"], ["1", "65535"], ["65535", "1"]] {
        let bytes = rpict(&folder, &mut command(&[]), [columns, rows], "2");
        let picture = Picture::read(&bytes).expect("a picture");
        let wrong = usize::from([picture.width(), picture.height()].map(|side| side.to_string()) != [columns, rows]);
        count(&format!("picture of {columns} × {rows}"), "other size than asked for", 1, wrong);
    }
}

#[test]
fn threads_give_the_same_bits() {
    let folder = room();
    let of = |threads: &str| pixels(&rpict(&folder, &mut command(&[]), ["64", "64"], threads)).to_vec();
    let one = of("1");
    let others = ["2", "7"].into_iter().filter(|threads| of(threads) != one).count();
    count("1, 2 and 7 threads", "pictures of other bits", 2, others);
}

/// Commands that trace, gather, interpolate, sample lights and read numbers.
const COMMANDS: [&[&str]; 5] = [
    &[
        "rpict", "-vp", "0", ".5", "1.5", "-vd", "0", "1", "0", "-ab", "1", "-ad", "16", "-x", "64", "-y", "64",
        "room.rad",
    ],
    &[
        "rpict", "-vp", "0", ".5", "1.5", "-vd", "0", "1", "0", "--error", ".1", "-ab", "2", "-x", "32", "-y", "32",
        "room.rad",
    ],
    &["rtrace", "-h", "-I", "-ab", "2", "-ad", "64", "-ov", "room.rad"],
    &["rcontrib", "-h", "-I", "-ab", "1", "-ad", "64", "-m", "light", "room.rad"],
    &["oconv", "-f", "room.rad"],
];

/// The variable names a program built with another profile; `.ci/run` sets it.
#[test]
fn profiles_give_the_same_bits() {
    let Some(other) = std::env::var_os("RADSIGHT_OTHER_PROFILE") else {
        println!(
            "| debug and release | outputs with other bits | not tried | RADSIGHT_OTHER_PROFILE names no program |"
        );
        return;
    };
    let folder = room();
    let output = |mut program: Command, words: &[&str]| {
        program.args(words).current_dir(folder.path(""));
        run_with(&mut program, b"0 .5 .5 0 0 1\n.3 .5 .2 0 1 0\n").done()
    };
    let differing: Vec<_> = COMMANDS
        .iter()
        .filter(|words| {
            let [here, there] = [command(&[]), Command::new(&other)].map(|program| output(program, words));
            without_header(&here) != without_header(&there)
        })
        .collect();
    assert!(differing.is_empty(), "other bits: {differing:?}");
    count("debug and release", "outputs with other bits", COMMANDS.len(), differing.len());
}

/// The bits after the header, if there is one: it contains the command line and the time.
fn without_header(bytes: &[u8]) -> &[u8] {
    if bytes.starts_with(b"#?RADIANCE") { pixels(bytes) } else { bytes }
}
