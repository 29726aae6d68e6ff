//! Differential tests against real Radiance and published pictures and views. Each is skipped if
//! these are not available: `RADSIGHT_RADIANCE` names a folder with `bin` and `lib` (otherwise PATH
//! is searched), `RADSIGHT_SHARED` one with `radiance/loose` and its neighbours.

use radsight_picture::{
    Encoding, FloatMatrix, Header, Image, MatrixFormat, Orientation, Picture, Resolution, RgbPrimaries, View,
    ViewOptions, decode_rgbe, encode_rgbe, mantissa_step, read_pfm, xyz_to_rgb,
};
use radsight_test_support::Radiance;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A program of real Radiance; prints a note if it is missing.
fn real(program: &str) -> Option<Command> {
    let mut command = Radiance::find()?.command(program, &[]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    Some(command)
}

fn run(mut command: Command, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let mut child = command.args(arguments).spawn().unwrap();
    let mut pipe = child.stdin.take().unwrap();
    let output = std::thread::scope(|scope| {
        scope.spawn(move || pipe.write_all(input));
        child.wait_with_output().unwrap()
    });
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// Published files with one of the endings.
fn shared(endings: &[&str]) -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("RADSIGHT_SHARED") else {
        println!("skipped: RADSIGHT_SHARED is not set");
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(folder).join("radiance")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap().map(Result::unwrap) {
            let path = entry.path();
            if entry.file_type().unwrap().is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| endings.iter().any(|known| ending == *known)) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(found.len() > 10, "few files: {found:?}");
    found
}

/// Values from black to the largest pixel value, many of them at the limits of mantissas.
fn values(count: usize) -> Vec<f32> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    (0..count)
        .map(|i| match i % 5 {
            0 => (next() % 1024) as f32 / 1024.0,
            1 => f32::from_bits((next() as u32 & 0x7fff_ffff).min(0x7e7f_ffff)),
            2 => -((next() % 100) as f32),
            3 => (next() % 256) as f32 * 2f32.powi((next() % 40) as i32 - 20),
            _ => (next() >> 40) as f32 / (1 << 24) as f32,
        })
        .collect()
}

#[test]
fn encoding_and_run_lengths_are_those_of_pvalue() {
    let Some(_) = real("pvalue") else { return };
    for (width, height) in [(1, 3), (16, 4), (17, 3), (300, 40), (1000, 3)] {
        let mut data = values(width * height * 3);
        // Some rows of runs of all lengths.
        for (i, value) in data.iter_mut().enumerate().take(width * 3) {
            *value = if (i / 3).is_multiple_of(7) { 0.5 } else { 0.25 * (1 + (i / 3) % 90 / 13) as f32 };
        }
        let image = Image::new(width, height, 3, data).unwrap();
        let raw: Vec<u8> = image.data().iter().flat_map(|value| value.to_le_bytes()).collect();
        let (y, x) = (height.to_string(), width.to_string());
        let theirs = run(real("pvalue").unwrap(), &["-r", "-h", "-H", "-df", "-y", &y, "+x", &x], &raw);
        let ours = Picture::from_rgb(Header::default(), &image).unwrap().to_bytes();
        let start = |bytes: &[u8]| {
            let (_, used) = Header::read(bytes).unwrap();
            used + bytes[used..].iter().position(|byte| *byte == b'\n').unwrap() + 1
        };
        assert_eq!(ours[start(&ours)..], theirs[start(&theirs)..], "{width} x {height}");
    }
}

/// Compares our picture with `pvalue`'s floats, bit by bit.
fn same_as_pvalue(path: &Path, option: &str, ours: &Image<f32>, stored: Resolution) {
    let mut arguments = vec!["-h", "-H", "-df", path.to_str().unwrap()];
    if !option.is_empty() {
        arguments.insert(0, option);
    }
    let theirs = run(real("pvalue").unwrap(), &arguments, b"");
    let theirs = theirs.as_chunks::<4>().0.iter().map(|value| f32::from_le_bytes(*value)).collect();
    assert_eq!(ours, &stored.upright(3, theirs).unwrap(), "{} {option}", path.display());
}

#[test]
fn pictures_of_others_have_the_values_of_pvalue() {
    let Some(_) = real("pvalue") else { return };
    let files = shared(&["hdr", "pic", "hsr"]);
    for path in &files {
        let bytes = std::fs::read(path).unwrap();
        let picture = Picture::read(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        same_as_pvalue(path, "", &picture.three_values(), picture.resolution());
        if picture.encoding() == Encoding::Rgbe {
            same_as_pvalue(path, "-o", &picture.radiance().unwrap(), picture.resolution());
        }
        let again = Picture::read(&picture.to_bytes()).unwrap();
        assert_eq!(again.pixels(), picture.pixels(), "{}", path.display());
    }
    println!("{} pictures", files.len());
}

#[test]
fn getinfo_finds_our_sizes_and_headers() {
    let Some(_) = real("getinfo") else { return };
    for path in shared(&["hdr", "pic"]) {
        let bytes = std::fs::read(&path).unwrap();
        let picture = Picture::read(&bytes).unwrap();
        let size = run(real("getinfo").unwrap(), &["-d"], &bytes);
        let theirs = Resolution::read(&size, 0).unwrap().0;
        assert_eq!(theirs, picture.resolution(), "{}", path.display());
        let header = run(real("getinfo").unwrap(), &[], &bytes);
        assert_eq!(Header::read_text(&header), Header::read(&bytes).unwrap().0, "{}", path.display());
    }
}

#[test]
fn all_orientations_are_turned_as_pvalue_says() {
    let Some(_) = real("pvalue") else { return };
    let image = Image::new(19, 5, 3, (0..285).map(|i| 1.0 + i as f32).collect()).unwrap();
    let picture = Picture::from_rgb(Header::new("RADIANCE"), &image).unwrap();
    for bits in 0..8 {
        let orientation =
            Orientation { scanlines_are_rows: bits & 4 != 0, x_falls: bits & 1 != 0, y_falls: bits & 2 != 0 };
        let bytes = picture.to_bytes_in(Resolution { orientation, ..picture.resolution() });
        let read = Picture::read(&bytes).unwrap();
        assert_eq!(read.pixels(), picture.pixels());
        // pvalue prints x from the left and y from the bottom with each pixel.
        let text = String::from_utf8(run(real("pvalue").unwrap(), &["-h", "-H"], &bytes)).unwrap();
        for line in text.lines() {
            let words: Vec<f32> = line.split_ascii_whitespace().map(|word| word.parse().unwrap()).collect();
            let ours = read.values().pixel(words[0] as usize, 4 - words[1] as usize)[0];
            assert!((ours - words[2]).abs() <= 1e-3 * ours, "{bits}: {line} {ours}");
        }
    }
}

#[test]
fn spectra_go_through_rmtxop_and_pvalue() {
    let Some(_) = real("rmtxop") else { return };
    let image = Image::new(21, 4, 9, values(21 * 4 * 9).into_iter().map(|v| v.clamp(0.0, 9.0)).collect()).unwrap();
    let mut header = Header::new("RADIANCE");
    header.push_exposure(2.5);
    let picture = Picture::from_spectra(header, &image, [720.0, 588.0, 480.0, 400.0]).unwrap();
    let theirs = FloatMatrix::read(&run(real("rmtxop").unwrap(), &["-ff", "-"], &picture.to_bytes())).unwrap();
    let (ours, theirs) = (picture.radiance().unwrap(), theirs.into_f32());
    assert_eq!((theirs.width(), theirs.height(), theirs.components()), (21, 4, 9));
    for (a, b) in ours.data().iter().zip(theirs.data()) {
        assert!((a - b).abs() <= 1e-6 * b.abs(), "{a} {b}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("spectra.hsr");
    std::fs::write(&path, picture.to_bytes()).unwrap();
    same_as_pvalue(&path, "", &picture.three_values(), picture.resolution());
}

#[test]
fn float_matrices_go_through_rmtxop_and_pvalue() {
    let Some(_) = real("rmtxop") else { return };
    let image = Image::new(7, 5, 2, values(70).into_iter().map(|v| v.clamp(-1e6, 1e6)).collect()).unwrap();
    for (format, option) in [(MatrixFormat::Ascii, "-fa"), (MatrixFormat::Float, "-ff"), (MatrixFormat::Double, "-fd")]
    {
        let bytes = FloatMatrix::write_f32(&Header::new("RADIANCE"), &image, MatrixFormat::Float);
        let theirs = FloatMatrix::read(&run(real("rmtxop").unwrap(), &[option, "-"], &bytes)).unwrap();
        assert_eq!(theirs.format, format);
        let ours = FloatMatrix::read(&FloatMatrix::write_f32(&Header::new("RADIANCE"), &image, format)).unwrap();
        assert_eq!(ours.clone().into_f32(), theirs.into_f32(), "{option}");
        let through = FloatMatrix::write_f32(&Header::default(), &image, format);
        let theirs = FloatMatrix::read(&run(real("rmtxop").unwrap(), &["-ff", "-"], &through)).unwrap();
        assert_eq!(ours.into_f32(), theirs.into_f32(), "{option}");
    }
    // Output of pvalue: with and without a resolution line, in both byte orders, and as text.
    let rgb = Image::new(21, 5, 3, values(315).into_iter().map(f32::abs).collect()).unwrap();
    let picture = Picture::from_rgb(Header::new("RADIANCE"), &rgb).unwrap();
    for options in [&["-df"][..], &["-dF"], &["-dd"], &["-dD"], &["-H", "-df"], &["-H", "-dF"]] {
        let matrix = FloatMatrix::read(&run(real("pvalue").unwrap(), options, &picture.to_bytes())).unwrap();
        assert_eq!(matrix.into_f32(), picture.values(), "{options:?}");
    }
}

#[test]
fn our_matrices_become_pictures_as_pvalue_makes_them() {
    let Some(_) = real("pvalue") else { return };
    let image = Image::new(30, 4, 1, values(120).into_iter().map(f32::abs).collect()).unwrap();
    let bytes = FloatMatrix::write_f32(&Header::new("RADIANCE"), &image, MatrixFormat::Float);
    let theirs = Picture::read(&run(real("pvalue").unwrap(), &["-r", "-df"], &bytes)).unwrap();
    let ours = Picture::from_rgb(Header::default(), &image).unwrap();
    assert_eq!(theirs.pixels(), ours.pixels());
}

/// Compares our conversion with `ra_xyze`'s: at most one mantissa step apart, and mostly equal.
fn same_as_ra_xyze(path: &Path, arguments: &[&str], ours: impl Fn(&Picture, [f32; 3]) -> [f32; 3]) {
    let bytes = std::fs::read(path).unwrap();
    let picture = Picture::read(&bytes).unwrap();
    let theirs = Picture::read(&run(real("ra_xyze").unwrap(), arguments, &bytes)).unwrap();
    let radiance = picture.radiance().unwrap();
    let mut differing = 0;
    for (value, theirs) in radiance.pixels().zip(theirs.pixels().pixels()) {
        let ours = encode_rgbe(ours(&picture, [value[0], value[1], value[2]]));
        if ours != *theirs {
            differing += 1;
            // The exponents differ where the largest value is near a power of two.
            let step = mantissa_step(ours[3].max(theirs[3]));
            let apart =
                |i: usize| (decode_rgbe(ours)[i] - decode_rgbe([theirs[0], theirs[1], theirs[2], theirs[3]])[i]).abs();
            assert!((0..3).all(|i| apart(i) <= step), "{ours:?} {theirs:?} {}", path.display());
        }
    }
    println!("{differing} of {} pixels differ", radiance.width() * radiance.height());
    assert!(differing * 500 <= radiance.width() * radiance.height(), "{differing} differ in {}", path.display());
}

#[test]
fn colours_convert_as_ra_xyze_converts_them() {
    let Some(_) = real("ra_xyze") else { return };
    let folder = tempfile::tempdir().unwrap();
    for path in shared(&["hdr"]) {
        let bytes = std::fs::read(&path).unwrap();
        let header = Header::read(&bytes).unwrap().0;
        if header.format().is_none() || Picture::read(&bytes).unwrap().components() != 3 {
            continue;
        }
        let primaries = header.primaries().unwrap().unwrap_or(RgbPrimaries::STANDARD);
        let to_xyz = primaries.rgb_to_xyz().unwrap().as_mat3();
        same_as_ra_xyze(&path, &["-o"], |_, rgb| (to_xyz * glam::Vec3::from(rgb) * 179.0).to_array());
        // Convert the result back.
        let xyz = folder.path().join("xyz.hdr");
        std::fs::write(&xyz, run(real("ra_xyze").unwrap(), &["-o"], &bytes)).unwrap();
        let to_rgb = RgbPrimaries::STANDARD.xyz_to_rgb().unwrap();
        same_as_ra_xyze(&xyz, &["-r", "-o"], |_, xyz| xyz_to_rgb(&to_rgb, xyz.map(|value| value / 179.0)));
    }
}

const VIEWS: [&str; 12] = [
    "-vtv -vp 1 2 3 -vd 1 2 -.5 -vh 60 -vv 40",
    "-vtv -vp -1e3 2 3 -vd 1 2 -.5 -vu 1 1 1 -vh 170 -vv 140 -vo .5 -va 9 -vs .2 -vl -.1",
    "-vtl -vp 1 2 3 -vd 0 0 -1 -vu 0 1 0 -vh 3 -vv 4 -vs .2 -vl 1.1",
    "-vtl -vp 1 2 3 -vd 1 2 -.5 -vh 3e-3 -vv 4e-3 -vo .5 -va 9",
    "-vtc -vp 1 2 3 -vd 1 2 -.5 -vh 360 -vv 120",
    "-vtc -vp 1 2 3 -vd 1 2 -.5 -vh 200 -vv 40 -vo .5 -va 9 -vs .1 -vl -.1",
    "-vth -vp 1 2 3 -vd 1 2 -.5 -vh 180 -vv 180",
    "-vth -vp 1 2 3 -vd 1 2 -.5 -vh 120 -vv 90 -vo .5 -va 9 -vs .2 -vl -.1",
    "-vta -vp 1 2 3 -vd 1 2 -.5 -vh 360 -vv 360",
    "-vta -vp 1 2 3 -vd 1 2 -.5 -vh 170 -vv 300 -vo .5 -va 9 -vs .2 -vl -.1",
    "-vts -vp 1 2 3 -vd 1 2 -.5 -vh 270 -vv 270",
    "-vts -vp 1 2 3 -vd 1 2 -.5 -vh 170 -vv 200 -vo .5 -va 9 -vs .2 -vl -.1",
];

/// Compares every ray of a view with those of `vwrays`, to 1e-9 of its length.
fn same_as_vwrays(view: &View, options: &[&str], (width, height): (usize, usize)) {
    let mut arguments = vec!["-fd", "-pa", "0", "-x", "37", "-y", "23"];
    arguments.extend_from_slice(options);
    let theirs = run(real("vwrays").unwrap(), &arguments, b"");
    let theirs: Vec<f64> = theirs.as_chunks::<8>().0.iter().map(|value| f64::from_le_bytes(*value)).collect();
    assert_eq!(theirs.len(), width * height * 6, "{options:?}");
    let resolution = Resolution::standard(width, height);
    let mut worst = 0f64;
    for (i, theirs) in theirs.as_chunks::<6>().0.iter().enumerate() {
        let ours = view.ray(resolution.location(i % width, i / width)).map_or([0.0; 6], |ray| {
            let direction = ray.direction * ray.length.unwrap_or(1.0);
            let (o, d) = (ray.origin, direction);
            [o.x, o.y, o.z, d.x, d.y, d.z]
        });
        for half in [0..3, 3..6] {
            let length = theirs[half.clone()].iter().fold(1e-3, |sum: f64, value| sum.max(value.abs()));
            let error = half.map(|k| (ours[k] - theirs[k]).abs()).fold(0.0, f64::max);
            worst = worst.max(error / length);
        }
    }
    assert!(worst < 1e-9, "{options:?}: {worst:e}");
}

#[test]
fn rays_are_those_of_vwrays() {
    let Some(_) = real("vwrays") else { return };
    for line in VIEWS {
        let mut options = ViewOptions::default();
        options.apply_line(line).unwrap();
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        same_as_vwrays(&View::new(options).unwrap(), &words, (37, 23));
    }
}

#[test]
fn view_files_of_others_are_read_as_vwrays_reads_them() {
    let Some(_) = real("vwrays") else { return };
    let files = shared(&["vf", "vp", "hdr", "pic"]);
    let mut read = 0;
    for path in &files {
        let bytes = std::fs::read(path).unwrap();
        let name = path.to_str().unwrap();
        let mut options = ViewOptions::default();
        let found = options.apply_file(&bytes);
        let theirs = real("vwrays").unwrap().args(["-d", "-pa", "0", "-vf", name]).output().unwrap();
        assert_eq!(found.is_ok() && View::new(options).is_ok(), theirs.status.success(), "{name}");
        if found.is_ok() {
            read += 1;
            same_as_vwrays(&View::new(options).unwrap(), &["-vf", name], (37, 23));
        }
    }
    println!("{read} of {} files have a view", files.len());
}

#[test]
fn resolutions_fit_as_in_vwrays() {
    let Some(_) = real("vwrays") else { return };
    for line in VIEWS {
        for (x, y, aspect) in [("512", "512", "1"), ("300", "100", "1"), ("100", "300", ".7"), ("64", "64", "0")] {
            let mut options = ViewOptions::default();
            options.apply_line(line).unwrap();
            let (width, height) =
                View::new(options).unwrap().fit(x.parse().unwrap(), y.parse().unwrap(), aspect.parse().unwrap());
            let mut arguments = vec!["-d", "-pa", aspect, "-x", x, "-y", y];
            arguments.extend(line.split_ascii_whitespace());
            let theirs = String::from_utf8(run(real("vwrays").unwrap(), &arguments, b"")).unwrap();
            assert!(theirs.starts_with(&format!("-x {width} -y {height}")), "{line} {x} {y} {aspect}: {theirs}");
        }
    }
}

#[test]
fn truth_maps_are_read() {
    let Some(folder) = std::env::var_os("RADSIGHT_SHARED") else {
        println!("skipped: RADSIGHT_SHARED is not set");
        return;
    };
    let mut read = 0;
    for entry in std::fs::read_dir(PathBuf::from(folder).join("gripps/truth")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "pfm") {
            let image = read_pfm(&std::fs::read(&path).unwrap()).unwrap();
            assert!(image.data().iter().all(|value| *value >= 0.0 && value.is_finite()), "{}", path.display());
            read += 1;
        }
    }
    assert!(read > 0);
}
