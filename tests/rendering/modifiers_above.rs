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

/// A pattern and a texture above the material `m`.
const ABOVE: [&str; 2] = ["m brightfunc above 2 .5 . 0 0\nabove", "m texfunc above 4 .2 .1 0 . 0 0\nabove"];

#[test]
fn all_parts_of_ward_functions_have_the_patterns_and_textures_above_them() {
    let parts: [(&str, [Seen; 2]); 7] = [
        (
            "void .5 0 0 void 0 0 0 void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
            [[0.1533, 0.1624, 0.194, 0.0969, 0.1352, 0.0538], [0.3679, 0.3551, 0.3486, 0.1242, 0.2354, 0.1347]],
        ),
        (
            "void 0 0 0 void .5 0 0 void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
            [[0.1518, 0.1608, 0.0579, 0.0964, 0.1345, 0.1965], [0.2661, 0.3071, 0.1067, 0.1617, 0.2496, 0.3846]],
        ),
        (
            "void .5 .01 .01 void 0 0 0 void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
            [[0.1518, 0.1608, 0.1921, 0.0965, 0.1345, 0.0535], [0.365, 0.3522, 0.3458, 0.1239, 0.2346, 0.1342]],
        ),
        (
            "void 0 0 0 void 0 0 0 void 1 0 0 . 0 9 .5 .4 .3 .2 .5 .6 0 0 0",
            [[0.0525, 0.042, 0.0315, 0.021, 0.0525, 0.063], [0.105, 0.084, 0.063, 0.042, 0.105, 0.126]],
        ),
        (
            "void 0 0 0 void 0 0 0 void 1 0 0 . 0 9 0 0 0 0 0 0 .5 .4 .3",
            [[0.075, 0.06, 0.045, 0.075, 0.06, 0.045], [0.15, 0.12, 0.09, 0.15, 0.12, 0.09]],
        ),
        (
            "own .5 0 0 own .2 0 0 own 1 0 0 . 0 9 .1 .1 .1 .1 .1 .1 .2 .2 .2",
            [[0.1838, 0.2099, 0.174, 0.1266, 0.1322, 0.1261], [0.3923, 0.4236, 0.3136, 0.1989, 0.2438, 0.2738]],
        ),
        (
            "inherit .5 0 0 inherit .2 0 0 inherit 1 0 0 . 0 9 .1 .1 .1 .1 .1 .1 .2 .2 .2",
            [[0.1817, 0.1906, 0.1841, 0.1264, 0.164, 0.1241], [0.3957, 0.398, 0.3378, 0.1951, 0.2977, 0.2647]],
        ),
    ];
    let own = "void brightfunc base 2 .7 . 0 0\nbase texfunc own 4 0 .2 0 . 0 0\n";
    check(parts.into_iter().flat_map(|(words, seen)| {
        let case = move |above: &str, seen| {
            (format!("{above} over {words}"), format!("{own}base WGMDfunc m 13 {words}\n{above}{PANE}"), seen)
        };
        ABOVE.into_iter().zip(seen).map(move |(above, seen)| case(above, seen))
    }));
}

#[test]
fn alternate_materials_have_the_patterns_and_textures_above_the_material_that_they_replace() {
    let alternates: [(&str, [Seen; 2]); 3] = [
        (
            "plastic a 0 0 5 .5 .4 .3 .05 0",
            [[0.1033, 0.091, 0.0834, 0.091, 0.0847, 0.0537], [0.1834, 0.1537, 0.1247, 0.1552, 0.1387, 0.0995]],
        ),
        (
            "metal a 0 0 5 .5 .4 .3 .9 0",
            [[0.1457, 0.1235, 0.1104, 0.0948, 0.1036, 0.0337], [0.3466, 0.2691, 0.1997, 0.1268, 0.1819, 0.0822]],
        ),
        (
            "glass a 0 0 3 .9 .8 .7",
            [[0.295, 0.2772, 0.1209, 0.1876, 0.233, 0.2637], [0.4853, 0.4853, 0.1763, 0.4026, 0.4535, 0.5157]],
        ),
    ];
    for replaced in ["mirror m 1 a 0 3 .9 .8 .7", "illum m 1 a 0 3 2 1 .5"] {
        check(alternates.into_iter().flat_map(|(material, seen)| {
            ABOVE.into_iter().zip(seen).map(move |(above, seen)| {
                let scene = format!("void {material}\nvoid {replaced}\n{above}{PANE}");
                (format!("{above} over {replaced}, {material}"), scene, seen)
            })
        }));
    }
}

#[test]
fn alternate_materials_and_mixtures_in_each_other_hand_patterns_on() {
    let mixed = [0.141, 0.1252, 0.0678, 0.1088, 0.1119, 0.1106];
    let above = ABOVE[0];
    let cases: [(&str, String, Seen); 4] = [
        (
            "the pattern of the illum itself",
            "void brightfunc own 2 .5 . 0 0\nown illum m 1 a 0 3 2 1 .5\nm".to_owned(),
            [0.5442, 0.5105, 0.1939, 0.3465, 0.4296, 0.5142],
        ),
        (
            "over a mixture with an illum",
            format!("void illum i 1 a 0 3 2 1 .5\nvoid mixfunc m 4 i b .3 . 0 0\n{above}"),
            mixed,
        ),
        (
            "over an illum with a mixture",
            format!("void mixfunc both 4 a b .3 . 0 0\nvoid illum m 1 both 0 3 2 1 .5\n{above}"),
            mixed,
        ),
        (
            "over a mirror with an illum",
            format!(
                "void illum n 1 a 0 3 2 1 .5\nn brightfunc half 2 .5 . 0 0\nvoid mirror m 1 half 0 3 2 1 .5\n{above}"
            ),
            [0.1703, 0.1605, 0.0843, 0.1081, 0.1347, 0.1384],
        ),
    ];
    check(cases.map(|(name, modifiers, seen)| {
        let parts = "void glass a 0 0 3 .9 .8 .7\nvoid plastic b 0 0 5 .5 .4 .3 0 0\n";
        (name.to_owned(), format!("{parts}{modifiers}{PANE}"), seen)
    }));
}

#[test]
fn strong_textures_of_brtd_functions_turn_rays_back() {
    let scene =
        "void BRTDfunc m 10 0 0 0 .8 .8 .8 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\nm texfunc bump 4 0 0 -1.5 . 0 0\nbump";
    let seen = [0.5141, 0.5521, 0.5931, 0.2534, 0.4489, 0.1899];
    check([("a strong texture".to_owned(), format!("{scene}{PANE}"), seen)]);
}

#[test]
fn surfaces_of_cuts_have_the_patterns_and_textures_above_the_antimatter() {
    let sky = [0.3856, 0.5381, 0.786];
    let of_cuts = [
        ("m", [0.1452, 0.2747, 0.4998]),
        ("m brightfunc above 2 .5 . 0 0\nabove", [0.0728, 0.1375, 0.2502]),
        ("m texfunc above 4 .2 .1 0 . 0 0\nabove", [0.1053, 0.2505, 0.4589]),
        ("m texfunc above 4 .2*Nz .1*Nx 0 . 0 0\nabove", [0.1955, 0.2542, 0.5049]),
    ];
    check(of_cuts.map(|(above, [red, green, blue])| {
        let scene = format!(
            "void metal body 0 0 5 .9 .8 .7 .9 0\nvoid metal a 0 0 5 .4 .8 .7 .9 0\nvoid antimatter m 2 a body 0 0\n\
             body sphere b 0 0 4 .95 .8 -.5 .3\n{above} sphere c 0 0 4 .87 .7 -.26 .24\n"
        );
        (above.to_owned(), scene, [red, green, blue, sky[0], sky[1], sky[2]])
    }));
}
