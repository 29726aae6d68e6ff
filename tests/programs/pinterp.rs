//! Compares `pinterp` with the real one.

use crate::program::{Folder, command, run_with};
use radsight_picture::{Header, Picture};
use radsight_test_support::Radiance;

const SCENE: &str = "
void light lamp 0 0 3 20 20 20
lamp sphere bulb 0 0 4 0 0 4 .5
void brightfunc checks 2 if(sin(3*Px)*sin(3*Pz+1),1,.5) . 0 0
checks plastic paint 0 0 5 .6 .5 .4 0 0
paint polygon back 0 0 12 -6 6 -6  6 6 -6  6 6 6  -6 6 6
void plastic red 0 0 5 .7 .1 .1 0 0
red cylinder post 0 0 7 .2 3 -4 .2 3 4 .3
";

/// A folder with pictures of two views, and their distances.
fn folder(radiance: &Radiance) -> Folder {
    let folder = Folder::new();
    folder.file("scene.rad", SCENE);
    let octree = radiance.octree(&folder, &["scene.rad"]);
    for (name, eye) in [("a", "-.3"), ("b", ".3")] {
        let words = format!(
            "-w -vp {eye} 0 0 -vd 0 1 0 -vu 0 0 1 -x 120 -y 100 -pa 0 -vv 40 -av .1 .1 .1 -ps 1 -pj 0 -dj 0 -z {name}.zbf {octree}"
        );
        let words: Vec<&str> = words.split(' ').collect();
        let picture = run_with(radiance.command("rpict", &words).current_dir(folder.path("")), b"").done();
        folder.file(&format!("{name}.hdr"), picture);
    }
    folder
}

/// The share of equal pixels, and both means.
fn compare(real: &[u8], ours: &[u8]) -> (f64, [f64; 2]) {
    let [real, ours] = [real, ours].map(|bytes| Picture::read(bytes).expect("a picture").values());
    assert_eq!((real.width(), real.height()), (ours.width(), ours.height()));
    let is_same = |(a, b): (&[f32], &[f32])| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.02 * a.max(*b));
    let same = real.pixels().zip(ours.pixels()).filter(|pair| is_same(*pair)).count();
    let mean = |values: &[f32]| values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64;
    (same as f64 / (real.width() * real.height()) as f64, [mean(real.data()), mean(ours.data())])
}

#[test]
fn views_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    let view = "-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vv 40 -x 120 -y 100 -pa 0";
    for (words, share) in [
        (format!("{view} -q a.hdr a.zbf"), 0.97),
        (format!("{view} a.hdr a.zbf b.hdr b.zbf"), 0.93),
        (format!("{view} -a -t .01 a.hdr a.zbf"), 0.93),
        (format!("{view} -q a.hdr a.zbf b.hdr b.zbf"), 0.97),
        (format!("{view} -ff -q -fc 1 0 1 a.hdr a.zbf"), 0.97),
        (format!("{view} -f0 -q -fc 1 0 1 a.hdr a.zbf"), 0.97),
        (format!("{view} -fs 3 -q -fc 1 0 1 a.hdr a.zbf"), 0.97),
        (format!("{view} -e +1 -q a.hdr a.zbf"), 0.97),
        (format!("{view} -q a.hdr 6"), 0.97),
        (format!("{view} -va 4 -q a.hdr a.zbf"), 0.97),
        (format!("{view} -va 4 -fb -q a.hdr a.zbf b.hdr b.zbf"), 0.97),
        ("-vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vv 40 -x 95 -y 100 -pa .7 -q a.hdr a.zbf".to_owned(), 0.97),
        ("-vth -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 60 -vv 60 -x 90 -y 90 -q a.hdr a.zbf b.hdr b.zbf".to_owned(), 0.95),
    ] {
        let words: Vec<&str> = words.split(' ').collect();
        let real = run_with(radiance.command("pinterp", &words).current_dir(folder.path("")), b"").done();
        let ours: Vec<&str> = std::iter::once("pinterp").chain(words.iter().copied()).collect();
        let ours = run_with(command(&ours).current_dir(folder.path("")), b"").done();
        let aspect = |picture: &[u8]| {
            Header::read(picture).expect("a header").0.variable("PIXASPECT").map(|value| value.to_string())
        };
        assert_eq!(aspect(&ours), aspect(&real), "{words:?}");
        let (same, [real, ours]) = compare(&real, &ours);
        assert!(same >= share, "{words:?}: {same} of the pixels are the same");
        assert!((ours / real - 1.0).abs() < 0.01, "{words:?}: mean {ours}, real {real}");
    }
}

#[test]
fn distances_and_blurred_views_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    let views = "VIEW= -vtv -vp -.1 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 40\nVIEW= -vp .1 0 0\nVIEW= -vp .2 0 .1\n";
    let words = "-B -x 120 -y 100 -pa 0 -z out.zbf a.hdr a.zbf b.hdr b.zbf";
    let words: Vec<&str> = words.split(' ').collect();
    let mut found = Vec::new();
    for is_real in [true, false] {
        let ours: Vec<&str> = std::iter::once("pinterp").chain(words.iter().copied()).collect();
        let mut program = if is_real { radiance.command("pinterp", &words) } else { command(&ours) };
        let picture = run_with(program.current_dir(folder.path("")), views.as_bytes()).done();
        let bytes = folder.read("out.zbf");
        let depths: Vec<f32> = bytes.as_chunks().0.iter().map(|depth| f32::from_ne_bytes(*depth)).collect();
        found.push((picture, depths));
    }
    let [(real, real_depths), (ours, depths)] = &found[..] else { panic!("two runs") };
    let (same, _) = compare(real, ours);
    assert!(same > 0.85, "{same} of the pixels are the same");
    let close = real_depths.iter().zip(depths).filter(|(a, b)| (*a - *b).abs() <= 0.02 * a.max(**b)).count();
    assert!(close as f64 > 0.95 * real_depths.len() as f64, "{close} of {} distances", real_depths.len());
    let (header, _) = Header::read(ours).expect("a header");
    assert!(header.variable("VIEW").is_some_and(|view| view.contains("-vp -0.1 0 0")), "{}", header.to_text());
}

#[test]
fn rays_find_what_no_picture_shows() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder(&radiance);
    let view = "-vp .8 0 0 -vd -.1 1 0 -vu 0 0 1 -vv 40 -x 120 -y 100 -pa 0";
    for fills in ["-ff", "-f0", "-fs 4"] {
        let rays = "-av .1 .1 .1 -ab 0 scene.oct";
        let words: Vec<&str> =
            view.split(' ').chain(fills.split(' ')).chain(["-q", "-fr", rays, "a.hdr", "a.zbf"]).collect();
        let real = run_with(radiance.command("pinterp", &words).current_dir(folder.path("")), b"").done();
        let ours: Vec<&str> = std::iter::once("pinterp").chain(words.iter().copied()).collect();
        let ours = run_with(command(&ours).current_dir(folder.path("")), b"").done();
        let (same, [real, ours]) = compare(&real, &ours);
        assert!(same > 0.9, "{fills}: {same} of the pixels are the same");
        assert!((ours / real - 1.0).abs() < 0.01, "{fills}: mean {ours}, real {real}");
    }
}

#[test]
fn wrong_command_lines_and_input_are_reported() {
    let folder = Folder::new();
    let plain = radsight_picture::Image::filled(4, 3, 3, 0.5f32).expect("a shape");
    folder.file("plain.hdr", Picture::from_rgb(Header::new("RADIANCE"), &plain).expect("a picture").to_bytes());
    let mut header = Header::new("RADIANCE");
    header.push_line("VIEW= -vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 40 -vv 30");
    folder.file("view.hdr", Picture::from_rgb(header, &plain).expect("a picture").to_bytes());
    folder.file("short.zbf", [0u8; 12]);
    folder.file("nan.zbf", [0xff_u8; 48]);
    folder.file("junk.hdr", "junk");
    let run = |words: &str| {
        let words: Vec<&str> = words.split(' ').collect();
        run_with(command(&words).current_dir(folder.path("")), b"")
    };
    for (words, code, message) in [
        ("pinterp", 2, "expected pairs of a picture and its distances"),
        ("pinterp view.hdr", 2, "expected pairs of a picture and its distances"),
        ("pinterp -q9 view.hdr 1", 2, "option \"-q9\" is unknown"),
        ("pinterp -fr -q view.hdr 1", 2, "rtrace: option \"-q\" is not supported"),
        ("pinterp -fr nowhere.oct view.hdr 1", 1, "nowhere.oct"),
        ("pinterp -fr", 2, "option \"-fr\" ends the command line"),
        ("pinterp -vh 999 view.hdr 1", 2, "view"),
        ("pinterp -x 0 view.hdr 1", 2, "a picture of 0 by"),
        ("pinterp -x 99999999 -y 99999999 -pa 0 view.hdr 1", 2, "expected 1 to"),
        ("pinterp view.hdr -3", 2, "the distance -3 is not above 0"),
        ("pinterp plain.hdr 1", 1, "the view in its header: there is none"),
        ("pinterp junk.hdr 1", 1, "junk.hdr: "),
        ("pinterp none.hdr 1", 1, "cannot read picture \"none.hdr\""),
        ("pinterp view.hdr none.zbf", 1, "cannot read distances \"none.zbf\""),
        ("pinterp view.hdr short.zbf", 1, "12 bytes, expected 48"),
        ("pinterp -B view.hdr 1", 1, "standard input has no view"),
    ] {
        let run = run(words);
        assert_eq!(run.code, code, "{words}: {}", run.messages);
        assert!(run.messages.contains(message), "{words}: {}", run.messages);
        assert!(run.output.is_empty(), "{words}");
    }
    run("pinterp -x 9 -y 9 view.hdr nan.zbf").done();
    run("pinterp -vp 5 0 0 -x 9 -y 9 view.hdr 1e-30").done();
}
