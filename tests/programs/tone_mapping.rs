//! `pcond` and the tone mapping of `ra_bmp`, compared with the real ones and with theory.

use crate::program::{Folder, command, radsight, run_with};
use radsight_picture::{Header, Image, Picture};
use radsight_test_support::Radiance;
use std::path::PathBuf;

/// Bright spots over seven decades of luminance, seen as wide as a room.
fn lamps(width: usize, height: usize, view: &str) -> Vec<u8> {
    let value = |i: usize| {
        let (pixel, part) = (i / 3, i % 3);
        let (x, y) = (pixel % width, pixel / width);
        let spot = f64::from(u8::from(x % 17 == 3 && y % 13 == 4)) * 5e3;
        (spot + 1e-4 * 10f64.powf(5.0 * x as f64 / width as f64) * (1.0 + (y as f64 / 7.0).sin() * 0.4)) as f32
            * [1.0, 0.8, 0.5][part]
    };
    let values = Image::new(width, height, 3, (0..width * height * 3).map(value).collect()).expect("a shape");
    let mut header = Header::new("RADIANCE");
    header.push_line(&format!("VIEW= {view}"));
    header.push_exposure(0.5);
    let scaled = values.map(|value| value * 0.5);
    Picture::from_rgb(header, &scaled).expect("a picture").to_bytes()
}

/// Our picture differs from the real one in no header line, and by at most one step of the mantissa
/// or three millionths of white: near black a pixel is the difference of its luminance and the
/// display's smallest, which one more foveal sample in the lowest bin changes by a few per cent.
#[track_caller]
fn same_but_for_rounding(real: &[u8], ours: &[u8], what: &str) {
    let (real, ours) = (Picture::read(real).expect("a picture"), Picture::read(ours).expect("a picture"));
    let lines = |picture: &Picture| picture.header().to_text();
    assert_eq!(lines(&real), lines(&ours), "{what}");
    let (real, ours) = (real.values(), ours.values());
    let differs = |(a, b): (&[f32], &[f32])| {
        let largest = a.iter().fold(0.0f32, |most, value| most.max(*value));
        a.iter().zip(b).any(|(a, b)| (a - b).abs() > f32::max(0.01 * largest, 3e-6))
    };
    let different = real.pixels().zip(ours.pixels()).filter(|pair| differs(*pair)).count();
    assert_eq!(different, 0, "{what}: pixels differ");
}

#[test]
fn pcond_gives_the_pixels_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("wide.hdr", lamps(90, 60, "-vth -vh 160 -vv 140"));
    folder.file("room.hdr", lamps(120, 80, "-vtv -vh 60 -vv 42"));
    folder.file("fixed.txt", "10 20\n60 5\n");
    folder.file("histogram.txt", "-1 3\n0 10\n1 20\n2 4\n3 1\n");
    let corner = |k: u32| [k & 1, k >> 1 & 1, k >> 2].map(f64::from);
    let pair = |[red, green, blue]: [f64; 3]| {
        format!("{red} {green} {blue} {} {} {}\n", 0.9 * red + 0.05, green * green, 0.8 * blue + 0.1 * red)
    };
    let map: String = (0..8).map(corner).chain([[0.4, 0.5, 0.3], [0.7, 0.2, 0.6]]).map(pair).collect();
    folder.file("map.cwp", map);
    let shared = std::env::var_os("RADSIGHT_SHARED").map(|folder| PathBuf::from(folder).join("radiance/loose/hdr"));
    let cabin = shared.map(|folder| folder.join("cabin.hdr")).filter(|path| path.exists());
    if let Some(cabin) = cabin {
        folder.file("cabin.hdr", std::fs::read(cabin).expect("a picture"));
    }
    for name in folder.names().iter().filter(|name| name.ends_with(".hdr")) {
        for (options, input) in [
            ("", ""),
            ("-h", ""),
            ("-a -c", ""),
            ("-v", ""),
            ("-s -w", ""),
            ("-l", ""),
            ("-l -s", ""),
            ("-e +1.5", ""),
            ("-u 300 -d 2000", ""),
            ("-p .64 .33 .3 .6 .15 .06 .3127 .329", ""),
            ("-l -m map.cwp", ""),
            ("-m map.cwp", ""),
            ("-i .3 -h-", "fixed.txt"),
            ("-I", "histogram.txt"),
        ] {
            let words = format!("pcond {options} {name}");
            let words: Vec<&str> = words.split_whitespace().collect();
            let input = if input.is_empty() { Vec::new() } else { folder.read(input) };
            let real = run_with(radiance.command("pcond", &words[1..]).current_dir(folder.path("")), &input).done();
            let ours = run_with(command(&words).current_dir(folder.path("")), &input).done();
            same_but_for_rounding(&real, &ours, &words.join(" "));
        }
    }
}

/// The pixels of an unpacked bitmap from the top, with 24 bits or 8.
fn bitmap(bytes: &[u8]) -> Vec<[u8; 3]> {
    let number = |at: usize| i32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"));
    assert_eq!((&bytes[..2], number(30)), (&b"BM"[..], 0), "a bitmap without packing");
    let (start, columns, height) = (number(10) as usize, number(18) as usize, number(22));
    let depth = usize::from(bytes[28]) / 8;
    let rows = bytes[start..].chunks_exact((columns * depth).next_multiple_of(4)).take(height.unsigned_abs() as usize);
    let pixels = |row: &[u8]| -> Vec<[u8; 3]> {
        row[..columns * depth].chunks_exact(depth).map(|pixel| [pixel[depth - 1], pixel[depth / 2], pixel[0]]).collect()
    };
    let rows: Vec<Vec<[u8; 3]>> = rows.map(pixels).collect();
    if height < 0 { rows.concat() } else { rows.into_iter().rev().collect::<Vec<_>>().concat() }
}

/// Tolerance of our bytes in each band: smallest, largest, and mean absolute difference over a
/// picture.
type Limits = [(i32, i32, f64); 3];

/// The real one stores the share of each component in the luminance as truncated bytes, so that it
/// is darker: most in blue, whose share is smallest. The mean difference depends on the picture.
fn limits_of_color(blue: f64) -> Limits {
    [(-2, 2, 0.82), (-2, 2, 0.62), (-2, 5, blue)]
}

/// Only luminance is quantised, in steps of some thousandths.
fn limits_of_grey(mean: f64) -> Limits {
    [(-1, 1, mean); 3]
}

#[test]
fn ra_bmp_maps_tones_as_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let mut pictures = vec![("lamps.hdr", 0.72, 0.09), ("tristimulus.hdr", 0.59, 0.04), ("narrow.hdr", 2.95, 0.07)];
    folder.file("lamps.hdr", lamps(90, 60, "-vtv -vh 60 -vv 42"));
    let shared = std::env::var_os("RADSIGHT_SHARED").map(|folder| PathBuf::from(folder).join("radiance/loose/hdr"));
    if let Some(cabin) = shared.map(|folder| folder.join("cabin.hdr")).filter(|path| path.exists()) {
        folder.file("cabin.hdr", std::fs::read(cabin).expect("a picture"));
        pictures.push(("cabin.hdr", 1.4, 0.4104));
    }
    run_with(command(&["ra_xyze", "lamps.hdr", "tristimulus.hdr"]).current_dir(folder.path("")), b"").done();
    let dim =
        Picture::read(&folder.read("lamps.hdr")).expect("a picture").values().map(|value| value.clamp(1e-3, 5e-3));
    folder.file("narrow.hdr", Picture::from_rgb(Header::new("RADIANCE"), &dim).expect("a picture").to_bytes());
    for (name, blue, grey) in pictures {
        for tones in ["auto", "h", "linear"] {
            for more in ["", "-b", "-g 1.8", "-p .64 .33 .3 .6 .15 .06 .3127 .329"] {
                let words = format!("ra_bmp -e {tones} {more} {name}");
                let words: Vec<&str> = words.split_whitespace().collect();
                let real = run_with(radiance.command("ra_bmp", &words[1..]).current_dir(folder.path("")), b"").done();
                let ours = run_with(command(&words).current_dir(folder.path("")), b"").done();
                let (real, ours) = (bitmap(&real), bitmap(&ours));
                assert_eq!(real.len(), ours.len(), "{words:?}");
                let limits = if more == "-b" { limits_of_grey(grey) } else { limits_of_color(blue) };
                for (band, (least, most, mean)) in limits.into_iter().enumerate() {
                    let apart: Vec<i32> =
                        real.iter().zip(&ours).map(|(a, b)| i32::from(b[band]) - i32::from(a[band])).collect();
                    let found = f64::from(apart.iter().map(|apart| apart.abs()).sum::<i32>()) / apart.len() as f64;
                    let beyond = apart.iter().filter(|apart| !(least..=most).contains(apart)).count();
                    assert!(beyond == 0 && found <= mean, "{words:?}: band {band}: {found}, {beyond} pixels beyond");
                }
            }
        }
    }
}

#[test]
fn a_mapping_that_is_none_is_refused() {
    let folder = Folder::new();
    let picture = folder.file("grey.hdr", lamps(20, 20, "-vtv -vh 40 -vv 40"));
    let black = Image::new(2, 2, 3, vec![0.0f32; 12]).expect("a shape");
    let black =
        folder.file("black.hdr", Picture::from_rgb(Header::new("RADIANCE"), &black).expect("a picture").to_bytes());
    let torn = folder.file("torn.hdr", &folder.read("grey.hdr")[..300]);
    for (words, code, message) in [
        (
            &["-e", "camera", &picture][..],
            2,
            "is followed by \"camera\", expected a number of stops with its sign, auto, human or linear",
        ),
        (&["-e", "autos", &picture], 2, "is followed by \"autos\""),
        (&["-e", "", &picture], 2, "is followed by \"\""),
        (&["-e"], 2, "ends the command line, expected a number of stops with its sign, auto, human or linear"),
        (&["-r", "-e", "auto", &picture], 2, "expected -e with a number of stops"),
        (&["-e", "auto", &black], 1, "the picture is black"),
        (&["-e", "auto", &torn], 1, "torn.hdr"),
    ] {
        let run = radsight(&[&["ra_bmp"], words].concat());
        assert_eq!((run.code, run.output.len()), (code, 0), "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?}: {}", run.messages);
    }
}

#[test]
fn the_map_rises_and_keeps_to_the_display() {
    let folder = Folder::new();
    let (picture, map) = (folder.file("wide.hdr", lamps(90, 60, "-vth -vh 160 -vv 140")), folder.word("map.txt"));
    let shown = radsight(&["pcond", "-h", "-u", "80", "-d", "50", "-x", &map, &picture]).done();
    let values = Picture::read(&shown).expect("a picture").values();
    let weighted = values.pixels().map(|pixel| 0.265 * pixel[0] + 0.670 * pixel[1] + 0.065 * pixel[2]);
    assert!(weighted.fold(0.0f32, f32::max) <= 1.01);
    let map = String::from_utf8(folder.read("map.txt")).expect("text");
    let pairs: Vec<[f64; 2]> = map
        .lines()
        .map(|line| line.split(' ').map(|number| number.parse().expect("a number")).collect::<Vec<f64>>())
        .map(|pair| [pair[0], pair[1]])
        .collect();
    assert_eq!(pairs.len(), 100);
    assert!(pairs.windows(2).all(|two| two[0][0] < two[1][0] && two[0][1] <= two[1][1]), "{pairs:?}");
    assert!(pairs[0][1] >= 80.0 / 50.0 - 1e-5 && pairs[99][1] <= 80.0 + 1e-4, "{pairs:?}");
}

#[test]
fn a_given_exposure_is_applied_and_recorded() {
    let folder = Folder::new();
    let picture = folder.file("grey.hdr", lamps(20, 20, "-vtv -vh 40 -vv 40"));
    let shown = Picture::read(&radsight(&["pcond", "-e", "4", &picture]).done()).expect("a picture");
    assert_eq!(shown.header().exposure(), Ok(2.0));
    let before = Picture::read(&folder.read("grey.hdr")).expect("a picture").values();
    let ratio = shown.values().pixel(10, 10)[0] / before.pixel(10, 10)[0];
    assert!((ratio - 4.0).abs() < 1e-4, "{ratio}");
}

#[test]
fn wrong_input_of_pcond_is_reported() {
    let folder = Folder::new();
    let picture = folder.file("grey.hdr", lamps(20, 20, "-vtv -vh 40 -vv 40"));
    let black = Image::new(8, 8, 3, vec![0.0; 192]).expect("a shape");
    let black =
        folder.file("black.hdr", Picture::from_rgb(Header::new("RADIANCE"), &black).expect("a picture").to_bytes());
    let wide = folder.file("wide.hdr", lamps(20, 20, "-vtv -vh 179.99 -vv 179.99"));
    let uncalibrated = folder.file("other.cal", "ro = 1\n");
    let check = |words: &[&str], input: &str, code: i32, message: &str| {
        let run = run_with(&mut command(words), input.as_bytes());
        assert_eq!(run.code, code, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?}: {}", run.messages);
        assert!(run.output.is_empty(), "{words:?} wrote something");
    };
    check(&["pcond"], "", 2, "no picture is given");
    check(&["pcond", "-q", &picture], "", 2, "option \"-q\" is unknown\nhint: expected -h -a");
    check(&["pcond", "-u", "0", &picture], "", 2, "option \"-u\" is followed by 0, expected more than");
    check(&["pcond", "-d", "1", &picture], "", 2, "expected more than 1");
    check(&["pcond", "-i", ".5", "-I", &picture], "", 2, "expected one");
    let lonely = folder.file("lonely.cwp", "1 2 3 4 5 6\n");
    check(&["pcond", "-m", "missing.cwp", &picture], "", 1, "missing.cwp");
    check(&["pcond", "-m", &lonely, &picture], "", 1, "expected two colours or more, with six numbers for each");
    check(&["pcond", "-m", &lonely, "-f", &uncalibrated, &picture], "", 1, "expected two colours");
    check(&["pcond", "-f", &uncalibrated, &picture], "", 1, "expected \"rxa(i)");
    check(&["pcond", &black], "", 1, "the picture is black");
    check(&["pcond", &wide], "", 1, "square degrees, expected at most");
    check(&["pcond", "-I", &picture], "1 2 2", 1, "an odd number of numbers");
    check(&["pcond", "-I", &picture], "1 2 1 3", 1, "do not increase");
    check(&["pcond", "-i", "1", &picture], "a b", 1, "\"a\" is not a number");
    check(&["pcond", "-x", "/nowhere/map", &picture], "", 3, "cannot write \"/nowhere/map\"");
    check(&["pcond", "missing.hdr"], "", 1, "cannot read \"missing.hdr\"");
}
