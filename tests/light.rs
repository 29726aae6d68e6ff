//! Light transport against real Radiance: the scenes in `tests/light`, each with its rays and options.
//!
//! A scene file tells in comments what is compared: `# ray` gives origin and direction, `# case` options of `rtrace` for both programs, and
//! after them, where they differ from the usual, how often each ray is traced (`repeats`) and by what share of the larger one the means may
//! differ (`tolerance`; what is far below the brightest value is compared less strictly).

mod program;
mod real_radiance;

use program::{Folder, command, run_with};
use real_radiance::Radiance;
use std::path::Path;

/// Real `rtrace` told to integrate: lights in small pieces with a random place in each, all of them tested, highlights sampled; with
/// the same random numbers in every run.
const INTEGRATE: &[&str] = &["-ds", ".01", "-dj", ".9", "-dt", "0", "-dc", "1", "-st", "0", "-ab", "0", "-u-"];

/// Options, and how to compare.
struct Case {
    options: Vec<String>,
    repeats: usize,
    tolerance: f64,
}

impl Case {
    fn parse(line: &str) -> Case {
        let mut case = Case { options: Vec::new(), repeats: 64, tolerance: 0.02 };
        let mut words = line.split_whitespace();
        while let Some(word) = words.next() {
            let mut value = || words.next().expect("a value follows");
            match word {
                "repeats" => case.repeats = value().parse().expect("a count"),
                "tolerance" => case.tolerance = value().parse().expect("a share"),
                option => case.options.push(option.to_owned()),
            }
        }
        case
    }
}

fn lines<'t>(scene: &'t str, mark: &str) -> Vec<&'t str> {
    scene.lines().filter_map(|line| line.strip_prefix(mark)).collect()
}

/// The mean of each ray.
fn means(output: &str, repeats: usize) -> Vec<[f64; 3]> {
    let values: Vec<[f64; 3]> = output
        .lines()
        .map(|line| {
            let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
            numbers.try_into().expect("three numbers")
        })
        .collect();
    let mean = |rays: &[[f64; 3]]| [0, 1, 2].map(|band| rays.iter().map(|ray| ray[band]).sum::<f64>() / repeats as f64);
    values.chunks(repeats).map(mean).collect()
}

/// What differs, in words.
fn compare(radiance: &Radiance, name: &str, scene: &str, rays: &[&str], case: &Case) -> String {
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let words: Vec<&str> = INTEGRATE.iter().copied().chain(case.options.iter().map(String::as_str)).collect();
    let input: String = rays.iter().map(|ray| format!("{ray}\n").repeat(case.repeats)).collect();
    let ours = [&["rtrace", "-h"], &words[..], &["scene.rad"]].concat();
    let ours = run_with(command(&ours).current_dir(folder.path("")), input.as_bytes()).text();
    let octree = radiance.octree(&folder, &["scene.rad"]);
    let theirs = [&["-h", "-w"], &words[..], &[&octree]].concat();
    let mut theirs = radiance.command("rtrace", &theirs);
    let theirs = run_with(theirs.current_dir(folder.path("")), input.as_bytes()).text();
    let [ours, theirs] = [ours, theirs].map(|output| means(&output, case.repeats));
    assert_eq!(ours.len(), rays.len(), "{name}: every ray is answered");
    let largest = theirs.iter().flatten().fold(0.0, |a: f64, b| a.max(*b));
    assert!(largest > 0.0, "{name}: something is seen");
    let mut wrong = String::new();
    for ((ray, ours), theirs) in rays.iter().zip(&ours).zip(&theirs) {
        for (band, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
            let scale = ours.abs().max(theirs.abs()).max(1e-3 * largest);
            if (ours - theirs).abs() > case.tolerance * scale {
                let options = case.options.join(" ");
                wrong += &format!("\n{name} {options}: ray {ray} band {band}: {ours} here, {theirs} there");
            }
        }
    }
    wrong
}

/// Compares all scenes whose names begin with one of `kinds`.
fn agrees(kinds: &[&str]) {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/light");
    let mut wrong = String::new();
    let mut cases = 0;
    for entry in std::fs::read_dir(folder).expect("the scenes are there") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        if !kinds.iter().any(|kind| name.starts_with(kind)) {
            continue;
        }
        let scene = std::fs::read_to_string(&path).expect("the scene is read");
        let rays = lines(&scene, "# ray ");
        for case in lines(&scene, "# case").into_iter().map(Case::parse) {
            wrong += &compare(&radiance, &name, &scene, &rays, &case);
            cases += 1;
        }
    }
    assert!(cases > 0, "there are cases");
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn bodies_refract_and_absorb_as_in_radiance() {
    agrees(&["dielectric"]);
}

#[test]
fn panes_and_mirrors_relay_light_as_in_radiance() {
    agrees(&["glass", "mirror"]);
}

#[test]
fn prisms_send_light_where_radiance_sends_it() {
    agrees(&["prism"]);
}

#[test]
fn illums_look_like_their_substitutes() {
    agrees(&["illum"]);
}

#[test]
fn lights_reach_as_far_as_in_radiance() {
    agrees(&["glow", "spotlight", "sources"]);
}

#[test]
fn a_sky_lights_by_interreflection() {
    agrees(&["sky"]);
}

#[test]
fn mist_dims_and_scatters_as_in_radiance() {
    agrees(&["mist"]);
}

#[test]
fn paths_end_where_radiance_ends_them() {
    agrees(&["weak"]);
}

#[test]
fn irradiance_is_measured_where_radiance_measures_it() {
    agrees(&["irradiance"]);
}
