//! Values beside real Radiance's: a surface with the BSDF under a small distant light, by `rtrace`,
//! without jitter.
//!
//! Skipped where `RADSIGHT_RADIANCE` names no folder with `bin` and `lib` and no `oconv` is on the
//! path.

use glam::DVec3;
use radsight_measured::MeasuredBsdf;
use radsight_test_support::bsdf_files::all_forms;
use radsight_test_support::{Radiance, Random};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Radiance marks cells by changing values by up to 3 parts in 10⁴ (matrices) or 2 parts in 10⁴
/// (trees).
const MARKS: f64 = 4e-4;

/// Radiance stores the colours of matrices in 16 bits.
const COLORS: f64 = 0.2;

const LIGHTS: usize = 4;
const RAYS: usize = 300;

/// Value times cosine for each given direction and each light, up to a constant factor: π for white
/// plastic.
fn real_values(radiance: &Radiance, folder: &Path, material: &str, light: DVec3, given: &[DVec3]) -> Vec<[f64; 3]> {
    let [x, y, z] = light.to_array();
    let scene = format!(
        "void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 {x} {y} {z} .05\n{material}\n\
         m polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"
    );
    let octree = radiance.run(folder, "oconv", &["-"], scene.as_bytes());
    std::fs::write(folder.join("scene.oct"), octree).expect("a file is written");
    let mut rays = String::new();
    for direction in given {
        let [x, y, z] = direction.to_array();
        writeln!(rays, "{x} {y} {z} {} {} {}", -x, -y, -z).expect("a string is written");
    }
    let arguments = ["-h", "-ss", "0", "-dj", "0", "-dt", "0", "-ab", "0", "scene.oct"];
    let output = radiance.run(folder, "rtrace", &arguments, rays.as_bytes());
    let text = String::from_utf8(output).expect("numbers");
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
    numbers.chunks(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect()
}

/// The file's values agree, except for the few pairs of directions on the edge between two cells.
fn agrees(radiance: &Radiance, name: &str, xml: &[u8]) {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("b.xml"), xml).expect("a file is written");
    let bsdf = MeasuredBsdf::read(xml).expect("it is read").bsdf;
    let mut random = Random(17);
    let material = "void BSDF m 6 0 b.xml 0 1 0 . 0 0";
    let (mut worst, mut lit, mut wrong) = (0.0_f64, 0, 0);
    for _ in 0..LIGHTS {
        let light = random.direction();
        let mut given: Vec<DVec3> = (0..RAYS).map(|_| random.direction()).collect();
        // One direction in three is near the mirror direction, one in three near straight-through.
        for (index, direction) in given.iter_mut().enumerate() {
            let peak = [light * DVec3::new(-1.0, -1.0, 1.0), -light][index % 2];
            if index % 3 > 0 {
                *direction = (peak + 0.06 * *direction).normalize();
            }
        }
        let white = "void plastic m 0 0 5 1 1 1 0 0";
        let up = DVec3::new(light.x, light.y, light.z.signum()).normalize();
        let scale =
            real_values(radiance, folder.path(), white, light, &[up])[0][1] * std::f64::consts::PI / light.z.abs();
        for (direction, real) in given.iter().zip(real_values(radiance, folder.path(), material, light, &given)) {
            let real = real.map(|band| band / scale / light.z.abs());
            let ours = bsdf.value(*direction, light);
            let size = ours.iter().chain(&real).copied().fold(0.02, f64::max);
            let error = ours.iter().zip(&real).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max);
            lit += usize::from(ours[1] > 0.0);
            let limit = if name.contains("colour") { COLORS } else { MARKS };
            if error > limit { wrong += 1 } else { worst = worst.max(error) }
        }
    }
    println!("{name}: {lit} lit, {wrong} on edges, others within {worst:.1e}");
    assert!(wrong * 200 <= LIGHTS * RAYS && lit > 100, "{name}: {wrong} of {} differ", LIGHTS * RAYS);
}

#[test]
fn values_are_those_of_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    // Radiance loses the colour of isotropic trees when it subtracts their Lambertian part, and
    // shows them in red.
    for (name, text) in all_forms().into_iter().filter(|(name, _)| *name != "coloured isotropic tree") {
        agrees(&radiance, name, text.as_bytes());
    }
}

#[test]
fn values_of_the_files_of_others_are_those_of_radiance() {
    let Some(radiance) = Radiance::find() else { return };
    let Some(shared) = std::env::var_os("RADSIGHT_SHARED").map(PathBuf::from) else {
        return println!("skipped: no RADSIGHT_SHARED");
    };
    for name in [
        "loose/bsdf_xml/clear_t4_4.xml",
        "loose/bsdf_xml/diffuse50.xml",
        "loose/bsdf_xml/klemsfull.xml",
        "loose/bsdf_xml/tensortree.xml",
        "renders/blinds20c.xml",
        "renders/sawtooth.xml",
        "scenes/frads_openoffice/Resources/blinds30.xml",
        "scenes/frads_openoffice/Resources/ec60.xml",
    ] {
        let xml = std::fs::read(shared.join("radiance").join(name)).expect("the file is there");
        agrees(&radiance, name, &xml);
    }
}
