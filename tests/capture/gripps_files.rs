//! The files of `radiance-scenes/gripps` are consistent.

use crate::program::{Folder, gripps, radsight};

#[test]
fn the_written_light_rings_are_what_the_program_prints() {
    for (ring, figures) in
        [("rig-cone.rad", ["fig08", "fig09", "fig10"]), ("rig-table.rad", ["fig11", "fig13", "fig14"])]
    {
        let written = std::fs::read_to_string(gripps(ring)).expect("the ring is read");
        for figure in figures {
            let printed = radsight(&["rig", &gripps(&format!("{figure}.toml"))]).text();
            assert!(printed == written, "radsight rig {figure}.toml is not {ring}");
        }
    }
}

#[test]
fn no_scene_file_has_a_mistake() {
    let parts = ["washer.rad", "part-ball.rad", "part-cone.rad", "part-machined-ring.rad"];
    let more_parts = ["part-torus.rad", "part-glass-ball.rad"];
    let others = ["sheet-lambertian.rad", "sheet-retro.rad", "rig-cone.rad", "rig-table.rad"];
    for file in parts.iter().chain(&more_parts).chain(&others).map(|name| gripps(name)) {
        let file = &file;
        assert!(radsight(&["check", "--strict", file]).text().ends_with("no error\n"), "{file}");
    }
}

#[test]
fn every_row_of_the_readme_is_a_capture() {
    let readme = std::fs::read_to_string(gripps("README.md")).expect("the README is read");
    let folder = Folder::new();
    let out = folder.word("x.png");
    let mut captured = 0;
    for row in readme.lines().filter(|line| line.contains("| `fig")) {
        let names: Vec<String> = row.split('`').skip(1).step_by(2).map(gripps).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        radsight(&[&["capture"], &names[..], &["--samples", "1", "-o", &out]].concat()).done();
        captured += 1;
    }
    assert_eq!(captured, 6);
}
