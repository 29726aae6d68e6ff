//! The materials `BSDF` and `aBSDF`, compared with real Radiance and with theory.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;
use radsight_test_support::bsdf_files::{all_forms, clear};
use std::fmt::Write;

/// A ray: origin and direction.
type Ray = [f64; 6];

/// Options that make real `rtrace` integrate: lights in small pieces, all of them tested,
/// everything sampled.
const INTEGRATE: [&str; 15] =
    ["-ds", ".05", "-dj", ".9", "-dt", "0", "-dc", "1", "-st", "0", "-lr", "6", "-lw", "1e-4", "-u-"];

const LAMP: &str = "void light lamp 0 0 3 100 90 80\nlamp polygon l 0 0 12 -.3 -.3 3 -.3 .3 3 .3 .3 3 .3 -.3 3\n";
const BACK_LAMP: &str =
    "void light back 0 0 3 50 60 70\nback polygon b 0 0 12 -.3 -.3 -3 .3 -.3 -3 .3 .3 -3 -.3 .3 -3\n";
const SKY: &str = "void glow sky 0 0 4 1 2 3 0\nsky source s 0 0 4 0 0 1 180\nvoid glow ground 0 0 4 .5 .4 .3 0\nground source g 0 0 4 0 0 -1 180\n";
const SUN: &str = "void light sun 0 0 3 1e4 1e4 1e4\nsun source sun 0 0 4 .3 .2 1 2\n";
const SHEET: &str = "polygon sheet 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";
const FLOOR: &str =
    "void plastic stone 0 0 5 .5 .4 .3 0 0\nstone polygon floor 0 0 12 -5 -5 -1 5 -5 -1 5 5 -1 -5 5 -1\n";
const CARD: &str = "void plastic red 0 0 5 .8 .1 .1 0 0\nred polygon card 0 0 12 -1 -1 -.1 1 -1 -.1 1 1 -.1 -1 1 -.1\n";
const SIDE_LAMP: &str = "void light side 0 0 3 90 90 90\nside polygon l 0 0 12 -1 2 -1 -1 2 1 -1 1.5 1 -1 1.5 -1\n";

/// Rays to the sheet from both sides.
fn rays() -> Vec<Ray> {
    [(0.1, 0.5, 1.0), (0.5, 4.0, -1.0), (0.8, 1.9, 1.0), (0.3, 5.4, 1.0), (1.1, 3.0, -1.0), (0.95, 2.6, 1.0)]
        .into_iter()
        .enumerate()
        .map(|(index, (polar, azimuth, side)): (usize, (f64, f64, f64))| {
            let [x, y, z] = [polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), side * polar.cos()];
            let [u, v] = [0.3 - 0.1 * index as f64, 0.07 * index as f64 - 0.2];
            [u + 0.8 * x, v + 0.8 * y, 0.8 * z, -x, -y, -z]
        })
        .collect()
}

/// Mean and standard error of each ray's bands.
type Estimate = [(f64, f64); 3];

fn estimates(output: &str, repeats: usize) -> Vec<Estimate> {
    let values: Vec<Vec<f64>> = output
        .lines()
        .map(|line| line.split_whitespace().map(|word| word.parse().expect("a number")).collect())
        .collect();
    let estimate = |rays: &[Vec<f64>]| {
        [0, 1, 2].map(|band| {
            let count = rays.len() as f64;
            let mean = rays.iter().map(|ray| ray[band]).sum::<f64>() / count;
            let variance = rays.iter().map(|ray| (ray[band] - mean).powi(2)).sum::<f64>() / count;
            (mean, (variance / count).sqrt())
        })
    };
    values.chunks(repeats).map(estimate).collect()
}

/// A folder with all the BSDF files.
fn folder() -> Folder {
    let folder = Folder::new();
    for (name, text) in all_forms() {
        folder.file(&format!("{}.xml", name.replace([' ', '\''], "_")), text);
    }
    folder.file("clear.xml", clear(0.8));
    folder
}

fn input(rays: &[Ray], repeats: usize) -> String {
    let mut text = String::new();
    for ray in rays {
        let words: Vec<String> = ray.iter().map(f64::to_string).collect();
        writeln!(text, "{}", words.join(" ")).expect("a string is written");
        let line_start = text.trim_end().rfind('\n').map_or(0, |at| at + 1);
        let line = text[line_start..].to_owned();
        text.push_str(&line.repeat(repeats - 1));
    }
    text
}

fn ours(folder: &Folder, scene: &str, words: &[&str], rays: &[Ray], repeats: usize) -> Vec<Estimate> {
    folder.file("scene.rad", scene);
    let words = [&["rtrace", "-h"], words, &["scene.rad"]].concat();
    let run = run_with(command(&words).current_dir(folder.path("")), input(rays, repeats).as_bytes());
    estimates(&run.text(), repeats)
}

/// Mean radiances differ by at most 2 % and the noise of both.
fn differences(
    radiance: &Radiance,
    folder: &Folder,
    name: &str,
    scene: &str,
    options: &[&str],
    repeats: usize,
) -> String {
    let rays = rays();
    let here = ours(folder, scene, options, &rays, repeats);
    let octree = radiance.octree(folder, &["scene.rad"]);
    let words = [&["-h"], &INTEGRATE[..], options, &[&octree]].concat();
    let mut there = radiance.command("rtrace", &words);
    let there = run_with(there.current_dir(folder.path("")), input(&rays, repeats).as_bytes());
    let there = estimates(&there.text(), repeats);
    assert_eq!(there.len(), rays.len(), "{name}: real rtrace answers all rays");
    let largest = there.iter().flatten().fold(0.0, |a: f64, b| a.max(b.0));
    assert!(largest > 0.0, "{name}: something is seen");
    let mut wrong = String::new();
    for (ray, (here, there)) in here.iter().zip(&there).enumerate() {
        for (band, (here, there)) in here.iter().zip(there).enumerate() {
            let allowed = 0.02 * here.0.max(there.0) + 5.0 * here.1.hypot(there.1) + 2e-3 * largest;
            if (here.0 - there.0).abs() > allowed {
                writeln!(wrong, "{name}, ray {ray}, band {band}: {here:?} here, {there:?} there").expect("a string");
            }
        }
    }
    wrong
}

/// Scenes of a sheet: name, text, options.
fn variants() -> Vec<(String, String, Vec<&'static str>)> {
    let scene = |around: &str, material: &str| format!("{around}{material}m {SHEET}");
    let direct = vec!["-ab", "0"];
    let mut all = Vec::new();
    let forms: Vec<String> = all_forms().iter().map(|(name, _)| name.replace([' ', '\''], "_")).collect();
    // Real Radiance scatters only light of sources against the direction of an isotropic tree, and
    // has no colours there.
    let is_broken = |form: &str| form == "coloured_isotropic_tree";
    for form in forms.iter().filter(|form| !is_broken(form)) {
        let material = format!("void BSDF m 6 0 {form}.xml 0 1 0 . 0 0\n");
        all.push((format!("{form} under lamps"), scene(&[LAMP, BACK_LAMP].concat(), &material), direct.clone()));
        if form != "isotropic_tree_one_way" {
            all.push((format!("{form} under a sky"), scene(SKY, &material), direct.clone()));
        }
    }
    let lamps = [LAMP, BACK_LAMP].concat();
    let half = "half_matrix_by_rows.xml";
    let mut add = |name: &str, material: String, around: &str, options: &[&'static str]| {
        all.push((name.to_owned(), scene(around, &material), options.to_vec()));
    };
    add("an oblique up vector", format!("void BSDF m 6 0 {half} 1 .3 .2 . 0 0\n"), &lamps, &direct);
    add("an up vector by functions", format!("void BSDF m 8 0 {half} Px+.2 Py+.7 0 . -rz 30 0 0\n"), &lamps, &direct);
    add("reflectance added in front", format!("void BSDF m 6 0 {half} 0 1 0 . 0 3 .1 .2 .3\n"), &lamps, &direct);
    add(
        "reflectance added on both sides",
        format!("void BSDF m 6 0 {half} 0 1 0 . 0 6 .1 .2 .3 .3 .2 .1\n"),
        &lamps,
        &direct,
    );
    let nine = format!("void BSDF m 6 0 {half} 0 1 0 . 0 9 .1 .2 .3 .3 .2 .1 .05 .1 .15\n");
    add("transmittance added", nine.clone(), &lamps, &direct);
    let stripes = "void brightfunc stripes 2 if(Px,.8,.4) . 0 0\n";
    add("a pattern", format!("{stripes}{}", nine.replace("void", "stripes")), &lamps, &direct);
    add("a pattern under a sky", format!("{stripes}{}", nine.replace("void", "stripes")), SKY, &direct);
    let tilt = "void texfunc tilt 4 .2 .1 0 . 0 0\n";
    add("a texture", format!("{tilt}tilt BSDF m 6 0 {half} 0 1 0 . 0 0\n"), &lamps, &direct);
    add("invisible from behind", nine.clone(), &lamps, &["-ab", "0", "-bv-"]);
    for thickness in [".2", "-.2"] {
        let material = format!("void BSDF m 6 {thickness} {half} 0 1 0 . 0 0\n{CARD}");
        add(&format!("a proxy {thickness} thick in view"), material, &lamps, &direct);
    }
    let even = ["-ab", "1", "-ad", "64", "-aa", "0"];
    add("a thin sheet in a lit place", nine, &[LAMP, FLOOR].concat(), &even);
    let proxy = format!("void BSDF m 6 .2 {half} 0 1 0 . 0 0\n{CARD}");
    add("a proxy met by scattered rays", proxy, &[SIDE_LAMP, FLOOR].concat(), &even);
    all
}

#[test]
fn materials_agree_with_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    let variants = variants();
    assert!(variants.len() >= 25, "{}", variants.len());
    let mut wrong = String::new();
    for (name, scene, options) in variants {
        wrong += &differences(&radiance, &folder, &name, &scene, &options, 100);
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn light_of_the_sun_passes_an_aperture_as_in_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    let scene = format!("{SUN}{FLOOR}void aBSDF m 5 clear.xml 0 1 0 . 0 0\nm {SHEET}");
    // Rays that start below the sheet, onto the floor in its light and beside it.
    let below: Vec<Ray> = [-0.6, -0.3, 0.0, 0.4, 1.9].map(|x| [x, 0.1, -0.5, 0.0, 0.05, -1.0]).to_vec();
    let here = ours(&folder, &scene, &["-ab", "0"], &below, 16);
    let octree = radiance.octree(&folder, &["scene.rad"]);
    let mut there = radiance.command("rtrace", &["-h", "-ab", "0", "-dj", "0", &octree]);
    let there = run_with(there.current_dir(folder.path("")), input(&below, 1).as_bytes());
    for (here, there) in here.iter().zip(estimates(&there.text(), 1)) {
        let (here, there) = (here[1].0, there[1].0);
        assert!((here - there).abs() < 2e-3 * there, "{here} here, {there} there");
    }
}

/// Radiance samples a part of the peak twice and returns up to 19 % more than the sky emits.
#[test]
fn an_aperture_gains_no_light() {
    let folder = folder();
    let even_sky = "void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 360\n";
    let scene = format!("{even_sky}void aBSDF m 5 clear.xml 0 1 0 . 0 0\nm {SHEET}");
    for estimate in ours(&folder, &scene, &["-ab", "0"], &rays(), 64) {
        assert!((estimate[1].0 - 0.8).abs() < 1e-4, "{estimate:?}");
    }
}

#[test]
fn a_proxy_shows_what_it_stands_for() {
    let folder = folder();
    let with = |sheet: &str| format!("{LAMP}{CARD}{sheet}");
    let proxy = format!("void BSDF m 6 .2 full_matrix.xml 0 1 0 . 0 0\nm {SHEET}");
    let seen = ours(&folder, &with(&proxy), &["-ab", "0"], &rays(), 1);
    assert_eq!(seen, ours(&folder, &with(""), &["-ab", "0"], &rays(), 1));
}
