//! The library and the program give the same bits.

use crate::program::{Folder, ROOM, command, gripps, radsight_with, run_with};
use radsight::{Capture, Renderer, Scene, View};

const VIEW: &str = "-vp 0 -1 1.5 -vd 0 1 -.1 -vh 50 -vv 40";

#[test]
fn pictures_are_equal() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let scene = Scene::from_text(ROOM).expect("a scene");
    let view = View::from_args(VIEW).expect("a view");
    let renderer = || Renderer::new(&scene).expect("a scene to render").ambient_bounces(1).ambient_divisions(64, 16);
    let cases = [("", renderer()), ("--error .1", renderer().error(0.1)), ("--samples 3", renderer().samples(3))];
    for (options, mut renderer) in cases {
        // A renderer of the library has the -ds of rays.
        let words: Vec<&str> =
            ["rpict", "-ff", "-x", "64", "-y", "48", "-ab", "1", "-ad", "64", "-as", "16", "-ds", ".2"]
                .into_iter()
                .chain(VIEW.split(' '))
                .chain(options.split_whitespace())
                .chain(["room.rad"])
                .collect();
        let bytes = run_with(command(&words).current_dir(folder.path("")), b"").done();
        let image = renderer.render(&view, 64, 48).expect("a picture");
        let expected: Vec<u8> = image.pixels().iter().flatten().flat_map(|value| value.to_ne_bytes()).collect();
        assert!(bytes.ends_with(&expected), "\"{options}\"");
    }
}

#[test]
fn exposures_are_equal() {
    let (camera, sheet) = (gripps("fig10.toml"), gripps("sheet-retro.rad"));
    let words = ["capture", &camera, &sheet, "--samples", "2", "--exposure", "-"];
    let bytes = radsight_with(&words, b"").done();
    let capture = Capture::load(&camera).expect("a camera").samples(2);
    let scene = capture.with_ring(Scene::builder().files([&sheet]).expect("files")).build().expect("a scene");
    let image = capture.expose(&scene).expect("an exposure");
    let expected: Vec<u8> = image.exposure_j_per_m2.iter().flat_map(|value| (*value as f32).to_ne_bytes()).collect();
    assert!(bytes.ends_with(&expected));
}
