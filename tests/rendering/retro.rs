//! Retroreflectors in scenes and in `radsight retro`: coefficients through the renderer, beads
//! compared with real Radiance.

use crate::program::{self, Folder, command, radsight, radsight_with, run_with};
use radsight_test_support::Radiance;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Half angle of the sun, degrees: much smaller than an observation angle.
const SUN_HALF_ANGLE_DEG: f64 = 0.0005;

/// A plane z = 0 of the material `m`, under a sun of irradiance 1 (perpendicular to its light) at
/// this entrance angle.
fn scene(material: &str, entrance_deg: f64) -> String {
    let half = SUN_HALF_ANGLE_DEG.to_radians();
    let radiance = 1.0 / (2.0 * PI * (1.0 - half.cos()));
    let (sin, cos) = entrance_deg.to_radians().sin_cos();
    format!(
        "{material}\nm polygon plane 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n\
         void light l 0 0 3 {radiance} {radiance} {radiance}\nl source sun 0 0 4 {sin} 0 {cos} {}\n",
        2.0 * SUN_HALF_ANGLE_DEG
    )
}

/// Rays from the plane of the sun to the origin, at these viewing angles.
fn rays(viewing_deg: &[f64]) -> String {
    let ray = |angle: &f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        format!("{} 0 {} {} 0 {}\n", sin * 3.0, cos * 3.0, -sin, -cos)
    };
    viewing_deg.iter().map(ray).collect()
}

/// Green radiances.
fn values(text: &str) -> Vec<f64> {
    text.lines().map(|line| line.split_whitespace().nth(1).expect("three columns").parse().expect("a number")).collect()
}

const OPTIONS: [&str; 8] = ["-h", "-faa", "-ab", "0", "-dt", "0", "-dj", "0"];

fn ours(folder: &Folder, scene: &str, rays: &str) -> Vec<f64> {
    let file = folder.file("scene.rad", scene);
    let mut words = vec!["rtrace"];
    words.extend(OPTIONS);
    words.push(&file);
    let mut command = command(&words);
    command.current_dir(folder.path("."));
    values(&run_with(&mut command, rays.as_bytes()).text())
}

/// The sun is a disk over which the lobe varies; more rays do not change the result.
fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len());
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let off = (found - expected).abs() / expected.abs().max(1e-9);
        assert!(off < tolerance, "{what}, ray {index}: {found} against {expected}");
    }
}

#[test]
fn glass_beads_are_those_of_metfunc_in_real_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("bead.cal", include_str!("../retro/bead.cal"));
    let observations = [0.05, 0.1, 0.2, 0.33, 0.6, 1.0, 2.0, 5.0, 19.0, 25.0, 40.0];
    for (entrance, binder, function) in [
        (0.0, "sheet", "in_sheet"),
        (5.0, "sheet", "in_sheet"),
        (35.0, "sheet", "in_sheet"),
        (60.0, "paint", "on_paint"),
    ] {
        let viewing: Vec<f64> = observations.iter().map(|observation| entrance - observation).collect();
        let rays = rays(&viewing);
        let by_function = scene(&format!("void metfunc m 2 beads_{function} bead.cal 0 5 1 1 1 1 7.5"), entrance);
        let native = scene(&format!("void brdfplugin m 3 retro glass_bead {binder} 0 1 7.5"), entrance);
        let file = folder.file("real.rad", &by_function);
        let octree = radiance.command("oconv", &[&file]).current_dir(folder.path(".")).output().expect("oconv runs");
        std::fs::write(folder.path("real.oct"), octree.stdout).expect("the octree is written");
        let mut words: Vec<&str> = OPTIONS.to_vec();
        words.push("real.oct");
        let mut rtrace = radiance.command("rtrace", &words);
        rtrace.current_dir(folder.path("."));
        let real = values(&run_with(&mut rtrace, rays.as_bytes()).text());
        assert!(real.iter().all(|value| *value > 0.0), "{real:?}");
        assert_near(&ours(&folder, &by_function, &rays), &real, 1e-3, "metfunc");
        assert_near(&ours(&folder, &native, &rays), &real, 1e-3, "glass_bead");
    }
}

#[test]
fn a_scene_shows_the_coefficients_of_its_table() {
    let folder = Folder::new();
    let material =
        "void brdfplugin m 2 retro table 0 21 0 1 .1 .2 4 800 .2 30 550 .2 45 345 .5 4 460 .5 30 215 .5 45 85";
    for (entrance, expected) in [(4.0, [800.0, 460.0]), (30.0, [550.0, 215.0]), (45.0, [345.0, 85.0])] {
        let viewing = [entrance - 0.2, entrance - 0.5];
        let found = ours(&folder, &scene(material, entrance), &rays(&viewing));
        for ((radiance, angle), expected) in found.iter().zip(viewing).zip(expected) {
            // R_A is the intensity per area and perpendicular illuminance, here 1.
            let coefficient = radiance * angle.to_radians().cos();
            assert!((coefficient / expected - 1.0).abs() < 5e-3, "{entrance}°, {angle}°: {coefficient} for {expected}");
        }
    }
}

#[test]
fn a_pattern_dims_and_a_texture_turns_native_sheeting() {
    let folder = Folder::new();
    let sharp = "brdfplugin m 2 retro sharp 0 3 .5 .01 6";
    let viewing = rays(&[9.9]);
    let plain = ours(&folder, &scene(&format!("void {sharp}"), 10.0), &viewing);
    let pattern = format!("void brightfunc seal 2 if(Px,.25,1) . 0 0\nseal {sharp}");
    let found = ours(&folder, &scene(&pattern, 10.0), &rays_at(9.9, &[-0.5, 0.5]));
    assert_near(&found, &[plain[0], 0.25 * plain[0]], 1e-5, "pattern");
    // Under a normal rotated by 30° the entrance angle differs: f cos β = R/cos ν for the larger
    // cosine.
    let wavy = format!("void texfunc wave 4 .57735 0 0 . 0 0\nwave {sharp}");
    let turned = ours(&folder, &scene(&wavy, 10.0), &viewing);
    assert!((turned[0] / plain[0] - 1.0).abs() > 1e-5, "{turned:?} {plain:?}");
    assert!((turned[0] / plain[0] - 1.0).abs() < 0.05, "the lobe still points back");
}

/// Each model, as written in a scene after the name of its material.
const EACH: [(&str, &str); 7] = [
    ("paper1991", "2 retro paper1991 0 5 .086 .00612 0 1.5 .1"),
    ("gauss_reciprocal", "2 retro gauss_reciprocal 0 5 .086 .00612 .2 1.5 .1"),
    ("sharp", "2 retro sharp 0 6 .5 .01 6 .2 1.5 .1"),
    ("mrm", "2 retro mrm 0 3 .5 .05 .8"),
    ("glass_bead", "3 retro glass_bead sheet 0 1 7.5"),
    ("cube_corner", "2 retro cube_corner 0 3 1.586 .0005 .01"),
    ("table", "2 retro table 0 9 0 1 .1 .2 4 800 .5 4 460"),
];

/// A sheet with a normal map is as bright as a rotated one.
#[test]
fn every_model_takes_a_pattern_and_a_normal_map() {
    let folder = Folder::new();
    folder.file("map.cal", "first(x,y,z)=x; second(x,y,z)=y; third(x,y,z)=z; along=Px+.5; across=Py+.5;");
    // Slopes over the unit square about the origin: 30 degrees away from the sun.
    folder.file("slope.dat", "2 0 1 2 0 1 2 -.57735027 -.57735027 -.57735027 -.57735027");
    folder.file("flat.dat", "2 0 1 2 0 1 2 0 0 0 0");
    let turned = "m polygon plane 0 0 12 -7.794 -9 -4.5 7.794 -9 4.5 7.794 9 4.5 -7.794 9 -4.5";
    let viewing = rays(&[9.9]);
    for (name, model) in EACH {
        let sheet = format!("brdfplugin m {model}");
        let flat = scene(&format!("void {sheet}"), 10.0);
        let plain = ours(&folder, &flat, &viewing);
        assert!(plain[0] > 0.0, "{name}");
        let pattern = format!("void brightfunc seal 2 if(Px,.25,1) . 0 0\nseal {sheet}");
        let found = ours(&folder, &scene(&pattern, 10.0), &rays_at(9.9, &[-0.5, 0.5]));
        assert_near(&found, &[plain[0], 0.25 * plain[0]], 1e-3, name);
        let map = "void texdata map 9 first second third slope.dat flat.dat flat.dat map.cal along across 0 0";
        let mapped = ours(&folder, &scene(&format!("{map}\nmap {sheet}"), 10.0), &viewing);
        let as_turned = flat.lines().map(|line| if line.starts_with("m polygon") { turned } else { line });
        let expected = ours(&folder, &as_turned.collect::<Vec<_>>().join("\n"), &viewing);
        assert!((expected[0] / plain[0] - 1.0).abs() > 5e-3, "{name}: the turn tells nothing");
        assert_near(&mapped, &expected, 1e-3, name);
    }
}

fn rays_at(viewing_deg: f64, places: &[f64]) -> String {
    let (sin, cos) = viewing_deg.to_radians().sin_cos();
    let ray = |x: &f64| format!("{} 0 {} {} 0 {}\n", x + sin * 3.0, cos * 3.0, -sin, -cos);
    places.iter().map(ray).collect()
}

#[test]
fn a_directive_leaves_the_scene_legal_for_radiance() {
    let folder = Folder::new();
    let native = ours(&folder, &scene("void brdfplugin m 3 retro glass_bead paint 0 1 7.5", 5.0), &rays(&[4.8]));
    let ordinary = "void plastic m 0 0 5 .5 .5 .5 0 0\n#@radsight brdf m retro glass_bead paint 7.5";
    assert_eq!(ours(&folder, &scene(ordinary, 5.0), &rays(&[4.8])), native);
    if let Some(radiance) = Radiance::find() {
        let file = folder.file("legal.rad", scene(ordinary, 5.0));
        let output = radiance.command("oconv", &[&file]).output().expect("oconv runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn mistakes_in_a_scene_stand_at_their_tokens() {
    let folder = Folder::new();
    for (material, expected) in [
        ("void brdfplugin m 2 retro shrap 0 0", ["no model \"shrap\"", "did you mean \"sharp\""]),
        ("void brdfplugin m 2 retro sharp 0 3 .5 .01 99", ["order is 99", "1:44"]),
        ("void brdfplugin m 3 retro sharp flat 0 3 .5 .01 9", ["extra word \"flat\"", "1:33"]),
        ("void brdfplugin m 2 retro sharp 0 4 .9 .01 6 .5", ["expected at most 100 %", "1:27"]),
    ] {
        let file = folder.file("wrong.rad", scene(material, 0.0));
        let run = radsight_with(&["rtrace", "-h", &file], rays(&[0.0]).as_bytes());
        assert_eq!(run.code, 1, "{material}: {}", run.messages);
        assert!(expected.iter().all(|part| run.messages.contains(part)), "{material}: {}", run.messages);
    }
}

#[test]
fn coefficients_survive_conversion() {
    let folder = Folder::new();
    let table = "observation,entrance,ra\n.1,-4,1200\n.2,30,550.25\n2,60,.003\n.5,45,85\n";
    let data = folder.file("data.csv", table);
    let brdf = folder.file("brdf.csv", radsight(&["retro", "convert", &data, "--to", "brdf"]).text());
    let back = radsight(&["retro", "convert", &brdf, "--to", "ra"]).text();
    let found: Vec<f64> = back.lines().skip(1).map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect();
    assert_near(&found, &[1200.0, 550.25, 0.003, 85.0], 1e-12, "R_A");
    let first: f64 =
        std::fs::read_to_string(&brdf).unwrap().lines().nth(1).unwrap().rsplit(',').next().unwrap().parse().unwrap();
    // 1200 cd/(lx m²) at entrance −4° and viewing −4.1°.
    assert!((first / (1200.0 / (4f64.to_radians().cos() * 4.1f64.to_radians().cos())) - 1.0).abs() < 1e-12);
}

#[test]
fn a_table_of_a_model_is_fitted_back_to_its_parameters() {
    let folder = Folder::new();
    let made = radsight(&["retro", "table", "sharp", ".2", ".008", "3", "--observation", ".1,.3,.5,.6"]).text();
    let text = radsight(&["retro", "fit", &folder.file("made.csv", &made), "--model", "sharp"]).text();
    for (name, expected) in [("rho_s", 0.2), ("half_width", 0.008), ("order", 3.0)] {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        let value: f64 = line.split(',').nth(2).unwrap().parse().unwrap();
        assert!((value / expected - 1.0).abs() < 1e-4, "{line}");
    }
    assert!(radsight(&["retro", "plot", "sharp", ".2", ".008", "3"]).text().starts_with("<svg"));
    let material = radsight(&["retro", "material", "sheet", "sharp", ".2", ".008", "3"]).text();
    assert_eq!(material, "void brdfplugin sheet\n2 retro sharp\n0\n3 0.2 0.008 3\n");
}

#[test]
fn the_command_refuses_what_it_does_not_know() {
    let folder = Folder::new();
    let bad = folder.file("bad.csv", ".2,-4,800\n.2,x,3\n");
    let run = radsight(&["retro", "fit", &bad, "--model", "sharp"]);
    assert!(
        run.code == 1 && run.messages.contains("bad.csv:2:4") && run.messages.contains("\"x\" is not a number"),
        "{run:?}"
    );
    assert_eq!(radsight(&["retro", "fit", &bad, "--model", "shrap"]).code, 2);
    assert_eq!(radsight(&["retro", "table", "sharp", ".2"]).code, 2);
    assert_eq!(radsight(&["retro", "table", "sharp", ".2", ".01", "3", "--observation", "100"]).code, 2);
    let types = radsight(&["retro", "minimum", "XI"]);
    assert!(types.code == 2 && types.messages.contains("I, II, III"), "{types:?}");
    assert!(radsight(&["retro", "minimum", "i"]).text().contains("0.2,-4,70,50,25,9,14,4,1"));
    let trailer = radsight(&["retro", "minimum", "dot-c2"]).text();
    assert!(trailer.contains("49 CFR 571.108") && trailer.contains("0.5,45,15,,,,4,,"), "{trailer}");
}

/// Real Radiance reads the parts without a warning, and meets the same materials from above.
#[test]
fn the_parts_are_radiance_scenes() {
    let folder = program::root().join("radiance-scenes/parts");
    let rays: String = (0..60 * 40)
        .map(|ray| (-0.0389 + 0.00131 * f64::from(ray % 60), -0.0359 + 0.00181 * f64::from(ray / 60)))
        .map(|(x, y)| format!("{x} {y} .3 0 0 -1\n"))
        .collect();
    for part in ["bolt", "bracket", "gear", "spring", "bearing", "plastic"] {
        let scene = format!("{part}.rad");
        let in_folder = |mut command: std::process::Command, input: &[u8]| {
            let run = run_with(command.current_dir(&folder), input);
            assert!(run.code == 0 && run.messages.is_empty(), "{part}: {}", run.messages);
            run.output
        };
        in_folder(command(&["check", "--strict", "materials.rad", &scene]), b"");
        let Some(radiance) = Radiance::find() else { continue };
        let scratch = Folder::new();
        let octree = scratch.file("part.oct", in_folder(radiance.command("oconv", &["materials.rad", &scene]), b""));
        let real = in_folder(radiance.command("rtrace", &["-h", "-oM", "-ab", "0", &octree]), rays.as_bytes());
        let ours = ["rtrace", "-h", "-oM", "-ab", "0", "materials.rad", &scene];
        let ours = in_folder(command(&ours), rays.as_bytes());
        let lines = |text: &[u8]| String::from_utf8_lossy(text).lines().map(str::to_owned).collect::<Vec<_>>();
        let (real, ours) = (lines(&real), lines(&ours));
        let hits = real.iter().filter(|name| !name.contains('*')).count();
        let different = real.iter().zip(&ours).filter(|(real, ours)| real.trim() != ours.trim()).count();
        assert!(real.len() == ours.len() && hits > 200, "{part}: {hits} rays of {} meet it", real.len());
        // Real Radiance includes points within products of lengths of 1e-6 in a polygon: a fifth of
        // a millimetre at an edge of 5 mm, if the unit is the metre.
        assert!(different <= real.len() / 50, "{part}: {different} rays meet another material");
    }
}

/// A millimetre is one unit here, so that real Radiance's tolerances are small compared with the
/// parts.
#[test]
fn the_parts_are_as_bright_under_a_sky_as_in_real_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let parts = program::root().join("radiance-scenes/parts");
    for file in ["materials.rad", "conductor.cal"] {
        std::fs::copy(parts.join(file), folder.path(file)).expect("the file is copied");
    }
    folder.file("sky.rad", "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 180\n");
    let rays: String = (0..30 * 20)
        .map(|ray| (-38.9 + 2.62 * f64::from(ray % 30), -35.9 + 3.62 * f64::from(ray / 30)))
        .map(|(x, y)| format!("{x} {y} 300 0 0 -1\n"))
        .collect();
    let options = "-h -w -ab 1 -ad 256 -as 0 -aa 0 -ss 64 -st 0 -oMsnv".split(' ').collect::<Vec<_>>();
    for part in ["bolt", "bracket", "gear", "spring", "bearing", "plastic", "washer"] {
        let scaled = radsight(&["xform", "-s", "1000", &parts.join(format!("{part}.rad")).to_string_lossy()]).text();
        folder.file("part.rad", scaled);
        let files = ["materials.rad", "part.rad", "sky.rad"];
        let octree = run_with(radiance.command("oconv", &files).current_dir(folder.path(".")), b"").output;
        folder.file("part.oct", octree);
        let mut real = radiance.command("rtrace", &[&options[..], &["part.oct"]].concat());
        let mut ours = command(&[&["rtrace"], &options[..], &files].concat());
        let [real, ours] = [&mut real, &mut ours].map(|command| {
            let run = run_with(command.current_dir(folder.path(".")), rays.as_bytes());
            run.text().lines().map(hit_line).collect::<Vec<_>>()
        });
        let mut means: BTreeMap<String, [f64; 3]> = BTreeMap::new();
        for (real, ours) in real.iter().zip(&ours).filter(|(real, ours)| real.is_same_place(ours)) {
            let sums = means.entry(real.names[0].clone()).or_default();
            [1.0, real.numbers[3], ours.numbers[3]].into_iter().zip(sums).for_each(|(value, sum)| *sum += value);
        }
        means.remove("*");
        assert!(means.values().map(|sums| sums[0]).sum::<f64>() > 30.0, "{part}: {means:?}");
        for (material, [rays, real, ours]) in means {
            // Noise of 64 samples per highlight.
            let tolerance = 0.015 + 0.15 / rays.sqrt();
            assert!((ours / real - 1.0).abs() < tolerance, "{part}, {material}, {rays} rays: {ours} for {real}");
        }
    }
}

/// The hit of one ray: names of material and surface; normal and green radiance.
struct HitLine {
    names: [String; 2],
    numbers: [f64; 4],
}

fn hit_line(line: &str) -> HitLine {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |index: usize| words[index].parse().expect("a number");
    HitLine { names: [words[0].to_owned(), words[1].to_owned()], numbers: [2, 3, 4, 5].map(number) }
}

impl HitLine {
    fn is_same_place(&self, other: &HitLine) -> bool {
        let normals = self.numbers.iter().zip(&other.numbers).take(3);
        self.names == other.names && normals.into_iter().all(|(a, b)| (a - b).abs() < 1e-3)
    }
}
