//! Coincident surfaces: each pair of materials and sides, compared with real `rtrace`.
//!
//! Each scene holds two coincident surfaces and is seen along three rays.
//! `coincident/references.txt` has a line for each group of scenes: its name, then for each pair of
//! materials which surface each ray met, first or second in the scene; lines whose name begins with
//! `values` have the radiances of the rays (green). `make_references` rewrites the file with real
//! Radiance.

use crate::program::{Folder, finish_command, radsight, root, run_with};
use glam::DVec3;
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, ReadOptions, read_scene};
use radsight_render::{BareSurfaces, NoModels, Ray, RenderOptions, RenderPlan, Renderer};
use radsight_test_support::Radiance;
use std::collections::BTreeMap;
use std::fmt::Write;

/// One letter per material; `V` has none, and `A` is another name of `P`.
const MATERIALS: &str = "
void plastic P 0 0 5 .5 .4 .3 0 0
void metal M 0 0 5 .7 .6 .5 .9 0
void glass G 0 0 3 .5 .6 .7
void dielectric D 0 0 5 .9 .9 .9 1.5 0
void light L 0 0 3 5 6 7
void illum I 1 void 0 3 1 2 3
void glow W 0 0 4 1 2 3 0
void mixfunc X 4 P void .3 . 0 0
void texfunc V 4 0 0 0 . 0 0
void trans T 0 0 7 .5 .5 .5 0 0 .5 .5
void BRTDfunc F 10 .1 .1 .1 .3 .3 .3 0 0 0 . 0 9 .1 .1 .1 .1 .1 .1 .1 .1 .1
void antimatter K 1 P 0 0
void mirror R 0 0 3 .8 .8 .8
void alias A P
void light lamp 0 0 3 100 100 100
lamp sphere bulb 0 0 4 0 0 1000 .5
void glow sky 0 0 4 .3 .4 .5 0
sky source dome 0 0 4 0 0 1 360
";

const ALL: &str = "PMGDLIWXVTFKRA";
const SEVEN: &str = "PMGFLXV";

/// A surface, and its reversal.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Square,
    /// A square and a triangle in one oblique plane.
    TiltedSquare,
    TiltedTriangle,
    Ring,
    Sphere,
    Cylinder,
    /// The same with its ends exchanged.
    CylinderBack,
    Cone,
    Mesh,
    Instance,
}

use Form::{Cone, Cylinder, CylinderBack, Instance, Mesh, Ring, Sphere, Square, TiltedSquare, TiltedTriangle};
use Turn::{Kept, Reversed};

/// Scenes of one kind.
struct Group {
    name: &'static str,
    materials: &'static str,
    forms: [Form; 2],
    offset: f64,
    scale: f64,
    /// Distance of the second surface above the first.
    apart: f64,
}

const fn group(name: &'static str, materials: &'static str, first: Form, second: Form) -> Group {
    Group { name, materials, forms: [first, second], offset: 0.0, scale: 1.0, apart: 0.0 }
}

const fn apart(name: &'static str, apart: f64) -> Group {
    Group { apart, ..group(name, "PGLX", Square, Square) }
}

const GROUPS: [Group; 26] = [
    group("polygons", SEVEN, Square, Square),
    group("polygons-of-all-materials", ALL, Square, Square),
    group("tilted-polygons", SEVEN, TiltedSquare, TiltedTriangle),
    Group { offset: 1e6, ..group("far-polygons", SEVEN, TiltedSquare, TiltedTriangle) },
    Group { scale: 1e3, ..group("large-polygons", "PGLX", TiltedSquare, TiltedTriangle) },
    Group { scale: 0.01, ..group("small-polygons", "PGLX", TiltedTriangle, TiltedSquare) },
    apart("above-by-1e-7", 1e-7),
    apart("below-by-1e-7", -1e-7),
    apart("below-by-9e-7", -9e-7),
    apart("above-by-1.1e-6", 1.1e-6),
    apart("below-by-1.1e-6", -1.1e-6),
    apart("below-by-1e-4", -1e-4),
    group("rings", SEVEN, Ring, Ring),
    group("ring-on-polygon", SEVEN, Square, Ring),
    group("polygon-on-ring", SEVEN, Ring, Square),
    group("spheres", SEVEN, Sphere, Sphere),
    group("cylinders", SEVEN, Cylinder, Cylinder),
    group("cylinders-end-to-end", SEVEN, Cylinder, CylinderBack),
    group("cones", SEVEN, Cone, Cone),
    group("meshes", SEVEN, Mesh, Mesh),
    group("mesh-on-polygon", SEVEN, Square, Mesh),
    group("polygon-on-mesh", SEVEN, Mesh, Square),
    group("instances", SEVEN, Instance, Instance),
    group("instance-on-polygon", SEVEN, Square, Instance),
    group("polygon-on-instance", SEVEN, Instance, Square),
    group("mesh-on-instance", SEVEN, Instance, Mesh),
];

/// Which of the two surfaces are reversed.
const TURNS: [[Turn; 2]; 3] = [[Kept, Kept], [Kept, Reversed], [Reversed, Kept]];

/// Whether a surface is reversed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    Kept,
    Reversed,
}

/// From above, from below, oblique.
const RAYS: [[[f64; 3]; 2]; 3] =
    [[[0.1, 0.2, 3.0], [0.0, 0.0, -1.0]], [[0.3, 0.2, -3.0], [0.01, 0.0, 1.0]], [[0.1, 0.3, 2.0], [0.13, 0.12, -1.0]]];

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
const INNER: &str = "void plastic Q 0 0 5 .2 .3 .4 0 0\nQ polygon inner 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";

impl Group {
    fn point(&self, [x, y, z]: [f64; 3], lift: f64) -> String {
        [x, y, z + lift / self.scale].map(|at| format!("{} ", self.offset + self.scale * at)).concat()
    }

    /// The text of a surface, lifted by this much.
    fn surface(&self, form: Form, modifier: char, name: &str, turn: Turn, lift: f64) -> String {
        let is_turned = turn == Reversed;
        let head = |kind: &str| format!("{modifier} {kind} {name} 0 0 ");
        let polygon = |corners: &[[f64; 3]]| {
            let mut corners: Vec<String> = corners.iter().map(|corner| self.point(*corner, lift)).collect();
            if is_turned {
                corners.reverse();
            }
            format!("{}{} {}\n", head("polygon"), 3 * corners.len(), corners.concat())
        };
        let between = |kind: [&str; 2], radii: &[f64], ends: [f64; 2]| {
            let ends = ends.map(|y| self.point([0.0, y, -0.5], lift)).concat();
            let radii: String = radii.iter().map(|radius| format!("{} ", radius * self.scale)).collect();
            let count = 6 + radii.split_whitespace().count();
            format!("{}{count} {ends}{radii}\n", head(kind[usize::from(is_turned)]))
        };
        let placed = |kind: &str, file: &str| {
            let turn = if is_turned { "3 FILE -rx 180" } else { "1 FILE" };
            format!("{modifier} {kind} {name} {} 0 0\n", turn.replace("FILE", file))
        };
        match form {
            Square => polygon(&[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]),
            TiltedSquare => polygon(&[[-1.0, -1.0, -1.0], [1.0, -1.0, -0.4], [1.0, 1.0, 1.0], [-1.0, 1.0, 0.4]]),
            TiltedTriangle => polygon(&[[-2.0, -1.0, -1.3], [2.0, -1.0, -0.1], [0.0, 2.0, 1.4]]),
            Ring => {
                let up = if is_turned { -1 } else { 1 };
                format!("{}8 {}0 0 {up} 0 {}\n", head("ring"), self.point([0.0; 3], lift), self.scale)
            }
            Sphere => {
                let kind = if is_turned { "bubble" } else { "sphere" };
                format!("{}4 {}{}\n", head(kind), self.point([0.0; 3], lift), self.scale)
            }
            Cylinder => between(["cylinder", "tube"], &[1.0], [-1.0, 1.0]),
            CylinderBack => between(["cylinder", "tube"], &[1.0], [1.0, -1.0]),
            Cone => between(["cone", "cup"], &[1.0, 0.7], [-1.0, 1.0]),
            Mesh => placed("mesh", "square.rtm"),
            Instance => placed("instance", "inner.oct"),
        }
    }

    /// Whether Radiance supports a light of this shape: no round one facing inwards, and no cone.
    fn is_lawful(form: Form, modifier: char, turn: Turn) -> bool {
        let is_light = matches!(modifier, 'L' | 'I' | 'W');
        let can_shine = match form {
            Sphere | Cylinder | CylinderBack => turn == Kept,
            Cone => false,
            _ => true,
        };
        !is_light || can_shine
    }

    /// For each pair of materials, the scenes with the pair.
    fn scenes(&self) -> Vec<Vec<String>> {
        let pairs = self.materials.chars().flat_map(|first| self.materials.chars().map(move |second| [first, second]));
        pairs
            .map(|pair| {
                let is_lawful =
                    |turns: &&[Turn; 2]| (0..2).all(|at| Group::is_lawful(self.forms[at], pair[at], turns[at]));
                let text = |turns: &[Turn; 2]| {
                    let [first, second] = [("first", 0.0), ("second", self.apart)];
                    MATERIALS.to_owned()
                        + &self.surface(self.forms[0], pair[0], first.0, turns[0], first.1)
                        + &self.surface(self.forms[1], pair[1], second.0, turns[1], second.1)
                };
                TURNS.iter().filter(is_lawful).map(text).collect()
            })
            .collect()
    }

    fn rays(&self) -> [[DVec3; 2]; 3] {
        RAYS.map(|[origin, direction]| {
            [DVec3::splat(self.offset) + self.scale * DVec3::from_array(origin), DVec3::from_array(direction)]
        })
    }
}

/// The surface that a ray met, and its radiance.
type Answer = (char, f64);

fn letter(name: &str) -> char {
    match name {
        "first" => '1',
        "second" => '2',
        _ => '-',
    }
}

/// Our result, without starting a program for each of thousands of scenes.
fn ours(scene: String, files: &MemoryLoader, rays: [[DVec3; 2]; 3]) -> Vec<Answer> {
    let input = Input::Text { name: "scene.rad".to_owned(), text: scene.into_bytes().into() };
    let read = read_scene(&[input], files, &ReadOptions::default());
    assert!(!read.has_errors(), "{}", read.render(9));
    let scene = read.scene.validate().expect("the scene is valid").scene;
    let options = RenderOptions { bare_surfaces: BareSurfaces::Reported, ..RenderOptions::default() };
    let renderer = Renderer::new(RenderPlan::new(scene, options, &NoModels).expect("the scene can be rendered"));
    let rays = rays.map(|[origin, direction]| Ray::new(origin, direction));
    let traced = renderer.trace_all(0, &rays);
    let answer = |traced: Option<radsight_render::Traced>| {
        let traced = traced.expect("every ray is answered");
        let name = traced.first_hit.map_or("", |hit| renderer.plan().names_at(&hit)[0]);
        (letter(name), traced.value[1])
    };
    traced.into_iter().map(answer).collect()
}

fn theirs(radiance: &Radiance, scene: &str, folder: &Folder, rays: [[DVec3; 2]; 3]) -> Vec<Answer> {
    folder.file("scene.rad", scene);
    let octree = radiance.octree(folder, &["scene.rad"]);
    let numbers = |ray: [DVec3; 2]| ray.map(|vector| vector.to_array().map(|at| format!("{at} ")).concat()).concat();
    let input: String = rays.map(|ray| numbers(ray) + "\n").concat();
    let mut command = radiance.command("rtrace", &["-h", "-w", "-ab", "0", "-st", "0", "-osv", &octree]);
    let text = run_with(command.current_dir(folder.path("")), input.as_bytes()).text();
    let answer = |line: &str| {
        let words: Vec<&str> = line.split('\t').collect();
        (letter(words[0]), words[2].parse().expect("a number"))
    };
    text.lines().map(answer).collect()
}

fn references() -> BTreeMap<String, Vec<String>> {
    let text =
        std::fs::read_to_string(root().join("tests/coincident/references.txt")).expect("the references are there");
    let words = |line: &str| line.split(' ').map(str::to_owned).collect::<Vec<_>>();
    text.lines().map(words).map(|mut words| (words.remove(0), words)).collect()
}

/// For each pair of materials, the surfaces that its rays met, in one word; and their radiances.
fn told(answers: &[Vec<Answer>]) -> [Vec<String>; 2] {
    let met = |answers: &Vec<Answer>| answers.iter().map(|(met, _)| *met).collect();
    let brought =
        |answers: &Vec<Answer>| answers.iter().map(|(_, value)| format!("{value:.4}")).collect::<Vec<_>>().join(",");
    [answers.iter().map(met).collect(), answers.iter().map(brought).collect()]
}

fn answers_of(group: &Group, mut ask: impl FnMut(String) -> Vec<Answer>) -> Vec<Vec<Answer>> {
    group.scenes().into_iter().map(|scenes| scenes.into_iter().flat_map(&mut ask).collect()).collect()
}

/// A mesh and an octree compiled by our programs.
fn own_files() -> MemoryLoader {
    let folder = Folder::new();
    let (square, inner) = (folder.file("square.obj", SQUARE), folder.file("inner.rad", INNER));
    radsight(&["obj2mesh", &square, &folder.word("square.rtm")]).done();
    let octree = radsight(&["oconv", "-f", &inner]).done();
    MemoryLoader::default().with("square.rtm", folder.read("square.rtm")).with("inner.oct", octree)
}

fn real_files(radiance: &Radiance) -> Folder {
    let folder = Folder::new();
    folder.file("square.obj", SQUARE);
    folder.file("inner.rad", INNER);
    let run =
        |program, words: &[&str]| finish_command(radiance.command(program, words).current_dir(folder.path(""))).done();
    run("obj2mesh", &["square.obj", "square.rtm"]);
    let octree = run("oconv", &["-f", "inner.rad"]);
    folder.file("inner.oct", octree);
    folder
}

/// Groups whose values are stored as well: the background and the illumination of the surface
/// matter.
fn keeps_values(group: &Group) -> bool {
    ["polygons", "spheres", "below-by-1e-7", "above-by-1.1e-6"].contains(&group.name)
}

#[track_caller]
fn same_values(ours: &[String], theirs: &[String], group: &str) {
    assert_eq!(ours.len(), theirs.len(), "{group}");
    for (pair, both) in ours.iter().zip(theirs).enumerate() {
        let [ours, theirs] = <[&String; 2]>::from(both).map(|words| words.split(',').collect::<Vec<_>>());
        let is_same = |(ours, theirs): (&&str, &&str)| match (ours.parse::<f64>(), theirs.parse::<f64>()) {
            (Ok(ours), Ok(theirs)) => (ours - theirs).abs() <= 2e-4 + 3e-3 * theirs.abs(),
            // If Radiance supports none of the scenes of a pair there is no value.
            _ => ours == theirs,
        };
        let is_same = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(is_same);
        assert!(is_same, "{group}, pair {pair}:\n{ours:?}\n{theirs:?}");
    }
}

/// Compares groups with the references, and returns the number of rays.
fn compare(is_wanted: impl Fn(&Group) -> bool) -> usize {
    let (references, files) = (references(), own_files());
    let mut count = 0;
    for group in GROUPS.iter().filter(|group| is_wanted(group)) {
        let [met, brought] = told(&answers_of(group, |scene| ours(scene, &files, group.rays())));
        assert_eq!(met, references[group.name], "{}", group.name);
        count += met.iter().map(String::len).sum::<usize>();
        if let Some(values) = references.get(&format!("values-of-{}", group.name)) {
            same_values(&brought, values, group.name);
        }
    }
    count
}

#[test]
fn a_ray_meets_the_polygon_that_real_rtrace_meets() {
    assert_eq!(compare(|group| group.name == "polygons"), 441);
}

#[test]
fn each_material_has_the_rank_that_it_has_in_radiance() {
    assert_eq!(compare(|group| group.name == "polygons-of-all-materials"), 1764);
}

#[test]
fn coincidence_has_the_same_bounds_at_each_scale_and_place() {
    let is_wanted = |group: &Group| group.forms[0] == Square && group.apart != 0.0 || group.name.ends_with("-polygons");
    assert!(compare(is_wanted) > 2000);
}

#[test]
fn round_surfaces_meshes_and_instances_win_where_they_do_in_radiance() {
    let is_wanted = |group: &Group| {
        group.apart == 0.0 && !group.name.ends_with("polygons") && !group.name.starts_with("polygons")
            || group.name.ends_with("-on-polygon")
    };
    assert!(compare(is_wanted) > 4000);
}

/// The radiance of a floor lit by a lamp through coincident surfaces in a plane between them.
fn floor_below(panes: &str) -> f64 {
    let square = |half: f64, height: f64| {
        let corner = |x: f64, y: f64| format!("{} {} {height} ", half * x, half * y);
        format!("0 0 12 {}\n", [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)].concat())
    };
    let mut text =
        "void plastic P 0 0 5 .5 .5 .5 0 0\nvoid mixfunc X 4 P void .3 . 0 0\nvoid plastic Q 0 0 5 .5 .5 .5 0 0
        void glass G 0 0 3 .5 .5 .5\nvoid light L 0 0 3 9 9 9\n"
            .to_owned();
    text += &format!("L polygon lamp {}P polygon floor {}", square(0.2, 3.0), square(5.0, 0.0));
    for (number, modifier) in panes.chars().enumerate() {
        text += &format!("{modifier} polygon pane{number} {}", square(4.0, 2.0));
    }
    let down = [DVec3::new(0.1, 0.2, 1.0), -DVec3::Z];
    ours(text, &MemoryLoader::default(), [down; 3])[0].1
}

#[test]
fn shadow_rays_pass_what_lies_under_a_mixture_as_in_radiance() {
    let mixed = floor_below("X");
    assert!((mixed / floor_below("") - 0.7).abs() < 0.02);
    // Defined later than P and earlier than Q.
    for panes in ["XP", "PX", "XG", "GX", "PXG", "XX"] {
        assert!((floor_below(panes) / mixed - 1.0).abs() < 0.02, "{panes}");
    }
    for panes in ["XQ", "QX", "QXP", "PG", "P"] {
        assert_eq!(floor_below(panes), 0.0, "{panes}");
    }
}

#[test]
fn the_references_are_what_real_rtrace_says() {
    let Some(radiance) = Radiance::find() else { return };
    let (references, folder) = (references(), real_files(&radiance));
    let group = &GROUPS[0];
    let [met, brought] = told(&answers_of(group, |scene| theirs(&radiance, &scene, &folder, group.rays())));
    assert_eq!(met, references[group.name]);
    same_values(&brought, &references["values-of-polygons"], group.name);
}

#[test]
#[ignore = "makes the references, with real Radiance"]
fn make_references() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = real_files(&radiance);
    let mut text = String::new();
    for group in &GROUPS {
        let [met, brought] = told(&answers_of(group, |scene| theirs(&radiance, &scene, &folder, group.rays())));
        writeln!(text, "{} {}", group.name, met.join(" ")).expect("a text grows");
        if keeps_values(group) {
            writeln!(text, "values-of-{} {}", group.name, brought.join(" ")).expect("a text grows");
        }
    }
    std::fs::write(root().join("tests/coincident/references.txt"), text).expect("the file is written");
}
