//! `rpict` and `vwrays`: headers, sizes, views and values, compared with real Radiance, and
//! continued pictures.

use crate::program::{Folder, Run, command, run_with};
use radsight_picture::{Header, Picture, Resolution, read_image};
use radsight_test_support::Radiance;

const ROOM: &str = "
void plastic wall 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 1 1 1
lamp sphere bulb 0 0 4 0 7 4 2
wall polygon floor 0 0 12 -10 0 0 10 0 0 10 20 0 -10 20 0
";

fn rpict(folder: &Folder, words: &[&str]) -> Run {
    run_with(command(&[&["rpict"], words].concat()).current_dir(folder.path("")), b"")
}

/// Views of all types with clipping planes, shift and lift, which show the room.
const VIEWS: [&str; 6] = [
    "-vtv -vh 60 -vv 40 -vo .3 -va 8 -vs .2 -vl -.1",
    "-vtl -vh 6 -vv 4 -vo .1 -va 30",
    "-vtc -vh 200 -vv 80 -vo .2",
    "-vth -vh 180 -vv 170 -vs .1",
    "-vta -vh 300 -vv 200 -va 20",
    "-vts -vh 200 -vv 170 -vl .2",
];

fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect()
}

#[test]
fn vwrays_sends_the_rays_of_real_vwrays() {
    let Some(radiance) = Radiance::find() else { return };
    for view in VIEWS {
        let words = format!("-fd {view} -vp 1 2 3 -vd .3 .4 -.2 -vu .1 0 1 -x 40 -y 30 -pa 1.3");
        let words: Vec<&str> = words.split(' ').collect();
        let ours = doubles(&run_with(&mut command(&[&["vwrays"], &words[..]].concat()), b"").done());
        let theirs = doubles(&run_with(&mut radiance.command("vwrays", &words), b"").done());
        assert_eq!(ours.len(), theirs.len(), "{view}");
        let largest = ours.iter().zip(&theirs).map(|(ours, theirs)| (ours - theirs).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{view}: {largest}");
    }
}

#[test]
fn vwrays_reads_pictures_depths_and_pixels_as_real_vwrays_does() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    rpict(&folder, &["-vp", "0", "-3", "1", "-x", "20", "-y", "14", "-o", "a.hdr", "-z", "a.zbf", "room.rad"]).done();
    let cases: [(&[&str], &str); 5] = [
        (&["a.hdr"], ""),
        (&["-d", "a.hdr"], ""),
        (&["a.hdr", "a.zbf"], ""),
        (&["-i", "a.hdr"], "3 4\n5.5 6\n0\n0\n"),
        (&["-d", "-vh", "30", "-x", "40", "-y", "30", "-va", "3"], ""),
    ];
    for (words, input) in cases {
        let ours = run_with(command(&[&["vwrays"], words].concat()).current_dir(folder.path("")), input.as_bytes());
        let theirs = run_with(radiance.command("vwrays", words).current_dir(folder.path("")), input.as_bytes());
        assert_eq!(ours.text(), theirs.text(), "{words:?}");
    }
}

/// Real `vwrays` uses the distance of a neighbouring pixel here.
#[test]
fn vwrays_finds_the_depth_of_a_pixel() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    rpict(&folder, &["-vp", "0", "-3", "1", "-x", "20", "-y", "14", "-o", "a.hdr", "-z", "a.zbf", "room.rad"]).done();
    let words = ["vwrays", "-fd", "-i", "a.hdr", "a.zbf"];
    let ray = doubles(&run_with(command(&words).current_dir(folder.path("")), b"3 4").done());
    assert!(ray[2].abs() < 1e-6, "the ray starts on the floor: {ray:?}");
    assert!(ray[5] > 0.0, "and goes back to the eye: {ray:?}");
}

/// A pane 2 units from the eye, a bright wall at 6, and one behind the eye, which a mirror shows.
#[test]
fn the_aft_plane_hides_what_is_behind_transparent_surfaces() {
    let walls = "void glow g 0 0 4 1 1 1 0\ng polygon wall 0 0 12 -9 6 -9 9 6 -9 9 6 9 -9 6 9\n\
                 g polygon behind 0 0 12 -9 -4 -9 -9 -4 9 9 -4 9 9 -4 -9\n";
    let pane = "pane polygon p 0 0 12 -5 2 -5 5 2 -5 5 2 5 -5 2 5\n";
    let mean_of = |material: &str, aft: &str| {
        let folder = Folder::new();
        folder.file("s.rad", format!("void {material}\n{pane}{walls}"));
        let view = ["-vp", "0", "0", "0", "-vd", "0", "1", "0", "-vh", "20", "-vv", "20", "-va", aft];
        mean(&rpict(&folder, &[&view[..], &["-x", "8", "-y", "8", "-ab", "0", "s.rad"]].concat()).done())
    };
    let transparent =
        ["glass pane 0 0 3 .9 .9 .9", "trans pane 0 0 7 .8 .8 .8 0 0 .9 1", "trans pane 0 0 7 .8 .8 .8 0 .1 .9 .9"];
    for material in transparent {
        let [seen, hidden, far] = ["0", "4", "9"].map(|aft| mean_of(material, aft));
        // What the surface reflects is left.
        let reflected = if material.starts_with("glass") { 0.1 } else { 0.0 };
        assert!(
            seen > 0.5 && hidden <= reflected && (far / seen - 1.0).abs() < 0.1,
            "{material}: {seen} {hidden} {far}"
        );
    }
    assert!(mean_of("mirror pane 0 0 3 .9 .9 .9", "4") > 0.8);
}

#[test]
fn the_header_says_what_real_rpict_says() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    folder.file("options", "-ab 0 -dj .5\n@more");
    folder.file("more", "-vh 50");
    let octree = radiance.octree(&folder, &["room.rad"]);
    let words = ["@options", "-vp", "0", "-3", "1", "-x", "30", "-y", "20", "-pa", "1.2", "-ps", "1"];
    let ours = rpict(&folder, &[&words[..], &["room.rad"]].concat()).done();
    let mut theirs = radiance.command("rpict", &[&words[..], &[&octree]].concat());
    let theirs = run_with(theirs.current_dir(folder.path("")), b"").done();
    let lines = |bytes: &[u8]| {
        let (header, start) = Header::read(bytes).expect("a header");
        let (resolution, _) = Resolution::read(bytes, start).expect("a resolution");
        let text = header.to_text();
        let differs = ["oconv", "SOFTWARE=", "GMT=", "CAPDATE="];
        let lines = text.lines().filter(|line| !differs.iter().any(|start| line.starts_with(start)));
        (lines.map(str::to_owned).collect::<Vec<_>>(), resolution)
    };
    assert_eq!(lines(&ours), lines(&theirs));
    let software = Header::read(&ours).expect("a header").0.variable("SOFTWARE").map(|value| value.into_owned());
    assert_eq!(software.as_deref(), Some(concat!("radsight ", env!("CARGO_PKG_VERSION"))));
}

/// Mean and greatest of the green values.
fn mean(bytes: &[u8]) -> f64 {
    let values = Picture::read(bytes).expect("a picture").radiance().expect("radiance");
    values.pixels().map(|pixel| f64::from(pixel[1])).sum::<f64>() / (values.width() * values.height()) as f64
}

#[test]
fn direct_light_is_that_of_real_rpict_in_every_view() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let octree = radiance.octree(&folder, &["room.rad"]);
    for view in VIEWS {
        let words = format!("{view} -vp 0 -1 2 -vd 0 1 -.1 -pa 0 -pj 1");
        let words: Vec<&str> = words.split(' ').collect();
        let small = ["-x", "40", "-y", "30", "--samples", "256", "room.rad"];
        let ours = mean(&rpict(&folder, &[&words[..], &small].concat()).done());
        let large = ["-x", "480", "-y", "360", "-ps", "1", "-dj", "1", "-ds", ".05", &octree];
        let mut theirs = radiance.command("rpict", &[&words[..], &large].concat());
        let theirs = mean(&run_with(theirs.current_dir(folder.path("")), b"").done());
        assert!((ours / theirs - 1.0).abs() < 0.01, "{view}: {ours} here, {theirs} there");
    }
}

/// Lamps whose corners extend into dark pixels by 0.15 of their sides: four samples seldom meet
/// them.
#[test]
fn corners_of_lamps_are_found_where_an_error_is_asked_for() {
    let folder = Folder::new();
    let mut scene = "void glow wall 0 0 4 .2 .2 .2 0\nwall polygon w 0 0 12 0 0 0 16 0 0 16 16 0 0 16 0\nvoid glow lamp 0 0 4 15 15 15 0\n".to_owned();
    for lamp in 0..16 {
        let [x, y] = [lamp % 4, lamp / 4].map(|place| f64::from(4 * place + 1));
        let [right, top] = [x + 1.15, y + 1.15];
        scene += &format!("lamp polygon l{lamp} 0 0 12 {x} {y} 1 {right} {y} 1 {right} {top} 1 {x} {top} 1\n");
    }
    folder.file("lamps.rad", &scene);
    let view =
        "-vtl -vp 8 8 10 -vd 0 0 -1 -vu 0 1 0 -vh 16 -vv 16 -x 16 -y 16 -pa 0 -pj 1 -ab 0 -w- --error .02 lamps.rad";
    let picture = rpict(&folder, &view.split(' ').collect::<Vec<_>>()).done();
    let values = Picture::read(&picture).expect("a picture").radiance().expect("radiance");
    // The share of a column or row of pixels that a lamp covers, from its first on.
    let covered = |place: usize| [0.0, 1.0, 0.15, 0.0][place % 4];
    let squares = values.pixels().enumerate().map(|(at, pixel)| {
        let right = 0.2 + 14.8 * covered(at % 16) * covered(15 - at / 16);
        (f64::from(pixel[1]) / right - 1.0).powi(2)
    });
    let error = (squares.sum::<f64>() / 256.0).sqrt();
    assert!(values.width() == 16 && error < 0.02, "{error}");
}

#[test]
fn an_interrupted_picture_goes_on_to_the_same_bytes() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let words = ["-vp", "0", "-3", "1", "-x", "300", "-y", "200"];
    rpict(&folder, &[&words[..], &["-o", "whole.hdr", "-z", "whole.zbf", "room.rad"]].concat()).done();
    let whole = folder.read("whole.hdr");
    let depths = folder.read("whole.zbf");
    let (_, start) = Header::read(&whole).expect("a header");
    for share in [0.0, 0.4, 0.999, 1.0] {
        let cut = start + 25 + (share * (whole.len() - start - 25) as f64) as usize;
        folder.file("part.hdr", &whole[..cut]);
        folder.file("part.zbf", &depths[..depths.len() / 2]);
        let _ = std::fs::remove_file(folder.path("again.hdr"));
        let go_on = rpict(&folder, &["-ro", "part.hdr", "-z", "part.zbf", "room.rad"]);
        go_on.done();
        let end = |bytes: &[u8]| bytes[Header::read(bytes).expect("a header").1..].to_vec();
        assert!(end(&folder.read("part.hdr")) == end(&whole), "{share}: the same size and pixels");
        assert_eq!(folder.read("part.zbf").len(), depths.len());
        if share == 0.0 {
            assert!(folder.read("part.zbf") == depths, "the same depths");
        }
    }
}

#[test]
fn a_sequence_goes_on_at_the_frame_that_is_recovered() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let views = b"VIEW= -vp 0 -3 1\nVIEW= -vp 0 -2 1\nVIEW= -vp 0 -2.5 1\nVIEW= -vp 0 -2.2 1\n";
    let run = |more: &[&str]| {
        let words = [&["rpict", "-S", "1", "-x", "20", "-y", "20", "-o", "f%d.hdr"], more, &["room.rad"]].concat();
        run_with(command(&words).current_dir(folder.path("")), views).done();
    };
    run(&[]);
    let whole: Vec<Vec<u8>> = (1..=4).map(|frame| folder.read(&format!("f{frame}.hdr"))).collect();
    let end = |bytes: &[u8]| bytes[Header::read(bytes).expect("a header").1..].to_vec();
    folder.file("f2.hdr", &whole[1][..whole[1].len() - 300]);
    folder.file("f3.hdr", "it is there");
    std::fs::remove_file(folder.path("f4.hdr")).expect("it was there");
    run(&["-r", "2"]);
    assert!(end(&folder.read("f2.hdr")) == end(&whole[1]), "the frame goes on");
    assert_eq!(folder.read("f3.hdr"), b"it is there");
    assert!(end(&folder.read("f4.hdr")) == end(&whole[3]), "the next one that is not there is made");
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let pixels = |threads: &str| {
        let bytes = rpict(&folder, &["-n", threads, "-vp", "0", "-3", "1", "-x", "90", "-y", "90", "room.rad"]).done();
        Picture::read(&bytes).expect("a picture").pixels().clone()
    };
    assert!(pixels("1") == pixels("3"));
}

#[test]
fn a_sequence_makes_a_picture_for_each_view() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let views = b"VIEW= -vp 0 -3 1\nnothing\nVIEW= -vp 0 -2 1\nVIEW= -vh 20\n";
    let words = ["rpict", "-S", "4", "-x", "8", "-y", "8", "-pm", ".5", "-o", "f%02d.hdr", "room.rad"];
    folder.file("f05.hdr", "it is there");
    run_with(command(&words).current_dir(folder.path("")), views).done();
    assert_eq!(folder.names(), ["f04.hdr", "f05.hdr", "f06.hdr", "room.rad"]);
    assert_eq!(folder.read("f05.hdr"), b"it is there");
    let text = Header::read(&folder.read("f06.hdr")).expect("a header").0.to_text();
    assert!(text.contains("FRAME=6\nVIEW= -vtv -vp 0 -2 1 -vd 0 1 0 -vu 0 0 1 -vh 20 "), "{text}");
}

/// A picture with an aperture is sharp at the focus distance, and blurred elsewhere.
#[test]
fn an_aperture_blurs_what_is_not_in_focus() {
    let folder = Folder::new();
    folder.file("edge.rad", "void glow g 0 0 4 1 1 1 0\ng polygon half 0 0 12 0 4 -9 9 4 -9 9 4 9 0 4 9\n");
    let edge = |distance: &str| {
        let words = ["-vd", "0", distance, "0", "-vh", "40", "-vv", "2", "-x", "41", "-y", "2", "-pa", "0"];
        let aperture = ["-pd", "1", "--samples", "256", "edge.rad"];
        let bytes = rpict(&folder, &[&words[..], &aperture].concat()).done();
        let values = Picture::read(&bytes).expect("a picture").values();
        values.row(0).iter().step_by(3).filter(|value| **value > 0.02 && **value < 0.98).count()
    };
    assert!(edge("4") <= 1, "{} pixels on the edge in focus", edge("4"));
    assert!(edge("2") > 8, "{} pixels on the edge out of focus", edge("2"));
}

#[test]
fn pixels_in_xyz_and_other_primaries_are_those_of_real_rpict() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = Folder::new();
    folder.file("room.rad", "void light lamp 0 0 3 3 2 1\nlamp source all 0 0 4 0 0 1 360\nvoid light dim 0 0 3 .1 .2 .4\ndim sphere ball 0 0 4 0 3 0 1\n");
    radiance.octree(&folder, &["room.rad"]);
    for color in ["-pXYZ", "-pc .7 .3 .2 .7 .15 .05 .3127 .329"] {
        let words = format!("-x 24 -y 24 -ps 1 {color} scene.oct");
        let words: Vec<&str> = words.split(' ').collect();
        let real = run_with(radiance.command("rpict", &words).current_dir(folder.path("")), b"").done();
        let ours = rpict(&folder, &words).done();
        let lines = |bytes: &[u8]| -> Vec<String> {
            let (header, _) = Header::read(bytes).expect("a header");
            let dated = ["SOFTWARE", "CAPDATE", "GMT"];
            let lines = header.lines().map(|line| String::from_utf8_lossy(line).into_owned());
            lines.filter(|line| !dated.iter().any(|name| line.starts_with(name))).collect()
        };
        assert_eq!(lines(&real), lines(&ours), "{color}");
        // The centre of the picture, and its corner: one light fills each.
        let (real, ours) = (Picture::read(&real).expect("a picture"), Picture::read(&ours).expect("a picture"));
        for (x, y) in [(12, 12), (0, 0)] {
            for (real, ours) in real.values().pixel(x, y).iter().zip(ours.values().pixel(x, y)) {
                assert!((real - ours).abs() <= 0.01 * real, "{color}: {real} {ours}");
            }
        }
    }
}

#[test]
fn definitions_of_the_command_line_are_for_all_functions() {
    let folder = Folder::new();
    folder.file(
        "room.rad",
        "void brightfunc dim 2 depth*half . 0 0\ndim glow all 0 0 4 1 1 1 0\nall bubble here 0 0 4 0 0 0 5\n",
    );
    folder.file("half.cal", "half = .5;\n");
    let words = ["-x", "4", "-y", "4", "-f", "half.cal", "-e", "depth : 3", "room.rad"];
    assert!((mean(&rpict(&folder, &words).done()) - 1.5).abs() < 0.02);
}

#[test]
fn scripts_learn_the_version_and_the_features() {
    for program in ["rpict", "rtrace", "rcontrib"] {
        let run = |words: &[&str]| run_with(&mut command(&[&[program], words].concat()), b"");
        assert!(run(&["-version"]).text().starts_with("RADIANCE 6.0a (radsight "));
        assert!(run(&["-features"]).text().lines().any(|line| line == "Aliases"));
        assert_eq!(run(&["-features", "Aliases", "Instancing=Octree", "OutputCS=RGB"]).text(), "");
        assert!(run(&["-features", "Instancing"]).text().starts_with("Instancing=Octree"));
        let missing = run(&["-features", "ShadowCache"]);
        assert!(missing.code == 1 && missing.messages.contains("missing feature - ShadowCache"), "{missing:?}");
    }
}

#[test]
fn every_option_that_the_real_programs_print_is_taken() {
    let Some(radiance) = Radiance::find() else { return };
    for program in ["rpict", "rtrace", "rcontrib"] {
        let printed = run_with(&mut radiance.command(program, &["-defaults"]), b"").text();
        let options = printed.lines().filter_map(|line| line.split('#').next()).flat_map(str::split_whitespace);
        let words: Vec<&str> = std::iter::once(program).chain(options).chain(["-defaults"]).collect();
        run_with(&mut command(&words), b"").done();
    }
}

#[test]
fn floats_are_what_pixels_are_made_of() {
    let folder = Folder::new();
    folder.file("room.rad", ROOM);
    let view = ["-vp", "0", "-3", "1", "-vd", "0", "1", "-.2", "-x", "20", "-y", "14"];
    for color in [&[][..], &["-pXYZ"]] {
        let words = [&view[..], color].concat();
        let pixels = Picture::read(&rpict(&folder, &[&words[..], &["room.rad"]].concat()).done()).expect("a picture");
        let bytes = rpict(&folder, &[&words[..], &["-ff", "room.rad"]].concat()).done();
        let (header, _) = Header::read(&bytes).expect("a header");
        assert_eq!(header.variable("NCOMP").as_deref(), Some("3"));
        let floats = read_image(&bytes).expect("floats").image;
        assert_eq!((floats.width(), floats.height(), floats.components()), (pixels.width(), pixels.height(), 3));
        let mut differ = 0;
        for (float, pixel) in floats.data().chunks_exact(3).zip(pixels.values().data().chunks_exact(3)) {
            // Eight bits of the largest component.
            let step = float.iter().copied().fold(0.0, f32::max) / 128.0;
            assert!(float.iter().zip(pixel).all(|(a, b)| (a - b).abs() <= step), "{float:?} as {pixel:?}");
            differ += usize::from(float != pixel);
        }
        assert!(differ > 0, "pixels are rounded");
    }
    let refused = rpict(&folder, &["-ff", "-ro", "a.hdr", "room.rad"]);
    assert!(refused.code == 2 && refused.messages.contains("-ff cannot continue a picture"), "{}", refused.messages);
}
