//! Compares mgf2rad, pkgBSDF, ies2rad and obj2rad with the real programs.

mod oracle;

use oracle::{Radiance, TestLoader, ours, words};

const MGF: &str = "# all of the format
c red = 
	cxy .6 .3
c dark = red
c bb =
cct 3000
c mixed =
cmix .3 red .7 dark
c spec =
cspec 400 700 .1 .5 .9 .2
m plastic_red =
c red
rd .5
c
rs .04 .02
sides 2
m m_spec =
c spec
rd .3
m copper =
c red
rs .7 .1
rd .1
m green_gloss =
c
cxy .25 .6
rd .4
c red
rs .3 .05
m pane =
ir 1.52 0
c
rs .08 0
ts .7 0
m solid_glass = pane
sides 1
m trans1 =
c mixed
rd .2
td .3
rs .03 .01
ts .1 .01
m lamp =
c bb
ed 1000
m two_rough =
c
rs .1 0
ts .3 .2
o top
v v0 =
p 0 0 0
v v1 =
p 1 0 0
v v2 =
p 1 1 .1
v v3 =
p 0 1 .1
v n0 =
p 0 0 1
n 0 .1 1
v n1 =
p 1 0 1
n .2 0 1
v n2 =
p 1 1 1
n 0 0 1
v h0 =
p .2 .2 .02
v h1 =
p .4 .2 .02
v h2 =
p .4 .4 .04
m plastic_red
f v0 v1 v2 v3
fh v0 v1 v2 v3 - h0 h1 h2
m m_spec
sph v1 .3
sph v1 -.2
m copper
cyl v0 .1 v2
cyl v0 -.1 v1
cone v0 .1 v1 .2
cone v0 0 v1 -.2
m pane
ring n0 0 .5
ring n1 .1 .5
m solid_glass
prism v0 v1 v2 v3 .5
prism n0 n1 n2 -.5
m trans1
torus n2 .2 .6
m lamp
xf -t 1 2 3 -rz 30 -a 2 -t 0 0 1 -a 3 -mx
o in
f v0 v1 v2
sph v3 .1
o
xf
m green_gloss
f v2 v1 v0
m two_rough
f v0 v1 v3
m plastic_red
rd .6
f v0 v1 v2
m
f v0 v1 v2
o
nonsense 1 2
";

#[test]
fn the_whole_of_mgf_equals_the_real_translation() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir();
    std::fs::write(folder.join("radsight-scene-generators.mgf"), MGF).unwrap();
    let loader = TestLoader { folders: vec![folder], ..TestLoader::default() };
    for line in ["mgf2rad radsight-scene-generators.mgf", "mgf2rad -g 2 -e .5 radsight-scene-generators.mgf"] {
        let real = radiance.run(&words(line), b"", loader.folders.first().map(|folder| folder.as_path()));
        let mine = String::from_utf8(ours(&words(line), b"", &loader).unwrap().standard_output).unwrap();
        let (mine, real): (Vec<&str>, Vec<&str>) =
            (mine.split_whitespace().collect(), real.standard_output.split_whitespace().collect());
        assert_eq!(mine.len(), real.len(), "{line}");
        for (place, (a, b)) in mine.iter().zip(&real).enumerate() {
            // The real program names an undefined modifier, and truncates spectra to integers.
            let close = |a: &f64, b: &f64| (a - b).abs() <= 5e-4 * a.abs().max(1e-2);
            let both = a.parse().ok().zip(b.parse().ok());
            let same = a == b || (*a, *b) == ("Phong", "T-nor");
            let context = || mine[place.saturating_sub(12)..place].join(" ");
            assert!(same || both.is_some_and(|(a, b)| close(&a, &b)), "{line}: ours {a}, real {b} after {}", context());
        }
    }
}

#[test]
fn spectra_keep_their_luminance() {
    let loader = TestLoader::default();
    let text = ours(&words("mgf2rad -s"), MGF.as_bytes(), &loader).unwrap().standard_output;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("\nvoid spectrum spec*\n0\n0\n33 400 700\t") && text.contains("\nspec* plastic m_spec\n"));
    assert!(text.contains("\nvoid spectrum bb*\n") && text.contains("\nbb* light lamp\n"), "{text}");
}

#[test]
fn smoothed_faces_have_their_texture_as_modifier() {
    let text = "v a =\np 0 0 0\nn 0 .3 1\nv b =\np 1 0 0\nn .3 0 1\nv c =\np 0 1 0\nn 0 0 1\nf a b c\n";
    let text = ours(&words("mgf2rad"), text.as_bytes(), &TestLoader::default()).unwrap().standard_output;
    let text = String::from_utf8(text).unwrap();
    assert!(
        text.contains("\nmat texfunc Phong\n4 dx dy dz tmesh.cal\n") && text.contains("\nPhong polygon t1\n"),
        "{text}"
    );
}

#[test]
fn bad_geometry_is_an_error_with_its_line() {
    let message =
        |text: &str| ours(&words("mgf2rad"), text.as_bytes(), &TestLoader::default()).unwrap_err().to_string();
    assert_eq!(message("m\nf a b c"), "mgf2rad: standard input: line 2: vertex \"a\" is not defined");
    assert_eq!(message("o 1x"), "mgf2rad: standard input: line 1: \"1x\" is not a name: names begin with a letter");
    assert_eq!(message("xf"), "mgf2rad: standard input: line 1: no transform is open");
    assert_eq!(message("rd 2"), "mgf2rad: standard input: line 1: 2 is not a number from 0 to 1");
    assert!(message("xf -a 1000000000\nxf").contains("more than 2000000 statements"));
    let mut loader = TestLoader::default();
    loader.files.insert("loop.mgf".into(), b"i loop.mgf".to_vec());
    let message = ours(&words("mgf2rad loop.mgf"), b"", &loader).unwrap_err().to_string();
    assert!(message.contains("nested more than 32 deep"), "{message}");
}

fn bsdf(geometry: &str, reflection: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?><WindowElement xmlns=\"x\"><FileType>BSDF</FileType><Optical><Layer><Material>\
         <Name>N</Name><Manufacturer>M</Manufacturer><Thickness unit=\"meter\">.05</Thickness>\
         <Width unit=\"foot\">3</Width><Height unit=\"meter\">2</Height></Material>{geometry}<WavelengthData><WavelengthDataBlock>\
         <WavelengthDataDirection>Reflection Front</WavelengthDataDirection><ScatteringData>{reflection}</ScatteringData>\
         </WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>"
    )
}

#[test]
fn a_bsdf_is_decoded_from_latin_1_and_utf_16() {
    let text = bsdf("", "1, 1").replace("<Name>N<", "<Name>B\u{fc}ro<");
    let little: Vec<u8> = "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    let latin: Vec<u8> = text.chars().map(|character| character as u8).collect();
    for bytes in [text.clone().into_bytes(), latin, little, big, format!("genBSDF <x.rad>\n{text}\n").into_bytes()] {
        let mut loader = TestLoader::default();
        loader.files.insert("pane.xml".into(), bytes);
        let output = ours(&words("pkgBSDF -s pane.xml"), b"", &loader).unwrap().standard_output;
        let output = String::from_utf8(output).unwrap();
        assert!(
            output.contains("# Material 'B\u{fc}ro' by 'M'\n") && output.contains("void BSDF m_pane\n"),
            "{output}"
        );
    }
}

#[test]
fn a_bsdf_becomes_its_surfaces() {
    let geometry = "<Geometry format=\"MGF\"><MGFblock unit=\"inch\">v a =\np 0 0 0\nv b =\np 1 0 0\nv c =\np 0 1 0\nf a b c\n</MGFblock></Geometry>";
    let mut loader = TestLoader::default();
    loader.files.insert("x/flat.xml".into(), bsdf("", "1, 1").into_bytes());
    loader.files.insert("both.xml".into(), bsdf(geometry, "1, 2").into_bytes());
    let text = |line: &str| String::from_utf8(ours(&words(line), b"", &loader).unwrap().standard_output).unwrap();
    let flat = text("pkgBSDF -s x/flat.xml");
    assert!(flat.contains("void BSDF m_flat\n6 0 flat.xml 0 1 0 .\n") && !flat.contains("_b"));
    assert!(flat.contains("\t4.572000e-01\t1.000000e+00\t0.000000e+00\n"), "{flat}");
    let both = text("pkgBSDF -s both.xml");
    assert!(both.contains("m_both_f polygon both_f") && both.contains("m_both_b polygon both_b"));
    assert!(both.contains("\n            0.0254                  0                  0\n"), "{both}");
    loader.files.insert("a b.xml".into(), bsdf("", "1, 1").into_bytes());
    let spaced = String::from_utf8(
        ours(&["pkgBSDF", "-s", "a b.xml"].map(str::to_owned), b"", &loader).unwrap().standard_output,
    )
    .unwrap();
    assert!(spaced.contains("void BSDF \"m_a b\"\n6 0 \"a b.xml\" 0 1 0 .\n"), "{spaced}");
    assert!(spaced.contains("\n\"m_a b\" polygon \"a b\"\n"), "{spaced}");
    loader.files.insert("bomb.xml".into(), b"<!DOCTYPE a [<!ENTITY b \"c\">]><WindowElement/>".to_vec());
    assert!(ours(&words("pkgBSDF -s bomb.xml"), b"", &loader).is_err());
}

/// A luminaire file with the given first line, tilt section, angles and opening.
fn ies(version: &str, tilt: &str, horizontal: &[f64], vertical: &[f64], opening: &str, kind: &str) -> String {
    let words = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let candela: Vec<f64> = (0..horizontal.len() * vertical.len()).map(|i| 1000.0 + 37.5 * (i % 7) as f64).collect();
    format!(
        "{version}\r\n[TEST] 12\r\n[LAMP] two warm-white tubes\r\n{tilt}\r\n2 1000. 1.5 {} {} {kind} {opening}\r\n.9 .95 60\r\n{}\r\n{}\r\n{}\r\n",
        vertical.len(),
        horizontal.len(),
        words(vertical),
        words(horizontal),
        words(&candela)
    )
}

const DOWN: &[f64] = &[0.0, 30.0, 60.0, 90.0];
const ALL: &[f64] = &[0.0, 45.0, 90.0, 120.0, 180.0];

fn luminaires() -> Vec<String> {
    let none = "TILT=NONE";
    let mut files = Vec::new();
    for (horizontal, kind) in [
        (&[0.0][..], "1 2"),
        (&[0.0, 45.0, 90.0], "1 1"),
        (&[0.0, 90.0, 180.0], "1 2"),
        (&[90.0, 180.0, 270.0], "1 2"),
        (&[0.0, 120.0, 240.0, 360.0], "1 2"),
        (&[0.0, 45.0, 90.0], "2 2"),
        (&[-90.0, 0.0, 90.0], "2 2"),
    ] {
        for vertical in [DOWN, ALL] {
            files.push(ies("IESNA:LM-63-2002", none, horizontal, vertical, ".2 .6 .1", kind));
        }
    }
    for version in ["old luminaire", "IESNA91", "IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019"] {
        for l in [".3", "0", "-.3"] {
            for w in [".3", "0", "-.3", "-1.2"] {
                for h in [".3", "0", "-.3", "2"] {
                    files.push(ies(version, none, &[0.0], ALL, &format!("{w} {l} {h}"), "1 2"));
                }
            }
        }
    }
    for tilt in [
        "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 .9 .8",
        "TILT=INCLUDE\n2 4 0 45 100 180 1 .9 .8,.7",
        "TILT=INCLUDE\n3 2 0 90 1 .9",
        "TILT=INCLUDE\n4 2 0 90 1 .9",
        "TILT=INCLUDE\n1 x",
    ] {
        files.push(ies("IESNA91", tilt, &[0.0], DOWN, "0 0 0", "1 2"));
    }
    files.push(ies("IESNA91", none, &[0.0], DOWN, "0 0 0", "3 2"));
    files.push("IESNA91\nno tilt\n".to_owned());
    files
}

#[test]
fn luminaires_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir().join("radsight-generate-ies");
    std::fs::create_dir_all(&folder).unwrap();
    let options = [
        "",
        "-dm",
        "-di/2",
        "-dc -m .5",
        "-t default -c 1 .5 .2",
        "-i .25",
        "-t mercury",
        "-u xenon",
        "-p sub",
        "-l sub",
        "-l . -p sub",
        "-l sub -p ./sub",
        "-g",
        "-f none -c 1 .5 .2",
        "-f none -t mercury",
    ];
    std::fs::create_dir_all(folder.join("sub")).unwrap();
    let (mut same, mut refused) = (0, 0);
    for (number, text) in luminaires().into_iter().enumerate() {
        let options = if number % 3 == 0 { options[number / 3 % options.len()] } else { "" };
        let argv = words(&format!("ies2rad {options} -o out in.ies"));
        std::fs::write(folder.join("in.ies"), &text).unwrap();
        let prefix = match options {
            "-p sub" | "-l sub" => "sub/",
            "-l . -p sub" | "-l sub -p ./sub" => "./sub/",
            _ => "",
        };
        let names = ["out.rad", "out.dat", "out%.dat"].map(|name| format!("{prefix}{name}"));
        names.iter().for_each(|name| drop(std::fs::remove_file(folder.join(name))));
        let real = radiance.run(&argv, b"", Some(&folder));
        let loader = TestLoader { folders: vec![folder.clone()], ..TestLoader::default() };
        let output = match ours(&argv, b"", &loader) {
            Ok(output) if real.succeeded => output,
            Ok(_) => panic!("{argv:?}: real fails with {}\n{text}", real.standard_error),
            Err(error) => {
                assert!(!real.succeeded, "{argv:?}: {error}\n{text}");
                refused += 1;
                continue;
            }
        };
        for name in &names {
            let real = std::fs::read_to_string(folder.join(name)).ok();
            let mine = output.files.iter().find(|file| file.0 == *name);
            let mine = mine.map(|file| String::from_utf8(file.1.clone()).unwrap());
            assert_eq!(mine.is_some(), real.is_some(), "{argv:?} {name}\n{text}");
            let (Some(mine), Some(real)) = (mine, real) else { continue };
            match oracle::compare(&mine, &real) {
                oracle::Likeness::Different(what) => panic!("{argv:?} {name}: {what}\n{mine}\n---\n{real}\n{text}"),
                likeness => same += usize::from(likeness == oracle::Likeness::Identical),
            }
        }
    }
    println!("ies2rad: {same} files are the same bytes, {refused} luminaires are refused by both");
}

#[test]
fn luminaires_are_converted_without_an_octree_or_a_lamp_table() {
    let plain = ies("IESNA:LM-63-1995", "TILT=NONE", &[0.0], ALL, ".3 .3 0", "1 2");
    let with_geometry = plain.replace("TILT=NONE", "[LUMINOUSGEOMETRY] body.mgf\nTILT=NONE");
    let files = [
        ("plain.ies", plain.as_str()),
        ("body.ies", with_geometry.as_str()),
        ("body.mgf", "v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 0 1 0\nf a b c\n"),
    ]
    .map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
    let loader = TestLoader { files: files.into(), ..TestLoader::default() };
    for (line, warnings) in [
        ("ies2rad -t default -g plain.ies", &[][..]),
        ("ies2rad -t default -g body.ies", &["-g: the scene holds the geometry of \"body.mgf\" itself, not an octree"]),
        ("ies2rad -f none plain.ies", &["no lamp data: "]),
    ] {
        let output = ours(&words(line), b"", &loader).unwrap_or_else(|error| panic!("{line}: {error}"));
        assert_eq!(output.files.len(), 2, "{line}");
        assert_eq!(output.warnings.len(), warnings.len(), "{line}: {:?}", output.warnings);
        assert!(output.warnings.iter().zip(warnings).all(|(found, begin)| found.starts_with(begin)), "{line}");
    }
}

/// The library's folder is for `RAYPATH`: only the files stand there, the scene does not name it.
#[test]
fn files_of_a_luminaire_go_to_the_folder_of_the_library() {
    let tilt = "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 .9 .8";
    let text = ies("IESNA91", tilt, &[0.0], DOWN, "0 0 0", "1 2");
    let loader = TestLoader { files: [("a.ies".to_owned(), text.into_bytes())].into(), ..TestLoader::default() };
    for (options, folder, named) in [
        ("-l lib", "lib/", ""),
        ("-l lib/ -p sub/", "lib/sub/", "sub/"),
        ("-l lib -p ./sub", "./sub/", "./sub/"),
        ("-l lib -p /sub", "/sub/", "/sub/"),
    ] {
        let output = ours(&words(&format!("ies2rad -t default {options} a.ies")), b"", &loader).unwrap();
        let mut files: Vec<&str> = output.files.iter().map(|file| file.0.as_str()).collect();
        files.sort_unstable();
        assert_eq!(files, ["a%.dat", "a.dat", "a.rad"].map(|name| format!("{folder}{name}")), "{options}");
        let scene = &output.files.iter().find(|file| file.0.ends_with(".rad")).unwrap().1;
        let scene = String::from_utf8(scene.clone()).unwrap();
        assert!(scene.contains(&format!(" '{named}a.dat' ")) && scene.contains(&format!(" {named}a%.dat ")), "{scene}");
    }
}

const MGF_WITH_LUMINAIRES: &str = "o lamp\nies a.ies\nxf -t 1 2 3\nies a.ies -t 0 0 1\nxf -a 2 -rz 90\n\
    o inner\nies lum/b.ies -rx 30\no\nxf\nxf\no\nies a.ies\nies c.ies -m 2\n";

#[test]
fn luminaires_of_mgf_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir().join("radsight-mgf-luminaires");
    drop(std::fs::remove_dir_all(&folder));
    std::fs::create_dir_all(folder.join("lum")).unwrap();
    let text = ies("IESNA91", "TILT=NONE", &[0.0], DOWN, "0 0 0", "1 2");
    for name in ["a.ies", "lum/b.ies", "c.ies"] {
        std::fs::write(folder.join(name), &text).unwrap();
    }
    std::fs::write(folder.join("in.mgf"), MGF_WITH_LUMINAIRES).unwrap();
    let loader = TestLoader { folders: vec![folder.clone()], ..TestLoader::default() };
    let argv = words("mgf2rad in.mgf");
    let mine = ours(&argv, b"", &loader).unwrap();
    let real = radiance.run(&argv, b"", Some(&folder));
    assert_eq!(String::from_utf8_lossy(&mine.standard_output), real.standard_output);
    assert_eq!(mine.files.len(), 6, "{:?}", mine.files);
    for (name, bytes) in &mine.files {
        let real = std::fs::read_to_string(folder.join(name)).unwrap();
        let without_command = |text: &str| text.split_once('\n').map(|(_, rest)| rest.to_owned()).unwrap_or_default();
        let (mine, real) = (without_command(&String::from_utf8_lossy(bytes)), without_command(&real));
        assert!(!matches!(oracle::compare(&mine, &real), oracle::Likeness::Different(_)), "{name}\n{mine}\n{real}");
    }
    // Files that exist are kept, but not one whose multiplier may be another.
    let again = ours(&argv, b"", &loader).unwrap();
    let names: Vec<&str> = again.files.iter().map(|file| file.0.as_str()).collect();
    assert_eq!(names, ["c_m2.dat", "c_m2.rad"]);
}

#[test]
fn luminaires_of_mgf_are_transformed_as_their_place_says() {
    let text = ies("IESNA91", "TILT=NONE", &[0.0], DOWN, "0 0 0", "1 2").into_bytes();
    let files = ["a.ies", "lum/b.ies", "c.ies"].map(|name| (name.to_owned(), text.clone()));
    let loader = TestLoader { files: files.into(), ..TestLoader::default() };
    let output = ours(&words("mgf2rad"), MGF_WITH_LUMINAIRES.as_bytes(), &loader).unwrap();
    let scene = String::from_utf8(output.standard_output).unwrap();
    let commands: Vec<&str> = scene.lines().filter(|line| line.starts_with('!')).collect();
    assert_eq!(
        commands,
        [
            "!xform -n lamp a.rad",
            "!xform -n lamp -t 0 0 1 -i 1 -t 1 2 3 a.rad",
            "!xform -n lamp.a0.inner -rx 30 -i 1 -i 0 -rz 90 -t 1 2 3 b.rad",
            "!xform -n lamp.a1.inner -rx 30 -i 1 -i 1 -rz 90 -t 1 2 3 b.rad",
            "!xform a.rad",
            "!xform c.rad",
        ]
    );
    let names: Vec<&str> = output.files.iter().map(|file| file.0.as_str()).collect();
    assert_eq!(names, ["a.dat", "a.rad", "b.dat", "b.rad", "c.dat", "c.rad"]);
    let missing = ours(&words("mgf2rad"), b"ies none.ies", &loader).unwrap_err().to_string();
    assert!(missing.contains("none.ies"), "{missing}");
}

/// Radiance writes `xform -m 2`, which is the modifier "2".
#[test]
fn luminaires_of_mgf_with_other_multipliers_have_files_of_their_own() {
    let text = ies("IESNA91", "TILT=NONE", &[0.0], DOWN, "0 0 0", "1 2").into_bytes();
    let files = ["a.ies", "b.ies", "b.rad"].map(|name| (name.to_owned(), text.clone()));
    let mut loader = TestLoader { files: files.into(), ..TestLoader::default() };
    loader.files.insert("./b.rad".into(), Vec::new());
    let mgf = "ies a.ies -m 2\nies a.ies\nies a.ies -m .5 -rx 3\nies a.ies -m 2 -t 1 0 0\nies b.ies\nies b.ies -m 2\n";
    let output = ours(&words("mgf2rad"), mgf.as_bytes(), &loader).unwrap();
    let scene = String::from_utf8(output.standard_output).unwrap();
    let commands: Vec<&str> = scene.lines().filter_map(|line| line.strip_prefix("!xform ")).collect();
    assert_eq!(commands, ["a.rad", "a_m1.rad", "-rx 3 a_m.5.rad", "-t 1 0 0 a.rad", "b.rad", "b_m2.rad"]);
    let radiance = |name: &str| {
        let scene = &output.files.iter().find(|file| file.0 == name).unwrap_or_else(|| panic!("{name}")).1;
        let scene = String::from_utf8(scene.clone()).unwrap();
        let line = scene.lines().skip_while(|line| !line.contains("_dist'")).nth(3).unwrap().to_owned();
        line.strip_prefix("1 ").unwrap().parse::<f64>().unwrap()
    };
    let ratio = |name: &str| radiance(name) / radiance("a_m1.rad");
    for (name, expected) in [("a.rad", 2.0), ("a_m.5.rad", 0.5), ("b_m2.rad", 2.0)] {
        assert!((ratio(name) / expected - 1.0).abs() < 1e-4, "{name}: {}", ratio(name));
    }
}

/// Wavefront text with flat, curved, smooth, degenerate and many-cornered faces under changing
/// names.
fn wavefront(numbers: &mut oracle::Numbers) -> String {
    let mut text = String::from("# made for a test\n#tight comment\nmtllib none.mtl\n");
    let points = 24;
    for index in 0..points {
        let z = if numbers.chance(2) { 0.0 } else { numbers.between(-0.5, 0.5) };
        text += &format!("v {:.4} {:.4} {z:.4}\n", (index % 6) as f64, (index / 6) as f64);
        text += &format!("vn {:.3} {:.3} 1\nvt .5 .{index}\n", numbers.between(-0.6, 0.6), numbers.between(-0.6, 0.6));
    }
    text += "vn 0 0 0\nvn 0 0 1\nvn 0 0 -1\nvt x\n";
    for _ in 0..40 {
        text += match numbers.below(12) {
            0 => "usemtl red\n",
            1 => "usemtl blue\n",
            2 => "g left wheel\n",
            3 => "g\n",
            4 => "o body\n",
            5 => "usemap wood\nusemap off\n",
            6 => "s 1\n\n",
            _ => "",
        };
        let count = 3 + numbers.below(4);
        let start = numbers.below(points - 8);
        let order: &[usize] = if numbers.chance(4) { &[0, 6, 7, 1, 2, 2] } else { &[0, 1, 7, 6, 6, 0] };
        text += "f";
        let style = numbers.below(5);
        for corner in &order[..count] {
            let index = 1 + start + corner;
            text += &match style {
                0 => format!(" {index}"),
                1 => format!(" {index}/{index}/{index}"),
                2 => format!(" {index}//26"),
                3 => format!(" {index}//27"),
                _ => format!(" {}/{}/-1", index as i64 - points as i64 - 1, index),
            };
        }
        text += if numbers.chance(6) { " \\\n" } else { "\n" };
        if text.ends_with("\\\n") {
            text += "\n";
        }
    }
    text
}

#[test]
fn wavefront_scenes_equal_real_ones() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = std::env::temp_dir();
    let mapping = "# rules\nwood (Material \"red\") ;\npaint (Group \"wheel\") (Face [3 : 30] ) ;\nvoid (Face 7) ;\nmetal (Object \"body\");";
    std::fs::write(folder.join("radsight-scene-generators.map"), mapping).unwrap();
    let loader = TestLoader { folders: vec![folder], ..TestLoader::default() };
    let mut numbers = oracle::Numbers(31);
    for _ in 0..60 {
        let text = wavefront(&mut numbers);
        for line in
            ["obj2rad", "obj2rad -f", "obj2rad -o thing", "obj2rad -n", "obj2rad -m radsight-scene-generators.map"]
        {
            oracle::expect_same(&radiance, &words(line), text.as_bytes(), &loader);
        }
    }
}

#[test]
fn broken_wavefront_text_is_an_error_with_its_line() {
    let message =
        |text: &str| ours(&words("obj2rad"), text.as_bytes(), &TestLoader::default()).unwrap_err().to_string();
    assert_eq!(message("v 1 2 3\nf 1 2 3"), "obj2rad: <stdin>: line 2: \"2\" names point 2, of 1 so far");
    assert_eq!(message("v 1 2"), "obj2rad: <stdin>: line 1: v is followed by 2 numbers, expected 3");
    assert_eq!(message("f 1"), "obj2rad: <stdin>: line 1: \"1\" names point 1, of 0 so far");
    let nan = "obj2rad: <stdin>: line 1: number 2 of v is \"nan\", expected a finite number";
    assert_eq!(message("v 1 nan .2"), nan);
    assert_eq!(message("v 1 nan .2 \\"), nan);
}

#[test]
fn a_backslash_at_the_end_of_wavefront_text_keeps_the_face() {
    let Some(radiance) = Radiance::find() else { return };
    for end in ["\\", "\\\n", "\\\n\\", "\n\\"] {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 {end}");
        for line in ["obj2rad", "obj2rad -n"] {
            let output = ours(&words(line), text.as_bytes(), &TestLoader::default()).unwrap();
            let text_out = String::from_utf8(output.standard_output).unwrap();
            assert!(text_out.contains("polygon") || text_out.contains("[1:1]"), "{end:?}: {text_out}");
            // Real obj2rad counts the empty line after the backslash.
            if end != "\\\n" {
                oracle::expect_same(&radiance, &words(line), text.as_bytes(), &TestLoader::default());
            }
        }
    }
}
