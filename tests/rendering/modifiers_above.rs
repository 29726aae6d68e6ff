//! What patterns and textures above a material do to the rays that it transmits and reflects, to
//! its parts, to alternate materials and to the surfaces of cuts.
//!
//! The colour of the sky tells the direction of a ray. The numbers are real Radiance's. Where it is
//! installed, it is asked again.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;

/// The mean colours of a ray from above and of one from below.
type Seen = [f64; 6];

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Compared {
    /// Colours.
    Colors,
    /// Colours but for a common factor, which the integral of a rough lobe changes.
    Hues,
}

const RAYS: [&str; 2] = [".5 .2 1 .3 .4 -1\n", ".5 .2 -1 -.3 .1 1\n"];

/// Number of times that each ray is traced.
const REPEATS: usize = 200;

const TOLERANCE: f64 = 1e-3;

const WORDS: &[&str] = &["-h", "-w-", "-u-", "-ab", "0", "-av", ".3", ".3", ".3", "-st", "0", "-ss", "1"];

const SKY: &str = "void colorfunc grad 4 .5+.4*Dx .5+.4*Dy .5+.3*Dz . 0 0
grad glow shining 0 0 4 1 1 1 0
shining source sky 0 0 4 0 0 1 360
";

const PANE: &str = " polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";

/// The pane as a mesh with interpolated normals.
const CURVED: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    vn -.3 -.3 1\nvn .3 -.3 1\nvn .3 .3 1\nvn -.3 .3 1\nf 1//1 2//2 3//3 4//4\n";

fn means(output: &str) -> Seen {
    let values: Vec<f64> =
        output.split_whitespace().map(|word| word.parse().expect("standard output holds numbers")).collect();
    assert_eq!(values.len(), RAYS.len() * REPEATS * 3);
    std::array::from_fn(|index| {
        let of_ray = &values[index / 3 * 3 * REPEATS..][..3 * REPEATS];
        of_ray.iter().skip(index % 3).step_by(3).sum::<f64>() / REPEATS as f64
    })
}

/// What both programs see of a scene: radsight, then real Radiance.
fn seen(scene: &str) -> (Seen, Option<Seen>) {
    let folder = Folder::new();
    folder.file("scene.rad", format!("{SKY}{scene}"));
    if scene.contains("pane.rtm") {
        folder.file("pane.obj", CURVED);
        run_with(command(&["obj2mesh", "pane.obj", "pane.rtm"]).current_dir(folder.path("")), b"").done();
    }
    let input: String = RAYS.iter().map(|ray| ray.repeat(REPEATS)).collect();
    let ours = [&["rtrace"], WORDS, &["scene.rad"]].concat();
    let ours = run_with(command(&ours).current_dir(folder.path("")), input.as_bytes()).text();
    let theirs = Radiance::find().map(|radiance| {
        let octree = radiance.octree(&folder, &["scene.rad"]);
        let theirs = radiance.run(&folder.path(""), "rtrace", &[WORDS, &[&octree]].concat(), input.as_bytes());
        means(&String::from_utf8_lossy(&theirs))
    });
    (means(&ours), theirs)
}

fn hues(seen: Seen) -> Seen {
    std::array::from_fn(|index| seen[index] / seen[index / 3 * 3..][..3].iter().sum::<f64>())
}

/// The ways in which what is seen differs from what is expected.
fn differences(name: &str, scene: &str, compared: Compared, expected: Seen) -> String {
    let (ours, theirs) = seen(scene);
    let mut found = String::new();
    for (program, seen) in [("radsight", Some(ours)), ("Radiance", theirs)] {
        let Some(seen) = seen else { continue };
        let [seen, expected] = match compared {
            Compared::Colors => [seen, expected],
            Compared::Hues => [hues(seen), hues(expected)],
        };
        if seen.iter().zip(&expected).any(|(seen, expected)| (seen - expected).abs() > TOLERANCE) {
            found += &format!("\n{name}: {program} sees {seen:.4?}, expected {expected:.4?}");
        }
    }
    found
}

#[track_caller]
fn check(cases: impl IntoIterator<Item = (String, String, Seen)>) {
    let cases = cases.into_iter();
    let wrong: String =
        cases.map(|(name, scene, expected)| differences(&name, &scene, Compared::Colors, expected)).collect();
    assert!(wrong.is_empty(), "{wrong}");
}

/// A material, what is compared, and what is seen of it in each surrounding.
struct Sheet {
    name: &'static str,
    text: &'static str,
    compared: Compared,
    seen: [Seen; 5],
}

/// The modifiers and the shape of a sheet `m`, in the order of [`Sheet::seen`].
const SURROUNDINGS: [(&str, &str, &str); 5] = [
    ("smoothed by Phong", "m texfunc Phong 4 .3 .1 0 . 0 0\nPhong", PANE),
    ("under a texture", "m texfunc bump 4 .3 .1 0 . 0 0\nbump", PANE),
    ("on a mesh", "m", " mesh p 1 pane.rtm 0 0\n"),
    ("under a texture on a mesh", "m texfunc bump 4 .3 .1 0 . 0 0\nbump", " mesh p 1 pane.rtm 0 0\n"),
    ("under Phong on a mesh", "m texfunc Phong 4 .3 .1 0 . 0 0\nPhong", " mesh p 1 pane.rtm 0 0\n"),
];

const GLASS: [Seen; 5] = [
    [0.4881, 0.5075, 0.2136, 0.291, 0.4203, 0.587],
    [0.3991, 0.4835, 0.1995, 0.3809, 0.4517, 0.5924],
    [0.4191, 0.4676, 0.1959, 0.3219, 0.452, 0.5891],
    [0.3376, 0.4349, 0.1996, 0.3951, 0.4721, 0.5862],
    [0.4909, 0.5073, 0.2098, 0.288, 0.4153, 0.5866],
];

const TRANS: [Seen; 5] = [
    [0.4859, 0.5145, 0.1853, 0.3085, 0.4305, 0.6288],
    [0.3891, 0.4886, 0.1695, 0.4046, 0.4642, 0.6351],
    [0.4141, 0.4679, 0.1657, 0.3269, 0.4596, 0.6293],
    [0.3066, 0.4305, 0.1716, 0.4237, 0.4919, 0.6292],
    [0.4859, 0.5145, 0.1853, 0.3085, 0.4305, 0.6288],
];

const WARD: [Seen; 5] = [
    [0.4859, 0.5145, 0.1853, 0.3085, 0.4305, 0.6288],
    [0.3936, 0.4946, 0.1708, 0.2411, 0.4, 0.6083],
    [0.4141, 0.4679, 0.1657, 0.2915, 0.4018, 0.6258],
    [0.3173, 0.4478, 0.1709, 0.2349, 0.3785, 0.605],
    [0.4859, 0.5145, 0.1853, 0.3085, 0.4305, 0.6288],
];

const SHEETS: [Sheet; 7] = [
    Sheet { name: "glass", text: "glass m 0 0 3 .8 .8 .8", compared: Compared::Colors, seen: GLASS },
    Sheet { name: "trans", text: "trans m 0 0 7 .8 .8 .8 0 0 1 1", compared: Compared::Colors, seen: TRANS },
    Sheet { name: "rough trans", text: "trans m 0 0 7 .8 .8 .8 0 .01 1 1", compared: Compared::Hues, seen: TRANS },
    Sheet {
        name: "trans2",
        text: "trans2 m 4 1 0 0 . 0 8 .8 .8 .8 0 .01 .01 1 1",
        compared: Compared::Hues,
        seen: TRANS,
    },
    Sheet {
        name: "BRTDfunc",
        text: "BRTDfunc m 10 0 0 0 .8 .8 .8 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        compared: Compared::Colors,
        seen: TRANS,
    },
    Sheet {
        name: "WGMDfunc",
        text: "WGMDfunc m 13 void 0 0 0 void .8 0 0 void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        compared: Compared::Colors,
        seen: WARD,
    },
    Sheet {
        name: "rough WGMDfunc",
        text: "WGMDfunc m 13 void 0 0 0 void .8 .01 .01 void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        compared: Compared::Hues,
        seen: WARD,
    },
];

#[test]
fn textures_turn_transmitted_rays_unless_they_only_smooth() {
    let mut wrong = String::new();
    for sheet in SHEETS {
        for ((surroundings, modifiers, shape), expected) in SURROUNDINGS.into_iter().zip(sheet.seen) {
            let name = format!("{} {surroundings}", sheet.name);
            let scene = format!("void {}\n{modifiers}{shape}", sheet.text);
            wrong += &differences(&name, &scene, sheet.compared, expected);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_modifier_of_the_surface_tells_whether_textures_only_smooth() {
    let (straight, turned) = (GLASS[0], GLASS[1]);
    let cases: [(&str, &str, Seen); 9] = [
        (
            "a pattern below the texture",
            "m texfunc Phong 4 .3 .1 0 . 0 0\nPhong brightfunc half 2 .5 . 0 0\nhalf",
            [0.2291, 0.2684, 0.1247, 0.1973, 0.2425, 0.3069],
        ),
        (
            "a pattern of the name",
            "m texfunc bump 4 .3 .1 0 . 0 0\nbump brightfunc Phong 2 .5 . 0 0\nPhong",
            [0.2737, 0.2804, 0.1318, 0.1523, 0.2268, 0.3042],
        ),
        ("an alias of the name", "m texfunc bump 4 .3 .1 0 . 0 0\ninherit alias Phong bump\nPhong", straight),
        ("an alias of another name", "m texfunc Phong 4 .3 .1 0 . 0 0\ninherit alias other Phong\nother", turned),
        (
            "a mixture of the name",
            "m texfunc bump 4 .3 .1 0 . 0 0\nvoid mixfunc Phong 4 bump bump .5 . 0 0\nPhong",
            straight,
        ),
        (
            "a part of a mixture, which another surface has as well",
            "m texfunc Phong 4 .3 .1 0 . 0 0\nvoid mixfunc both 4 Phong m .5 . 0 0\nPhong sphere far 0 0 4 0 0 -9 1\nboth",
            [0.4406, 0.497, 0.21, 0.3444, 0.4406, 0.5906],
        ),
        ("an alternate material", "m texfunc Phong 4 .3 .1 0 . 0 0\nvoid illum lit 1 Phong 0 3 1 1 1\nlit", turned),
        ("an illum of the name", "m texfunc bump 4 .3 .1 0 . 0 0\nvoid illum Phong 1 bump 0 3 1 1 1\nPhong", straight),
        (
            "a material of the name",
            "void texfunc bump 4 .3 .1 0 . 0 0\nbump glass Phong 0 0 3 .8 .8 .8\nPhong",
            straight,
        ),
    ];
    check(cases.map(|(name, modifiers, seen)| {
        (name.to_owned(), format!("void glass m 0 0 3 .8 .8 .8\n{modifiers}{PANE}"), seen)
    }));
}
