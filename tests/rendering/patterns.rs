//! Patterns, textures and mixtures, compared with real Radiance ray by ray.
//!
//! A pattern on a `glow` shows its values; a mirror under a coloured sky shows the normals of a
//! texture.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;
use std::fmt::Write as _;

/// A scene with the files that it needs.
struct Case {
    name: String,
    scene: String,
    files: Vec<(&'static str, Vec<u8>)>,
}

impl Case {
    fn new(name: &str, scene: impl Into<String>) -> Case {
        Case { name: name.to_owned(), scene: scene.into(), files: Vec::new() }
    }

    /// A pattern named `pat` on a floor of glow.
    fn glowing(name: &str, pattern: &str) -> Case {
        Case::new(name, format!("{pattern}\npat glow lit 0 0 4 1 .8 .6 0\nlit {FLOOR}"))
    }

    /// A texture named `tex` on a mirror-like floor under a sky that has a colour in each
    /// direction.
    fn mirroring(name: &str, texture: &str) -> Case {
        Case::new(name, format!("{SKY}{texture}\ntex metal shiny 0 0 5 .9 .8 .7 1 0\nshiny {FLOOR}"))
    }

    /// A mixture named `mix` of materials on a floor under the same sky and a small distant lamp.
    fn mixing(name: &str, mixture: &str) -> Case {
        Case::new(
            name,
            format!(
                "{SKY}{LAMP}{PARTS}{mixture}\nmix {FLOOR}lower polygon below 0 0 12 -3 -3 -1 3 -3 -1 3 3 -1 -3 3 -1\n"
            ),
        )
    }

    fn file(mut self, name: &'static str, bytes: impl Into<Vec<u8>>) -> Case {
        self.files.push((name, bytes.into()));
        self
    }
}

const FLOOR: &str = "polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n";
const SKY: &str = "void colorfunc sky 4 .6+.4*Dx .6+.4*Dy .6+.4*Dz . 0 0\nsky glow skylight 0 0 4 1 1 1 0\nskylight source dome 0 0 4 0 0 1 360\n";
const LAMP: &str = "void light lamp 0 0 3 9e4 8e4 7e4\nlamp source sun 0 0 4 .3 -.2 1 .01\n";
const PARTS: &str = "
void plastic matte 0 0 5 .6 .5 .4 0 0
void brightfunc stripes 2 .5+.5*sin(9*Px) . 0 0
stripes plastic striped 0 0 5 .2 .7 .3 0 0
void metal shiny 0 0 5 .9 .8 .7 1 0
void glow glowing 0 0 4 1 2 3 0
void glass pane 0 0 3 .8 .7 .9
void plastic lower 0 0 5 .7 .7 .2 0 0
";

/// Rays down to the floor from all over, and some from below.
fn rays() -> String {
    let mut text = String::new();
    for index in 0..150 {
        let part = |step: f64| (f64::from(index) * step + 0.37).fract() * 2.0 - 1.0;
        let (x, y) = (1.9 * part(0.754_877_666), 1.9 * part(0.569_840_291));
        let height = if index % 8 == 7 { -0.6 } else { 1.5 };
        let eye = [x + part(0.430_159_709), y + part(0.819_172_513), height];
        let _ = writeln!(text, "{} {} {} {} {} {}", eye[0], eye[1], eye[2], x - eye[0], y - eye[1], -eye[2]);
    }
    text
}

/// The outputs of both programs: radsight, then real Radiance.
fn both(radiance: &Radiance, case: &Case, words: &[&str]) -> [Vec<Vec<f64>>; 2] {
    let folder = Folder::new();
    folder.file("scene.rad", &case.scene);
    for (name, bytes) in &case.files {
        folder.file(name, bytes);
    }
    let words = [&["-h", "-st", "0", "-lr", "12"], words].concat();
    let ours = [&["rtrace"], &words[..], &["scene.rad"]].concat();
    let ours = run_with(command(&ours).current_dir(folder.path("")), rays().as_bytes()).text();
    let octree = radiance.octree(&folder, &["scene.rad"]);
    let mut theirs = radiance.command("rtrace", &[&words[..], &[&octree]].concat());
    let theirs = run_with(theirs.current_dir(folder.path("")), rays().as_bytes()).text();
    [ours, theirs].map(|text| text.lines().map(numbers).collect())
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(|word| word.parse().expect("a number")).collect()
}

/// Compares each ray of each case with a tolerance relative to the largest value, except for a
/// share of the rays: those at the edge of a letter or a pixel.
fn same_values(cases: Vec<Case>, words: &[&str], tolerance: f64, outliers: f64) {
    let Some(radiance) = Radiance::find() else { return };
    let mut wrong = String::new();
    for case in cases {
        let [ours, theirs] = both(&radiance, &case, words);
        assert_eq!(ours.len(), theirs.len(), "{}", case.name);
        let largest = theirs.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(largest > 0.0, "{}: something is seen", case.name);
        let first = theirs.iter().find(|value| value.iter().any(|band| *band != 0.0));
        assert!(theirs.iter().any(|value| Some(value) != first), "{}: not all is the same", case.name);
        let differs = |(ours, theirs): &(&Vec<f64>, &Vec<f64>)| {
            ours.len() != theirs.len() || ours.iter().zip(*theirs).any(|(a, b)| (a - b).abs() > tolerance * largest)
        };
        let differing: Vec<_> = ours.iter().zip(&theirs).filter(differs).collect();
        if differing.len() as f64 > outliers * ours.len() as f64 {
            let _ = writeln!(wrong, "{}: {} of {} rays differ", case.name, differing.len(), ours.len());
            for (ours, theirs) in differing.into_iter().take(4) {
                let _ = writeln!(wrong, "    {ours:?} here, {theirs:?} there");
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

/// A picture of flat pixels with its resolution line.
fn picture(header: &str, resolution: &str, pixels: usize) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{header}FORMAT=32-bit_rle_rgbe\n\n{resolution}\n").into_bytes();
    for index in 0..pixels {
        let value = |step: usize| (40 + index * step % 200) as u8;
        bytes.extend([value(37), value(83), value(151), 128 + (index % 3) as u8]);
    }
    bytes
}

const TABLE: &str = "2 0 2 5 -1 1 4\n1 2 3 4 5 6 7 8 9 8 7 6 5 4 3 2 1 2 3 4\n";
const CURVE: &str = "1 0 0 5 -1.5 -1 0 .5 2\n.2 .9 .4 .7 .1\n";
const CURVE_2: &str = "1 -2 2 3\n1 .2 .8\n";

#[test]
fn functions_and_tables() {
    let file = ".off(x) = x+.1; { used below } wave = .5+.4*sin(6*Px+A1)*cos(5*Py); twice(x) = 2*x; sum(a,b,c) = a+b*c;\n\
        part(a,b,c) = .3*a+.5*b+.2*c; ramp = (1-far)*.5+.5; far = abs(Px)/2; self(x) = x*x; near = 1/(.1+Px*Px+Py*Py);\n\
        noise = .5+.4*noise3(3*Px,3*Py,.2);";
    let file = &file.replace(".off(x) = x+.1; ", "");
    let of = |name: &str, pattern: &str| {
        Case::glowing(name, pattern)
            .file("own.cal", file.as_str())
            .file("t.dat", TABLE)
            .file("c.dat", CURVE)
            .file("d.dat", CURVE_2)
    };
    let cases = vec![
        of("brightfunc", "void brightfunc pat 2 wave own.cal 0 1 .3"),
        of("brightfunc of an expression", "void brightfunc pat 2 .5+.3*Px*Py . 0 0"),
        of("brightfunc of noise", "void brightfunc pat 2 noise own.cal 0 0"),
        of("brightfunc below zero", "void brightfunc pat 2 Px . 0 0"),
        of("brightfunc of the ray", "void brightfunc pat 2 .1+Dx*Dx+abs(Nz)*T/9+Rdot*.2+S/3+Ts/7 . 0 0"),
        of("brightfunc moved", "void brightfunc pat 14 wave own.cal -rx 20 -ry 30 -rz 40 -s .5 -t .1 .2 .3 0 1 1"),
        of("brightfunc mirrored", "void brightfunc pat 4 .5+.3*Px+.1*Nz . -mx -mz 0 0"),
        of("brightfunc moved twice", "!xform -rz 30 -s .7 -t .3 .1 0 inner.rad\n")
            .file("inner.rad", "void brightfunc pat 8 .5+.3*sin(5*Px) . -rx 10 -t .1 0 0 0 0\n"),
        of("colorfunc", "void colorfunc pat 4 wave ramp near own.cal 0 1 .1"),
        of("colorfunc moved", "void colorfunc pat 8 wave Px Py own.cal -rz 33 -s 1.5 0 1 .1"),
        of("two patterns", "void brightfunc one 2 wave own.cal 0 1 .3\none colorfunc pat 4 ramp 1 near own.cal 0 0"),
        of(
            "constants",
            "void brightfunc one 2 .5 . 0 0\none colorfunc two 4 .3 1 2 . 0 0\ntwo brightfunc pat 2 Px*Px . 0 0",
        ),
        of("brightdata", "void brightdata pat 5 self t.dat own.cal Px*Px Py 0 0"),
        of("brightdata far outside", "void brightdata pat 5 twice t.dat own.cal 9*Px 9*Py 0 0"),
        of("brightdata of an irregular axis", "void brightdata pat 4 noneg c.dat . Px 0 0"),
        of("brightdata moved", "void brightdata pat 8 noneg c.dat . Px -rz 45 -s 2 0 0"),
        of("colordata", "void colordata pat 8 part part part c.dat c.dat d.dat own.cal Px 0 0"),
        of("colordata of two coordinates", "void colordata pat 9 sum sum sum t.dat t.dat t.dat own.cal Px Py 0 0"),
        of("colordata by bands", "void colordata pat 8 part twice self c.dat d.dat c.dat own.cal Px 0 0"),
        of("brightfunc with arguments", "void brightfunc pat 2 arg(1)+arg(2)*sin(arg(3)*Px) . 0 3 .5 .4 7"),
    ];
    same_values(cases, &[], 2e-5, 0.0);
}

#[test]
fn pictures() {
    let of = |name: &str, pattern: &str, picture: Vec<u8>| {
        let file = "part(a,b,c) = .3*a+.5*b+.2*c; half(x) = x/2; double(x) = 2*x;";
        Case::glowing(name, pattern).file("p.hdr", picture).file("own.cal", file)
    };
    let plain = "void colorpict pat 7 red green blue p.hdr . (Px+2)/4 (Py+2)/4 0 0";
    let usual = || picture("", "-Y 3 +X 4", 12);
    let mut cases: Vec<Case> =
        ["-Y 3 +X 4", "-Y 3 -X 4", "+Y 3 +X 4", "+Y 3 -X 4", "+X 4 -Y 3", "-X 4 -Y 3", "+X 4 +Y 3", "-X 4 +Y 3"]
            .iter()
            .map(|resolution| of(&format!("colorpict {resolution}"), plain, picture("", resolution, 12)))
            .collect();
    cases.extend([
        of("colorpict that is tall", plain, picture("", "-Y 5 +X 2", 10)),
        of("colorpict of wide pixels", plain, picture("PIXASPECT=.5\n", "-Y 3 +X 4", 12)),
        of("colorpict of high pixels", plain, picture("PIXASPECT=1.7\n", "-Y 3 +X 4", 12)),
        of("colorpict with an exposure", plain, picture("EXPOSURE=4\nCOLORCORR= 1 2 3\n", "-Y 3 +X 4", 12)),
        of("colorpict far outside", "void colorpict pat 7 red green blue p.hdr . 3*Px 3*Py 0 0", usual()),
        of("colorpict of functions", "void colorpict pat 7 part double half p.hdr own.cal Px Py 0 0", usual()),
        of("colorpict moved", "void colorpict pat 15 red green blue p.hdr . Px Py -rz 30 -s 3 -t -1 -1 0 0 0", usual()),
        of(
            "colorpict through picture.cal",
            "void colorpict pat 9 red green blue p.hdr picture.cal pic_u pic_v -s 2 0 0",
            usual(),
        )
        .file("picture.cal", "pic_u = Px; pic_v = Py;"),
        of(
            "colorpict below a brightfunc",
            &format!("{plain}\n")
                .replace("pat 7", "one 7")
                .replace("0 0\n", "0 0\none brightfunc pat 2 .5+.4*Px . 0 0"),
            usual(),
        ),
    ]);
    same_values(cases, &[], 2e-5, 0.0);
}

/// A font with a hole, a stroke, a slanted letter, a blank.
const FONT: &str = "
# A test font.
32 0
65 8 0 0 255 0 255 255 128 255 0 255 60 60 200 60 130 220
73 4 100 0 155 0 155 255 100 255
79 10 55 0 205 0 205 255 55 255 55 0 100 100 100 200 150 200 150 100 100 100
118 5 30 200 120 0 140 0 230 200 128 60
";

#[test]
fn text() {
    let of = |name: &str, pattern: &str| {
        Case::glowing(name, pattern).file("test.fnt", FONT).file("text.txt", "AIO v\n\nOO  AA\nI   I   O\n")
    };
    let place = "-1.8 1.8 0 .5 0 0 0 -.7 0";
    let line = |kind: &str, words: &str, numbers: &str| {
        let strings = words.split_whitespace().count();
        let reals = numbers.split_whitespace().count();
        format!("void {kind} pat {strings} {words} 0 {reals} {numbers}")
    };
    let cases = vec![
        of("brighttext", &line("brighttext", "test.fnt . AIO v OA", &format!("{place} .9 .2"))),
        of("brighttext of a file", &line("brighttext", "test.fnt text.txt", &format!("{place} .9 .2"))),
        of("colortext of a file", &line("colortext", "test.fnt text.txt", &format!("{place} .9 .2 .4 .1 .5 .3"))),
        of("brighttext with spacing", &line("brighttext", "test.fnt text.txt", &format!("{place} .9 .2 .3"))),
        of("brighttext squeezed", &line("brighttext", "test.fnt text.txt", &format!("{place} .9 .2 -.2"))),
        of("brighttext with no spacing", &line("brighttext", "test.fnt text.txt", &format!("{place} .9 .2 0"))),
        of(
            "brighttext with unknown letters",
            &line("brighttext", "test.fnt . xxAzI xO z", &format!("{place} .9 .2 -.1")),
        ),
        of(
            "brighttext with unknown letters in columns",
            &line("brighttext", "test.fnt . xxAzI xO z", &format!("{place} .9 .2 .1")),
        ),
        of("brighttext askew", &line("brighttext", "test.fnt text.txt", "-1.5 1.5 0 .5 .2 .1 .1 -.7 0 .9 .2")),
        of(
            "brighttext on another plane",
            &line("brighttext", "test.fnt text.txt", "-1.5 1.5 0 .5 .2 .4 .1 -.7 .3 .9 .2 .2"),
        ),
        of("colortext moved", "!xform -rz 20 -s .8 -t .1 .1 0 inner.rad\n")
            .file("inner.rad", line("colortext", "test.fnt . AIO vO", &format!("{place} .9 .2 .4 .1 .5 .3"))),
    ];
    same_values(cases, &[], 2e-5, 0.02);
}

#[test]
fn textures() {
    let of = |name: &str, texture: &str| {
        let file = "tx = .3*sin(5*Px); ty = .2*cos(4*Py); tz = .1*Px*Py; one(a,b,c) = a+.1*c; two(a,b,c) = b-.2; none(a,b,c) = 0;";
        Case::mirroring(name, texture).file("own.cal", file).file("c.dat", CURVE).file("d.dat", CURVE_2)
    };
    let cases = vec![
        of("texfunc", "void texfunc tex 4 tx ty tz own.cal 0 0"),
        of("texfunc that is strong", "void texfunc tex 4 4*tx 5*ty -2 own.cal 0 0"),
        of("texfunc moved", "void texfunc tex 14 tx ty tz own.cal -rx 20 -ry -30 -s .5 -t .1 0 0 0 0"),
        of("texfunc mirrored", "void texfunc tex 7 tx ty tz own.cal -mx -rz 20 0 0"),
        of("texdata", "void texdata tex 8 one two none c.dat d.dat c.dat own.cal Px 0 0"),
        of("texdata moved", "void texdata tex 12 one two none c.dat d.dat c.dat own.cal Px -rz 40 -s 2 0 0"),
        of("two textures", "void texfunc first 4 tx 0 0 own.cal 0 0\nfirst texfunc tex 4 0 ty 0 own.cal 0 0"),
        of(
            "a pattern and a texture",
            "void brightfunc first 2 .5+.3*Px . 0 0\nfirst texfunc tex 4 tx ty 0 own.cal 0 0",
        ),
        of(
            "textures in a mixture",
            "void texfunc a 4 tx 0 0 own.cal 0 0\nvoid texfunc b 4 0 ty .5 own.cal 0 0\nvoid mixfunc tex 4 a b .5+.4*Py . 0 0",
        ),
    ];
    same_values(cases, &[], 2e-5, 0.0);
}

#[test]
fn mixtures_of_patterns() {
    let parts = "void brightfunc a 2 .5+.4*sin(7*Px) . 0 0\nvoid colorfunc b 4 .5 .2+.1*Py .7 . 0 0\n";
    let of = |name: &str, mixture: &str| {
        Case::glowing(name, &format!("{parts}{mixture}"))
            .file("p.hdr", picture("", "-Y 3 +X 4", 12))
            .file("c.dat", CURVE)
            .file("test.fnt", FONT)
            .file("own.cal", "part(a,b,c) = .3*a+.5*b+.2*c; double(x) = 2*x;")
    };
    let cases = vec![
        of("mixfunc", "void mixfunc pat 4 a b .5+.3*Px . 0 0"),
        of("mixfunc out of range", "void mixfunc pat 4 a b .5+Px . 0 0"),
        of("mixfunc with nothing", "void mixfunc pat 4 a void .5+.3*Px . 0 0"),
        of("mixfunc on nothing", "void mixfunc pat 4 void b .5+.3*Px . 0 0"),
        of("mixfunc moved", "void mixfunc pat 6 a b .5+.3*Px . -rz 40 0 0"),
        of("mixdata", "void mixdata pat 6 a b double c.dat own.cal Px 0 0"),
        of("mixpict", "void mixpict pat 7 a b part p.hdr own.cal (Px+2)/4 (Py+2)/4 0 0"),
        of("mixtext", "void mixtext pat 5 a b test.fnt . AIOv 0 9 -1.8 1.8 0 .9 0 0 0 -2 0"),
        of("mixfunc in a mixfunc", "void mixfunc c 4 a b .5+.3*Px . 0 0\nvoid mixfunc pat 4 c b .5+.3*Py . 0 0"),
        of("mixfunc of a pattern", "b mixfunc pat 4 a void .5+.3*Px . 0 0"),
        of("mixfunc with a chain", "a brightfunc c 2 .5+.2*Py . 0 0\nvoid mixfunc pat 4 c b .5+.3*Px . 0 0"),
        of("mixfunc below a pattern", "void mixfunc c 4 a b .5+.3*Px . 0 0\nc brightfunc pat 2 .5+.2*Py . 0 0"),
    ];
    same_values(cases, &[], 2e-5, 0.02);
}

#[test]
fn mixtures_of_materials() {
    let of = |name: &str, mixture: &str| {
        Case::mixing(name, mixture)
            .file("p.hdr", picture("", "-Y 3 +X 4", 12))
            .file("c.dat", CURVE)
            .file("test.fnt", FONT)
            .file("own.cal", "part(a,b,c) = .3*a+.5*b+.2*c; double(x) = 2*x; tx = .2*sin(5*Px);")
    };
    let cases = vec![
        of("two materials", "void mixfunc mix 4 striped glowing .5+.3*Px . 0 0"),
        of("a mirror and a pane", "void mixfunc mix 4 shiny pane .5+.3*Px . 0 0"),
        of("a material and nothing", "void mixfunc mix 4 striped void .5+.3*Px . 0 0"),
        of("nothing and a material", "void mixfunc mix 4 void glowing if(sin(9*Px),1,0) . 0 0"),
        of("a hole", "void mixtext mix 5 void matte test.fnt . AIOv 0 9 -1.8 1.8 0 .9 0 0 0 -2 0"),
        of("letters", "void mixtext mix 5 glowing pane test.fnt . AIOv 0 10 -1.8 1.8 0 .9 0 0 0 -2 0 .2"),
        of("a picture", "void mixpict mix 7 shiny striped part p.hdr own.cal (Px+2)/4 (Py+2)/4 0 0"),
        of("a table", "void mixdata mix 6 glowing void double c.dat own.cal Px 0 0"),
        of(
            "mixtures in mixtures",
            "void mixfunc in 4 striped void .5+.4*Px . 0 0\nvoid mixfunc mix 4 in glowing .5+.4*Py . 0 0",
        ),
        of(
            "a pattern before a mixture",
            "void mixfunc in 4 striped glowing .5+.3*Px . 0 0\nin colorfunc mix 4 .5+.2*Px .3 .8 . 0 0",
        ),
        of(
            "a texture before a mixture",
            "void mixfunc in 4 shiny glowing .5+.3*Px . 0 0\nin texfunc mix 4 tx 0 0 own.cal 0 0",
        ),
        of("a pattern and nothing", "void mixfunc mix 4 stripes matte .5+.3*Px . 0 0"),
    ];
    same_values(cases, &[], 2e-3, 0.02);
}

/// A hyperspectral picture of flat pixels.
fn spectral_picture() -> Vec<u8> {
    let head = "#?RADIANCE\nNCOMP=5\nWAVELENGTH_SPLITS= 720 588 480 400\nFORMAT=Radiance_spectra\n\n-Y 3 +X 4\n";
    let mut bytes = head.as_bytes().to_vec();
    for index in 0..12 {
        bytes.extend([37, 83, 151, 61, 97].map(|step| (40 + index * step % 200) as u8));
        bytes.push(128 + (index % 3) as u8);
    }
    bytes
}

/// The bands in which real Radiance traces light, and whether it writes them.
const SAMPLINGS: [&[&str]; 5] = [
    &[],
    &["-cs", "18"],
    &["-cs", "18", "-co+"],
    &["-cs", "24", "-cw", "400", "700", "-co+"],
    &["-cs", "5", "-cw", "900", "500", "-co+"],
];

#[test]
fn spectra() {
    let before = "void brightfunc before 2 .5+.2*Px . 0 0\nbefore";
    let of = |name: &str, pattern: &str| {
        Case::glowing(name, pattern)
            .file("own.cal", "of(v,w) = v*w/600;")
            .file("rising.dat", "1 400 700 4 .1 .9 .3 .5\n")
            .file("falling.dat", "1 760 380 6 .1 .9 .3 .5 .2 .4\n")
            .file("grid.dat", "2 -2 2 3 400 700 4 .1 .9 .3 .5 .3 .2 .8 .1 .5 .6 .7 .8\n")
            .file("uneven.dat", "2 -2 2 3 0 0 4 400 450 600 700 .1 .9 .3 .5 .3 .2 .8 .1 .5 .6 .7 .8\n")
            .file("p.hsr", spectral_picture())
    };
    let cases = || {
        vec![
            of("spectrum", &format!("{before} spectrum pat 0 0 7 380 780 .1 .1 .1 .9 .9")),
            of("spectrum falling", &format!("{before} spectrum pat 0 0 8 700 400 .1 .2 .9 .4 .6 .3")),
            of("spectrum of few values", &format!("{before} spectrum pat 0 0 5 600 500 .5 .9 .1")),
            of(
                "spectrum of many values",
                &format!("{before} spectrum pat 0 0 32 780 390 {}", ".1 .2 .9 .4 .6 .3 ".repeat(5)),
            ),
            of("specfile", &format!("{before} specfile pat 1 rising.dat 0 0")),
            of("specfile falling", &format!("{before} specfile pat 1 falling.dat 0 0")),
            of("specdata", "void specdata pat 4 of grid.dat own.cal Px 0 0"),
            of("specdata of an irregular axis", "void specdata pat 4 of uneven.dat own.cal Px 0 0"),
            of("specpict", "void specpict pat 5 of p.hsr own.cal (Px+2)/4 (Py+2)/4 0 0"),
            of(
                "spectra mixed",
                &format!(
                    "{before} spectrum a 0 0 5 700 400 .2 .9 .1\nvoid colorfunc b 4 .3 .5 .7 . 0 0\nvoid mixfunc pat 4 a b .5+.2*Py . 0 0"
                ),
            ),
        ]
    };
    for words in SAMPLINGS {
        same_values(cases(), words, 5e-4, 0.0);
    }
}

/// Real Radiance evaluates `specfunc` at random wavelengths.
#[test]
fn spectral_functions() {
    let case = || {
        vec![
            Case::glowing("specfunc", "void specfunc pat 2 of own.cal 0 2 400 700")
                .file("own.cal", "of(w) = .5+.1*Px+w/2000;"),
            Case::glowing("specfunc of a wide range", "void specfunc pat 2 of own.cal 0 2 900 300")
                .file("own.cal", "of(w) = .5+.1*Px+w/2000;"),
            // Its mean over a band is not its value in the middle.
            Case::glowing("a curved specfunc", "void specfunc pat 2 of own.cal 0 2 400 700")
                .file("own.cal", "of(w) = .5+.1*Px+2e-3*((w-540)/20)^2;"),
        ]
    };
    for words in SAMPLINGS {
        same_values(case(), words, 0.02, 0.0);
    }
}

#[test]
fn materials_in_many_bands() {
    let cases = || {
        vec![
            Case::mixing("two materials", "void mixfunc mix 4 striped glowing .5+.3*Px . 0 0"),
            Case::mixing("a mirror and a pane", "void mixfunc mix 4 shiny pane .5+.3*Px . 0 0"),
            Case::mixing(
                "a metal of a spectrum",
                "void spectrum s 0 0 6 750 390 .9 .7 .3 .1\ns metal mix 0 0 5 1 1 1 1 0",
            ),
        ]
    };
    for words in SAMPLINGS {
        same_values(cases(), words, 2e-3, 0.0);
    }
}

/// The number of radiance at the end of rays of `rtrace -h -ab 0`, or with further options.
fn traced(scene: &str, rays: &str, options: &[&str]) -> Vec<Vec<f64>> {
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let words = [&["rtrace", "-h"], options, &["scene.rad"]].concat();
    let run = run_with(command(&words).current_dir(folder.path("")), rays.as_bytes());
    run.text().lines().map(numbers).collect()
}

#[test]
fn a_pattern_on_a_distant_source_sees_where_the_ray_starts() {
    let scene =
        "void colorfunc c 4 .5+.1*Px .5+.1*Py .5+.1*Pz . 0 0\nc glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n";
    let found = traced(scene, "1 2 3 0 0 1\n-1 0 1 .6 0 .8\n", &["-ab", "0"]);
    for (values, expected) in found.iter().zip([[0.6, 0.7, 0.8], [0.4, 0.5, 0.6]]) {
        assert!(values.iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-5), "{values:?}");
    }
}

#[test]
fn a_negative_pattern_takes_no_light_from_other_surfaces() {
    let scene = "void brightfunc n 2 if(Px,.5,-.5) . 0 0\nn plastic p 0 0 5 .6 .6 .6 0 0\nvoid plastic q 0 0 5 .5 .5 .5 0 0\n\
                 void light l 0 0 3 10 10 10\nl sphere lamp 0 0 4 0 0 3 .2\n\
                 p polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\nq polygon wall 0 0 12 -2 -2 0 -2 2 0 -2 2 2 -2 -2 2\n";
    let rays = "-.5 0 1 0 0 -1\n.5 0 1 0 0 -1\n-1 0 .3 -1 0 0\n";
    let [direct, all] = ["0", "1"].map(|bounces| traced(scene, rays, &["-ab", bounces, "-aa", "0", "-ad", "256"]));
    assert_eq!([&direct[0], &all[0]], [&vec![0.0; 3]; 2]);
    assert!(direct[1][0] > 0.005 && direct[2][0] > 0.005, "{direct:?}");
    assert!(all[2][0] > direct[2][0], "{} with the floor, {} without", all[2][0], direct[2][0]);
}
