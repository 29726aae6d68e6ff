//! `falsecolor`: its colours and legend, and the pixels of the real one.

use crate::picture_programs::gradient;
use crate::program::{Folder, command, radsight_with, run_with};
use radsight_picture::{Encoding, Header, Image, Picture};
use radsight_test_support::Radiance;

#[test]
fn falsecolor_shows_a_value_in_its_colour_beside_a_legend() {
    let folder = Folder::new();
    let grey = Image::new(120, 250, 3, vec![0.5f32; 3 * 120 * 250]).expect("a shape");
    let picture = Picture::from_rgb(Header::new("RADIANCE"), &grey).expect("a picture").to_bytes();
    let file = folder.file("a.hdr", &picture);
    let run = |options: &str| {
        let words: Vec<&str> =
            ["falsecolor", "-i", &file, "-m", "1", "-s", "1"].into_iter().chain(options.split(' ')).collect();
        Picture::read(&radsight_with(&words, b"").done()).expect("a picture")
    };
    // The centre of the "spectrum": red 1.6/2 − 0.6, green 1.6 − 1.6/2, no blue.
    let spectrum = run("-pal spec");
    assert_eq!((spectrum.width(), spectrum.height()), (220, 250));
    let values = spectrum.values();
    let pixel = values.pixel(150, 100);
    for (found, expected) in pixel.iter().zip([0.2, 0.8, 0.0]) {
        assert!((found - expected).abs() < 0.01, "{pixel:?}");
    }
    assert_eq!(run("-lw 0").width(), 120);
    // A picture without edges has no contours.
    let lines = run("-cl -lw 0");
    assert!(lines.values().data().iter().all(|value| *value < 1e-6));
}

/// Viewers take the colours for what FORMAT says; palettes and legends are red, green and blue.
#[test]
fn falsecolor_of_xyze_and_of_spectra_is_that_of_the_converted_picture() {
    let folder = Folder::new();
    let rgb = folder.file("rgb.hdr", gradient(140, 60));
    let xyz = folder.file("xyz.hdr", radsight_with(&["ra_xyze", &rgb], b"").done());
    let spectra: Vec<f32> = (0..140 * 60 * 6).map(|i| 0.1 + (i % 840) as f32 / 840.0).collect();
    let spectra = Image::new(140, 60, 6, spectra).expect("a shape");
    let spectra = Picture::from_spectra(Header::new("RADIANCE"), &spectra, Encoding::USUAL_SPLITS).expect("a picture");
    let spectral = folder.file("spectral.hsr", spectra.to_bytes());
    for file in [xyz, spectral] {
        let converted = folder.file("converted.hdr", radsight_with(&["ra_xyze", "-r", &file], b"").done());
        for options in ["-i A", "-ip A -cl -s 30", "-i B -cb -p A", "-i A -e -s auto", "-i A -odim 1 1", "-i A -c0"] {
            let run = |picture: &str| {
                let file = |word| match word {
                    "A" => picture,
                    "B" => &rgb,
                    option => option,
                };
                let words: Vec<&str> = ["falsecolor"].into_iter().chain(options.split(' ').map(file)).collect();
                Picture::read(&radsight_with(&words, b"").done()).expect("a picture")
            };
            let (found, expected) = (run(&file), run(&converted));
            assert_eq!(found.encoding(), Encoding::Rgbe, "{options} of {file}");
            assert!(found.pixels() == expected.pixels(), "{options} of {file}");
        }
    }
}

/// Y of XYZE is in cd/m², so its scale is that of the picture in red, green and blue.
#[test]
fn falsecolor_of_xyze_has_the_scale_of_the_same_picture_in_rgbe() {
    let folder = Folder::new();
    let rgb = folder.file("rgb.hdr", gradient(140, 60));
    let xyz = folder.file("xyz.hdr", radsight_with(&["ra_xyze", &rgb], b"").done());
    let run = |file: &str| {
        let words = ["falsecolor", "-lw", "0", "-pal", "hot", "-s", "200", "-i", file];
        Picture::read(&radsight_with(&words, b"").done()).expect("a picture").values()
    };
    let (expected, found) = (run(&rgb), run(&xyz));
    let differences = expected.data().iter().zip(found.data()).map(|(a, b)| (a - b).abs());
    assert!(differences.fold(0.0, f32::max) < 0.05);
    assert!(expected.data().iter().any(|value| *value > 0.5) && expected.data().iter().any(|value| *value < 0.1));
}

#[test]
fn falsecolor_names_the_background_of_another_size() {
    let folder = Folder::new();
    let (picture, background) = (folder.file("a.hdr", gradient(40, 30)), folder.file("b.hdr", gradient(30, 40)));
    let run = radsight_with(&["falsecolor", "-i", &picture, "-p", &background], b"");
    assert_eq!(run.code, 1, "{}", run.messages);
    let message = format!("{background}: 30 x 40 pixels, expected 40 x 30 as in the first picture");
    assert!(run.messages.contains(&message), "{}", run.messages);
}

/// The real one is a script that is missing in some installations.
#[test]
fn falsecolor_has_the_pixels_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.hdr", gradient(140, 230));
    let words =
        |options: &'static str| -> Vec<&'static str> { ["falsecolor"].into_iter().chain(options.split(' ')).collect() };
    let found = radiance.command("falsecolor", &["-i", "a.hdr"]).current_dir(folder.path("")).output();
    if !found.is_ok_and(|output| output.status.success()) {
        println!("skipped: real falsecolor not found");
        return;
    }
    for options in [
        "-i a.hdr -s 100",
        "-ip a.hdr -cl -s 50",
        "-i a.hdr -cb -n 5 -s 20 -l Nits",
        "-i a.hdr -log 2 -s 500 -pal hot",
        "-i a.hdr -cp -pal eco",
        "-i a.hdr -e -s auto",
        "-i a.hdr -odim 2 5",
        "-i a.hdr -e -odim 2 3 -orct 5 10 135 220 -m 1",
    ] {
        let words = words(options);
        let real = run_with(radiance.command(words[0], &words[1..]).current_dir(folder.path("")), b"").done();
        let ours = run_with(command(&words).current_dir(folder.path("")), b"").done();
        let pixels = |bytes: &[u8]| Picture::read(bytes).expect("a picture").pixels().clone();
        assert!(pixels(&real) == pixels(&ours), "{words:?}");
    }
}

#[test]
fn values_are_written_over_a_part_of_the_picture() {
    let folder = Folder::new();
    let file = folder.file("a.hdr", gradient(240, 100));
    let run = |options: &str| {
        let words: Vec<&str> = ["falsecolor", "-lw", "0", "-i", &file].into_iter().chain(options.split(' ')).collect();
        radsight_with(&words, b"")
    };
    let plain = Picture::read(&run("-m 1").done()).expect("a picture").values();
    let written = Picture::read(&run("-m 1 -odim 2 2 -orct 120 0 240 100").done()).expect("a picture").values();
    let changed = |from: usize, to: usize| {
        // The values are one pixel higher than their shadow, as is the upper border.
        let differs = |at: &usize| plain.pixel(at % 240, at / 240) != written.pixel(at % 240, at / 240 + 1);
        (0..240 * 100).filter(|at| (from..to).contains(&(at % 240))).filter(differs).count()
    };
    assert_eq!(changed(0, 118), 0);
    assert!(changed(118, 240) > 100);
    for (options, message) in [
        ("-odim 40 40", "40 x 40 values do not fit with letters of 10 pixels in 240 x 100"),
        (
            "-odim 2 2 -orct 10 10 300 50",
            "\"-orct\" with 10 10 300 50: expected left, lower, right and upper border within 240 x 100",
        ),
        ("-odim 2 2 -orct 10 10 5 50", "\"-orct\" with 10 10 5 50"),
        ("-odim 2", "option \"-odim\" ends the command line"),
    ] {
        let run = run(options);
        assert_eq!((run.code, run.output.len()), (2, 0), "{options}: {}", run.messages);
        assert!(run.messages.contains(message), "{options}: {}", run.messages);
    }
}

#[test]
fn falsecolor_takes_functions_of_the_user() {
    let folder = Folder::new();
    let picture = folder.file("a.hdr", gradient(40, 33));
    let with = |options: &str| {
        let words = format!("falsecolor -lw 0 -i {picture} {options}");
        Picture::read(&radsight_with(&words.split(' ').collect::<Vec<_>>(), b"").done()).expect("a picture")
    };
    // The palette's own functions by name give the palette.
    assert_eq!(with("-pal hot").pixels(), with("-r hot_red(v) -g hot_grn(v) -b hot_blu(v)").pixels());
    let red = with("-r 1 -g 0 -b clip(-v)").values();
    assert!(red.pixels().all(|pixel| pixel[0] > 0.99 && pixel[1] < 0.01 && pixel[2] < 0.01));
    assert_eq!(radsight_with(&["falsecolor", "-r", "u+1", "-i", &picture], b"").code, 2);
    let palettes = Picture::read(&radsight_with(&["falsecolor", "-palettes"], b"").done()).expect("a picture");
    assert_eq!((palettes.width(), palettes.height()), (256, 300));
}
