//! Compares `obj2mesh` with the real one: both meshes, rendered by both renderers.

use crate::program::{Folder, command, radsight, run_with};
use radsight_test_support::Radiance;
use std::fmt::Write;

const MATERIALS: &str = "\
void brightfunc stripes 2 if(sin(20*Lu),1,.3) . 0 0
stripes plastic red 0 0 5 .6 .1 .1 0 0
void metal steel 0 0 5 .5 .5 .5 .9 0
void glow shine 0 0 4 2 3 4 0
";

/// A wavy sheet with normals, texture coordinates and two materials, and a non-convex star.
fn wavefront(steps: usize) -> String {
    let mut text = String::from("# made by hand\ng sheet\n");
    for at in 0..(steps + 1) * (steps + 1) {
        let [u, v] = [at % (steps + 1), at / (steps + 1)].map(|step| step as f64 / steps as f64);
        let (height, slope) = (0.2 * (7.0 * u).sin(), 1.4 * (7.0 * u).cos());
        let _ = writeln!(text, "v {u:.6} {v:.6} {height:.6}\nvn {:.6} 0 1\nvt {u:.6} {v:.6}", -slope);
    }
    for at in 0..steps * steps {
        let corner = at / steps * (steps + 1) + at % steps + 1;
        let [a, b, c, d] = [corner, corner + 1, corner + steps + 2, corner + steps + 1];
        let material = if at % 3 == 0 { "red" } else { "steel" };
        let _ = writeln!(text, "usemtl {material}\nf {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c} {d}/{d}/{d}");
    }
    text.push_str("usemtl\ng shine\n");
    for tip in 0..10 {
        let (angle, radius) = (f64::from(tip) * 0.628_318_5, if tip % 2 == 0 { 0.4 } else { 0.15 });
        let _ = writeln!(text, "v {:.6} {:.6} .7", 0.5 + radius * angle.cos(), 0.5 + radius * angle.sin());
    }
    let words: Vec<String> = (1..=10).map(|back| format!("-{}", 11 - back)).collect();
    let _ = writeln!(text, "f {}", words.join(" "));
    text
}

/// Rays from above all over the mesh, and from below.
fn rays() -> String {
    let mut text = String::new();
    for at in 0..2000 {
        let [x, y] = [f64::from(at) * 0.618_034 % 1.0, f64::from(at) * 0.414_214 % 1.0];
        let (z, down) = if at % 4 == 3 { (-2.0, 1.0) } else { (2.0, -1.0) };
        let _ = writeln!(text, "{x:.6} {y:.6} {z} .05 -.03 {down}");
    }
    text
}

#[test]
fn meshes_render_as_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("materials.rad", MATERIALS);
    folder.file("sheet.obj", wavefront(40));
    let words = ["-a", "materials.rad", "sheet.obj"];
    let real = run_with(radiance.command("obj2mesh", &words).current_dir(folder.path("")), b"").done();
    let ours = run_with(command(&["obj2mesh", "-a", "materials.rad", "sheet.obj"]).current_dir(folder.path("")), b"");
    folder.file("real.rtm", real);
    folder.file("ours.rtm", ours.done());
    let mut found = Vec::new();
    for (mesh, renders_really) in [("real", true), ("ours", true), ("real", false), ("ours", false)] {
        let text =
            format!("void light lamp 0 0 3 9 9 9\nlamp sphere bulb 0 0 4 2 3 9 1\nvoid mesh it 1 {mesh}.rtm 0 0\n");
        let scene = folder.file(&format!("{mesh}.rad"), text);
        let octree = radiance.octree(&folder, &[&scene]);
        let words = ["-h", "-w", "-ovLmN", "-dj", "0", "-ds", "0", &octree];
        let ours: Vec<&str> = std::iter::once("rtrace").chain(words).collect();
        let mut program = if renders_really { radiance.command("rtrace", &words) } else { command(&ours) };
        found.push(run_with(program.current_dir(folder.path("")), rays().as_bytes()).text());
    }
    for (pair, share) in [([0, 1], 2e-3), ([2, 3], 2e-3)] {
        let mut off = 0;
        for (real, ours) in found[pair[0]].lines().zip(found[pair[1]].lines()) {
            let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
            let is_near = |(real, ours): (&String, &String)| match (real.parse::<f64>(), ours.parse::<f64>()) {
                (Ok(real), Ok(ours)) => (real - ours).abs() <= share * (1.0 + real.abs()),
                _ => real == ours,
            };
            off += usize::from(!words(real).iter().zip(&words(ours)).all(is_near));
        }
        // Rays that meet an edge between two materials may return either.
        assert!(off <= 10, "{off} of 2000 rays differ");
        assert!(found[pair[0]].contains("shine") && found[pair[0]].contains("steel"));
    }
}

/// Faces of four to six corners, convex and not, from above and from below, none of them planar. Deeper notches are
/// flatter: the real program loses parts of faces whose outlines intersect themselves in its projection.
fn faces_not_planar() -> String {
    let mut text = String::new();
    let mut random = (0..).map(|number| f64::from(number) * 0.754_877_666 % 1.0);
    let mut between = |low: f64, high: f64| low + (high - low) * random.next().unwrap_or_default();
    for face in 0..90 {
        let corners = 4 + face % 3;
        let (first, sign) = (between(0.0, 6.0), if face % 2 == 0 { 1.0 } else { -1.0 });
        let [deepest, height] = if face % 5 == 0 { [0.08, 0.01] } else { [0.35, 0.1] };
        for corner in 0..corners {
            let angle = first + sign * std::f64::consts::TAU * f64::from(corner) / f64::from(corners);
            let radius = between(deepest, 0.42);
            let [x, y] = [f64::from(face % 10) + radius * angle.cos(), f64::from(face / 10) + radius * angle.sin()];
            let _ = writeln!(text, "v {x:.6} {y:.6} {:.6}\nvt {x:.6} {y:.6}", between(-height, height));
        }
        let words: Vec<String> = (1..=corners).map(|back| format!("-{0}/-{0}", corners + 1 - back)).collect();
        let _ = writeln!(text, "f {}", words.join(" "));
    }
    text
}

#[test]
fn faces_not_planar_are_cut_as_by_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("faces.obj", faces_not_planar());
    let real = run_with(radiance.command("obj2mesh", &["faces.obj"]).current_dir(folder.path("")), b"").done();
    folder.file("real.rtm", real);
    folder.file("ours.rtm", run_with(command(&["obj2mesh", "faces.obj"]).current_dir(folder.path("")), b"").done());
    let mut text = String::new();
    for at in 0..4000 {
        let [x, y] = [f64::from(at) * 0.618_034 % 1.0, f64::from(at) * 0.414_214 % 1.0];
        let _ = writeln!(text, "{:.6} {:.6} 2 0 0 -1", 10.0 * x - 0.5, 9.0 * y - 0.5);
    }
    let [real, ours] = ["real", "ours"].map(|mesh| {
        let scene = folder.file(&format!("{mesh}.rad"), format!("void mesh it 1 {mesh}.rtm 0 0\n"));
        let program = &mut command(&["rtrace", "-h", "-w", "-oLNc", &scene]);
        run_with(program.current_dir(folder.path("")), text.as_bytes()).text()
    });
    let numbers = |line: &str| line.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<f64>>();
    let (mut apart, mut hits) = (0, 0);
    for (real, ours) in real.lines().zip(ours.lines()).map(|(real, ours)| (numbers(real), numbers(ours))) {
        hits += usize::from(real[0] < 9.0);
        apart += usize::from(real.iter().zip(&ours).any(|(real, ours)| (real - ours).abs() > 1e-4));
    }
    // Rays that meet an edge may find either of its triangles.
    assert!(apart <= 4 && hits > 1000, "{apart} of {hits} rays differ");
}

#[test]
fn large_meshes_are_read_by_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    let source = folder.file("sheet.obj", wavefront(150));
    let target = folder.word("sheet.rtm");
    radsight(&["obj2mesh", "-v", &source, &target]).done();
    let scene = folder.file("scene.rad", format!("void plastic p 0 0 5 .5 .5 .5 0 0\np mesh it 1 {target} 0 0\n"));
    let octree = radiance.octree(&folder, &[&scene]);
    let words = ["-h", "-oL", &octree];
    let real = run_with(&mut radiance.command("rtrace", &words), rays().as_bytes()).text();
    let ours = run_with(&mut command(&["rtrace", "-h", "-oL", &octree]), rays().as_bytes()).text();
    let lengths = |text: &str| text.lines().filter_map(|line| line.trim().parse().ok()).collect::<Vec<f64>>();
    let (real, ours) = (lengths(&real), lengths(&ours));
    let apart = real.iter().zip(&ours).filter(|(real, ours)| (*real - *ours).abs() > 1e-5).count();
    assert!(real.len() == 2000 && ours.len() == 2000 && apart <= 5, "{apart} of {} rays differ", real.len());
    assert!(real.iter().filter(|length| **length < 9.0).count() > 1500);
}

/// At the apex of a cone of 2,000 triangles, a cube has more of them than a file can store.
#[test]
fn a_mesh_with_many_triangles_at_a_point_ends_and_is_read_by_the_real_program() {
    let folder = Folder::new();
    let mut cone = String::from("v .1 .2 1\n");
    for at in 0..2000 {
        let (sin, cos) = (f64::from(at) * std::f64::consts::TAU / 2000.0).sin_cos();
        let _ = writeln!(cone, "v {cos} {sin} 0");
    }
    for at in 0..2000 {
        let _ = writeln!(cone, "f 1 {} {}", at + 2, (at + 1) % 2000 + 2);
    }
    folder.file("cone.obj", cone);
    let run = run_with(command(&["obj2mesh", "cone.obj"]).current_dir(folder.path("")), b"");
    assert!(run.messages.contains("triangles are missing from cubes that more than 511 touch"), "{}", run.messages);
    let mesh = run.done();
    assert!(mesh.len() < 40_000_000, "{} bytes", mesh.len());
    folder.file("cone.rtm", mesh);
    folder.file("scene.rad", "void plastic p 0 0 5 1 1 1 0 0\np mesh m 1 cone.rtm 0 0\n");
    let Some(radiance) = Radiance::find() else { return };
    folder.file("scene.oct", run_with(command(&["oconv", "scene.rad"]).current_dir(folder.path("")), b"").done());
    let words = ["rtrace", "-h", "-w", "-ab", "0", "-op", "scene.oct"];
    let real = radiance.command(words[0], &words[1..]);
    let [theirs, ours] = [real, command(&words)].map(|mut rtrace| {
        let text = run_with(rtrace.current_dir(folder.path("")), rays().as_bytes()).text();
        text.split_whitespace().map(|word| word.parse().expect("a number")).collect::<Vec<f64>>()
    });
    assert!(
        theirs.len() == ours.len() && theirs.iter().zip(&ours).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs().max(1.0))
    );
}

#[test]
fn wrong_input_is_reported() {
    let folder = Folder::new();
    folder.file("empty.obj", "v 0 0 0\n");
    folder.file("bad.obj", "v 0 0 0\nf 1 2 3\n");
    folder.file("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl brass\nf 1 2 3\n");
    folder.file("materials.rad", MATERIALS);
    folder.file("surfaces.rad", "void sphere s 0 0 4 0 0 0 1\n");
    folder.file("broken.rad", "void plastic\n");
    let check = |words: &str, code: i32, message: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        let run = run_with(command(&words).current_dir(folder.path("")), b"");
        assert_eq!(run.code, code, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message), "{words:?}: {}", run.messages);
    };
    check("obj2mesh -q good.obj", 2, "option \"-q\" is unknown");
    check("obj2mesh none.obj", 1, "cannot read mesh \"none.obj\"");
    check("obj2mesh empty.obj", 1, "no triangle with an area");
    check("obj2mesh bad.obj", 1, "bad.obj: line 2: ");
    check("obj2mesh a b c", 2, "unexpected argument");
    check("obj2mesh -a materials.rad good.obj", 1, "undefined modifier \"brass\"");
    check("obj2mesh -a surfaces.rad good.obj", 1, "has surfaces");
    check("obj2mesh -a broken.rad good.obj", 1, "broken.rad:1:");
    check("obj2mesh -l nowhere.rad good.obj", 1, "nowhere.rad");
}
