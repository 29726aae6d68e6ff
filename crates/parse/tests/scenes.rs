//! Published scenes, compared with real Radiance: numbers of surfaces, bounding boxes, cubes.

mod support;

use radsight_parse::syntax::{Item, Items};
use radsight_parse::{
    Bounds, Input, Read, ReadOptions, Role, UnusedModifiers, bounds, cube, read_scene, write_scene, xform,
};
use std::path::{Path, PathBuf};
use support::{Disk, Radiance, difference, shared};

/// Folder below the shared one, and the arguments of `oconv` in it. `*` stands for any file name.
const SCENES: &[(&str, &[&str])] = &[
    (
        "scenes/frads_openoffice",
        &[
            "!gendaylit 3 21 12.5 -a 37.7 -o 122.2 -m 120 -W 800 120",
            "skies_glow.rad",
            "Objects/*.mat",
            "Objects/*.rad",
        ],
    ),
    ("scenes/gjward1_objects", &["preview_light.rad", "black_chair.rad"]),
    ("scenes/gjward1_objects", &["blue_chair.rad"]),
    ("scenes/gjward1_objects", &["bookbox.rad"]),
    ("scenes/gjward1_objects", &["coatrack.rad"]),
    ("scenes/gjward1_objects", &["conf_table.rad"]),
    ("scenes/gjward1_objects", &["dafvase.rad"]),
    ("scenes/gjward1_objects", &["desk.rad"]),
    ("scenes/gjward1_objects", &["desklamp.rad"]),
    ("scenes/gjward1_objects", &["dresser.rad"]),
    ("scenes/gjward1_objects", &["exit_sign.rad"]),
    ("scenes/gjward1_objects", &["extinguisher.rad"]),
    ("scenes/gjward1_objects", &["medcab.rad"]),
    ("scenes/gjward1_objects", &["mug.rad"]),
    ("scenes/gjward1_objects", &["openbook.rad"]),
    ("scenes/gjward1_objects", &["orange_chair.rad"]),
    ("scenes/gjward1_objects", &["podium.rad"]),
    ("scenes/gjward1_objects", &["red_chair.rad"]),
    ("scenes/gjward1_objects", &["toilet.rad"]),
    ("scenes/gjward1_objects", &["vanity.rad"]),
    ("scenes/gjward1_objects", &["wastebasket.rad"]),
    ("scenes/gjward1_objects", &["whale2.rad"]),
    (
        "scenes/honeybee_folder_bsdf",
        &[
            "!gensky 6 21 15:00 +s -a 42.4 -o 71.0 -m 75",
            "skies_glow.rad",
            "model/scene/*.mat",
            "model/scene/*.rad",
            "model/aperture/*.mat",
            "model/aperture/*.rad",
            "model/aperture_group/*..default..0.rad",
        ],
    ),
    ("scenes/lbnl_daffodil", &["daf.rad"]),
    ("scenes/lbnl_daffodil", &["examp"]),
    ("scenes/lbnl_luminaires", &["preview_room.rad", "preview_lum.rad"]),
    ("scenes/lbnl_office", &["model.b90", "desk", "misc", "window", "blinds", "lights", "lamp", "picture"]),
    (
        "scenes/lbnl_office",
        &[
            "!gensky 7 12 17 | xform -rx -90 -ry 90",
            "sky",
            "model.b90",
            "desk",
            "misc",
            "window",
            "blinds",
            "lamp",
            "picture",
        ],
    ),
    ("scenes/lbnl_virtual", &["plainoff.rad", "environ.rad", "furniture.rad"]),
    ("scenes/lbnl_virtual", &["illumoff.rad", "environ.rad", "furniture.rad"]),
    ("scenes/radiance_cornell", &["cornell.rad"]),
    ("scenes/radmodels_classroom", &["model.rad"]),
    ("scenes/radmodels_island", &["model.rad"]),
    ("scenes/radmodels_manhattan_tex", &["model.rad"]),
    ("scenes/radmodels_pool", &["skies/*.sky", "model.rad"]),
    (
        "scenes/raytraverse_office",
        &[
            "!gendaylit 3 21 11 -a 46.2 -o -6.1 -m -15 -W 700 150",
            "skies_glow.rad",
            "options/clear.rad",
            "RAD/office.rad",
        ],
    ),
    ("scenes/raytraverse_office", &["options/fabric.rad", "RAD/office.rad"]),
    ("scenes/simple_boxes", &["ray_tracer/glass_box/box.rad"]),
    ("scenes/simple_boxes", &["ray_tracer/metal_box_rough/box.rad"]),
    ("scenes/simple_boxes", &["ray_tracer/plastic_box_full/box.rad"]),
    ("scenes/simple_boxes", &["scenes/cornell_glass.rad"]),
    ("scenes/simple_boxes", &["scenes/cornell_solid.rad"]),
    ("scenes/simple_boxes", &["scenes/scene0.rad"]),
    ("scenes/spider_misc", &["preview_light.rad", "mostapha-forest-sphere.rad"]),
    ("scenes/spider_misc", &["preview_light.rad", "djmonitor.rad"]),
    (
        "scenes/spider_misc",
        &["honeybee_005.opq.mat", "honeybee_005.opq.rad", "honeybee_005.glz.mat", "honeybee_005.glz.rad"],
    ),
    (
        "renders",
        &["basic.mat", "diorama_walls.rad", "rect_opening.rad", "front_cap.rad", "vase.rad", "dielectric_pane.rad"],
    ),
    ("renders", &["basic.mat", "diorama_walls.rad", "torus.rad", "sunset_sky.rad", "glass_ill.rad"]),
    ("renders", &["basic.mat", "closed_end.rad", "porsches.rad", "spotlights.rad", "rect_fixture.rad", "glowbulb.rad"]),
    ("renders", &["basic.mat", "chrome.mat", "diorama_walls.rad", "woman.rad"]),
    ("renders", &["basic.mat", "glass_pane.rad", "antimatter_portal.rad", "bubble_in_cube.rad", "mirror.rad"]),
    ("renders", &["basic.mat", "gymbal.rad", "mist.rad", "spotlights.rad", "spotcones.rad"]),
    (
        "renders",
        &[
            "basic.mat",
            "mixtex.mat",
            "sunset_sky.rad",
            "glass_pane.rad",
            "disks.rad",
            "constellation.rad",
            "blinds.rad",
        ],
    ),
    ("renders", &["basic.mat", "patterns.mat", "diorama_walls.rad", "disks.rad", "rect_fixture.rad"]),
    ("renders", &["basic.mat", "gold.mat", "!xform -m gold ./vase.rad", "prism1.rad"]),
    ("renders", &["basic.mat", "prism2.rad"]),
    ("renders", &["basic.mat", "spectral.mat", "gold.mat", "diorama_walls.rad", "spectral_objs.rad"]),
    ("renders", &["basic.mat", "ball_in_cube.rad", "illum_tfunc.rad"]),
    ("renders", &["basic.mat", "ballcompare.rad", "trans_pane.rad", "sunset_sky.rad"]),
    ("renders", &["basic.mat", "gymbal.rad", "illum_trans2.rad"]),
    ("renders", &["basic.mat", "ringlight.rad", "gymbal2.rad"]),
    ("renders", &["combined_scene.rad"]),
];

#[test]
fn scenes_of_others_have_the_surfaces_and_bounds_that_real_radiance_gives_them() {
    let (Some(radiance), Some(shared)) = (Radiance::find(), shared()) else { return };
    let (mut agreed, mut wrong, mut unread) = (0, Vec::new(), Vec::new());
    for (folder, inputs) in SCENES {
        let unpacked = unpacked(&shared.join(folder));
        let folder_path = unpacked.as_ref().map_or(shared.join(folder), |unpacked| unpacked.path().to_owned());
        let names: Vec<String> = inputs.iter().flat_map(|input| expand(&folder_path, input)).collect();
        let loader = Disk { folder: folder_path.clone(), library: radiance.library() };
        let options = ReadOptions { unused: UnusedModifiers::Lower, ..ReadOptions::default() };
        let files: Vec<Input> = names.iter().cloned().map(Input::File).collect();
        let read = read_scene(&files, &loader, &options);
        let title = format!("{folder} {}", inputs.join(" "));
        if read.has_errors() {
            unread.push(format!("{title}\n{}", read.render(5)));
            continue;
        }
        match compare(&radiance, &folder_path, &names, &read) {
            Ok(()) => agreed += 1,
            Err(difference) => wrong.push(format!("{title}: {difference}")),
        }
    }
    println!("{agreed} of {} scenes agree; not read:\n{}", SCENES.len(), unread.join("\n"));
    assert!(wrong.is_empty(), "{} scenes differ:\n{}", wrong.len(), wrong.join("\n"));
    assert_eq!(agreed, SCENES.len(), "not all scenes are read");
}

fn compare(radiance: &Radiance, folder: &Path, names: &[String], read: &Read) -> Result<(), String> {
    let arguments: Vec<&str> = ["-w", "-h"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let (text, _) = radiance.run("getbbox", &arguments, folder);
    let numbers: Vec<f64> = numbers(&text);
    let [x0, x1, y0, y1, z0, z1] = numbers[..] else { return Err("getbbox fails".to_owned()) };
    let Some(ours) = bounds(&read.scene) else { return Err("no bounds".to_owned()) };
    let size = (ours.high - ours.low).max_element().max(ours.high.abs().max_element());
    let pairs = [ours.low.to_array(), ours.high.to_array()].concat().into_iter().zip([x0, y0, z0, x1, y1, z1]);
    if pairs.clone().any(|(a, b)| (a - b).abs() > 1e-5 * size) {
        return Err(format!("our bounds are {ours:?}, theirs {numbers:?}"));
    }
    let surfaces = count_surfaces(radiance, folder, names);
    let left_out = read.diagnostics.iter().filter(|diagnostic| diagnostic.message.contains("it is left out")).count();
    if read.scene.surfaces.len() + left_out != surfaces {
        return Err(format!(
            "we have {} surfaces and leave out {left_out}, xform has {surfaces}",
            read.scene.surfaces.len()
        ));
    }
    compare_cubes(radiance, folder, names, read)?;
    compare_xform(radiance, folder, names)?;
    compare_written(radiance, folder, names)
}

/// Compares our `xform`, with commands in files run, with the real one.
fn compare_xform(radiance: &Radiance, folder: &Path, names: &[String]) -> Result<(), String> {
    let loader = Disk { folder: folder.to_owned(), library: radiance.library() };
    for name in names.iter().filter(|name| !name.starts_with('!')) {
        let arguments = ["-n", "p", "-rx", "20", "-s", "2", "-mx", "-t", "1", "2", "3", name];
        let (theirs, succeeded) = radiance.run("xform", &arguments, folder);
        let argv: Vec<String> = ["xform"].iter().chain(&arguments).map(|word| (*word).to_owned()).collect();
        match xform(&argv, b"", &loader) {
            Ok(ours) => {
                let [ours, theirs] = [&ours.standard_output, &theirs].map(|text| without_comments(text));
                if let Some(difference) = difference(&ours, &theirs, 1e-9) {
                    return Err(format!("xform {name}: {difference}"));
                }
            }
            Err(error) if succeeded => return Err(format!("xform {name}: {error}")),
            Err(_) => {}
        }
    }
    Ok(())
}

/// Drops comments: some name temporary files of commands, which no longer exist.
fn without_comments(text: &[u8]) -> Vec<u8> {
    let lines = text.split_inclusive(|byte| *byte == b'\n');
    lines.filter(|line| !line.trim_ascii_start().starts_with(b"#")).flatten().copied().collect()
}

/// Our output must be the same scene to real Radiance: the same rays return the same radiance.
fn compare_written(radiance: &Radiance, folder: &Path, names: &[String]) -> Result<(), String> {
    let loader = Disk { folder: folder.to_owned(), library: radiance.library() };
    let files: Vec<Input> = names.iter().cloned().map(Input::File).collect();
    let read = read_scene(&files, &loader, &ReadOptions::default());
    let mut text = String::new();
    write_scene(&read.scene, &mut text).unwrap();
    let again = Input::Text { name: "written.rad".to_owned(), text: text.as_bytes().into() };
    let again = read_scene(&[again], &loader, &ReadOptions::default());
    if again.has_errors() {
        return Err(format!("our own output cannot be read:\n{}", again.render(5)));
    }
    let (ours, theirs) = (bounds(&again.scene), bounds(&read.scene));
    let same = |a: &Bounds, b: &Bounds| (a.low - b.low).abs().max((a.high - b.high).abs()).max_element() < 1e-9;
    if ours.iter().zip(&theirs).any(|(a, b)| !same(a, b)) || again.scene.surfaces.len() != read.scene.surfaces.len() {
        return Err(format!("our own output reads as {ours:?} instead of {theirs:?}"));
    }
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), &text).unwrap();
    let written = file.path().to_str().unwrap().to_owned();
    let Some(ours) = theirs else { return Ok(()) };
    let rays = rays(&ours);
    let mut values = Vec::new();
    for inputs in [names, &[written]] {
        let arguments: Vec<&str> = ["-w"].into_iter().chain(inputs.iter().map(String::as_str)).collect();
        let (octree, succeeded) = radiance.run("oconv", &arguments, folder);
        if !succeeded {
            return Err("real oconv rejects our output".to_owned());
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), octree).unwrap();
        let input = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(input.path(), &rays).unwrap();
        let mut command = radiance.command("rtrace");
        // Otherwise the random numbers that mist uses depend on the time of day.
        command.args(["-u-", "-h", "-w", "-ab", "0", "-dj", "0", "-ss", "0", "-st", "0", "-lr", "2"]).arg(file.path());
        command.current_dir(folder).stdin(std::fs::File::open(input.path()).unwrap());
        values.push(numbers(&command.output().unwrap().stdout));
    }
    let [theirs, ours] = &values[..] else { unreachable!() };
    let wrong = theirs.iter().zip(ours).filter(|(a, b)| (**a - **b).abs() > 1e-3 * (a.abs() + b.abs() + 1e-6)).count();
    if theirs.len() == ours.len() && wrong * 50 <= theirs.len() {
        return Ok(());
    }
    Err(format!("{wrong} of {} values differ ({} from ours) after writing", theirs.len(), ours.len()))
}

/// Rays from inside a box in all directions, as text; deterministic.
fn rays(inside: &Bounds) -> String {
    let mut state = 12345_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    let mut text = String::new();
    for _ in 0..300 {
        let origin = inside.low + (inside.high - inside.low) * glam::DVec3::new(random(), random(), random());
        let direction = glam::DVec3::new(random(), random(), random()) - 0.5;
        for value in origin.to_array().into_iter().chain(direction.to_array()) {
            text.push_str(&format!("{value} "));
        }
        text.push('\n');
    }
    text
}

fn compare_cubes(radiance: &Radiance, folder: &Path, names: &[String], read: &Read) -> Result<(), String> {
    let octree = tempfile::NamedTempFile::new().unwrap();
    let arguments: Vec<&str> = ["-w"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let (bytes, succeeded) = radiance.run("oconv", &arguments, folder);
    if !succeeded {
        return Err("real oconv rejects the scene".to_owned());
    }
    std::fs::write(octree.path(), bytes).unwrap();
    let (text, _) = radiance.run("getinfo", &["-d", octree.path().to_str().unwrap()], folder);
    let text = String::from_utf8_lossy(&text).into_owned();
    let theirs = numbers(text.rsplit_once("tmp").map_or(text.as_str(), |(_, rest)| rest).as_bytes());
    let Some(ours) = cube(&read.scene) else { return Err("no cube".to_owned()) };
    let [.., x, y, z, size] = theirs[..] else { return Err(format!("getinfo -d says {text}")) };
    let ours = [ours.origin.x, ours.origin.y, ours.origin.z, ours.size];
    let same = ours.iter().zip([x, y, z, size]).all(|(a, b)| (a - b).abs() <= 1e-5 * size);
    if same { Ok(()) } else { Err(format!("our cube is {ours:?}, theirs {text}")) }
}

fn numbers(text: &[u8]) -> Vec<f64> {
    String::from_utf8_lossy(text).split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// Number of surfaces that real `xform` prints for the scene.
fn count_surfaces(radiance: &Radiance, folder: &Path, names: &[String]) -> usize {
    let mut count = 0;
    for name in names {
        let (text, _) = match name.strip_prefix('!') {
            Some(_) => {
                let file = tempfile::Builder::new().tempfile().unwrap();
                std::fs::write(file.path(), name).unwrap();
                // Read standard input, so that xform stays in the folder.
                let mut command = radiance.command("xform");
                command.arg("-e").current_dir(folder).stdin(std::fs::File::open(file.path()).unwrap());
                (command.output().unwrap().stdout, true)
            }
            None => {
                // Likewise: `oconv` runs the commands of a file in its own folder.
                let mut command = radiance.command("xform");
                command.arg("-e").current_dir(folder).stdin(std::fs::File::open(folder.join(name)).unwrap());
                (command.output().unwrap().stdout, true)
            }
        };
        let mut items = Items::new(&text).unwrap();
        while let Some(item) = items.advance() {
            let is_surface = |kind: radsight_parse::Kind| matches!(kind.role(), Role::Surface | Role::Volume);
            count += usize::from(matches!(item, Ok(Item::Primitive(primitive)) if is_surface(primitive.kind)));
        }
    }
    count
}

/// An unpacked copy of a scene whose files come in an archive.
fn unpacked(folder: &Path) -> Option<tempfile::TempDir> {
    let archive = folder.join("objects.tar.gz");
    if !archive.exists() || folder.join("objects").exists() {
        return None;
    }
    let copy = tempfile::tempdir().unwrap();
    let run = |program: &str, arguments: &[&std::ffi::OsStr]| {
        let status = std::process::Command::new(program).args(arguments).status();
        assert!(status.is_ok_and(|status| status.success()), "{program} fails");
    };
    run("cp", &["-r".as_ref(), folder.join(".").as_os_str(), copy.path().as_os_str()]);
    run("tar", &["xzf".as_ref(), archive.as_os_str(), "-C".as_ref(), copy.path().as_os_str()]);
    Some(copy)
}

/// The files that a name with `*` matches.
fn expand(folder: &Path, name: &str) -> Vec<String> {
    let Some((before, after)) = name.split_once('*').filter(|_| !name.starts_with('!')) else {
        return vec![name.to_owned()];
    };
    let directory = PathBuf::from(before.rsplit_once('/').map_or("", |(directory, _)| directory));
    let entries = std::fs::read_dir(folder.join(&directory)).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| directory.join(entry.unwrap().file_name()).to_string_lossy().into_owned())
        .filter(|path| path.starts_with(before) && path.ends_with(after))
        .collect();
    names.sort();
    names
}
