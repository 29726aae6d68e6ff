//! Files that programs read from and write to the working folder: materials of `mgf2rad -m`, scenes
//! and octrees of `pkgBSDF`, data of `total` and `rcalc`.

use crate::program::{Folder, Run, command, run_with};
use radsight_test_support::Radiance;

const MGF: &str = "m red =\n\trd .4\n\trs .05 .1\n\tsides 1\nv a =\n\tp 0 0 0\nv b =\n\tp 1 0 0\n\
    v c =\n\tp 1 1 0\no thing\nm red\nf a b c\nm\nf c b a\no\n";

/// A BSDF file with the shape of its sample.
const SHAPED: &str = "<?xml version=\"1.0\"?><WindowElement xmlns=\"x\"><WindowElementType>System</WindowElementType>\
    <FileType>BSDF</FileType><Optical><Layer><Material><Name>N</Name><Manufacturer>M</Manufacturer>\
    <Thickness unit=\"meter\">.05</Thickness><Width unit=\"meter\">1</Width><Height unit=\"meter\">2</Height></Material>\
    <Geometry format=\"MGF\"><MGFblock unit=\"meter\">m blue =\nrd .3\nm blue\nv a =\np 0 0 0\nv b =\np 1 0 0\nv c =\n\
    p 0 1 0\nf a b c\n</MGFblock></Geometry></Layer></Optical></WindowElement>";

fn run_in(folder: &Folder, line: &str) -> Run {
    let words: Vec<&str> = line.split(' ').collect();
    run_with(command(&words).current_dir(folder.path("")), b"")
}

#[test]
fn materials_of_mgf_are_appended_to_the_file_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("a.mgf", MGF);
    folder.file("real.rad", "# mine\n");
    folder.file("ours.rad", "# mine\n");
    for _ in 0..2 {
        let words = ["-m", "real.rad", "a.mgf"];
        let real = run_with(radiance.command("mgf2rad", &words).current_dir(folder.path("")), b"").text();
        let ours = run_in(&folder, "mgf2rad -m ours.rad a.mgf").text();
        assert!(!ours.contains("plastic"), "{ours}");
        assert_eq!(words_of(&ours.replace("ours.rad", "real.rad")), words_of(&real));
        let [real, ours] = ["real.rad", "ours.rad"].map(|name| folder.read(name));
        assert_eq!(words_of(&String::from_utf8_lossy(&ours)), words_of(&String::from_utf8_lossy(&real)));
    }
    let refused = run_in(&folder, "mgf2rad -m a.mgf a.mgf");
    assert_eq!(refused.code, 2, "{}", refused.messages);
    assert_eq!(folder.read("a.mgf"), MGF.as_bytes(), "an input is kept");
}

/// The words of a scene; the real program's name may have a folder before it.
fn words_of(text: &str) -> Vec<String> {
    text.split_whitespace().map(|word| word.rsplit("bin/").next().unwrap_or(word).to_owned()).collect()
}

#[test]
fn materials_of_two_files_in_a_scene_are_those_of_both() {
    let folder = Folder::new();
    folder.file("a.mgf", MGF);
    folder.file("b.mgf", MGF.replace("red", "green"));
    // The surfaces stand before the materials, and need others of the same names.
    let scene = "void plastic red 0 0 5 0 0 0 0 0\nvoid plastic green 0 0 5 0 0 0 0 0\nvoid plastic mat 0 0 5 0 0 0 0 0\n\
        !mgf2rad -m materials.rad a.mgf\n!mgf2rad -m materials.rad b.mgf\n";
    folder.file("a.rad", scene);
    folder.file("b.rad", format!("{scene}!cat materials.rad\n"));
    let count = |name: &str, scene: &str| {
        let octree = run_in(&folder, &format!("oconv -f {scene}")).done();
        String::from_utf8_lossy(&octree).matches(name).count()
    };
    for name in ["red", "green"] {
        assert_eq!(count(name, "b.rad"), count(name, "a.rad") + 1, "{name}");
    }
    assert!(!folder.path("materials.rad").exists(), "a scene that is read writes no file");
}

#[test]
fn bsdf_files_become_scenes_beside_the_caller() {
    let folder = Folder::new();
    folder.file("shaped.xml", SHAPED);
    folder.file("flat.xml", SHAPED.replace("MGFblock", "Otherblock"));
    assert_eq!(run_in(&folder, "pkgBSDF shaped.xml flat.xml").text(), "");
    for name in ["shaped", "flat"] {
        let printed = run_in(&folder, &format!("pkgBSDF -s {name}.xml")).done();
        assert_eq!(folder.read(&format!("{name}.rad")), printed, "{name}");
    }
    assert_eq!(run_in(&folder, "pkgBSDF -i shaped.xml").text(), "");
    let scene = String::from_utf8(folder.read("shaped.rad")).expect("text");
    assert!(scene.ends_with("void instance shaped_g\n1 shaped.oct\n0\n0\n\n"), "{scene}");
    let info = run_in(&folder, "getinfo shaped.oct").text();
    assert!(info.contains("oconv -f -"), "{info}");
    let bounds = run_in(&folder, "getbbox -h shaped.oct");
    assert_eq!(bounds.code, 0, "{}", bounds.messages);
    let several = run_in(&folder, "pkgBSDF -s shaped.xml flat.xml");
    assert!(several.messages.contains("-s writes the scene of one BSDF file"), "{}", several.messages);
}

#[test]
fn data_files_are_not_looked_for_in_raypath() {
    let (folder, library) = (Folder::new(), Folder::new());
    library.file("data.txt", "1 2\n3 4\n");
    library.file("twice.cal", "$1=2*$1;\n");
    folder.file("own.txt", "5 6\n");
    let raypath = format!(".:{}", library.word(""));
    let run = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        run_with(command(&words).current_dir(folder.path("")).env("RAYPATH", &raypath), b"")
    };
    for line in ["total data.txt", "rcalc -e $1=$1 data.txt", "rlam own.txt data.txt", "rcollate data.txt"] {
        let run = run(line);
        assert!(run.code != 0 && run.messages.contains("data.txt"), "{line}: {} {}", run.code, run.messages);
    }
    assert_eq!(run("rcalc -f twice.cal own.txt").text(), "10\n", "functions are looked for");
    assert_eq!(run(&format!("total {}", library.word("data.txt"))).text(), "4\t6\n");
}

#[test]
fn a_count_that_is_too_small_is_named_as_it_was_given() {
    let folder = Folder::new();
    for word in ["1.5", "1"] {
        let run = run_in(&folder, &format!("cnt 3 {word}"));
        let expected = format!("count is {word}, expected a whole number of at least 2");
        assert!(run.code != 0 && run.messages.contains(&expected), "{}", run.messages);
    }
}
