//! `rfluxmtx`: compares flux matrices with real `rfluxmtx` and real `rcontrib`.

use crate::program::{Folder, command, run_with};
use radsight_matrix::Matrix;
use radsight_test_support::Radiance;

/// The surfaces before a window: ground, and a canopy that hides a part.
const OUTSIDE: &str = "\
void plastic earth 0 0 5 .5 .4 .3 0 0
earth ring ground 0 0 8 0 0 -1 0 0 1 0 30
earth polygon canopy 0 0 12 -1 -2 3.2 -1 0 3.2 5 0 3.2 5 -2 3.2
";

/// A window of two panes.
fn window(basis: &str) -> String {
    format!(
        "#@rfluxmtx h={basis} u=+Z\nvoid glow port 0 0 4 1 1 1 0\n\
         port polygon pane1 0 0 12 0 0 1  0 0 3  2 0 3  2 0 1\nport polygon pane2 0 0 18 2 0 1  2 0 3  4 0 3  4 0 2  3 0 2  3 0 1\n"
    )
}

/// A wall opposite to it.
fn wall(basis: &str) -> String {
    format!(
        "#@rfluxmtx u=+Z\n#@rfluxmtx h={basis}\nvoid glow wall 0 0 4 1 1 1 0\n\
         wall polygon plane 0 0 12 -9 -3 -5  -9 -3 9  9 -3 9  9 -3 -5\n"
    )
}

/// Runs both programs, with words split at spaces, and returns the content of `file` from each.
fn both(radiance: &Radiance, folder: &Folder, words: &str, input: &[u8], file: &str) -> [Matrix; 2] {
    let words: Vec<&str> = words.split(' ').collect();
    let mut ours = command(&[&["rfluxmtx", "-fo"], &words[..]].concat());
    let mut theirs = radiance.command("rfluxmtx", &words);
    let raypath = radiance.raypath();
    [ours.env("RAYPATH", raypath), &mut theirs].map(|program| {
        run_with(program.current_dir(folder.path("")), input).done();
        let matrix = Matrix::read(&folder.read(file)).expect("a matrix");
        std::fs::remove_file(folder.path(file)).expect("the file is removed");
        matrix
    })
}

/// Compares totals, and the distribution of the values over rows and columns.
#[track_caller]
fn assert_like([ours, theirs]: &[Matrix; 2], what: &str) {
    assert_eq!((ours.size(), ours.components()), (theirs.size(), theirs.components()), "{what}");
    let sum = |matrix: &Matrix| matrix.values().iter().map(|value| f64::from(*value)).sum::<f64>();
    let (ours_sum, theirs_sum) = (sum(ours), sum(theirs));
    assert!((ours_sum / theirs_sum - 1.0).abs() < 0.02, "{what}: {ours_sum} here, {theirs_sum} there");
    let product = |a: &Matrix, b: &Matrix| -> f64 {
        a.values().iter().zip(b.values()).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
    };
    let cosine = product(ours, theirs) / (product(ours, ours) * product(theirs, theirs)).sqrt();
    assert!(cosine > 0.99, "{what}: values in other places, {cosine}");
}

#[test]
fn directions_are_those_of_real_rfluxmtx() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("outside.rad", OUTSIDE);
    for (sender, receiver) in [
        ("kf", "r1"),
        ("-kh", "kq"),
        ("r1", "-sc5"),
        ("sc6", "kf"),
        ("u", "cie"),
        ("kq", "-r2"),
        ("-r2", "kh"),
        ("-sc4", "u"),
        ("k1", "t1"),
    ] {
        folder.file("sender.rad", window(sender));
        folder.file("receiver.rad", wall(receiver));
        let samples = if sender == "u" { 20_000 } else { 400 };
        let words = format!("-ff -c {samples} -ab 1 -ad 4 -lw 1e-3 -o flux.mtx sender.rad receiver.rad outside.rad");
        assert_like(&both(&radiance, &folder, &words, b"", "flux.mtx"), &format!("{sender} to {receiver}"));
    }
}

#[test]
fn a_sky_and_a_ground_get_a_matrix_each() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("outside.rad", OUTSIDE);
    // Surfaces of a command are placed, and options before the command apply to them.
    folder.file("panes.rad", window("kq").replace("#@rfluxmtx h=kq u=+Z\n", ""));
    folder.file("sender.rad", "#@rfluxmtx h=kq u=.1,0,1\n!xform -t 0 0 .5 panes.rad\n");
    let sky = "#@rfluxmtx h=u u=+Y o=ground.mtx\nvoid glow low 0 0 4 1 1 1 0\nlow source below 0 0 4 0 0 -1 180\n\
               #@rfluxmtx h=r1 u=+Y o=sky.mtx\nvoid glow high 0 0 4 1 1 1 0\nhigh source above 0 0 4 0 0 1 180\n";
    folder.file("sky.rad", sky);
    let words = "-fa -c 1000 -ab 2 -ad 4 -lw 1e-3 sender.rad sky.rad outside.rad";
    for file in ["sky.mtx", "ground.mtx"] {
        assert_like(&both(&radiance, &folder, words, b"", file), file);
    }
    // An octree may replace the scene.
    let octree = radiance.octree(&folder, &["outside.rad"]);
    let words = format!("-ff -c 1000 -ab 2 -ad 4 -lw 1e-3 sender.rad sky.rad -i {octree}");
    assert_like(&both(&radiance, &folder, &words, b"", "sky.mtx"), "octree");
}

#[test]
fn rays_of_others_pass_through() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("outside.rad", OUTSIDE);
    folder.file("receiver.rad", wall("kq").replace("h=kq", "h=kq o=view.mtx"));
    let points = b"2 -1 .5 0 -1 .2\n1 -.5 1 0 -1 0\n3 -2.5 2 .1 -1 0\n";
    let words = "-I+ -ab 2 -ad 3000 -lw 1e-5 -y 3 - receiver.rad outside.rad";
    assert_like(&both(&radiance, &folder, words, points, "view.mtx"), "irradiance");
}

#[test]
fn the_seed_changes_the_rays_of_a_sender() {
    let folder = Folder::new();
    folder.file("sender.rad", window("u"));
    folder.file("receiver.rad", wall("r1"));
    folder.file("outside.rad", OUTSIDE);
    let [unsaid, first, other, again] = ["", "--seed 0", "--seed 1", "--seed 1"].map(|seed| {
        let words = format!("rfluxmtx {seed} -h -ab 0 -c 50 sender.rad receiver.rad outside.rad");
        let words: Vec<&str> = words.split_whitespace().collect();
        run_with(command(&words).current_dir(folder.path("")), b"").text()
    });
    assert!(unsaid == first && other == again && first != other);
}

#[test]
fn mistakes_are_reported() {
    let folder = Folder::new();
    folder.file("outside.rad", OUTSIDE);
    folder.file("sender.rad", window("kf"));
    folder.file("receiver.rad", wall("u"));
    folder.file("unsaid.rad", wall("u").replace("h=u", ""));
    folder.file("strange.rad", wall("q"));
    folder.file("empty.rad", "void glow wall 0 0 4 1 1 1 0\n");
    folder.file("broken.rad", "void polygon\n");
    folder.file("sun.rad", "#@rfluxmtx h=r1\nvoid glow sun 0 0 4 1 1 1 0\nsun source disk 0 0 4 0 0 1 5\n");
    folder.file("cie.rad", window("cie"));
    folder.file("flat.rad", "#@rfluxmtx h=u u=Z\nvoid glow g 0 0 4 1 1 1 0\ng ring r 0 0 8 0 0 0 0 0 1 0 1\n");
    folder.file(
        "ball.rad",
        "#@rfluxmtx h=u\nvoid glow g 0 0 4 1 1 1 0\ng ring a 0 0 8 0 0 0 0 0 1 0 1\ng ring b 0 0 8 0 0 0 0 0 -1 0 1\n",
    );
    let check = |words: &str, code: i32, message: &str| {
        let words: Vec<&str> = std::iter::once("rfluxmtx").chain(words.split_whitespace()).collect();
        let run = run_with(command(&words).current_dir(folder.path("")), b"");
        assert_eq!(run.code, code, "{words:?}: {}", run.messages);
        assert!(run.messages.contains(message) && run.output.is_empty(), "{words:?}: {}", run.messages);
    };
    check("sender.rad", 2, "expected a sender (or -) and a receiver");
    check("-zz sender.rad receiver.rad", 2, "option \"-zz\" is not supported");
    check("-fx sender.rad receiver.rad", 2, "option \"-fx\" is not supported");
    check("-c 0 sender.rad receiver.rad", 2, "expected a number of rays, 1 or more");
    check("-av 1 2", 2, "expected 3 values after it");
    check("-I+ sender.rad receiver.rad", 2, "applies only to rays from standard input (-)");
    check("sender.rad receiver.rad -n 6 outside.rad", 2, "\"-n\" is not supported among the scene files");
    check("sender.rad none.rad", 1, "cannot read scene file \"none.rad\"");
    check("sender.rad empty.rad", 1, "no surface is given");
    check("sender.rad unsaid.rad", 1, "surfaces of \"wall\" have no basis");
    check("sender.rad strange.rad", 1, "\"strange.rad\": \"q\" is not a basis");
    check("sender.rad broken.rad", 1, "broken.rad:1");
    check("sender.rad sun.rad", 1, "source \"disk\" is not 180 degrees wide");
    check("sun.rad receiver.rad", 1, "source \"disk\" cannot send rays");
    check("cie.rad receiver.rad", 1, "for receivers only");
    check("flat.rad receiver.rad", 1, "the up direction is parallel to the normal");
    check("ball.rad receiver.rad", 1, "have normals that cancel");
}
