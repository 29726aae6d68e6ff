//! Indirect light on normals that a texture turns: the irradiance of the surface and its gradient by
//! rotation, in every way in which indirect light is computed.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;
use std::fmt::Write;

/// Normals by their parts along the surface, relative to that across it.
const TEXTURES: [[f64; 2]; 4] = [[0.2, 0.1], [-1.0, 0.5], [1.7, 0.0], [-0.4, 1.5]];

/// Radiance 1 where `Dx > 0`, and 0.2 elsewhere, from above and from below.
const SKY: &str = "void brightfunc half 2 if(Dx,1,.2) . 0 0\nhalf glow shine 0 0 4 1 1 1 0\n\
                   shine source sky 0 0 4 0 0 1 360\n";

const FLOOR: &str = "m polygon floor 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";

/// A sky through a square window in a wall; without it, rays rarely find the window.
const WINDOW: &str = "void glow shine 0 0 4 3 2 1 0\nshine source sky 0 0 4 0 0 1 360\n\
                      void plastic dark 0 0 5 .1 .1 .1 0 0\n\
                      dark polygon wall 0 0 30 2 -50 -50  2 50 -50  2 50 50  2 -50 50  2 -50 -50  2 -.4 .4  2 -.4 1.2 \
                      2 .4 1.2  2 .4 .4  2 -.4 .4\n\
                      dark polygon ceiling 0 0 12 -50 -50 3  -50 50 3  2 50 3  2 -50 3\n\
                      dark polygon back 0 0 12 -3 -50 -50  -3 -50 50  -3 50 50  -3 50 -50\n\
                      dark polygon left 0 0 12 -3 -50 -50  -3 -50 3  2 -50 3  2 -50 -50\n\
                      dark polygon right 0 0 12 -3 50 -50  2 50 -50  2 50 3  -3 50 3\n\
                      void glass pane 0 0 3 .9 .9 .9\npane polygon glazing 0 0 12 2 -.4 .4 2 -.4 1.2 2 .4 1.2 2 .4 .4\n";

/// Every way to compute indirect light, and the number of repeated rays.
const WAYS: [(&str, usize); 5] = [
    ("-aa 0 -ad 4096", 4),
    ("-aa 0 -ad 1", 1 << 14),
    ("-aa .1 -ad 4096 -as 0", 1),
    ("-aa .1 -ad 1024 -as 0", 1),
    ("--samples 4096", 1),
];

fn scene(folder: &Folder, [along, aside]: [f64; 2], material: &str, surroundings: &str) -> String {
    let texture = format!("void texfunc turn 4 {along} {aside} 0 . 0 0\n");
    folder.file("scene.rad", format!("{texture}turn {material}\n{FLOOR}{surroundings}"))
}

/// Mean of the first band of repeated rays.
fn red(folder: &Folder, words: &str, input: &str, repeats: usize) -> f64 {
    let words: Vec<&str> = words.split_whitespace().collect();
    let mut ours = command(&words);
    let reds = reds(&run_with(ours.current_dir(folder.path("")), input.repeat(repeats).as_bytes()).text());
    assert_eq!(reds.len(), repeats);
    reds.iter().sum::<f64>() / repeats as f64
}

/// The first band of one ray, by a program of real Radiance.
fn real_red(radiance: &Radiance, folder: &Folder, program: &str, options: &str, input: &str) -> f64 {
    let octree = radiance.octree(folder, &["scene.rad"]);
    let words: Vec<&str> = options.split_whitespace().chain([octree.as_str()]).collect();
    let mut theirs = radiance.command(program, &words);
    let reds = reds(&run_with(theirs.current_dir(folder.path("")), input.as_bytes()).text());
    assert_eq!(reds.len(), 1);
    reds[0]
}

fn reds(text: &str) -> Vec<f64> {
    text.lines().map(|line| line.split_whitespace().next().expect("red").parse().expect("a number")).collect()
}

/// The part of the turned normal along x.
fn along([along, aside]: [f64; 2]) -> f64 {
    along / (1.0 + along * along + aside * aside).sqrt()
}

#[test]
fn all_ways_follow_the_gradient_by_rotation() {
    let folder = Folder::new();
    let mut wrong = String::new();
    // A texture turns the normal of the back by the same vector, so that it faces the other way.
    for (material, reflectance, input, side) in [
        ("plastic m 0 0 5 .5 .4 .3 0 0", 0.5, "0 0 1 0 0 -1\n", 1.0),
        ("plastic m 0 0 5 .5 .4 .3 0 0", 0.5, ".2 .1 -1 0 0 1\n", -1.0),
        ("trans m 0 0 7 .5 .4 .3 0 0 1 0", 0.5, "0 0 1 0 0 -1\n", -1.0),
    ] {
        for texture in TEXTURES {
            let scene = scene(&folder, texture, material, SKY);
            // L = 1 over half the hemisphere and 0.2 over the other: E = π (0.6 + 0.4 n′_x).
            let expected = reflectance * (0.6 + 0.4 * side * along(texture));
            for (way, repeats) in WAYS {
                let found = red(&folder, &format!("rtrace -h -ab 1 -lw 1e-9 {way} {scene}"), input, repeats);
                if (found / expected - 1.0).abs() > 0.03 {
                    let _ = writeln!(wrong, "{material}, {texture:?}, {way}: {found}, expected {expected}");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn rays_towards_a_window_follow_it_as_well() {
    let folder = Folder::new();
    let of = |texture: [f64; 2], way: &str, repeats: usize| {
        let scene = scene(&folder, texture, "plastic m 0 0 5 .5 .4 .3 0 0", WINDOW);
        red(&folder, &format!("rtrace -h -ab 1 -lw 1e-9 {way} {scene}"), "0 0 1 0 0 -1\n", repeats)
    };
    let cached = "-aa .1 -ad 16384 -as 0";
    let plain = of([0.0; 2], cached, 1);
    for texture in TEXTURES {
        let exact = of(texture, cached, 1);
        for (way, repeats) in [("-aa 0 -ad 4096", 4), ("-aa 0 --samples 8192", 1), ("-aa .1 -ad 2048 -as 0", 1)] {
            let found = of(texture, way, repeats);
            assert!((found - exact).abs() < 0.08 * plain, "{texture:?}, {way}: {found}, {cached}: {exact}");
        }
    }
}

/// Radiance's contributions leave the texture out, and a contribution is never negative.
#[test]
fn contributions_are_those_of_the_surface() {
    let folder = Folder::new();
    let radiance = Radiance::find();
    let input = "0 0 1 0 0 -1\n";
    let options = "-h -V+ -ab 1 -ad 16384 -lw 1e-9 -m shine";
    for texture in TEXTURES {
        let scene = scene(&folder, texture, "plastic m 0 0 5 .5 .4 .3 0 0", SKY);
        let found = red(&folder, &format!("rcontrib {options} {scene}"), input, 1);
        assert!((found / 0.3 - 1.0).abs() < 0.01, "{texture:?}: {found}");
        let Some(radiance) = &radiance else { continue };
        let theirs = real_red(radiance, &folder, "rcontrib", options, input);
        assert!((found / theirs - 1.0).abs() < 0.02, "{texture:?}: {found}, real {theirs}");
    }
}

/// A facet that faces away from the only light gets none, and no sum of rays is negative.
#[test]
fn no_irradiance_is_negative() {
    let folder = Folder::new();
    let scene = scene(&folder, [-1.0, 0.5], "plastic m 0 0 5 .5 .4 .3 0 0", WINDOW);
    for way in
        ["-aa 0 -ad 4096", "-aa 0 -ad 64", "-aa .1 -ad 4096", "--samples 4096", "-aa 0 --samples 4096", "--error .05"]
    {
        assert_eq!(red(&folder, &format!("rtrace -h -ab 1 -lw 1e-9 {way} {scene}"), "0 0 1 0 0 -1\n", 1), 0.0, "{way}");
    }
    // Signed rays leave nothing where their mean is negative, and add nothing elsewhere.
    let picture =
        format!("rpict -vp 0 0 1 -vd 0 0 -1 -vu 0 1 0 -vh 60 -vv 60 -x 8 -y 8 -ab 1 -aa 0 --samples 64 {scene}");
    let words: Vec<&str> = picture.split_whitespace().collect();
    let picture = run_with(command(&words).current_dir(folder.path("")), b"").done();
    let values = run_with(&mut command(&["pvalue", "-h", "-H", "-d", "-b"]), &picture).text();
    assert!(values.lines().all(|line| line.trim().parse::<f64>().expect("a number") >= 0.0), "{values}");
}

/// Real Radiance without interpolation has the same, unless the irradiance of the facet falls below
/// a twentieth of that of the surface: then it takes the latter.
#[test]
fn real_radiance_agrees() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let input = "0 0 1 0 0 -1\n";
    let options = "-h -ab 1 -lw 1e-9 -aa 0 -ad 16384 -as 0";
    for surroundings in [SKY, WINDOW] {
        let of = |texture: [f64; 2]| {
            let scene = scene(&folder, texture, "plastic m 0 0 5 .5 .4 .3 0 0", surroundings);
            red(&folder, &format!("rtrace {options} {scene}"), input, 1)
        };
        let plain = of([0.0; 2]);
        for texture in TEXTURES {
            let found = of(texture);
            let theirs = real_red(&radiance, &folder, "rtrace", options, input);
            // Radiance takes the gradient from few cells next to the horizon.
            let agrees = (found - theirs).abs() < 0.15 * plain;
            assert!(agrees || found < 0.05 * plain, "{texture:?}: {found}, real {theirs}, plain {plain}");
        }
    }
}
