//! Compares Radiance's picture programs with the real ones: the same bytes, for pictures of all
//! kinds.

use crate::program::{Folder, Run, command, radsight_with, run_with};
use radsight_picture::{FileFormat, Header, Image, Picture, write_image};
use radsight_test_support::Radiance;
use std::path::PathBuf;

/// Published pictures that are small enough for many runs, and one of a single line.
fn pictures() -> Vec<Vec<u8>> {
    const LARGEST: u64 = 150_000;
    const MOST: usize = 8;
    let shared = std::env::var_os("RADSIGHT_SHARED").map(|folder| PathBuf::from(folder).join("radiance/loose/hdr"));
    let mut paths: Vec<PathBuf> = match shared.and_then(|folder| folder.read_dir().ok()) {
        Some(entries) => entries.map(|entry| entry.expect("an entry").path()).collect(),
        None => Vec::new(),
    };
    paths.retain(|path| path.metadata().is_ok_and(|found| found.len() < LARGEST));
    paths.sort();
    paths.truncate(MOST);
    let mut pictures: Vec<Vec<u8>> = paths.iter().map(|path| std::fs::read(path).expect("a picture")).collect();
    pictures.push(gradient(40, 33));
    pictures.push(gradient(5, 1));
    pictures
}

/// A picture with a wide range of values. Without a COLORCORR: the real programs divide by it with
/// less precision than a float.
pub(crate) fn gradient(width: usize, height: usize) -> Vec<u8> {
    let value = |index: usize| ((index * 7919 % 1013) as f32 / 1013.0).powi(9) * 300.0;
    let values = Image::new(width, height, 3, (0..width * height * 3).map(value).collect()).expect("a shape");
    let mut header = Header::new("RADIANCE");
    header.push_line("VIEW= -vtv -vp 1 2 3 -vd 0 1 0 -vu 0 0 1 -vh 40 -vv 30");
    header.push_exposure(2.5);
    Picture::from_rgb(header, &values).expect("a picture").to_bytes()
}

/// Removes the time from a header.
fn without_dates(bytes: &[u8]) -> Vec<u8> {
    let dated = |line: &&[u8]| !line.starts_with(b"CAPDATE=") && !line.starts_with(b"GMT=");
    // The first lines are the header; pixels may hold anything.
    let mut parts: Vec<&[u8]> = bytes.splitn(40, |byte| *byte == b'\n').collect();
    parts.retain(dated);
    parts.join(&b'\n')
}

/// Runs both with the same words and input; the outputs must be the same.
#[track_caller]
fn same(radiance: &Radiance, words: &[&str], input: &[u8]) -> Vec<u8> {
    let real = run_with(&mut radiance.command(words[0], &words[1..]), input);
    let ours = radsight_with(words, input);
    let (real, ours) = (worked(real, words), worked(ours, words));
    assert!(without_dates(&real) == without_dates(&ours), "{words:?} gives other bytes");
    ours
}

/// As [`same`], in a folder.
#[track_caller]
fn same_in(radiance: &Radiance, folder: &Folder, words: &[&str], input: &[u8]) {
    let real = run_with(radiance.command(words[0], &words[1..]).current_dir(folder.path("")), input);
    let ours = run_with(command(words).current_dir(folder.path("")), input);
    let (real, ours) = (worked(real, words), worked(ours, words));
    assert!(without_dates(&real) == without_dates(&ours), "{words:?} gives other bytes");
}

#[track_caller]
fn worked(run: Run, words: &[&str]) -> Vec<u8> {
    assert_eq!(run.code, 0, "{words:?}: {}", run.messages);
    run.output
}

#[test]
fn pfilt_gives_the_bytes_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    for picture in pictures() {
        for options in [
            "-1",
            "-x /2 -y /2",
            "-x 70 -y 90 -p 1",
            "-x 30 -y 9 -c",
            "-r .6 -x /3 -y /2",
            "-1 -e +2 -r .7",
            "-1 -er 2 -eb .5",
            "-1 -n 6 -h .3 -s .001",
            "-a -e .3",
            "-x 90 -y 70 -r 1",
            "-1 -m .25 -x /2 -y /2",
        ] {
            let words: Vec<&str> = std::iter::once("pfilt").chain(options.split(' ')).collect();
            if options.contains("-m") && !even(&picture) {
                continue;
            }
            same(&radiance, &words, &picture);
        }
    }
}

/// Whether both sizes are even. If rows do not coincide, the real `pfilt -m` averages a row that it
/// has not read yet.
fn even(picture: &[u8]) -> bool {
    let picture = Picture::read(picture).expect("a picture");
    picture.width().is_multiple_of(2) && picture.height().is_multiple_of(2)
}

#[test]
fn pvalue_gives_the_bytes_of_the_real_one_both_ways() {
    let Some(radiance) = Radiance::find() else { return };
    for picture in pictures() {
        for options in [
            "-o",
            "-O -d",
            "-h -H -d",
            "-b",
            "-b -o -d",
            "-u -d",
            "-di",
            "-db",
            "-dW -H",
            "-dF",
            "-dd -b",
            "-pg -dd",
            "-g 2.2 -d",
            "-e +1 -d",
            "-R -df",
            "-o -h -df -H",
            "+di",
        ] {
            let words: Vec<&str> = std::iter::once("pvalue").chain(options.split(' ')).collect();
            same(&radiance, &words, &picture);
        }
        for (there, back) in [
            ("-df", "-r"),
            ("-d", "-r"),
            ("+da", "-r"),
            ("-df -b", "-r"),
            ("-o -df", "-r -e .1"),
            ("-h -df", "-r -h -df -u"),
            ("-dd -o", "-r -pXYZ -O"),
            ("-di", "-r -di"),
            ("-h -dw -R", "-r -h -dw -R -g 1.5"),
        ] {
            let there: Vec<&str> = std::iter::once("pvalue").chain(there.split(' ')).collect();
            let back: Vec<&str> = std::iter::once("pvalue").chain(back.split(' ')).collect();
            let numbers = same(&radiance, &there, &picture);
            same(&radiance, &back, &numbers);
        }
    }
}

#[test]
fn getinfo_gives_the_bytes_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    for picture in pictures() {
        same(&radiance, &["getinfo"], &picture);
        same(&radiance, &["getinfo", "-d"], &picture);
        same(&radiance, &["getinfo", "+d"], &picture);
        same(&radiance, &["getinfo", "-"], &picture);
        same(&radiance, &["getinfo", "-d", "-"], &picture);
        same(&radiance, &["getinfo", "-a", "VIEW= -vtv", "hello"], &picture);
        same(&radiance, &["getinfo", "-r", "EXPOSURE=3", "VIEW="], &picture);
        same(&radiance, &["getinfo", "-c", "wc", "-c"], &picture);
    }
}

#[test]
fn pcomb_gives_the_bytes_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let (first, second) = (folder.file("a.hdr", gradient(40, 33)), folder.file("b.hdr", gradient(40, 33)));
    let (a, b) = (first.as_str(), second.as_str());
    for words in [
        &[a][..],
        &["-o", a],
        &["-s", ".5", a, "-o", "-s", "2", b],
        &["-c", "1", ".5", "2", a],
        &["-h", a],
        &["-e", "lo=li(1)", a],
        &["-e", "ro=gi(1);go=bi(1);bo=ri(1)*x/xmax", a],
        &["-e", "lo=(li(1)+li(1,1)+li(1,-1)+li(1,0,1)+li(1,0,-1))/5", a],
        &["-e", "lo=max(ri(1,5,70),ri(1,-5,-70))", a],
        &["-x", "xmax/2", "-y", "ymax/3", a],
        &["-x", "50", "-y", "30", "-e", "lo=x*y/30000"],
        &["-ff", "-e", "lo=li(1)-.3", a],
        &["-ff", a],
        &["-e", "ro=Dx(1)+1;go=Dy(1)+1;bo=Dz(1)+1", a],
        &["-e", "ro=S(1)*1e4;go=T(1);bo=le(1)", a],
        &["-e", "lo=if(li(1)-.5,li(1),re(2)+pa(1)+nfiles)", a, b],
        &["-e", "sum=sum+li(1);lo=WE*sum", a],
        &["!cat a.hdr", b],
    ] {
        let words: Vec<&str> = std::iter::once("pcomb").chain(words.iter().copied()).collect();
        same_in(&radiance, &folder, &words, b"");
    }
    let floats = same(&radiance, &["pcomb", "-ff", a], b"");
    same(&radiance, &["pcomb", "-ff", "-fc", a], b"");
    same(&radiance, &["pvalue", "-pRGB", a], b"");
    same(&radiance, &["pcomb", "-e", "lo=li(1)", "-"], &floats);
}

#[test]
fn pcompos_gives_the_bytes_of_the_real_one() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.hdr", gradient(40, 33));
    folder.file("b.hdr", gradient(25, 50));
    for words in [
        "a.hdr 0 0 b.hdr 40 0",
        "-a 2 a.hdr b.hdr a.hdr",
        "-a -2 -s 5 a.hdr b.hdr a.hdr",
        "-x 60 -y 40 -b .5 .2 .1 a.hdr -5 -2",
        "-h a.hdr 0 0 +t .3 b.hdr 3 4",
        "-t .2 a.hdr 0 0 =+- b.hdr 40 0",
        "=00 a.hdr 30 20 b.hdr 1 2",
        "-a 2 -o 20 10 a.hdr b.hdr",
    ] {
        let words: Vec<&str> = std::iter::once("pcompos").chain(words.split(' ')).collect();
        same_in(&radiance, &folder, &words, b"");
    }
}

#[test]
fn turned_pictures_and_extrema_are_those_of_the_real_programs() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.hdr", gradient(40, 33));
    for words in [
        "pflip -h a.hdr",
        "pflip -v a.hdr",
        "pflip -h -v -c a.hdr",
        "pextrem a.hdr",
        "pextrem -o a.hdr",
        "pextrem -O a.hdr",
    ] {
        same_in(&radiance, &folder, &words.split(' ').collect::<Vec<_>>(), b"");
    }
    for options in ["", " -r", " -c", " -r -c"] {
        let words = format!("protate{options} a.hdr turned.hdr");
        let words: Vec<&str> = words.split(' ').collect();
        let mut real = radiance.command(words[0], &words[1..]);
        run_with(real.current_dir(folder.path("")), b"").done();
        // The real one puts its path into the header.
        let real = Picture::read(&folder.read("turned.hdr")).expect("a picture");
        run_with(command(&words).current_dir(folder.path("")), b"").done();
        let ours = Picture::read(&folder.read("turned.hdr")).expect("a picture");
        assert_eq!((real.pixels(), real.resolution()), (ours.pixels(), ours.resolution()), "{words:?}");
    }
}

#[test]
fn signs_have_the_pixels_of_the_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let Some(shared) = std::env::var_os("RADSIGHT_SHARED") else {
        println!("skipped: RADSIGHT_SHARED is not set");
        return;
    };
    let font = PathBuf::from(shared).join("radiance/loose/fnt/helvet.fnt").display().to_string();
    for words in [
        &["hello"][..],
        &["-s", "-.15", "-cf", "1", "1", "1", "-cb", "0", "0", "0", "-h", "20", "cd/m2"],
        &["-a", "2", "-x", "200", "-y", "24", "-s", "-.15", "some label text"],
        &["-s", ".2", "two   words", "and tab"],
        &["-du", "up"],
        &["-dl", "left"],
        &["-dd", "-h", "50", "Down gq"],
        &["-x", "120", "-a", "0", "-y", "40", "fill"],
    ] {
        let words: Vec<&str> = ["psign", "-f", &font].into_iter().chain(words.iter().copied()).collect();
        let real = run_with(&mut radiance.command(words[0], &words[1..]), b"").done();
        let ours = radsight_with(&words, b"").done();
        let pixels = |bytes: &[u8]| Picture::read(bytes).expect("a picture").pixels().clone();
        assert!(pixels(&real) == pixels(&ours), "{words:?}");
    }
}

#[test]
fn pixmaps_are_those_of_the_real_program_both_ways() {
    let Some(radiance) = Radiance::find() else { return };
    let picture = gradient(40, 33);
    for options in ["", " -b", " -a", " -a -b", " -s 65535", " -s 1000 -a -g 1", " -e +2", " -e -3 -g 1.8"] {
        let words = format!("ra_ppm{options}");
        let pixmap = same(&radiance, &words.split(' ').collect::<Vec<_>>(), &picture);
        same(&radiance, &["ra_ppm", "-r"], &pixmap);
        same(&radiance, &["ra_ppm", "-r", "-e", "+1", "-g", "1.5"], &pixmap);
    }
}

#[test]
fn bitmaps_and_tiff_go_to_the_real_programs_and_back() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.hdr", gradient(40, 33));
    let run = |words: &str, is_real: bool| -> Run {
        let words: Vec<&str> = words.split(' ').collect();
        let mut command = if is_real { radiance.command(words[0], &words[1..]) } else { command(&words) };
        run_with(command.current_dir(folder.path("")), b"")
    };
    for (forward, back, file) in [
        ("ra_bmp a.hdr", "ra_bmp -r", "out.bmp"),
        ("ra_bmp -b -e +1 a.hdr", "ra_bmp -r", "out.bmp"),
        ("ra_bmp -e -1 -p .64 .33 .3 .6 .15 .06 .3127 .329 a.hdr", "ra_bmp -r", "out.bmp"),
        ("ra_tiff a.hdr", "ra_tiff -r", "out.tif"),
        ("ra_tiff -b a.hdr", "ra_tiff -r", "out.tif"),
        ("ra_tiff -w a.hdr", "ra_tiff -r", "out.tif"),
        ("ra_tiff -f a.hdr", "ra_tiff -r", "out.tif"),
        ("ra_tiff -z -e -1 a.hdr", "ra_tiff -r", "out.tif"),
    ] {
        let mut pictures = Vec::new();
        for (writer, reader) in [(true, true), (true, false), (false, true), (false, false)] {
            run(&format!("{forward} {file}"), writer).done();
            run(&format!("{back} {file} back.hdr"), reader).done();
            pictures.push(Picture::read(&folder.read("back.hdr")).expect("a picture").pixels().clone());
        }
        assert!(pictures.windows(2).all(|pair| pair[0] == pair[1]), "{forward}");
    }
}

/// A bitmap of 4 x 2 pixels with 8 bits and a palette of red and white, with packed rows.
fn packed_bitmap(rows: &[u8]) -> Vec<u8> {
    let mut bytes = b"BM".to_vec();
    for number in [62 + rows.len() as u32, 0, 62, 40, 4, 2, 8 << 16 | 1, 1, rows.len() as u32, 0, 0, 2, 0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([0, 0, 255, 0, 255, 255, 255, 0]);
    bytes.extend(rows);
    bytes
}

#[test]
fn packed_bitmaps_are_read() {
    // Rows from the bottom: four of the second colour; three of the first and one of the second.
    let bitmap = packed_bitmap(&[4, 1, 0, 0, 3, 0, 1, 1, 0, 1]);
    let picture = Picture::read(&radsight_with(&["ra_bmp", "-r"], &bitmap).done()).expect("a picture");
    let values = picture.values();
    let is_white = |column: usize, row: usize| values.pixel(column, row)[1] > 0.9;
    assert_eq!((picture.width(), picture.height()), (4, 2));
    let white: Vec<bool> = (0..8).map(|at| is_white(at % 4, at / 4)).collect();
    assert_eq!(white, [false, false, false, true, true, true, true, true]);
}

/// A picture of one grey level with lines in its header.
fn plain(size: [usize; 2], lines: &[&str]) -> Vec<u8> {
    let mut header = Header::new("RADIANCE");
    lines.iter().for_each(|line| header.push_line(line));
    let image = Image::filled(size[0], size[1], 3, 0.5f32).expect("a shape");
    Picture::from_rgb(header, &image).expect("a picture").to_bytes()
}

#[test]
fn messages_name_the_picture_and_the_line() {
    let folder = Folder::new();
    folder.file("a.hdr", plain([4, 3], &[]));
    folder.file("small.hdr", plain([2, 2], &[]));
    folder.file("collinear.hdr", plain([4, 3], &["A=1", "PRIMARIES= .1 .1 .2 .2 .3 .3 .33 .33"]));
    folder.file("dark.hdr", plain([4, 3], &["EXPOSURE=1e-30", "EXPOSURE=1e-30"]));
    for (words, message) in [
        ("pcomb a.hdr a.hdr small.hdr", "small.hdr: 2 x 2 pixels, expected 4 x 3 as in the first picture"),
        ("pcompos a.hdr 0", "picture \"a.hdr\" is followed by the end of the command line, expected its position"),
        ("pcompos a.hdr 0 b.hdr 0 0", "picture \"a.hdr\" is followed by \"b.hdr\", expected its position"),
        ("ra_bmp collinear.hdr", "collinear.hdr: header line 3: PRIMARIES is \" 0.1000 0.1000 0.2000"),
        ("pvalue -o dark.hdr", "header line 3: EXPOSURE is \"1e-30\", expected all such values together within"),
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let run = run_with(command(&words).current_dir(folder.path("")), b"");
        assert!(run.code > 0 && run.messages.contains(message), "{words:?}: {}", run.messages);
    }
}

#[test]
fn truncated_bitmaps_are_reported() {
    let mut huge = packed_bitmap(&[4, 1, 0, 1]);
    huge[18..22].copy_from_slice(&60_000u32.to_le_bytes());
    huge[22..26].copy_from_slice(&60_000u32.to_le_bytes());
    let short = &packed_bitmap(&[4, 1])[..40];
    for (bytes, message) in [(&huge[..], "ends before 60000 x 60000 pixels"), (short, "cannot read the bitmap")] {
        let run = radsight_with(&["ra_bmp", "-r"], bytes);
        assert_eq!(run.code, 1);
        assert!(run.messages.contains(message), "{}", run.messages);
    }
}

#[test]
fn tiff_becomes_tristimulus_values_as_in_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.hdr", gradient(40, 33));
    for form in ["-z", "-w", "-f"] {
        let mut program = command(&["ra_tiff", form, "a.hdr", "a.tif"]);
        run_with(program.current_dir(folder.path("")), b"").done();
        let words = ["ra_tiff", "-r", "-x", "a.tif", "a.xyz"];
        let pictures = [true, false].map(|is_real| {
            let mut program = if is_real { radiance.command(words[0], &words[1..]) } else { command(&words) };
            run_with(program.current_dir(folder.path("")), b"").done();
            Picture::read(&folder.read("a.xyz")).expect("a picture")
        });
        let [real, ours] = &pictures;
        assert_eq!(ours.header().format().as_deref(), Some("32-bit_rle_xyze"), "{form}");
        for (real, ours) in real.values().pixels().zip(ours.values().pixels()) {
            let step = real.iter().copied().fold(0.0, f32::max) / 100.0;
            assert!(real.iter().zip(ours).all(|(a, b)| (a - b).abs() <= step), "{form}: {ours:?}, expected {real:?}");
        }
    }
}

#[test]
fn tristimulus_values_are_within_a_step_of_the_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let rgb = gradient(40, 33);
    let value = |index: usize| ((index * 7919 % 1013) as f32 / 1013.0).powi(3) * 30.0;
    let values = Image::new(20, 9, 7, (0..20 * 9 * 7).map(value).collect()).expect("a shape");
    let spectra = Picture::from_spectra(Header::new("RADIANCE"), &values, [780.0, 588.0, 480.0, 380.0]);
    let spectra = spectra.expect("a picture").to_bytes();
    for (words, picture) in [
        ("ra_xyze", &rgb),
        ("ra_xyze -o", &rgb),
        ("ra_xyze -e +1 -c", &rgb),
        ("ra_xyze -r", &rgb),
        ("ra_xyze", &spectra),
        ("ra_xyze -o -c", &spectra),
        ("ra_xyze -r", &spectra),
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let real = run_with(&mut radiance.command(words[0], &words[1..]), picture).done();
        let ours = radsight_with(&words, picture).done();
        let (real, ours) = (Picture::read(&real).expect("a picture"), Picture::read(&ours).expect("a picture"));
        let lines = |picture: &Picture| picture.header().to_text();
        assert_eq!(lines(&real), lines(&ours));
        for (a, b) in real.pixels().pixels().zip(ours.pixels().pixels()) {
            // The real one computes with less precision than a float.
            let same = a[3] == b[3] && (0..3).all(|i| a[i].abs_diff(b[i]) <= 1);
            assert!(same || a[3].abs_diff(b[3]) == 1, "{words:?}: {a:?} {b:?}");
        }
    }
    for words in [&["ra_rgbe", "-e", "+2"][..], &["ra_rgbe", "-r"]] {
        // The real one puts its path into the header.
        let real = run_with(&mut radiance.command(words[0], &words[1..]), &rgb).done();
        let (real, ours) = (Picture::read(&real), Picture::read(&radsight_with(words, &rgb).done()));
        assert_eq!(real.expect("a picture").pixels(), ours.expect("a picture").pixels(), "{words:?}");
    }
}

#[test]
fn pcompos_refuses_positions_beyond_those_of_radiance() {
    let folder = Folder::new();
    let picture = folder.file("a.hdr", gradient(8, 6));
    for options in ["A 0 99999999999", "A -3e9 0", "-x 5 -y 5 A 9e99 9e99", "-y 99999999999 A 0 0", "-a 1 -s 1e300 A A"]
    {
        let options = options.replace('A', &picture);
        let words: Vec<&str> = ["pcompos"].into_iter().chain(options.split(' ')).collect();
        let run = radsight_with(&words, b"");
        assert_eq!((run.code, run.output.len()), (2, 0), "{options}: {}", run.messages);
        let message = "expected a number of pixels from -2147483647 to 2147483647";
        assert!(run.messages.contains(message), "{options}: {}", run.messages);
    }
}

#[test]
fn frames_of_an_animation_are_taken_apart() {
    let Some(radiance) = Radiance::find() else { return };
    let frame = |number: usize| {
        let mut picture = Picture::read(&gradient(20 + number, 9)).expect("a picture");
        picture.header_mut().push_variable("FRAME", &number.to_string());
        picture.to_bytes()
    };
    let animation: Vec<u8> = [1, 2, 4].into_iter().flat_map(frame).collect();
    for words in ["ra_rgbe -n 2", "ra_rgbe -r -n 4", "ra_rgbe -n 3", "ra_rgbe -e +1 -r", "ra_rgbe"] {
        let words: Vec<&str> = words.split(' ').collect();
        let mut program = radiance.command(words[0], &words[1..]);
        // Real ra_rgbe writes the full path of its call.
        let path = program.get_program().to_string_lossy().into_owned();
        let real = without_dates(&worked(run_with(&mut program, &animation), &words));
        let ours = without_dates(&worked(radsight_with(&words, &animation), &words));
        let bytes = |text: &[u8]| text.iter().map(|byte| char::from(*byte)).collect::<String>();
        assert!(bytes(&real).replace(&path, "ra_rgbe") == bytes(&ours), "{words:?} gives other bytes");
    }
    let folder = Folder::new();
    folder.file("all.hdr", &animation);
    let mut program = command(&["ra_rgbe", "all.hdr", "f%02d.hdr"]);
    run_with(program.current_dir(folder.path("")), b"").done();
    assert_eq!(folder.names(), ["all.hdr", "f01.hdr", "f02.hdr", "f04.hdr"]);
    let torn = run_with(&mut command(&["ra_rgbe", "-n", "4"]), &animation[..animation.len() - 9]);
    assert_eq!(torn.code, 1, "{}", torn.messages);
}

#[test]
fn a_picture_that_ends_early_is_filtered_as_far_as_it_goes() {
    let picture = gradient(40, 33);
    let run = radsight_with(&["pfilt", "-x", "/2", "-y", "/2"], &picture[..picture.len() / 2]);
    assert_eq!(run.code, 1);
    assert!(run.messages.contains("warning - partial frame ("), "{}", run.messages);
    assert!(Picture::read(&run.output).is_ok_and(|picture| picture.height() < 16));
}

#[test]
fn a_wrong_option_is_named() {
    for (words, message) in [
        (&["pfilt", "-q"][..], "radsight: pfilt: option \"-q\" is unknown"),
        (&["pfilt", "-x"], "radsight: pfilt: option \"-x\" ends the command line"),
        (&["pfilt", "-r", "wide"], "radsight: pfilt: option \"-r\" is followed by \"wide\", expected a number"),
        (
            &["ra_bmp", "-p", ".64", "green"],
            "radsight: ra_bmp: option \"-p\" is followed by \"green\", expected eight numbers: x and y of red",
        ),
        (
            &["pcond", "-p", ".64", ".33"],
            "radsight: pcond: option \"-p\" ends the command line, expected eight numbers: x and y of red",
        ),
        (&["pvalue", "-dq"], "radsight: pvalue: option \"-dq\" is unknown"),
    ] {
        let run = run_with(&mut command(words), b"");
        assert_eq!(run.code, 2, "{words:?}");
        assert!(run.messages.starts_with(message), "{}", run.messages);
    }
}

#[test]
fn the_light_of_a_lamp_becomes_white_as_in_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let table = folder.file("lamp.tab", "/yellow/ .5 .42 .8\n/blue[- ]lamp/ .25 .25 1\n/gold/ (yellow)\n");
    for lamp in ["gold", "a Blue lamp"] {
        let words = ["pfilt", "-1", "-e", "2", "-f", &table, "-t", lamp];
        let picture = gradient(40, 33);
        let real = run_with(&mut radiance.command(words[0], &words[1..]), &picture).done();
        let ours = radsight_with(&words, &picture).done();
        let (real, ours) = (Picture::read(&real).expect("a picture"), Picture::read(&ours).expect("a picture"));
        // The chromaticity passes a matrix in single precision there.
        let scale = |picture: &Picture| picture.header().radiance_scale().expect("a scale");
        for (a, b) in scale(&real).iter().zip(scale(&ours)) {
            assert!((a - b).abs() < 1e-4 * b, "{lamp}: {a} {b}");
        }
        for (a, b) in real.values().data().iter().zip(ours.values().data()) {
            assert!((a - b).abs() <= 0.01 * a.max(1e-6) || (a - b).abs() < 1e-3, "{lamp}: {a} {b}");
        }
    }
    let run = radsight_with(&["pfilt", "-f", &table, "-t", "none"], &gradient(5, 1));
    assert_eq!((run.code, run.messages.trim()), (1, &*format!("radsight: pfilt: no lamp is \"none\" in {table}")));
}

#[test]
fn png_files_hold_the_bytes_of_a_pixmap() {
    let folder = Folder::new();
    let picture = folder.file("a.hdr", gradient(40, 33));
    for options in ["", "-b", "-g 1.8 -e +1"] {
        let words = |program| -> Vec<String> {
            format!("{program} {options} {picture}").split_whitespace().map(str::to_owned).collect()
        };
        let run = |program| radsight_with(&words(program).iter().map(String::as_str).collect::<Vec<_>>(), b"").done();
        let (png, pixmap) = (run("ra_png"), run("ra_ppm"));
        let png = radsight_picture::read_png(&png).expect("a PNG");
        let stored: Vec<u8> = png.values.data().iter().map(|value| *value as u8).collect();
        assert!(pixmap.ends_with(&stored), "{options}");
        assert_eq!((png.values.width(), png.values.height(), png.bits), (40, 33, 8));
        assert!(png.header.is_some_and(|header| header.to_text().contains("VIEW=")));
    }
}

#[test]
fn pcomb_makes_a_radiance_picture_of_float_formats() {
    let folder = Folder::new();
    // Values that a Radiance picture holds exactly.
    let values: Vec<f32> = (0..18).map(|index| (128.5 + index as f32) / 128.0).collect();
    let image = Image::new(3, 2, 3, values.clone()).expect("a shape");
    for (name, format) in [("a.exr", FileFormat::Exr), ("a.pfm", FileFormat::Pfm), ("a.npy", FileFormat::Npy)] {
        let bytes = write_image(format, &Header::new("RADIANCE"), &image).expect("three components");
        std::fs::write(folder.path(name), &bytes).expect("a file");
        let words = ["pcomb", name];
        let made = worked(run_with(command(&words).current_dir(folder.path("")), &[]), &words);
        let picture = Picture::read(&made).expect("a picture").radiance().expect("an exposure");
        assert_eq!((picture.width(), picture.height()), (3, 2), "{name}");
        assert_eq!(picture.data(), values, "{name}");
        let piped = worked(radsight_with(&["pcomb", "-"], &bytes), &["pcomb", "-"]);
        assert_eq!(Picture::read(&piped).expect("a picture").radiance().expect("an exposure").data(), values);
    }
}

#[test]
fn a_picture_of_another_format_is_named_with_its_converter() {
    let image = Image::new(2, 1, 3, vec![0.5f32; 6]).expect("a shape");
    for (format, found, converter) in [
        (FileFormat::Exr, "an OpenEXR picture", "pcomb -"),
        (FileFormat::Tiff, "a TIFF picture", "ra_tiff -r -"),
        (FileFormat::Png, "a PNG picture", "ra_png -r -"),
    ] {
        let bytes = write_image(format, &Header::new("RADIANCE"), &image).expect("three components");
        for program in ["pfilt", "pextrem", "pvalue"] {
            let run = radsight_with(&[program, "-"], &bytes);
            assert_eq!(run.code, 1, "{program}: {}", run.messages);
            let expected = format!("the file is {found}, expected a Radiance picture");
            assert!(run.messages.contains(&expected), "{program}: {}", run.messages);
            assert!(run.messages.contains(&format!("hint: `{converter}`")), "{program}: {}", run.messages);
            assert!(run.output.is_empty(), "{program}");
        }
    }
}
