//! Compiled files in scenes: meshes, octrees, fonts. Files that real Radiance compiled must give
//! the scenes they were made of.

mod support;

use glam::DVec3;
use radsight_ir::{Facing, Material, MixtureAmount, ModifierKind, Pattern, Scene, Shape};
use radsight_loader::MemoryLoader;
use radsight_parse::{Input, Read, ReadOptions, bounds, read_scene, write_scene};
use std::path::Path;
use support::{Disk, Radiance, difference, files_below, shared};

fn read_text(text: &str, loader: &MemoryLoader) -> Read {
    let input = Input::Text { name: "scene.rad".to_owned(), text: text.as_bytes().into() };
    read_scene(&[input], loader, &ReadOptions::default())
}

fn read_files(folder: &Path, names: &[&str]) -> Read {
    let loader = Disk { folder: folder.to_owned(), library: None };
    let inputs: Vec<Input> = names.iter().map(|name| Input::File((*name).to_owned())).collect();
    read_scene(&inputs, &loader, &ReadOptions::default())
}

fn sound(read: Read) -> Scene {
    assert!(!read.has_errors(), "{}", read.render(10));
    assert!(read.scene.clone().validate().is_ok());
    read.scene
}

fn written(scene: &Scene) -> String {
    let mut text = String::new();
    write_scene(scene, &mut text).unwrap();
    text
}

const PAINTS: &str = "void plastic red 0 0 5 .5 0 0 0 0\nvoid glow lamp 0 0 4 1 1 1 0\n";

/// Two triangles with a common edge: normals and local coordinates on the first only.
const OBJ: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvn 0 0 1\nvn .6 0 .8\nvt 0 0\nvt 1 0\nvt 1 .5\n\
    usemtl red\nf 1/1/1 2/2/2 3/3/1\nusemtl lamp\nf 1 3 4\n";

/// A folder with a mesh compiled by real Radiance.
fn folder_with_mesh(radiance: &Radiance) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("paints.rad"), PAINTS).unwrap();
    std::fs::write(folder.path().join("pair.obj"), OBJ).unwrap();
    let (_, succeeded) = radiance.run("obj2mesh", &["-a", "paints.rad", "pair.obj", "pair.rtm"], folder.path());
    assert!(succeeded, "real obj2mesh fails");
    folder
}

#[test]
fn a_mesh_has_the_vertices_normals_and_coordinates_it_was_made_of() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder_with_mesh(&radiance);
    std::fs::write(folder.path().join("scene.rad"), "void mesh pair 7 pair.rtm -rz 90 -t 0 0 1 0 0\n").unwrap();
    let scene = sound(read_files(folder.path(), &["scene.rad"]));
    let mesh = &scene.meshes.items()[0];
    assert_eq!(mesh.triangles.len(), 2);
    let of_kind = |is_textured: bool| mesh.triangles.iter().find(|triangle| triangle.textured == is_textured).unwrap();
    let first = of_kind(true);
    assert!(first.smooth);
    let corners = [([0.0, 0.0, 0.0], [0.0, 0.0]), ([2.0, 0.0, 0.0], [1.0, 0.0]), ([2.0, 1.0, 0.0], [1.0, 0.5])];
    for (position, coordinates) in corners {
        let is_here = |index: &&u32| mesh.vertices[**index as usize].distance(DVec3::from_array(position)) < 1e-6;
        let index = *first.vertices.iter().find(is_here).expect("the corner is there") as usize;
        let [u, v] = mesh.uvs[index];
        assert!((u - coordinates[0]).abs() < 1e-6 && (v - coordinates[1]).abs() < 1e-6, "{u} {v}");
        let normal = if position[0] == 2.0 && position[1] == 0.0 { DVec3::new(0.6, 0.0, 0.8) } else { DVec3::Z };
        assert!(mesh.normals[index].distance(normal) < 2e-4, "{}", mesh.normals[index]);
    }
    let second = of_kind(false);
    assert!(!second.smooth);
    let [a, b, c] = second.vertices.map(|index| mesh.vertices[index as usize]);
    assert!((b - a).cross(c - a).z > 0.0, "the front is where it was");
    let name = |triangle: &radsight_ir::MeshTriangle| scene.modifier_name(triangle.modifier).to_owned();
    assert_eq!([name(first), name(second)], ["red", "lamp"]);
    let placed = &scene.mesh_instances.items()[0];
    assert!(placed.to_scene.point(DVec3::X).distance(DVec3::new(0.0, 1.0, 1.0)) < 1e-12);
}

#[test]
fn the_materials_of_a_mesh_are_unknown_outside_it() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder_with_mesh(&radiance);
    let text = "void metal lamp 0 0 5 1 1 1 1 0\nvoid mesh pair 1 pair.rtm 0 0\nlamp sphere s 0 0 4 0 0 0 1\n\
        red sphere t 0 0 4 0 0 0 1\n";
    std::fs::write(folder.path().join("scene.rad"), text).unwrap();
    let read = read_files(folder.path(), &["scene.rad"]);
    assert_eq!(read.diagnostics.len(), 1, "{}", read.render(9));
    assert_eq!(read.diagnostics[0].message, "undefined modifier \"red\"");
    let sphere = &read.scene.surfaces.items()[1];
    let material = &read.scene.modifiers[sphere.modifier.unwrap()].kind;
    assert!(matches!(material, ModifierKind::Material(Material::Metal(_))), "{material:?}");
}

#[test]
fn a_mesh_under_a_modifier_brings_no_materials() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder_with_mesh(&radiance);
    let text = "void plastic own 0 0 5 1 1 1 0 0\nown mesh pair 1 pair.rtm 0 0\n";
    std::fs::write(folder.path().join("scene.rad"), text).unwrap();
    let scene = sound(read_files(folder.path(), &["scene.rad"]));
    assert_eq!(scene.modifiers.len(), 1);
    assert!(scene.meshes.items()[0].triangles.iter().all(|triangle| triangle.modifier.is_none()));
}

const SCENE: &str = "# shapes\nvoid plastic \"odd name\" 0 0 5 .5 .25 .125 0 0\n\
    inherit alias other \"odd name\"\nvoid brightfunc pattern 2 Px*.5+.25 . 0 0\npattern alias both other\n\
    both polygon p 0 0 9 0 0 0 1 0 0 0 1 0\nother bubble b 0 0 4 1 2 3 .5\n\
    void source s 0 0 4 0 0 1 5\nother cone c 0 0 8 0 0 0 0 0 1 .3 .1\n\
    !xform -n x -rz 30 -t 5 0 0 part.rad\n";

/// A folder with an octree compiled by real Radiance from [`SCENE`].
fn folder_with_octree(radiance: &Radiance, options: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let part = "void metal m 0 0 5 .9 .9 .9 .9 .01\nm ring r 0 0 8 0 0 0 0 0 1 0 .5\n";
    std::fs::write(folder.path().join("part.rad"), part).unwrap();
    std::fs::write(folder.path().join("scene.rad"), SCENE).unwrap();
    compile(radiance, folder.path(), options, "scene.rad", "scene.oct");
    folder
}

fn compile(radiance: &Radiance, folder: &Path, options: &[&str], scene: &str, octree: &str) {
    let arguments: Vec<&str> = options.iter().copied().chain(["-w", scene]).collect();
    let (bytes, succeeded) = radiance.run("oconv", &arguments, folder);
    assert!(succeeded, "real oconv fails");
    std::fs::write(folder.join(octree), bytes).unwrap();
}

#[test]
fn an_octree_is_the_scene_that_it_was_made_of() {
    let Some(radiance) = Radiance::find() else { return };
    for options in [&[][..], &["-f"][..]] {
        let folder = folder_with_octree(&radiance, options);
        let from_text = written(&sound(read_files(folder.path(), &["scene.rad"])));
        let read = read_files(folder.path(), &["scene.oct"]);
        assert!(read.history.lines().any(|line| line.starts_with(b"oconv")), "the header is kept");
        let from_octree = written(&sound(read));
        assert_eq!(difference(from_octree.as_bytes(), from_text.as_bytes(), 1e-8), None, "{options:?}");
    }
}

#[test]
fn a_placed_octree_is_a_scene_of_its_own() {
    let Some(radiance) = Radiance::find() else { return };
    for options in [&[][..], &["-f"][..]] {
        let folder = folder_with_octree(&radiance, options);
        let text = "void instance one 5 scene.oct -t 1 2 3 0 0\nvoid instance two 2 scene.oct -mx 0 0\n";
        std::fs::write(folder.path().join("place.rad"), text).unwrap();
        compile(&radiance, folder.path(), options, "place.rad", "place.oct");
        std::fs::write(folder.path().join("outer.rad"), "void instance all 1 place.oct 0 0\n").unwrap();
        let outer = sound(read_files(folder.path(), &["outer.rad"]));
        let place = &outer.octrees.items()[0].scene;
        assert_eq!((outer.octrees.len(), place.octrees.len(), place.instances.len()), (1, 1, 2), "{options:?}");
        let inner = &place.octrees.items()[0].scene;
        let kinds: Vec<bool> =
            inner.surfaces.items().iter().map(|surface| matches!(surface.shape, Shape::Source(_))).collect();
        assert_eq!(kinds, [false, false, true, false, false]);
        assert_eq!(inner.spheres.items()[0].facing, Facing::Inward);
        let (text, _) = radiance.run("getbbox", &["-h", "outer.rad"], folder.path());
        let theirs: Vec<f64> =
            String::from_utf8_lossy(&text).split_whitespace().map(|word| word.parse().unwrap()).collect();
        let ours = bounds(&outer).unwrap();
        for (axis, pair) in theirs.chunks(2).enumerate() {
            assert!((ours.low[axis] - pair[0]).abs() < 1e-4 && (ours.high[axis] - pair[1]).abs() < 1e-4, "{ours:?}");
        }
    }
}

/// An octree that names a scene file.
fn octree(name: &str) -> Vec<u8> {
    let mut header = radsight_picture::Header::new("RADIANCE");
    header.push_variable("FORMAT", radsight_formats::OCTREE_FORMAT);
    let content = radsight_formats::OctreeContent::Files(vec![name.as_bytes()]);
    let octree = radsight_formats::Octree { header, origin: [0.0; 3], size: 1.0, object_count: 1, content };
    octree.write(&radsight_formats::Tree::Empty).unwrap()
}

#[test]
fn an_octree_without_its_scene_file_is_an_error() {
    let loader = MemoryLoader::default().with("a.oct", octree("none.rad"));
    for input in [&octree("none.rad")[..], b"void instance a 1 a.oct 0 0\n"] {
        let input = Input::Text { name: "input".to_owned(), text: input.into() };
        let read = read_scene(&[input], &loader, &ReadOptions::default());
        assert!(read.has_errors());
        assert_eq!(read.diagnostics[0].message, "cannot find scene file \"none.rad\"");
    }
}

#[test]
fn mutually_recursive_octrees_are_an_error() {
    let loader = MemoryLoader::default()
        .with("a.oct", octree("a.rad"))
        .with("a.rad", "void instance b 1 b.oct 0 0\nvoid sphere s 0 0 4 0 0 0 1\n")
        .with("b.oct", octree("b.rad"))
        .with("b.rad", "void instance a 1 a.oct 0 0\n");
    let read = read_text("void instance a 1 a.oct 0 0\n", &loader);
    assert_eq!(read.diagnostics[0].message, "octree \"a.oct\" contains itself as an instance");
    let shown = read.render(1);
    assert!(shown.contains("b.rad:1:") && shown.contains("scene.rad:1:"), "{shown}");
}

/// A frozen octree of objects.
fn frozen(objects: Vec<radsight_formats::Object<'_>>) -> Vec<u8> {
    let mut header = radsight_picture::Header::new("RADIANCE");
    header.push_variable("FORMAT", radsight_formats::OCTREE_FORMAT);
    let object_count = objects.len();
    let content = radsight_formats::OctreeContent::Objects(objects);
    let octree = radsight_formats::Octree { header, origin: [0.0; 3], size: 4.0, object_count, content };
    octree.write(&radsight_formats::Tree::Empty).unwrap()
}

fn object<'a>(kind: &'a str, modifier: Option<usize>, name: &'a str) -> radsight_formats::Object<'a> {
    let (kind, name) = (kind.as_bytes().into(), name.as_bytes().into());
    radsight_formats::Object { kind, modifier, name, strings: Vec::new(), reals: Vec::new() }
}

#[test]
fn objects_of_a_frozen_octree_keep_odd_names_and_every_digit() {
    // A coordinate that an octree's four bytes of digits hold.
    let exact = f64::from(f32::from_bits(0x3f9d_70a4));
    let square = vec![0.0, 0.0, exact, 1.0, 0.0, exact, 1.0, 1.0, exact, 0.0, 1.0, exact];
    let paint =
        radsight_formats::Object { reals: vec![0.5, 0.5, 0.5, 0.0, 0.0], ..object("plastic", None, "# a \"b\" 'c'") };
    let other =
        radsight_formats::Object { strings: vec![b"# a \"b\" 'c'"[..].into()], ..object("alias", None, "other") };
    let polygon = radsight_formats::Object { reals: square, ..object("polygon", Some(2), "!p q") };
    let bytes = frozen(vec![paint, other, object("alias", Some(0), "same"), polygon]);
    let loader = MemoryLoader::default().with("a.oct", bytes.clone());
    let scene = sound(read_scene(&[Input::File("a.oct".to_owned())], &loader, &ReadOptions::default()));
    let names: Vec<&str> = scene.modifiers.items().iter().map(|modifier| scene.names.get(modifier.name)).collect();
    assert!(names.contains(&"same"), "{names:?}");
    let Shape::Polygon { start: 0, count: 4 } = scene.surfaces.items()[0].shape else { panic!("a polygon") };
    let radsight_formats::OctreeContent::Objects(stored) = radsight_formats::Octree::read(&bytes).unwrap().content
    else {
        panic!("a frozen octree")
    };
    let read: Vec<f64> = scene.vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
    assert_eq!(read, stored[3].reals);
}

#[test]
fn a_mistake_in_a_frozen_octree_is_shown_with_its_line() {
    let short = radsight_formats::Object { reals: vec![0.0, 0.0, 1.0], ..object("sphere", None, "short") };
    let loader = MemoryLoader::default().with("a.oct", frozen(vec![object("lamp", None, "x"), short]));
    let read = read_scene(&[Input::File("a.oct".to_owned())], &loader, &ReadOptions::default());
    let text = read.render(10);
    for expected in
        ["<objects of a.oct>:1:6: error: unknown type \"lamp\"", "<objects of a.oct>:8:1: error: sphere \"short\""]
    {
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn a_chain_of_octrees_that_doubles_at_each_level_is_read_once() {
    let mut loader = MemoryLoader::default().with("s30.rad", "void sphere s 0 0 4 0 0 0 1\n");
    for level in 0..=30 {
        let file = format!("s{level}.rad");
        loader = loader.with(&format!("s{level}.oct"), octree(&file));
        if level < 30 {
            let next = level + 1;
            let text = format!("void instance a 1 s{next}.oct 0 0\nvoid instance b 5 s{next}.oct -t 1 0 0 0 0\n");
            loader = loader.with(&file, text);
        }
    }
    let scene = sound(read_text("void instance a 1 s0.oct 0 0\n", &loader));
    assert_eq!(scene.octrees.len(), 1);
}

#[test]
fn text_has_its_words_lines_and_frame() {
    let loader =
        MemoryLoader::default().with("box.fnt", "65 4 0 0 200 0 200 250 0 250\n32 0\n").with("page.txt", "AA A\n\nA\n");
    let text = "void brighttext t 4 box.fnt . A AA 0 11 1 2 3 .5 0 0 0 -1 0 .25 .75\n\
        void colortext c 2 box.fnt page.txt 0 16 0 0 0 1 0 0 0 -1 0 1 0 0 0 0 1 -.1\n\
        t plastic p 0 0 5 1 1 1 0 0\nc plastic q 0 0 5 1 1 1 0 0\n\
        void mixtext m 5 p q box.fnt . A 0 9 0 0 0 1 0 0 0 -1 0\nm sphere s 0 0 4 0 0 0 1\n";
    let scene = sound(read_text(text, &loader));
    let texts: Vec<_> = scene
        .modifiers
        .items()
        .iter()
        .filter_map(|modifier| match &modifier.kind {
            ModifierKind::Pattern(Pattern::Text(text)) => Some(text),
            ModifierKind::Mixture(mixture) => match &mixture.amount {
                MixtureAmount::Text(text) => Some(text),
                _ => None,
            },
            _ => None,
        })
        .collect();
    let [bright, color, mixed] = texts[..] else { panic!("three texts") };
    assert_eq!(bright.lines, [b"A AA".to_vec()]);
    assert_eq!((bright.origin, bright.spacing), (DVec3::new(1.0, 2.0, 3.0), None));
    assert_eq!((bright.foreground.0[0], bright.background.0[0]), (0.25, 0.75));
    assert_eq!(color.lines, [b"AA A".to_vec(), b"".to_vec(), b"A".to_vec()]);
    assert_eq!((color.spacing, color.background.0), (Some(-0.1), [0.0, 0.0, 1.0]));
    assert_eq!(mixed.lines, [b"A".to_vec()]);
    assert_eq!(scene.fonts.len(), 1);
    assert_eq!(scene.fonts[mixed.font].glyphs[65].as_ref().unwrap().vertices.len(), 4);
}

#[test]
fn mistakes_in_compiled_files_say_what_is_wrong_where() {
    let loader = MemoryLoader::default()
        .with("bad.rtm", "#?RADIANCE\nFORMAT=Radiance_octree\n\n")
        .with("short.oct", "#?RADIANCE\nFORMAT=Radiance_octree\n\n\x01\x1f0")
        .with("bad.fnt", "65 1 300 0\n");
    for (text, expected) in [
        ("void mesh m 0 0 0", "mesh \"m\" names no file"),
        ("void mesh m 1 none.rtm 0 0", "cannot find mesh \"none.rtm\""),
        ("void mesh m 1 bad.rtm 0 0", "\"bad.rtm\": the format is \"Radiance_octree\", expected Radiance_tmesh"),
        ("void mesh m 2 bad.rtm -rx 0 0", "missing the angle of -rx"),
        ("void instance m 1 short.oct 0 0", "\"short.oct\": byte 38: the file ends, expected a coordinate of the cube"),
        (
            "void brighttext t 3 bad.fnt . A 0 11 0 0 0 1 0 0 0 -1 0 1 0 t sphere s 0 0 4 0 0 0 1",
            "\"bad.fnt\": byte 5: expected a coordinate from 0 to 255, found \"300\"",
        ),
        (
            "void brighttext t 3 helvet.fnt . A 0 11 0 0 0 1 0 0 2 0 0 1 0 t sphere s 0 0 4 0 0 0 1",
            "brighttext \"t\" has parallel or zero right and down vectors, expected vectors that span a plane",
        ),
    ] {
        assert_eq!(read_text(text, &loader).diagnostics[0].message, expected);
    }
}

#[test]
fn the_compiled_files_of_others_are_read() {
    let Some(shared) = shared() else { return };
    let mut count = 0;
    for path in files_below(&shared) {
        let bytes = || std::fs::read(&path).unwrap();
        let read = match path.extension().and_then(|extension| extension.to_str()) {
            Some("rtm") => radsight_formats::Mesh::read(&bytes()).map(|mesh| !mesh.triangles.is_empty()),
            Some("oct") => radsight_formats::Octree::read(&bytes()).map(|octree| octree.object_count > 0),
            Some("fnt") => radsight_formats::Font::read(&bytes()).map(|font| font.glyphs.iter().flatten().count() > 9),
            _ => continue,
        };
        assert_eq!(read, Ok(true), "{}", path.display());
        count += 1;
    }
    assert!(count > 50, "only {count} files");
}
