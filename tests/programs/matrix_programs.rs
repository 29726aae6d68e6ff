//! Compares `gendaymtx`, `genskyvec`, `rmtxop`, `rcomb` and `dctimestep` with the real ones.

use crate::program::{Folder, command, root, run_with};
use radsight_matrix::{Matrix, Stored};
use radsight_test_support::Radiance;
use std::env;
use std::path::PathBuf;

/// The folder with published scenes, if there is one.
fn shared() -> Option<PathBuf> {
    let folder = env::var_os("RADSIGHT_SHARED").map(|shared| PathBuf::from(shared).join("radiance"));
    if folder.is_none() {
        println!("skipped: RADSIGHT_SHARED is not set");
    }
    folder
}

/// A matrix as text, with values between 0 and 1 and some zeros.
fn text([rows, columns]: [usize; 2], components: usize, seed: u32) -> String {
    let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let value = f64::from(state >> 8) / f64::from(1 << 24);
        if value < 0.15 { 0.0 } else { value }
    };
    let head = format!("#?RADIANCE\nmade by hand\nNROWS={rows}\nNCOLS={columns}\nNCOMP={components}\nFORMAT=ascii\n\n");
    let row = |_| (0..columns * components).map(|_| format!("{:.6}", next())).collect::<Vec<_>>().join(" ") + "\n";
    head + &(0..rows).map(row).collect::<String>()
}

/// A folder with matrices and pictures of all kinds.
fn folder(radiance: &Radiance) -> Folder {
    let folder = Folder::new();
    folder.file("a.mtx", text([4, 3], 3, 1));
    folder.file("b.mtx", text([3, 5], 3, 2));
    folder.file("c.mtx", text([4, 3], 3, 3));
    folder.file("v.mtx", text([5, 1], 3, 4));
    folder.file("grey.mtx", text([4, 3], 1, 5));
    folder.file("six.mtx", text([4, 3], 6, 6));
    let wavelengths = text([4, 3], 9, 7).replace("NCOMP=9", "NCOMP=9\nWAVELENGTH_SPLITS= 700 588 480 400");
    folder.file("nine.mtx", wavelengths);
    for (words, name) in [
        ("-fc a.mtx", "a.hdr"),
        ("-fc -c XYZ a.hdr", "a.xyz"),
        ("-fc six.mtx", "six.hsr"),
        ("-ff b.mtx", "b.flt"),
        ("-fd c.mtx", "c.dbl"),
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let made = run_with(radiance.command("rmtxop", &words).current_dir(folder.path("")), b"").done();
        folder.file(name, made);
    }
    folder.file("exposed.hdr", exposed(&folder.read("a.hdr")));
    folder
}

/// The same picture with an exposure.
fn exposed(picture: &[u8]) -> Vec<u8> {
    let head = b"#?RADIANCE\nEXPOSURE=2.5\nCOLORCORR= 1 2 1\n";
    let rest = picture.strip_prefix(b"#?RADIANCE\n").expect("a picture");
    [head, rest].concat()
}

/// Runs the real program and ours with the same words; returns both matrices.
fn both(radiance: &Radiance, folder: &Folder, program: &str, words: &str, input: &str) -> [Matrix; 2] {
    let words: Vec<&str> = split(words);
    let real = run_with(radiance.command(program, &words).current_dir(folder.path("")), input.as_bytes()).done();
    let ours: Vec<&str> = std::iter::once(program).chain(words.iter().copied()).collect();
    let ours = run_with(command(&ours).current_dir(folder.path("")), input.as_bytes()).done();
    [real, ours].map(|bytes| Matrix::read(&bytes).unwrap_or_else(|error| panic!("{words:?}: {error}")))
}

/// Words between spaces; quoted ones may contain spaces.
fn split(words: &str) -> Vec<&str> {
    let quoted = words.split('\'').enumerate();
    quoted
        .flat_map(|(index, part)| if index % 2 == 1 { vec![part] } else { part.split_whitespace().collect() })
        .collect()
}

#[track_caller]
fn assert_same([real, ours]: [Matrix; 2], words: &str, share: f32) {
    let kind = |matrix: &Matrix| (matrix.size(), matrix.components(), matrix.stored);
    assert_eq!(kind(&ours), kind(&real), "{words}");
    let largest = real.values().iter().copied().fold(0.0, f32::max);
    for (at, (ours, real)) in ours.values().iter().zip(real.values()).enumerate() {
        let off = (ours - real).abs();
        assert!(off <= share * real.abs() + 1e-6 * largest, "{words}: value {at} is {ours}, real {real}");
    }
}

#[test]
fn products_and_sums_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    for words in [
        "a.mtx",
        "-ff a.mtx b.mtx",
        "-fd a.mtx . b.mtx v.mtx",
        "a.mtx + c.mtx . b.mtx . v.mtx",
        "b.flt v.mtx",
        "a.mtx b.flt",
        "a.mtx + c.dbl",
        "-s 2 a.mtx + -s .5 1 2 c.mtx",
        "a.mtx * c.mtx / grey.mtx",
        "-t a.mtx . c.mtx",
        "-t a.mtx -t -s 3",
        "-c 1 0 0 0 1 0 a.mtx",
        "-c .3 .4 .3 -s 10 a.mtx",
        "-c 1 2 3 4 5 6 -s 2 3 a.mtx",
        "-c Y a.mtx",
        "-c XYZ a.mtx",
        "-c rgb a.hdr",
        "-c XYZ -fc a.hdr",
        "-c RGB a.xyz",
        "-fa -c Yz a.xyz",
        "-c SMA a.mtx",
        "-c sma a.mtx",
        "-C A a.mtx * c.mtx",
        "-fa a.hdr + exposed.hdr",
        "-fc exposed.hdr",
        "a.hdr * grey.mtx",
        "-ff six.mtx",
        "six.hsr",
        "-fa six.hsr + six.hsr",
        "-s 1 2 3 4 5 6 six.mtx",
        "-fc grey.mtx",
        "-fa -c a.hdr six.mtx",
    ] {
        let same_as_stored =
            if words.contains("hdr") || words.contains("hsr") || words.contains("-fc") { 0.01 } else { 1e-5 };
        assert_same(both(&radiance, &folder, "rmtxop", words, ""), words, same_as_stored);
    }
}

#[test]
fn colors_of_spectra_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    for words in [
        "-c RGB six.mtx",
        "-c XYZ six.mtx",
        "-c y six.mtx",
        "-c XYZ nine.mtx",
        "-c rgb nine.mtx",
        "-c six.mtx nine.mtx",
        "-c SM six.mtx",
        "-c sMA nine.mtx",
    ] {
        assert_same(both(&radiance, &folder, "rmtxop", words, ""), words, 0.02);
    }
}

#[test]
fn bsdf_files_are_the_matrices_of_the_real_program() {
    let (Some(radiance), Some(shared)) = (Radiance::find(), shared()) else { return };
    let folder = Folder::new();
    for file in [
        "loose/bsdf_xml/klemsfull.xml",
        "renders/blinds20c.xml",
        "scenes/frads_openoffice/Resources/ec60.xml",
        "loose/bsdf_xml/diffuse50.xml",
    ] {
        let path = shared.join(file);
        for words in ["", "-rf ", "-rb "] {
            let words = format!("-ff {words}{}", path.display());
            assert_same(both(&radiance, &folder, "rmtxop", &words, ""), &words, 1e-3);
        }
    }
}

#[test]
fn functions_of_elements_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    folder.file("half.cal", "half(x)=x/2;\n");
    for words in [
        "a.mtx c.mtx",
        "-s 2 a.mtx -s .5 c.mtx",
        "-e co=ci(1)*ci(2) a.mtx c.mtx",
        "-e co(p)=ci(1,p)-ci(2,4-p) a.mtx c.mtx",
        "-e 'ro=ri(1)+r;go=gi(2)*c;bo=ncols' a.mtx c.mtx",
        "-f half.cal -e co=half(ci(1))+nfiles+PI a.mtx",
        "-e co(p)=wl(p)*ci(1,p) six.mtx",
        "-e co(p)=wl(p)/100 nine.mtx",
        "a.mtx -m b.mtx",
        "a.mtx c.mtx -c Y -mt grey.mtx",
        "-C Y a.mtx c.mtx",
        "-fd a.mtx -c 1 0 0",
        "-fc a.hdr -e co=2*ci(1)",
    ] {
        let share = if words.contains("hdr") { 0.01 } else { 1e-5 };
        assert_same(both(&radiance, &folder, "rcomb", words, ""), words, share);
    }
}

#[test]
fn values_of_different_kinds_are_combined_with_a_warning() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    let run = |words: &str| run_with(command(&split(words)).current_dir(folder.path("")), b"");
    let warning = "a picture of X, Y and Z (XYZE) combined with a picture of red, green and blue (RGBE)\n";
    for (words, expected) in [
        ("rmtxop -fa a.hdr + a.xyz", format!("rmtxop: warning - a.xyz: {warning}")),
        ("rcomb -fa a.hdr a.xyz", format!("rcomb: warning - a.xyz: {warning}")),
        ("rcomb -w -fa a.hdr a.xyz", String::new()),
        ("rmtxop -fa a.hdr + a.hdr", String::new()),
        ("rmtxop -fa a.mtx + c.dbl", String::new()),
        ("rcomb -fa -C RGB a.hdr a.xyz", String::new()),
        ("rcomb -fa -e co(p)=1/(ci(1,p)-ci(1,p)) a.mtx", "rcomb: warning - division by zero\n".to_owned()),
        ("rcomb -w -fa -e co(p)=sqrt(-1-ci(1,p)) a.mtx", String::new()),
    ] {
        let run = run(words);
        assert_eq!((run.code, &run.messages), (0, &expected), "{words}");
        let has_line = String::from_utf8_lossy(&run.output).contains("\nWARNING: data type mismatch\n");
        assert_eq!(has_line, words.starts_with("rmtxop") && !expected.is_empty(), "{words}");
    }
}

#[test]
fn daylight_is_that_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    folder.file("sky.mtx", text([5, 6], 3, 8));
    let sky: String = text([5, 6], 3, 8).lines().skip(7).collect::<Vec<_>>().join("\n");
    for (words, input) in [
        ("b.flt v.mtx", ""),
        ("-of b.flt sky.mtx", ""),
        ("-od -n 6 b.flt", sky.as_str()),
        ("-n 6 -ia b.flt", sky.as_str()),
        ("a.mtx b.mtx sky6.mtx", ""),
        ("-x 2 -y 2 -of a.mtx b.mtx sky6.mtx v.mtx", ""),
        ("-oc -x 2 -y 2 a.mtx b.mtx sky6.mtx v.mtx", ""),
    ] {
        let words = words.replace("sky6.mtx", "five.mtx");
        folder.file("five.mtx", text([5, 5], 3, 9));
        let input = if words.starts_with("a.mtx") { text([5, 2], 3, 10) } else { input.to_owned() };
        let share = if words.contains("-oc") { 0.01 } else { 1e-5 };
        assert_same(both(&radiance, &folder, "dctimestep", &words, &input), &words, share);
    }
}

#[test]
fn files_of_moments_and_sums_of_pictures_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    for direction in 0..5 {
        folder.file(&format!("p{direction}.mtx"), text([4, 3], 3, 20 + direction));
        let words = ["-fc".to_owned(), format!("p{direction}.mtx")];
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let picture = run_with(radiance.command("rmtxop", &words).current_dir(folder.path("")), b"").done();
        folder.file(&format!("dc{direction:03}.hdr"), picture);
    }
    folder.file("sky.mtx", text([5, 3], 3, 8));
    assert_same(both(&radiance, &folder, "dctimestep", "-oc dc%03d.hdr v.mtx", ""), "one sky", 0.02);
    for (words, name) in
        [("-of -o out%02d.dat b.mtx sky.mtx", "out02.dat"), ("-oc -o sum%d.hdr dc%03d.hdr sky.mtx", "sum1.hdr")]
    {
        let words: Vec<&str> = words.split(' ').collect();
        let mut found = Vec::new();
        for is_real in [true, false] {
            let ours: Vec<&str> = std::iter::once("dctimestep").chain(words.iter().copied()).collect();
            let mut program = if is_real { radiance.command("dctimestep", &words) } else { command(&ours) };
            run_with(program.current_dir(folder.path("")), b"").done();
            let bytes = folder.read(name);
            let is_told =
                String::from_utf8_lossy(&bytes).contains(if name == "sum1.hdr" { "FRAME=1" } else { "FRAME=2" });
            assert!(is_told, "{name}");
            found.push(Matrix::read(&bytes).expect("a matrix"));
            std::fs::remove_file(folder.path(name)).expect("the file is removed");
        }
        let ours = found.pop().expect("two runs");
        assert_same([found.pop().expect("two runs"), ours], name, 0.02);
    }
}

/// The pictures in one output, each with its frame number.
fn frames(bytes: &[u8]) -> Vec<(String, Matrix)> {
    let starts = |at: &usize| bytes[*at..].starts_with(b"FRAME=");
    let read = |at: usize| {
        let line = bytes[at..].split(|byte| *byte == b'\n').next().expect("a line");
        (String::from_utf8_lossy(line).into_owned(), Matrix::read(&bytes[at..]).expect("a picture"))
    };
    (0..bytes.len()).filter(starts).map(read).collect()
}

#[test]
fn pictures_of_several_moments_follow_each_other_in_one_output() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    for direction in 0..3 {
        let picture = format!("-fc -s {} a.mtx", direction + 1);
        let picture = run_with(radiance.command("rmtxop", &split(&picture)).current_dir(folder.path("")), b"").done();
        folder.file(&format!("dc{direction}.hdr"), picture);
    }
    // The real program needs numbered names unless each sky has light from one direction only.
    let head = "#?RADIANCE\nNROWS=3\nNCOLS=3\nNCOMP=3\nFORMAT=ascii\n\n";
    folder.file("sky.mtx", format!("{head}1 .5 .2 0 0 0 0 0 0\n0 0 0 2 1 1 0 0 0\n0 0 0 0 0 0 .1 .2 .3\n"));
    for words in ["-oc dc%d.hdr sky.mtx", "-oc -o all.hdr dc%d.hdr sky.mtx"] {
        let ours: Vec<&str> = std::iter::once("dctimestep").chain(words.split(' ')).collect();
        let outputs = [radiance.command("dctimestep", &ours[1..]), command(&ours)].map(|mut program| {
            let printed = run_with(program.current_dir(folder.path("")), b"").done();
            if words.contains("all.hdr") { folder.read("all.hdr") } else { printed }
        });
        let [real, ours] = outputs.map(|bytes| frames(&bytes));
        assert_eq!((real.len(), ours.len()), (3, 3), "{words}");
        for ((real_name, real), (name, ours)) in real.into_iter().zip(ours) {
            assert_eq!(name, real_name);
            assert_same([real, ours], &name, 0.02);
        }
    }
    let many = run_with(command(&["dctimestep", "-oc", "dc%d.hdr", "b.mtx"]).current_dir(folder.path("")), b"").done();
    assert_eq!(frames(&many).len(), 5, "skies with light from several directions");
}

#[test]
fn a_view_times_a_window_times_daylight_times_a_sky() {
    let (Some(radiance), Some(shared)) = (Radiance::find(), shared()) else { return };
    let folder = Folder::new();
    let bsdf = shared.join("loose/bsdf_xml/klemsfull.xml");
    folder.file("view.mtx", text([2, 145], 3, 1));
    folder.file("daylight.mtx", text([145, 7], 3, 2));
    folder.file("sky.mtx", text([7, 2], 3, 3));
    let words = format!("-of view.mtx {} daylight.mtx sky.mtx", bsdf.display());
    assert_same(both(&radiance, &folder, "dctimestep", &words, ""), "three phases", 1e-3);
}

/// A room with a hole in the wall, and the hole as a receiver of rays.
const ROOM: &str = "\
void plastic grey 0 0 5 .5 .4 .3 0 0
grey polygon floor 0 0 12 0 0 0  4 0 0  4 5 0  0 5 0
grey polygon ceiling 0 0 12 0 0 3  0 5 3  4 5 3  4 0 3
grey polygon back 0 0 12 0 5 0  4 5 0  4 5 3  0 5 3
grey polygon left 0 0 12 0 0 0  0 5 0  0 5 3  0 0 3
grey polygon right 0 0 12 4 0 0  4 0 3  4 5 3  4 5 0
grey polygon sill 0 0 12 0 0 0  0 0 1  4 0 1  4 0 0
";
const WINDOW: &str = "\
#@rfluxmtx h=kf u=+Z o=view.vmx
void glow portal 0 0 4 1 1 1 0
portal polygon window 0 0 12 0 0 1  0 0 3  4 0 3  4 0 1
";

#[test]
fn the_real_rfluxmtx_runs_our_rcontrib() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder.file("window.rad", WINDOW);
    let links = folder.word("links");
    std::fs::create_dir(&links).expect("a folder");
    run_with(&mut command(&["install-links", &links]), b"").done();
    let words = ["-ff", "-I+", "-ab", "3", "-ad", "4000", "-lw", "1e-5", "-", "window.rad", "room.rad"];
    let points = "2 1 .8 0 0 1\n2 3 .8 0 0 1\n1 4 .8 0 0 1\n".repeat(REPEATS);
    let points: Vec<u8> =
        points.split_whitespace().flat_map(|word| word.parse::<f32>().expect("a number").to_ne_bytes()).collect();
    let mut found = Vec::new();
    for is_real in [true, false] {
        let mut program = radiance.command("rfluxmtx", &words);
        if !is_real {
            let path =
                program.get_envs().find(|(name, _)| *name == "PATH").and_then(|(_, path)| path.map(ToOwned::to_owned));
            let mut own = std::ffi::OsString::from(&links);
            own.push(":");
            own.push(path.or_else(|| env::var_os("PATH")).unwrap_or_default());
            program.env("PATH", own);
        }
        run_with(program.current_dir(folder.path("")), &points).done();
        found.push(Matrix::read(&folder.read("view.vmx")).expect("a matrix"));
        std::fs::remove_file(folder.path("view.vmx")).expect("the file is removed");
    }
    assert_eq!((found[0].size(), found[0].components()), (found[1].size(), found[1].components()));
    for point in 0..3 {
        let [(real, real_error), (ours, our_error)] = [&found[0], &found[1]].map(|matrix| mean_total(matrix, point));
        let bound = 5.0 * real_error.hypot(our_error) + 0.01 * real;
        assert!((ours - real).abs() < bound, "point {point}: {ours} here, {real} there, bound {bound}");
    }
}

/// Number of repetitions of each point: real `rcontrib` uses other samples in each run.
const REPEATS: usize = 16;

/// Mean of the sums of a point's rows, with its standard error.
fn mean_total(matrix: &Matrix, point: usize) -> (f64, f64) {
    let rows = matrix.values().chunks_exact(3 * matrix.columns()).skip(point).step_by(3);
    let totals: Vec<f64> = rows.map(|row| row.iter().map(|value| f64::from(*value)).sum()).collect();
    let count = totals.len() as f64;
    let mean = totals.iter().sum::<f64>() / count;
    let variance = totals.iter().map(|total| (total - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// Four days of hours with varying light in units of a WEA file: also at night, and none by day.
fn weather(units: u32, scale: f64) -> String {
    let mut text = format!(
        "place Test_X\nlatitude 47.4\nlongitude -8.5\ntime_zone -15\nsite_elevation 400\nweather_data_file_units {units}\n"
    );
    for (step, (month, day)) in [(2, 28), (2, 29), (6, 21), (12, 3)].into_iter().enumerate() {
        for hour in 0..24 {
            let turn = (7 * hour + 5 * step) % 11;
            let direct = if (6..20).contains(&hour) { [0., 30., 200., 500., 900.][turn % 5] * scale } else { 0.0 };
            let diffuse = if (6..20).contains(&hour) { [5., 50., 150., 400.][turn % 4] * scale } else { 0.0 };
            text += &format!("{month} {day} {hour}.500 {direct} {diffuse}\n");
        }
    }
    text
}

#[test]
fn skies_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    for (name, units, scale) in [("normal.wea", 1, 1.0), ("level.wea", 2, 0.5), ("lux.wea", 3, 110.0)] {
        folder.file(name, weather(units, scale));
        for options in
            ["-m 2", "-O1", "-s", "-d", "-u -A", "-r 30", "-5 .533 -d -m 3", "-g .3 .2 .1 -c 1 .9 .8 -i 60", "-h"]
        {
            let words = format!("-of {options} {name}");
            if options == "-h" {
                let [real, ours] =
                    [radiance.command("gendaymtx", &[options, name]), command(&["gendaymtx", options, name])]
                        .map(|mut program| run_with(program.current_dir(folder.path("")), b"").text());
                // Three digits, of which the last may be rounded differently.
                let lines = |text: &str| text.lines().map(|line| line.split(' ').count()).collect::<Vec<_>>();
                assert!(lines(&ours) == lines(&real), "the lines differ");
                let numbers = ours.split_whitespace().zip(real.split_whitespace());
                for (ours, real) in numbers.filter(|(ours, real)| ours != real) {
                    let [ours, real] = [ours, real].map(|word| word.parse::<f64>().expect("a number"));
                    assert!((ours / real - 1.0).abs() < 0.011, "{ours}, real {real}");
                }
                continue;
            }
            assert_same(both(&radiance, &folder, "gendaymtx", &words, ""), &words, 2e-4);
        }
    }
    let suns = [
        (radiance.command("gendaymtx", &split("-n -D theirs.rad -M theirs.txt normal.wea")), "theirs"),
        (command(&split("gendaymtx -n -D ours.rad -M ours.txt normal.wea")), "ours"),
    ];
    let [real, ours] = suns.map(|(mut program, name)| {
        assert!(run_with(program.current_dir(folder.path("")), b"").done().is_empty());
        [folder.read(&format!("{name}.rad")), folder.read(&format!("{name}.txt"))]
    });
    assert!(ours == real && !ours[1].is_empty());
}

/// Numbers of the lines after the header, if there is one.
fn vector(text: &str) -> (Vec<&str>, Vec<[f64; 3]>) {
    let (head, body) = text.split_once("\n\n").unwrap_or(("", text));
    let numbers = |line: &str| {
        let numbers: Vec<f64> = line.split('\t').map(|word| word.parse().expect("a number")).collect();
        numbers.try_into().expect("three numbers")
    };
    (head.lines().collect(), body.lines().map(numbers).collect())
}

/// References from Radiance's own `genskyvec.pl` with real programs; its header names the script
/// `genskyvec`, too.
#[test]
fn skies_in_patches_are_those_of_the_real_script() {
    let folder = root().join("tests/genskyvec");
    for (name, sky, words) in [
        ("clear", "clear", "-m 1"),
        ("perez", "perez", "-m 1 -c .92 1.03 1.2"),
        ("cloudy", "cloudy", "-m 2 -h -c 1 1 1"),
        ("five", "perez", "-m 1 -5 -d"),
        ("direct", "clear", "-m 1 -d -c 1 1 1"),
    ] {
        let read = |file: String| std::fs::read_to_string(folder.join(file)).expect("a file");
        let words = format!("genskyvec {words}");
        let made = run_with(&mut command(&split(&words)), read(format!("{sky}.rad")).as_bytes()).text();
        let expected = read(format!("{name}.vec"));
        let ((ours, found), (real, expected)) = (vector(&made), vector(&expected));
        assert_eq!(ours, real, "{words}");
        assert_eq!(found.len(), expected.len(), "{words}");
        for (patch, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 2e-6 * b);
            assert!(close, "{words}: patch {patch}: {found:?} instead of {expected:?}");
        }
    }
}

#[test]
fn wrong_skies_are_reported() {
    let sky = "void brightfunc skyfunc\n2 skybr skybright.cal\n0\n7 1 1 1 1 0 0 1\n";
    for (words, input, code, message) in [
        ("genskyvec -q", sky, 2, "genskyvec: unknown option \"-q\""),
        ("genskyvec -m 0", sky, 2, "subdivision (-m) is 0, expected an integer above zero"),
        ("genskyvec -m 1000", sky, 2, "subdivision (-m) is 1000, expected at most 64"),
        ("genskyvec -c 1 2", sky, 2, "missing blue (-c)"),
        ("genskyvec", "void glow a 0 0 4 1 1 1 0\n", 1, "\"skyfunc\" is missing"),
        ("genskyvec", "!gensky 6 21 12\n", 1, "a line is a command, expected scene text without commands"),
        ("genskyvec", "void brightfunc skyfunc\n2 skybr\n", 1, "a primitive is incomplete"),
        ("genskyvec -m 1", "void brightfunc skyfunc 2 skybr nowhere.cal 0 0\n", 1, "nowhere.cal"),
    ] {
        let run = run_with(&mut command(&split(words)), input.as_bytes());
        assert_eq!((run.code, run.output.len()), (code, 0), "{words}: {}", run.messages);
        assert!(run.messages.contains(message), "{words}: {}", run.messages);
    }
}

#[test]
fn results_are_stored_as_asked() {
    let folder = Folder::new();
    folder.file("a.mtx", text([4, 3], 3, 1));
    for (format, stored) in
        [("-ff", Stored::Float), ("-fd", Stored::Double), ("-fa", Stored::Ascii), ("-fc", Stored::Rgbe)]
    {
        let made = run_with(command(&["rmtxop", format, "a.mtx"]).current_dir(folder.path("")), b"").done();
        assert_eq!(Matrix::read(&made).expect("a matrix").stored, stored);
    }
}

#[test]
fn wrong_command_lines_and_input_are_reported() {
    let folder = Folder::new();
    folder.file("a.mtx", text([4, 3], 3, 1));
    folder.file("b.mtx", text([3, 5], 3, 2));
    folder.file("six.mtx", text([4, 3], 6, 6));
    folder.file("short.mtx", "#?RADIANCE\nNROWS=9\nNCOLS=9\n\n1 2 3\n");
    folder.file("huge.mtx", "#?RADIANCE\nNROWS=2000000000\nNCOLS=2000000000\nFORMAT=float\n\n");
    folder.file("bad.xml", "<WindowElement/>");
    folder.file("day.wea", weather(1, 1.0));
    folder.file("odd.wea", weather(1, 1.0).replace("2 29 12.500", "2 30 12.500"));
    let check = |words: &str, code: i32, message: &str| {
        let words = split(words);
        let run = run_with(command(&words).current_dir(folder.path("")), b"");
        assert_eq!(run.code, code, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?}: {}", run.messages);
        assert!(run.output.is_empty(), "{words:?}");
    };
    check("rmtxop", 2, "no matrix is given");
    check("rmtxop + a.mtx", 2, "\"+\" has no matrix before it");
    check("rmtxop a.mtx +", 2, "has no matrix after it");
    check("rmtxop - + -", 2, "standard input is named twice");
    check("rmtxop -q a.mtx", 2, "option \"-q\" is unknown");
    check("rmtxop -s a.mtx", 2, "option \"-s\" has no factors");
    check("gendaymtx -m 91 day.wea", 2, "subdivision (-m) is 91, expected 1 to 90");
    check("gendaymtx -m 90 -x day.wea", 2, "unknown option \"-x\"");
    check("gendaymtx -m 90 day.wea", 1, "the output exceeds");
    check("gendaymtx odd.wea", 1, "odd.wea: line 43: there is no hour 12.5 of day 30 in month 2");
    check("gendaymtx a.mtx", 1, "expected \"place\" or \"LOCATION,\"");
    check("gendaymtx none.wea", 1, "none.wea");
    check("gendaymtx -r", 2, "missing rotation in degrees (-r)");
    check("rmtxop none.mtx", 1, "cannot read matrix \"none.mtx\"");
    check("rmtxop b.mtx a.mtx", 1, "a.mtx: a product of 3 x 5 and 4 x 3");
    check("rmtxop a.mtx + b.mtx", 1, "b.mtx: 3 x 5, expected 4 x 3");
    check("rmtxop a.mtx + six.mtx", 1, "six.mtx: 6 components, expected 3");
    check("rmtxop -c Q a.mtx", 1, "component \"Q\" is not known");
    check("rmtxop -c 1 2 a.mtx", 1, "2 coefficients for 3 components");
    check("rmtxop -s 1 2 a.mtx", 1, "2 factors for 3 components");
    check("rmtxop short.mtx", 1, "short.mtx: ");
    check("rmtxop huge.mtx", 1, "huge.mtx: ");
    check("rmtxop bad.xml", 1, "bad.xml: ");
    check("rmtxop '!exit 3'", 1, "command \"exit 3\"");
    check("rcomb", 2, "no matrix is given");
    check("rcomb a.mtx b.mtx", 1, "b.mtx: 3 x 5, expected 4 x 3");
    check("rcomb a.mtx -m b.mtx -zz", 2, "option \"-zz\" is unknown");
    check("rcomb -e co=(1 a.mtx", 1, "option -e:1:");
    check("rcomb -e co=nothere a.mtx", 1, "nothere");
    check("rcomb -f none.cal a.mtx", 1, "none.cal");
    check("rcomb - -m -", 2, "standard input is named twice");
    check("dctimestep", 2, "no coefficients are given");
    check("dctimestep -zz a.mtx", 2, "option \"-zz\" is unknown");
    check("dctimestep a a a a a", 2, "unexpected argument");
    check("dctimestep a.mtx six.mtx", 1, "six.mtx: 6 components, expected 3");
    check("dctimestep a.mtx a.mtx", 1, "a product of 4 x 3 and 4 x 3");
    check("dctimestep -n 2 a.mtx short.mtx", 1, "\"#?RADIANCE\" is not a number");
    check("dctimestep -x 7 a.mtx b.mtx", 1, "cannot be arranged as");
    check("dctimestep -o out%d.hdr none%d.hdr b.mtx", 1, "cannot read matrix \"none0.hdr\"");
}
