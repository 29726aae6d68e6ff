//! `rcontrib`: coefficients and contributions, compared with analytic values and with the real one.

use crate::program::{self, Folder, command, run_with};
use radsight_picture::Header;
use radsight_test_support::Radiance;
use std::f64::consts::PI;

const SKY: &str = "\
void glow skyglow 0 0 4 3 2 1 0
skyglow source sky 0 0 4 0 0 1 180
void glow groundglow 0 0 4 .5 .5 .5 0
groundglow source ground 0 0 4 0 0 -1 180
void light sun 0 0 3 1e6 9e5 8e5
sun source disk 0 0 4 .6 0 .8 .533
";

const ROOM: &str = "\
void plastic grey 0 0 5 .5 .4 .3 0 0
void plastic white 0 0 5 .7 .7 .7 .05 .1
void glass pane 0 0 3 .9 .9 .9
grey polygon floor 0 0 12 0 0 0  4 0 0  4 5 0  0 5 0
white polygon ceiling 0 0 12 0 0 3  0 5 3  4 5 3  4 0 3
white polygon back 0 0 12 0 5 0  4 5 0  4 5 3  0 5 3
white polygon left 0 0 12 0 0 0  0 5 0  0 5 3  0 0 3
white polygon right 0 0 12 4 0 0  4 0 3  4 5 3  4 5 0
white polygon sill 0 0 12 0 0 0  0 0 1  4 0 1  4 0 0
pane polygon window 0 0 12 0 0 1  0 0 3  4 0 3  4 0 1
";

/// A scene with one polygon far below, so that nothing occludes the sky.
const FAR: &str = "void plastic grey 0 0 5 .5 .5 .5 0 0\ngrey ring far 0 0 8 0 0 -1e4 0 0 1 0 1\n";

/// Runs our program in a folder; the words are split at spaces.
fn run(folder: &Folder, words: &str, input: &str) -> program::Run {
    let words: Vec<&str> = std::iter::once("rcontrib").chain(words.split_whitespace()).collect();
    run_with(command(&words).current_dir(folder.path("")), input.as_bytes())
}

/// Records of numbers.
fn numbers(text: &[u8]) -> Vec<Vec<f64>> {
    let text = std::str::from_utf8(text).expect("text");
    text.lines().map(|line| line.split_whitespace().map(|word| word.parse().expect("a number")).collect()).collect()
}

/// The red values of each record.
fn reds(text: &[u8]) -> Vec<Vec<f64>> {
    numbers(text).iter().map(|record| record.iter().step_by(3).copied().collect()).collect()
}

#[track_caller]
fn near(found: f64, expected: f64, share: f64) {
    assert!((found - expected).abs() <= share * expected.abs(), "{found}, expected {expected}");
}

#[test]
fn sky_coefficients_are_projected_solid_angles() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{FAR}"));
    let words = "-h -I+ -ab 1 -ad 16384 -lw 1e-6 -f tregenza.cal -b tbin -bn Ntbins -m skyglow scene.rad";
    let record = &numbers(&run(&folder, words, "0 0 0 0 0 1\n").done())[0];
    assert_eq!(record.len(), 3 * 146);
    let total: f64 = record.iter().step_by(3).sum();
    near(total, PI, 2e-3);
    // The last patch is the cap of 6 degrees around the zenith.
    near(record[3 * 145], PI * 6f64.to_radians().sin().powi(2), 0.03);
    // A patch of the lowest row spans 12 degrees of azimuth and of altitude.
    let lowest: f64 = (1..=30).map(|bin| record[3 * bin]).sum();
    near(lowest, PI * 12f64.to_radians().sin().powi(2), 0.02);
}

#[test]
fn contributions_have_the_radiance_and_coefficients_have_not() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{FAR}"));
    // The solid angle of the sun, seen at cos 0.8 from a horizontal plane.
    let projected = PI * 0.2665f64.to_radians().sin().powi(2) * 0.8;
    let coefficients = run(&folder, "-h -I+ -ab 0 -m sun scene.rad", "0 0 0 0 0 1\n").done();
    near(numbers(&coefficients)[0][1], projected, 1e-3);
    let contributions = run(&folder, "-h -V+ -I+ -ab 0 -m sun scene.rad", "0 0 0 0 0 1\n").done();
    for (found, radiance) in numbers(&contributions)[0].iter().zip([1e6, 9e5, 8e5]) {
        near(*found, projected * radiance, 1e-3);
    }
}

#[test]
fn patterns_of_an_emitter_are_no_part_of_its_coefficient() {
    let folder = Folder::new();
    let scene = "void brightfunc half 2 .5 . 0 0\nhalf light lamp 0 0 3 7 7 7\nlamp sphere bulb 0 0 4 0 0 5 1\n";
    folder.file("scene.rad", format!("{scene}{FAR}"));
    let record = numbers(&run(&folder, "-h -ab 0 -m lamp -m grey scene.rad", "0 0 0 0 0 1\n").done());
    assert_eq!(record[0], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let contribution = numbers(&run(&folder, "-h -V+ -ab 0 -m lamp scene.rad", "0 0 0 0 0 1\n").done());
    near(contribution[0][0], 3.5, 1e-6);
}

#[test]
fn surfaces_that_emit_nothing_have_coefficients_too() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{ROOM}"));
    let record = &numbers(&run(&folder, "-h -ab 1 -ad 4096 -m grey -m white scene.rad", "2 4 1 0 0 -1\n").done())[0];
    // The ray meets the floor itself, and the gloss of the walls shows it again; everything visible
    // from the floor except the window is white.
    near(record[0], 1.0, 0.01);
    assert!(record[3] > 0.3 && record[3] < 0.5 && record[4] < record[3] && record[5] < record[4], "{record:?}");
}

#[test]
fn records_do_not_depend_on_threads_and_add_up() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{ROOM}"));
    let rays = "1 1 .8 0 0 1\n2 2 1 0 0 1\n3 4 .8 0 0 1\n";
    let many = "-h -I+ -ab 1 -ad 40000 -lw 1e-6 -m skyglow scene.rad";
    assert_eq!(run(&folder, many, rays).done(), run(&folder, &format!("-n 1 {many}"), rays).done());
    let words = "-h -I+ -ab 2 -ad 3000 -m skyglow -m sun scene.rad";
    let records = run(&folder, words, rays).done();
    assert_eq!(records, run(&folder, &format!("-n 1 {words}"), rays).done());
    let records = numbers(&records);
    let sum = &numbers(&run(&folder, &format!("-c 0 {words}"), rays).done())[0];
    let mean = &numbers(&run(&folder, &format!("-c 3 {words}"), rays).done())[0];
    for (column, sum) in sum.iter().enumerate() {
        let expected: f64 = records.iter().map(|record| record[column]).sum();
        near(*sum, expected, 1e-5);
        near(mean[column], expected / 3.0, 1e-5);
    }
}

#[test]
fn coefficients_agree_with_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let scene = folder.file("scene.rad", format!("{SKY}{ROOM}"));
    let octree = radiance.octree(&folder, &[&scene]);
    let rays = "1 1 .8 0 0 1\n2 2 1 0 0 1\n3 4 .8 0 0 1\n2 1 2 0 -1 0\n1.5 3 .3 .2 0 1\n2.5 .7 1.2 0 -.3 1\n";
    let roof = rays.lines().count();
    for (quantity, bins) in [
        ("-I+", "-e MF:1 -f reinhartb.cal -b rbin -bn Nrbins"),
        ("-i+", "-f tregenza.cal -b tbin -bn 146"),
        ("-V+ -I+", ""),
    ] {
        // `-i+` measures irradiance at the point that a ray meets.
        let rays = format!("{rays}2 2 9 0 0 {}\n", if quantity == "-i+" { -1 } else { 1 });
        let words = format!("-h -u- {quantity} -ab 3 -ad 4000 -lw 1e-5 {bins} -m skyglow -b 0 -m groundglow -m sun");
        let words: Vec<&str> = words.split(' ').filter(|word| !word.is_empty()).chain([octree.as_str()]).collect();
        let real = numbers(&run_with(&mut radiance.command("rcontrib", &words), rays.as_bytes()).done());
        let ours: Vec<&str> = std::iter::once("rcontrib").chain(words).collect();
        let ours = numbers(&run_with(&mut command(&ours), rays.as_bytes()).done());
        assert_eq!((real.len(), real[0].len()), (ours.len(), ours[0].len()));
        let sky = real[0].len() - 6;
        for columns in [0..sky, sky..sky + 3] {
            // Summed over all points and bins, random errors average out.
            let total = |records: &[Vec<f64>]| records.iter().flat_map(|record| &record[columns.clone()]).sum::<f64>();
            near(total(&ours), total(&real), 0.04);
        }
        let sun = |records: &[Vec<f64>]| -> Vec<f64> { records.iter().map(|record| record[sky + 3]).collect() };
        let (ours_of_sun, real_of_sun) = (sun(&ours), sun(&real));
        let (ours_on_roof, real_on_roof) = (ours_of_sun[roof], real_of_sun[roof]);
        near(ours_on_roof, real_on_roof, 0.003);
        // No point in the room sees the sun: its light arrives by way of walls, where few rays find
        // it.
        for (ours, real) in ours_of_sun[..roof].iter().zip(&real_of_sun) {
            assert!(ours.max(*real) < 1e-4 * real_on_roof, "{ours} here, {real} there");
        }
        // Directions of the light: bins in groups of rows, by their sums over all points.
        let row = |records: &[Vec<f64>], from: usize, to: usize| -> f64 {
            records.iter().flat_map(|record| &record[(3 * from).min(sky)..(3 * to).min(sky)]).sum()
        };
        for (from, to) in [(0, 31), (31, 61), (61, 85)] {
            if row(&real, from, to) > 0.05 * row(&real, 0, 146) {
                near(row(&ours, from, to), row(&real, from, to), 0.15);
            }
        }
    }
}

#[test]
fn files_have_the_names_and_headers_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let scene = folder.file("scene.rad", format!("{SKY}{ROOM}"));
    radiance.octree(&folder, &[&scene]);
    let rays = "2 4 1 0 -1 0\n".repeat(6);
    for words in [
        "-faf -x 3 -y 2 -ad 2 -f tregenza.cal -b tbin -bn 146 -o %s_%03d.dat -m skyglow scene.oct",
        "-fac -x 3 -y 2 -ad 2 -o %s.hdr -m skyglow -m sun scene.oct",
        "-fad -y 6 -ad 2 -o both.dat -m skyglow -m sun scene.oct",
        "-fa -c 2 -ad 2 -f tregenza.cal -b tbin -bn 146 -o bins%d.txt -m skyglow scene.oct",
        "-faf -c 0 -ad 2 -o sum.dat -m skyglow -m sun scene.oct",
    ] {
        let mut found = Vec::new();
        for is_real in [true, false] {
            let words: Vec<&str> = std::iter::once("rcontrib").chain(words.split(' ')).collect();
            let mut program = if is_real { radiance.command(words[0], &words[1..]) } else { command(&words) };
            run_with(program.current_dir(folder.path("")), rays.as_bytes()).done();
            let names = folder.names().into_iter().filter(|name| !name.starts_with("scene"));
            let mut files = Vec::new();
            for name in names {
                let bytes = folder.read(&name);
                let (header, length) = Header::read(&bytes).expect("a header");
                let lines: Vec<String> = header
                    .lines()
                    .map(|line| String::from_utf8_lossy(line).trim_end().to_owned())
                    .filter(|line| !["SOFTWARE", "CAPDATE", "GMT"].iter().any(|name| line.starts_with(name)))
                    .collect();
                let is_text = name.ends_with(".txt");
                files.push((name.clone(), lines, if is_text { 0 } else { bytes.len() - length }));
                std::fs::remove_file(folder.path(&name)).expect("the file is removed");
            }
            found.push(files);
        }
        assert!(!found[0].is_empty() && found[0] == found[1], "{words}: {found:#?}");
    }
}

#[test]
fn an_interrupted_run_is_gone_on_with() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{ROOM}"));
    let rays: Vec<String> = (0..6).map(|ray| format!("{} 3 1 0 0 1\n", 0.5 * f64::from(ray))).collect();
    let words = "-I+ -ab 2 -ad 64 -m groundglow -m skyglow scene.rad";
    for (format, size) in [("-faf", 24), ("-fad -c 2", 48), ("-fac -x 3 -y 2", 4)] {
        let name = if size == 4 { "%s.dat" } else { "both.dat" };
        let run_once =
            |recovering: &str, input: &str| run(&folder, &format!("{recovering} {format} -o {name} {words}"), input);
        run_once("-fo+", &rays.concat()).done();
        let names: Vec<String> = folder.names().into_iter().filter(|name| name.ends_with(".dat")).collect();
        let whole: Vec<Vec<u8>> = names.iter().map(|name| folder.read(name)).collect();
        // The file ends within its third record; or an interrupted run of ours has left it beside.
        for place in ["", "."] {
            for (name, whole) in names.iter().zip(&whole) {
                let records = if size == 48 { 3 } else { 6 };
                let end = whole.len() - records * size + 2 * size + 3;
                std::fs::remove_file(folder.path(name)).expect("the file is removed");
                let part = if place == "." { format!(".{name}.abcdef.part") } else { name.clone() };
                folder.file(&part, &whole[..end]);
            }
            run_once("-r+", &rays.concat()).done();
            assert!(names.iter().zip(&whole).all(|(name, whole)| folder.read(name) == *whole), "{format} {place}");
        }
        if size == 24 {
            // Wrong input keeps existing output.
            folder.file(".both.dat.abcdef.part", &whole[0][..whole[0].len() - 3 * size]);
            std::fs::remove_file(folder.path("both.dat")).expect("the file is removed");
            assert_eq!(run_once("-r+", "1 2 3").code, 1);
            run_once("-r+", &rays.concat()).done();
            assert!(folder.read("both.dat") == whole[0]);
        }
        let complete = run_once("-r+ -y 2", &rays.concat());
        assert!(complete.messages.contains("appears to be complete"), "{}", complete.messages);
        for name in &names {
            std::fs::remove_file(folder.path(name)).expect("the file is removed");
        }
        let fresh = run_once("-r+", &rays.concat());
        assert!(fresh.messages.contains("no previous data to recover"), "{}", fresh.messages);
        for (name, whole) in names.iter().zip(&whole) {
            let records = size * if size == 48 { 3 } else { 6 };
            assert!(folder.read(name).ends_with(&whole[whole.len() - records..]), "{format}");
            std::fs::remove_file(folder.path(name)).expect("the file is removed");
        }
    }
    // One record of all rays continues the sums of an earlier one.
    for (recovering, half) in [("-fo+", &rays[..3]), ("-r+", &rays[3..])] {
        run(&folder, &format!("{recovering} -c 0 -faf -o sum.dat {words}"), &half.concat()).done();
    }
    let sums = folder.read("sum.dat");
    let parts = numbers(&run(&folder, &format!("-h -c 0 {words}"), &rays.concat()).done());
    for (sum, expected) in sums[sums.len() - 24..].as_chunks().0.iter().zip(&parts[0]) {
        near(f64::from(f32::from_ne_bytes(*sum)), *expected, 0.15);
    }
}

#[test]
fn rays_end_where_their_direction_does() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    // Without gloss, so that nothing is random.
    let scene = folder.file("scene.rad", format!("{SKY}{}", ROOM.replace(".05 .1", "0 0")));
    let octree = radiance.octree(&folder, &[&scene]);
    // To the wall and shorter; through the window to the sky; to the window, and through it but not
    // to the sky.
    let rays = "2 1 1.5 0 4.1 0\n2 1 1.5 0 3.9 0\n2 1 1.5 0 -.9 0\n2 1 1.5 0 -3 0\n2 1 1.5 0 0 -2\n";
    for on in ["-ld+", "-ld-"] {
        let words = ["-h", "-ab", "0", on, "-m", "skyglow", "-m", "white", "-m", "grey", "-m", "pane", &octree];
        let real = numbers(&run_with(&mut radiance.command("rcontrib", &words), rays.as_bytes()).done());
        let ours: Vec<&str> = std::iter::once("rcontrib").chain(words).collect();
        let ours = numbers(&run_with(&mut command(&ours), rays.as_bytes()).done());
        for (ours, real) in ours.iter().flatten().zip(real.iter().flatten()) {
            assert!((ours - real).abs() < 2e-3, "{on}: {ours} here, {real} there");
        }
    }
}

#[test]
fn spectra_agree_with_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let sky = "void spectrum blue 0 0 6 380 780 3 2 1 .5\nblue glow skyglow 0 0 4 1 1 1 0\nskyglow source sky 0 0 4 0 0 1 180\n";
    let green = "void spectrum green 0 0 6 380 780 .1 .6 .3 .2\ngreen plastic paint 0 0 5 1 1 1 0 0\n";
    let wall = "paint polygon wall 0 0 12 -9 1 0  9 1 0  9 1 9  -9 1 9\n";
    let scene = folder.file("scene.rad", format!("{sky}{green}{wall}"));
    radiance.octree(&folder, &[&scene]);
    for words in ["-cs 9 -V-", "-cs 9 -V+", "-cs 4 -cw 400 700 -V+", "-cs 9 -faf -V+"] {
        let words = format!("rcontrib -u- -w- {words} -ab 2 -ad 3000 -o out%d.dat -m skyglow scene.oct");
        let words: Vec<&str> = words.split(' ').collect();
        let mut found = Vec::new();
        for is_real in [true, false] {
            let mut program = if is_real { radiance.command(words[0], &words[1..]) } else { command(&words) };
            run_with(program.current_dir(folder.path("")), b"0 0 1 0 1 0\n").done();
            let bytes = folder.read("out0.dat");
            let (header, start) = Header::read(&bytes).expect("a header");
            let lines = ["NCOMP=", "WAVELENGTH_SPLITS=", "FORMAT="].map(|name| {
                let text = header.to_text();
                text.lines().find(|line| line.starts_with(name)).map(|line| line.trim_end().to_owned())
            });
            let record = match words.contains(&"-faf") {
                true => {
                    bytes[start..].as_chunks().0.iter().map(|value| f64::from(f32::from_ne_bytes(*value))).collect()
                }
                false => numbers(&bytes[start..])[0].clone(),
            };
            found.push((lines, record));
            std::fs::remove_file(folder.path("out0.dat")).expect("the file is removed");
        }
        let [(real_lines, real), (lines, ours)] = &found[..] else { panic!("two runs") };
        assert_eq!((lines, ours.len()), (real_lines, real.len()), "{words:?}");
        for (ours, real) in ours.iter().zip(real) {
            near(*ours, *real, 0.04);
        }
    }
}

#[test]
fn surfaces_that_emit_nothing_have_contributions_too() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let scene = folder.file("scene.rad", format!("{SKY}{ROOM}"));
    let octree = radiance.octree(&folder, &[&scene]);
    // The floor itself, the ceiling with its highlight, the sky by way of the window.
    for ray in ["2 4 1 0 0 -1", "2 4 1 0 .2 1", "2 4 2 0 -1 0"] {
        let rays = format!("{ray}\n").repeat(9);
        let words = "-h -u- -w- -V+ -c 9 -ab 3 -ad 4000 -lw 1e-5 -m grey -m white -m pane -m skyglow";
        let words: Vec<&str> = words.split(' ').chain([octree.as_str()]).collect();
        let real = &numbers(&run_with(&mut radiance.command("rcontrib", &words), rays.as_bytes()).done())[0];
        let ours: Vec<&str> = std::iter::once("rcontrib").chain(words).collect();
        let ours = &numbers(&run_with(&mut command(&ours), rays.as_bytes()).done())[0];
        let largest = real.iter().copied().fold(0.0, f64::max);
        for (ours, real) in ours.iter().zip(real) {
            assert!((ours - real).abs() < 0.06 * largest, "{ray}: {ours} here, {real} there");
        }
    }
}

#[test]
fn the_contribution_of_a_surface_is_its_radiance() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("void glow skyglow 0 0 4 4 3 2 0\nskyglow source sky 0 0 4 0 0 1 180\n{FAR}"));
    let words = "-h -V+ -ab 1 -ad 1024 -m grey -m skyglow scene.rad";
    let record = &numbers(&run(&folder, words, "0 0 0 0 0 -1\n").done())[0];
    for (found, expected) in record.iter().zip([2.0, 1.5, 1.0, 2.0, 1.5, 1.0]) {
        near(*found, expected, 1e-3);
    }
}

#[test]
fn a_command_gets_the_records_that_are_sent_to_it() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{FAR}"));
    let words = ["rcontrib", "-h", "-ab", "0", "-o", "!cat > got.txt", "-m", "skyglow", "scene.rad"];
    run_with(command(&words).current_dir(folder.path("")), b"0 0 0 0 0 1\n").done();
    assert_eq!(numbers(&folder.read("got.txt"))[0], [1.0; 3]);
}

/// Parameters count from their option on: files see them, and later definitions replace them, unless other
/// parameters come between.
#[test]
fn parameters_and_definitions_count_in_their_order() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{FAR}"));
    folder.file("bins.cal", "count : 2*MF;\nbin = if(Dz, MF, 0);\n");
    folder.file("own.cal", "MF = 1;\nbin = if(Dz, MF, 0);\n");
    let own = [["-p MF=2", "-f own.cal"], ["-f own.cal", "-p MF=2"]].map(|order| order.join(" "));
    for (words, columns, bin) in [
        ("-p MF=2 -f bins.cal -bn count -b bin -m skyglow", 4, 2),
        ("-e MF:3 -p MF=2 -f bins.cal -bn count -b bin -m skyglow", 4, 2),
        (&format!("{} -bn 2*MF -b bin -m skyglow", own[0]), 2, 1),
        (&format!("{} -bn 2*MF -b bin -m skyglow", own[1]), 4, 2),
        ("-f own.cal -bn 4 -b bin -p MF=3 -m skyglow -p MF=2 -m groundglow", 8, 3),
        ("-e k=1 -bn 3 -b k -m skyglow", 3, 1),
        ("-p K=2,L=0 -bn 3 -b K -m skyglow", 3, 2),
        ("-bn 3 -b 0 -m skyglow", 1, 0),
    ] {
        let record = &reds(&run(&folder, &format!("-h {words} scene.rad"), "0 0 0 .3 .4 .6\n").done())[0];
        assert_eq!(record.len(), columns, "{words}");
        assert_eq!(record.iter().position(|value| *value > 0.0), Some(bin), "{words}: {record:?}");
    }
}

#[test]
fn wrong_command_lines_and_input_are_reported() {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{ROOM}"));
    folder.file("taken.dat", "");
    folder.file("broken.cal", "bin = (1;\n");
    let check = |words: &str, input: &str, code: i32, message: &str| {
        let run = run(&folder, words, input);
        assert_eq!(run.code, code, "{words}: {}", run.messages);
        assert!(run.messages.contains(message), "{words}: {}", run.messages);
    };
    check("scene.rad", "", 2, "no modifier is given");
    check("-m sun", "", 2, "no scene is given");
    check("-m sun -m sun scene.rad", "", 2, "modifier \"sun\" is named twice");
    check("-m void scene.rad", "", 2, "\"void\" cannot be tracked");
    check("-b Dx -m sun scene.rad", "", 2, "number of bins of \"sun\" is missing");
    check("-b 1 -bn 2 -m sun scene.rad", "", 2, "the constant 1, expected 0");
    check("-e k:1 -b k -bn 2 -m sun scene.rad", "", 2, "the constant 1, expected 0");
    check("-p N:2 -m sun scene.rad", "", 2, "\"-p N:2\" is no list of parameters");
    check("-p N=1+1 -m sun scene.rad", "", 2, "\"-p N=1+1\" is no list of parameters");
    check("-bn 0 -m sun scene.rad", "", 2, "expected 1 to");
    check("-bn 1e30 -m sun scene.rad", "", 2, "expected 1 to");
    check("-bn Nrbins -m sun scene.rad", "", 1, "Nrbins");
    check("-f missing.cal -m sun scene.rad", "", 1, "missing.cal");
    check("-f broken.cal -m sun scene.rad", "", 1, "broken.cal:1:");
    check("-b nobin -bn 2 -m sun scene.rad", "", 1, "nobin");
    check("-M missing.txt scene.rad", "", 1, "cannot read modifiers \"missing.txt\"");
    check("-o taken.dat -m sun scene.rad", "", 3, "it exists, expected -fo+");
    check("-o nowhere/x.dat -m sun scene.rad", "", 3, "cannot write \"nowhere/x.dat\"");
    check("-o %s%s -m sun scene.rad", "", 2, "has an unknown % format");
    check("-fxa -m sun scene.rad", "", 2, "format \"-fxa\" is unknown");
    check("-r+ -m sun scene.rad", "", 2, "standard output cannot be recovered (-r)");
    check("-r+ -o sun.dat -m sun scene.rad", "", 2, "text cannot be recovered (-r)");
    check("-r+ -o !cat -m sun scene.rad", "", 2, "output of \"!cat\" cannot be recovered (-r)");
    check("-r+ -ff -o broken.cal -m sun scene.rad", "", 1, "cannot recover \"broken.cal\"");
    check("-ap map.pm 9 -m sun scene.rad", "", 2, "photon maps are not supported");
    check("-zz -m sun scene.rad", "", 2, "option \"-zz\" is not supported");
    check("-m sun scene.rad", "1 2 3", 1, "standard input, ray 1: the stream ends after 3 of 6 numbers");
    check(
        "-x 2 -y 2 -m sun scene.rad",
        "1 1 1 0 0 1\n",
        1,
        "standard input ends 3 rays before the number given by -x and -y",
    );
    let warned = run(&folder, "-h -m moon scene.rad", "1 1 1 0 0 1\n");
    assert!(warned.code == 0 && warned.messages.contains("the scene has no modifier \"moon\""), "{}", warned.messages);
    assert_eq!(folder.names().iter().filter(|name| name.ends_with(".part")).count(), 0);
}

#[cfg(unix)]
#[test]
fn a_pipe_is_written_to_and_stays_a_pipe() {
    use std::os::unix::fs::FileTypeExt;
    let folder = Folder::new();
    folder.file("scene.rad", "void light shine 0 0 3 1 2 3\nshine sphere ball 0 0 4 0 0 0 1\n");
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe")).status();
    if !made.is_ok_and(|status| status.success()) {
        return;
    }
    let pipe = folder.path("pipe");
    let reader = std::thread::spawn(move || std::fs::read(pipe).expect("the pipe is read"));
    let mut program = command(&["rcontrib", "-h-", "-o", "pipe", "-m", "shine", "scene.rad"]);
    run_with(program.current_dir(folder.path("")), b"0 0 5 0 0 -1\n").done();
    let read = String::from_utf8(reader.join().expect("the reader ends")).expect("text");
    assert_eq!(read.split_whitespace().count(), 3, "{read}");
    let found = std::fs::symlink_metadata(folder.path("pipe")).expect("it is there");
    assert!(found.file_type().is_fifo(), "nothing takes the place of the pipe");
}

#[test]
fn coefficients_count_the_backs_of_lights_and_radiance_does_not() {
    let folder = Folder::new();
    let scene = "\
void glow g 0 0 4 2 2 2 0
g polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0
void light l 0 0 3 2 2 2
l polygon q 0 0 12 3 -1 0 5 -1 0 5 1 0 3 1 0
void illum i 1 void 0 3 2 2 2
i polygon r 0 0 12 7 -1 0 9 -1 0 9 1 0 7 1 0
";
    folder.file("scene.rad", scene);
    // Downwards at the front of each, and upwards at its back.
    let rays = "0 0 1 0 0 -1\n0 0 -1 0 0 1\n4 0 1 0 0 -1\n4 0 -1 0 0 1\n8 0 -1 0 0 1\n";
    let found = |values: &str| reds(&run(&folder, &format!("-h -ab 0 {values} -m g -m l -m i scene.rad"), rays).done());
    let expected = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(found("-V-"), expected);
    let radiance = found("-V+");
    assert_eq!(radiance[..4], [[2.0, 0.0, 0.0], [0.0; 3], [0.0, 2.0, 0.0], [0.0; 3]]);
    // The hemisphere over a point behind the glow: the form factor of a square (Howell, B-4 four
    // times) with half sides as long as its distance, times pi.
    let below = "0 0 -1 0 0 1\n";
    let words = "-h -I -ab 1 -ad 16384 -lw 1e-6 -m g scene.rad";
    let record = &numbers(&run(&folder, words, below).done())[0];
    let corner = (0.5f64.sqrt() * 0.5f64.sqrt().atan()) / PI;
    near(record[0], 4.0 * PI * corner, 0.02);
    let all = numbers(&run(&folder, "-h -ab 0 -c -1 -m g scene.rad", rays).done());
    assert_eq!(all.len(), 1);
    if let Some(radiance) = Radiance::find() {
        let words = ["-h", "-ab", "0", "-m", "g", "-m", "l", "-m", "i", "scene.oct"];
        let octree = run_with(radiance.command("oconv", &["scene.rad"]).current_dir(folder.path("")), b"").done();
        folder.file("scene.oct", octree);
        let real = run_with(radiance.command("rcontrib", &words).current_dir(folder.path("")), rays.as_bytes()).done();
        assert_eq!(reds(&real), expected);
    }
}
