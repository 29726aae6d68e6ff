//! Light transport, compared with real Radiance: the scenes in `tests/light`, each with its rays
//! and options.
//!
//! Comments of a scene file describe the comparison: `# ray` gives origin and direction, `# case`
//! options of `rtrace` for both programs, followed by deviations from the defaults: the number of
//! repetitions (`repeats`) and the tolerance of the means relative to the larger one (`tolerance`;
//! values far below the brightest one have a larger tolerance).

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;
use std::f64::consts::PI;
use std::path::Path;

/// Options that make real `rtrace` integrate: lights in small jittered pieces, all of them tested,
/// highlights sampled; with the same random numbers in every run.
const INTEGRATE: &[&str] = &["-ds", ".01", "-dj", ".9", "-dt", "0", "-dc", "1", "-st", "0", "-ab", "0", "-u-"];

/// Options, and tolerances.
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

/// A description of the differences.
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
fn warped_polygons_lie_where_radiance_puts_them() {
    agrees(&["warped"]);
}

#[test]
fn prisms_send_light_where_radiance_sends_it() {
    agrees(&["prism"]);
}

#[test]
fn illums_render_as_their_substitutes() {
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

/// The sun of the render tests behind `prism2`, found by rays through the prism: a glow that is not
/// a light source is seen only by those.
#[test]
fn the_sun_lights_through_a_prism_what_rays_through_it_find() {
    let Some(radiance) = Radiance::find() else { return };
    let shared =
        std::env::var_os("RADSIGHT_SHARED").map(|folder| Path::new(&folder).join("radiance/renders/prism.cal"));
    let Some(functions) = shared.and_then(|path| std::fs::read(path).ok()) else {
        println!("skipped: RADSIGHT_SHARED names no folder with prism.cal");
        return;
    };
    let folder = Folder::new();
    folder.file("prism.cal", functions);
    let prism = "void prism2 prism 11 coef1 dx1 dy1 dz1 coef2 dx2 dy2 dz2 prism.cal -rz 90 0 4 1.52 .2 .1 .2\n\
                 prism polygon window 0 0 12 -8.1 1 1 -8.1 4 1 -8.1 4 2 -8.1 1 2\n\
                 void plastic black 0 0 5 0 0 0 0 0\n\
                 black polygon wall 0 0 30 -8 -9 -9 -8 9 -9 -8 9 9 -8 -9 9 -8 -9 -9\n\
                 -8 1 1 -8 1 2 -8 4 2 -8 4 1 -8 1 1\n";
    let sun = |radiance: &str| format!("{prism}void {radiance}\nsun source disk 0 0 4 -.9338 -.35 1e-3 1\n");
    folder.file("light.rad", sun("light sun 0 0 3 2.5e4 2.5e4 2.5e4"));
    folder.file("glow.rad", sun("glow sun 0 0 4 2.5e4 2.5e4 2.5e4 0"));
    let octree = radiance.octree(&folder, &["glow.rad"]);
    // On the floor and on the ceiling, each with the direction of the sun's image.
    for (place, normal, image) in
        [("-6.31 4.22 0", 1.0, [-0.6478, -0.35097, 0.67615]), ("-5.23 2.6 3", -1.0, [-0.82476, -0.35096, -0.4434])]
    {
        let words = ["rtrace", "-h", "-I+", "-ab", "0", "-dr", "1", "--samples", "1024", "light.rad"];
        let input = format!("{place} 0 0 {normal}\n");
        let ours = run_with(command(&words).current_dir(folder.path("")), input.as_bytes()).text();
        let ours = means(&ours, 1)[0][0];
        let found = through_the_prism(&radiance, &octree, place, (image, 0.04), &folder);
        println!("{place}: {ours} here, {found} by rays through the prism");
        assert!((ours / found - 1.0).abs() < 0.005, "{place}: {ours} here, {found} by rays through the prism");
    }
}

/// A lamp three units behind a prism that deflects by a fixed angle. Shadow rays of Radiance search
/// it where that angle is correct for the prism's centre.
#[test]
fn a_near_lamp_lights_through_a_prism_what_rays_through_it_find() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let prism = "void prism1 tilted 5 .8 Dx+.2*if(Dz,1,-1) Dy Dz . 0 0\n\
                 tilted polygon window 0 0 12 -2 -2 2 -2 2 2 2 2 2 2 -2 2\n";
    let lamp = |radiance: &str| {
        format!("{prism}void {radiance}\nlamp polygon panel 0 0 12 .4 -.1 5 .4 .1 5 .6 .1 5 .6 -.1 5\n")
    };
    folder.file("light.rad", lamp("light lamp 0 0 3 40 40 40"));
    folder.file("glow.rad", lamp("glow lamp 0 0 4 40 40 40 0"));
    let octree = radiance.octree(&folder, &["glow.rad"]);
    for (place, image) in [("0 0 0", [-0.02, 0.0, 0.9998]), ("1 0 0", [-0.2176, 0.0, 0.976])] {
        let words = ["rtrace", "-h", "-I+", "-ab", "0", "-dr", "1", "--samples", "1024", "light.rad"];
        let ours = run_with(command(&words).current_dir(folder.path("")), format!("{place} 0 0 1\n").as_bytes()).text();
        let ours = means(&ours, 1)[0][0];
        let found = through_the_prism(&radiance, &octree, place, (image, 0.1), &folder);
        println!("{place}: {ours} here, {found} by rays through the prism");
        assert!((ours / found - 1.0).abs() < 0.02, "{place}: {ours} here, {found} by rays through the prism");
    }
}

/// Irradiance on a horizontal surface from the directions around a unit direction, by rays of real
/// `rtrace` on a grid of this width in the tangent plane of the sphere.
fn through_the_prism(
    radiance: &Radiance,
    octree: &str,
    place: &str,
    (image, width): ([f64; 3], f64),
    folder: &Folder,
) -> f64 {
    const SIDE: usize = 300;
    let [x, y, z] = image;
    let level = x.hypot(y);
    let mut rays = String::new();
    let mut solid_angles = Vec::new();
    for index in 0..SIDE * SIDE {
        let [a, b] = [index % SIDE, index / SIDE].map(|step| width * ((step as f64 + 0.5) / SIDE as f64 - 0.5));
        let beside = [-y / level * a - x * z / level * b, x / level * a - y * z / level * b, level * b];
        let towards = [x + beside[0], y + beside[1], z + beside[2]];
        let length = (1.0 + a * a + b * b).sqrt();
        rays += &format!("{place} {} {} {}\n", towards[0], towards[1], towards[2]);
        solid_angles.push((width / SIDE as f64).powi(2) / length.powi(3) * (towards[2] / length).abs());
    }
    let words = ["-h", "-w", "-ab", "0", "-lr", "8", "-lw", "1e-6", octree];
    let mut rtrace = radiance.command("rtrace", &words);
    let seen = means(&run_with(rtrace.current_dir(folder.path("")), rays.as_bytes()).text(), 1);
    seen.iter().zip(&solid_angles).map(|(radiance, projected)| radiance[0] * projected).sum()
}

#[test]
fn sensors_in_a_penumbra_see_how_much_of_the_sun_is_visible() {
    // An edge at height 10, whose shadow's penumbra is as wide as the sun there.
    let scene = "
        void light bright 0 0 3 1e6 1e6 1e6
        bright source sun 0 0 4 0 0 1 .53
        void glow dim 0 0 4 .001 .001 .001 0
        dim source sky 0 0 4 0 0 1 180
        void plastic black 0 0 5 0 0 0 0 0
        black polygon shade 0 0 12 -10 -10 10 10 -10 10 10 0 10 -10 0 10
        black polygon floor 0 0 12 -20 -20 0 20 -20 0 20 20 0 -20 20 0
    ";
    let radius = 10.0 * 0.265_f64.to_radians().tan();
    let places: Vec<f64> = (-9..10).map(|step| f64::from(step) / 8.0).collect();
    let sensors: String = places.iter().map(|place| format!("0 {} .001 0 0 1\n", place * radius)).collect();
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let words = ["rtrace", "-h", "-I", "-ab", "1", "-ad", "1024", "-aa", ".2", "scene.rad"];
    let output = run_with(command(&words).current_dir(folder.path("")), sensors.as_bytes()).text();
    let values: Vec<f64> =
        output.lines().map(|line| line.split_whitespace().next().unwrap().parse().unwrap()).collect();
    let sunny = values.last().unwrap();
    assert_eq!(values.len(), places.len());
    for (place, value) in places.iter().zip(&values) {
        let x = place.clamp(-1.0, 1.0);
        let visible = 0.5 + (x.asin() + x * (1.0 - x * x).sqrt()) / PI;
        assert!((value / sunny - visible).abs() < 0.2, "at {place}: {} instead of {visible}", value / sunny);
    }
}
