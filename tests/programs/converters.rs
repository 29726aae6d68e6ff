//! What `ra_tiff`, `ra_bmp`, `ra_ppm` and `ra_rgbe` keep of a picture beside its pixels, and how
//! they treat spectra, colours outside the gamut and existing files: compared with the real
//! programs.

use crate::program::{Folder, Run, command, run_with};
use radsight_picture::{
    Header, Image, Orientation, Picture, Resolution, RgbPrimaries, Tiff, TiffColors, TiffCompression, TiffPixels,
    TiffTags, read_tiff_pixels, write_tiff_pixels,
};
use radsight_test_support::Radiance;

/// Whose programs run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Whose {
    Real,
    Ours,
}

use Whose::{Ours, Real};

/// Both programs in a folder with pictures.
struct Programs {
    radiance: Radiance,
    folder: Folder,
}

impl Programs {
    fn find() -> Option<Programs> {
        Some(Programs { radiance: Radiance::find()?, folder: Folder::new() })
    }

    fn run(&self, words: &str, whose: Whose) -> Run {
        let words: Vec<&str> = words.split(' ').collect();
        let mut program = match whose {
            Real => self.radiance.command(words[0], &words[1..]),
            Ours => command(&words),
        };
        run_with(program.current_dir(self.folder.path("")), b"")
    }

    /// Converts a file forth and back by each pair of programs.
    #[track_caller]
    fn round_trips(&self, forth: &str, back: &str) -> Vec<Picture> {
        let pairs = [(Real, Real), (Real, Ours), (Ours, Real), (Ours, Ours)];
        let round_trip = |(writer, reader)| {
            self.run(forth, writer).done();
            self.run(back, reader).done();
            Picture::read(&self.folder.read("back.hdr")).expect("a picture")
        };
        pairs.map(round_trip).to_vec()
    }
}

/// A picture with all properties that TIFF has tags for.
fn described() -> Picture {
    let value = |index: usize| ((index * 7919 % 1013) as f32 / 1013.0).powi(3) * 2.0;
    let values = Image::new(12, 7, 3, (0..12 * 7 * 3).map(value).collect()).expect("a shape");
    let mut header = Header::new("RADIANCE");
    header.push_variable("CAPDATE", " 2026:11:21 11:14:09");
    header.push_variable("OWNER", " Ada of the tower");
    header.push_variable("PRIMARIES", " .64 .33 .3 .6 .15 .06 .3127 .329");
    header.push_variable("PIXASPECT", "1.25");
    header.push_exposure(2.5);
    Picture::from_rgb(header, &values).expect("a picture")
}

/// The lines of a header that describe the picture, without commands.
fn properties(picture: &Picture) -> Vec<String> {
    let text = picture.header().to_text();
    text.lines().filter(|line| line.contains('=')).map(str::to_owned).collect()
}

#[test]
fn tiff_keeps_exposure_primaries_aspect_date_and_owner() {
    let Some(programs) = Programs::find() else { return };
    programs.folder.file("a.hdr", described().to_bytes());
    for forth in
        ["ra_tiff", "ra_tiff -w -e +2", "ra_tiff -f -e -1", "ra_tiff -z", "ra_tiff -L", "ra_tiff -b", "ra_tiff -b -f"]
    {
        for back in ["ra_tiff -r", "ra_tiff -r -x", "ra_tiff -r -e +3"] {
            let pictures = programs.round_trips(&format!("{forth} a.hdr a.tif"), &format!("{back} a.tif back.hdr"));
            let [real, ours @ ..] = &pictures[..] else { panic!("four pictures") };
            let lines = properties(real);
            assert!(lines.iter().any(|line| line.starts_with("EXPOSURE=")), "{lines:?}");
            for ours in ours {
                assert_eq!(properties(ours), lines, "{forth}, {back}");
            }
        }
    }
}

#[test]
fn tiff_of_tristimulus_values_and_without_exposure_says_how_bright_it_is() {
    let Some(programs) = Programs::find() else { return };
    let values = described().values();
    programs.folder.file("a.hdr", Picture::from_xyz(Header::new("RADIANCE"), &values).expect("a picture").to_bytes());
    programs.folder.file("b.hdr", Picture::from_rgb(Header::new("RADIANCE"), &values).expect("a picture").to_bytes());
    for (forth, back) in [
        ("ra_tiff a.hdr a.tif", "ra_tiff -r a.tif back.hdr"),
        ("ra_tiff -L a.hdr a.tif", "ra_tiff -r -x a.tif back.hdr"),
        ("ra_tiff -w b.hdr a.tif", "ra_tiff -r a.tif back.hdr"),
    ] {
        let pictures = programs.round_trips(forth, back);
        for ours in &pictures[1..] {
            assert_eq!(properties(ours), properties(&pictures[0]), "{forth}");
        }
    }
}

#[test]
fn a_tiff_without_a_scale_gives_a_picture_without_exposure() {
    let Some(programs) = Programs::find() else { return };
    let (resolution, pixels) = (Resolution::standard(2, 1), TiffPixels::Bytes(vec![10, 20, 30, 40, 50, 60]));
    let (colors, tags) = (TiffColors::Rgb, TiffTags::default());
    let tiff = Tiff { resolution, components: 3, pixels, colors, tags, header: None };
    programs.folder.file("a.tif", write_tiff_pixels(&tiff, TiffCompression::None).expect("a TIFF"));
    let read = |whose| {
        programs.run("ra_tiff -r -e +1 a.tif back.hdr", whose).done();
        Picture::read(&programs.folder.read("back.hdr")).expect("a picture")
    };
    let (real, ours) = (read(Real), read(Ours));
    assert_eq!((properties(&ours), ours.pixels()), (properties(&real), real.pixels()));
    assert_eq!(ours.header().variable("EXPOSURE"), None);
}

#[test]
fn tiff_keeps_each_orientation() {
    let Some(programs) = Programs::find() else { return };
    let mut picture = described();
    picture.header_mut().remove("PIXASPECT");
    for bits in 0..8 {
        let orientation =
            Orientation { scanlines_are_rows: bits & 4 != 0, x_falls: bits & 1 != 0, y_falls: bits & 2 != 0 };
        let resolution = Resolution { orientation, ..picture.resolution() };
        programs.folder.file("a.hdr", picture.to_bytes_in(resolution));
        for forth in ["ra_tiff a.hdr a.tif", "ra_tiff -L a.hdr a.tif"] {
            let pictures = programs.round_trips(forth, "ra_tiff -r a.tif back.hdr");
            for ours in &pictures {
                assert_eq!(ours.resolution(), resolution, "{forth}");
                assert_eq!(ours.pixels(), pictures[0].pixels(), "{forth}, {resolution}");
            }
        }
    }
}

#[test]
fn the_aspect_of_a_turned_picture_survives() {
    let folder = Folder::new();
    let picture = described();
    let turned = Orientation { scanlines_are_rows: false, x_falls: false, y_falls: true };
    let resolution = Resolution { orientation: turned, ..picture.resolution() };
    folder.file("a.hdr", picture.to_bytes_in(resolution));
    for words in [["ra_tiff", "a.hdr", "a.tif"].as_slice(), &["ra_tiff", "-r", "a.tif", "back.hdr"]] {
        run_with(command(words).current_dir(folder.path("")), b"").done();
    }
    let back = Picture::read(&folder.read("back.hdr")).expect("a picture");
    assert_eq!(back.header().variable("PIXASPECT").as_deref(), Some("1.250000"));
}

/// A spectrum of seven bands for each pixel.
fn spectra() -> Vec<u8> {
    let value = |index: usize| ((index * 7919 % 1013) as f32 / 1013.0).powi(2);
    let values = Image::new(20, 9, 7, (0..20 * 9 * 7).map(value).collect()).expect("a shape");
    let picture = Picture::from_spectra(Header::new("RADIANCE"), &values, [780.0, 588.0, 480.0, 380.0]);
    picture.expect("a picture").to_bytes()
}

/// Tristimulus values, some of them outside the gamut of RGB, some brighter than 1.
fn tristimulus_values() -> Vec<u8> {
    let value = |index: usize| ((index * 7919 % 1013) as f32 / 1013.0).powi(2) * 1.3;
    let values = Image::new(20, 9, 3, (0..20 * 9 * 3).map(value).collect()).expect("a shape");
    Picture::from_xyz(Header::new("RADIANCE"), &values).expect("a picture").to_bytes()
}

/// The values of a TIFF relative to their range, or as floats.
fn values(tiff: &[u8]) -> Vec<f32> {
    match read_tiff_pixels(tiff).expect("a TIFF").pixels {
        TiffPixels::Bytes(values) => values.into_iter().map(|value| f32::from(value) / 255.0).collect(),
        TiffPixels::Words(values) => values.into_iter().map(|value| f32::from(value) / 65535.0).collect(),
        TiffPixels::Floats(values) => values,
    }
}

/// Each value of the first TIFF must be this close to that of the second.
#[track_caller]
fn same_values(programs: &Programs, words: &str, bound: f32) {
    let tiffs = [Real, Ours].map(|whose| {
        programs.run(words, whose).done();
        values(&programs.folder.read("a.tif"))
    });
    assert_eq!(tiffs[0].len(), tiffs[1].len(), "{words}");
    for (real, ours) in tiffs[0].iter().zip(&tiffs[1]) {
        assert!((real - ours).abs() <= bound, "{words}: {ours}, expected {real}");
    }
}

#[test]
fn tiff_of_spectra_has_the_integrals_of_the_real_one() {
    let Some(programs) = Programs::find() else { return };
    programs.folder.file("a.hsr", spectra());
    // The real one has steps of 1/65535 in the integrals of the observer.
    for (words, bound) in [
        ("ra_tiff a.hsr a.tif", 1.0 / 255.0),
        ("ra_tiff -w a.hsr a.tif", 5e-4),
        ("ra_tiff -w -e +1 a.hsr a.tif", 5e-4),
        ("ra_tiff -f a.hsr a.tif", 1.5e-4),
        ("ra_tiff -L a.hsr a.tif", 2e-2),
    ] {
        same_values(&programs, words, bound);
    }
}

#[test]
fn grey_tiff_of_spectra_has_their_luminance() {
    let folder = Folder::new();
    folder.file("a.hsr", spectra());
    for words in [["ra_tiff", "-b", "-f", "a.hsr", "a.tif"].as_slice(), &["ra_xyze", "a.hsr", "a.xyz"]] {
        run_with(command(words).current_dir(folder.path("")), b"").done();
    }
    let xyz = Picture::read(&folder.read("a.xyz")).expect("a picture").values();
    for (grey, xyz) in values(&folder.read("a.tif")).iter().zip(xyz.pixels()) {
        assert!((grey - xyz[1]).abs() < 0.01 * xyz.iter().copied().fold(0.0, f32::max), "{grey} for {xyz:?}");
    }
}

#[test]
fn tiff_of_tristimulus_values_is_mapped_into_the_gamut() {
    let Some(programs) = Programs::find() else { return };
    programs.folder.file("a.xyz", tristimulus_values());
    for (words, bound) in [
        ("ra_tiff a.xyz a.tif", 1.0 / 255.0),
        ("ra_tiff -z -e -1 a.xyz a.tif", 1.0 / 255.0),
        // A gamma enlarges what rounding leaves of components that are 0.
        ("ra_tiff -w a.xyz a.tif", 1e-3),
        ("ra_tiff -w -g 1 -e -2 a.xyz a.tif", 2.0 / 65535.0),
        ("ra_tiff -f a.xyz a.tif", 1e-5),
        ("ra_tiff -L a.xyz a.tif", 2e-2),
        ("ra_tiff -b -w a.xyz a.tif", 2.0 / 65535.0),
        ("ra_tiff -b -f a.xyz a.tif", 1e-5),
    ] {
        same_values(&programs, words, bound);
    }
}

#[test]
fn pixmaps_and_png_of_tristimulus_values_have_the_pixels_of_tiff() {
    let folder = Folder::new();
    folder.file("a.xyz", tristimulus_values());
    let run = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        run_with(command(&words).current_dir(folder.path("")), b"").done()
    };
    for option in ["", "-b "] {
        run(&format!("ra_tiff {option}a.xyz a.tif"));
        let TiffPixels::Bytes(tiff) = read_tiff_pixels(&folder.read("a.tif")).expect("a TIFF").pixels else {
            panic!("bytes")
        };
        assert!(run(&format!("ra_ppm {option}a.xyz")).ends_with(&tiff), "{option}");
        let png = radsight_picture::read_png(&run(&format!("ra_png {option}a.xyz"))).expect("a picture");
        let stride = png.values.components() * 20 * 9 / tiff.len();
        let png: Vec<u16> = png.values.data().iter().copied().step_by(stride).collect();
        assert!(png.iter().zip(&tiff).all(|(a, b)| *a == u16::from(*b)), "{option}");
    }
}

#[test]
fn log_luv_keeps_colours_outside_the_gamut_as_tristimulus_values() {
    let Some(programs) = Programs::find() else { return };
    programs.folder.file("a.xyz", tristimulus_values());
    let pictures = programs.round_trips("ra_tiff -L a.xyz a.tif", "ra_tiff -r -x a.tif back.hdr");
    for ours in &pictures[1..] {
        for (real, ours) in pictures[0].values().pixels().zip(ours.values().pixels()) {
            let step = real.iter().copied().fold(0.0, f32::max) / 50.0;
            assert!(real.iter().zip(ours).all(|(a, b)| (a - b).abs() <= step), "{ours:?}, expected {real:?}");
        }
    }
}

#[test]
fn bitmaps_keep_the_header_gamma_and_primaries() {
    let Some(programs) = Programs::find() else { return };
    programs.folder.file("a.hdr", described().to_bytes());
    for forth in [
        "ra_bmp a.hdr a.bmp",
        "ra_bmp -b a.hdr a.bmp",
        "ra_bmp -g 1.5 a.hdr a.bmp",
        "ra_bmp -p .7 .3 .2 .7 .14 .05 .3333 .3333 a.hdr a.bmp",
    ] {
        let pictures = programs.round_trips(forth, "ra_bmp -r a.bmp back.hdr");
        let lines = properties(&pictures[0]);
        assert!(lines.iter().any(|line| line.starts_with("OWNER=")), "{lines:?}");
        for ours in &pictures[1..] {
            assert_eq!(properties(ours), lines, "{forth}");
            for (real, ours) in pictures[0].pixels().pixels().zip(ours.pixels().pixels()) {
                let values = [real, ours].map(Vec::from);
                assert!(near(&values), "{forth}: {ours:?}, expected {real:?}");
            }
        }
    }
    programs.run("ra_bmp -e auto a.hdr a.bmp", Ours).done();
    programs.run("ra_bmp -r a.bmp back.hdr", Real).done();
    let toned = Picture::read(&programs.folder.read("back.hdr")).expect("a picture");
    let noted = toned.header().primaries().expect("primaries").expect("a line of primaries");
    assert_eq!(noted.to_header_value(), RgbPrimaries::STANDARD.to_header_value());
}

/// Whether two pixels made from bytes differ by at most one step of a byte.
fn near(pixels: &[Vec<u8>; 2]) -> bool {
    let bytes = pixels.clone().map(|pixel| {
        let pixel = [pixel[0], pixel[1], pixel[2], pixel[3]];
        radsight_picture::decode_rgbe(pixel).map(|value| 255.0 * value.powf(1.0 / 2.2))
    });
    (0..3).all(|i| (bytes[0][i] - bytes[1][i]).abs() < 2.5)
}

#[test]
fn lines_in_a_bitmap_that_are_no_header_are_ignored() {
    let folder = Folder::new();
    folder.file("a.hdr", described().to_bytes());
    let run = |words: &[&str]| run_with(command(words).current_dir(folder.path("")), b"");
    run(&["ra_bmp", "a.hdr", "a.bmp"]).done();
    let bitmap = folder.read("a.bmp");
    let end = u32::from_le_bytes([bitmap[10], bitmap[11], bitmap[12], bitmap[13]]) as usize;
    for (at, byte) in [(end - 1, b'\n'), (end - 20, b'\0'), (end - 2, b' ')] {
        let mut changed = bitmap.clone();
        changed[at] = byte;
        folder.file("b.bmp", &changed);
        let back = Picture::read(&run(&["ra_bmp", "-r", "b.bmp"]).done()).expect("a picture");
        assert_eq!(back.header().variable("OWNER"), None);
    }
}

#[test]
fn ra_rgbe_keeps_existing_files_as_the_real_one() {
    let Some(programs) = Programs::find() else { return };
    let frame = |exposure: f64| {
        let mut picture = described();
        picture.header_mut().push_exposure(exposure);
        picture.to_bytes()
    };
    programs.folder.file("two.hdr", [frame(1.0), frame(3.0)].concat());
    for whose in [Real, Ours] {
        let name = if whose == Real { "real%d.hdr" } else { "ours%d.hdr" };
        let run = programs.run(&format!("ra_rgbe two.hdr {name}"), whose);
        assert_eq!(run.code, 1, "{}", run.messages);
        assert!(run.messages.contains("exists"), "{}", run.messages);
        let first = programs.folder.read(&name.replace("%d", "0"));
        assert_eq!(Picture::read(&first).expect("a picture").header().exposure(), Ok(2.5));

        programs.folder.file("old.hdr", "old");
        assert_eq!(programs.run("ra_rgbe two.hdr old.hdr", whose).code, 1);
        assert_eq!(programs.folder.read("old.hdr"), b"old");
        programs.run("ra_rgbe -f two.hdr old.hdr", whose).done();
        assert!(Picture::read(&programs.folder.read("old.hdr")).is_ok());
    }
}
