//! `pcomb`: expressions of pixels as in the real program, and warnings.

use crate::program::{Folder, Run, command, run_with};
use radsight_picture::{Header, Image, Picture};
use radsight_test_support::Radiance;

fn values(seed: usize) -> Image<f32> {
    let value = |index: usize| ((index * 7919 + seed) % 1013) as f32 / 100.0 + 0.01;
    Image::new(13, 9, 3, (0..13 * 9 * 3).map(value).collect()).expect("a shape")
}

fn folder() -> Folder {
    let folder = Folder::new();
    let header = || Header::new("RADIANCE");
    folder.file("a.hdr", Picture::from_rgb(header(), &values(1)).expect("a picture").to_bytes());
    folder.file("b.hdr", Picture::from_rgb(header(), &values(77)).expect("a picture").to_bytes());
    folder.file("xyz.hdr", Picture::from_xyz(header(), &values(5)).expect("a picture").to_bytes());
    folder
}

fn run_in(folder: &Folder, words: &[&str]) -> Run {
    run_with(command(words).current_dir(folder.path("")), b"")
}

#[test]
fn expressions_of_positions_and_neighbours_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    let folder = folder();
    for expressions in [
        "lo=li(1)*x",
        "lo=li(1)+y/2",
        "ro=ri(1)*gi(2);go=x*y;bo=xmax-x",
        "lo=li(1,-1,0)+li(2,1,2)",
        "sum=sum+1;lo=sum",
        "x=3;lo=li(1)*x",
        "ro=ri(1,x-6,y-4)",
        "lo=if(x-5,li(2),ri(3))",
        "k:le(1);ro=k*ri(1);go=2*k;bo=re(2)",
        "f(a):a*le(1);lo=f(2)*x",
    ] {
        let words = ["-e", expressions, "a.hdr", "b.hdr"];
        let real = run_with(radiance.command("pcomb", &words).current_dir(folder.path("")), b"").done();
        let ours = run_in(&folder, &[&["pcomb"], &words[..]].concat()).done();
        let [real, ours] = [real, ours].map(|bytes| Picture::read(&bytes).expect("a picture").values());
        for (at, (ours, real)) in ours.data().iter().zip(real.data()).enumerate() {
            assert!((ours - real).abs() <= 0.01 * real.abs(), "{expressions}: value {at} is {ours}, real {real}");
        }
    }
}

#[test]
fn a_picture_that_is_not_there_is_a_warning() {
    let folder = folder();
    let run = run_in(&folder, &["pcomb", "-e", "ro=ri(3);go=1;bo=log(-x-1)", "a.hdr"]);
    assert_eq!(run.messages, "pcomb: warning - ri(): domain error\npcomb: warning - log(): domain error\n");
    let picture = Picture::read(&run.done()).expect("a picture").values();
    let close =
        picture.data()[..3].iter().zip([0.0, 1.0, 0.0]).all(|(value, expected)| (value - expected).abs() < 0.005);
    assert!(close, "{:?}", &picture.data()[..3]);
    for words in [&["pcomb", "-w", "-e", "lo=li(2)", "a.hdr"][..], &["pcomb", "-e", "lo=li(0)", "a.hdr"]] {
        assert_eq!(run_in(&folder, words).messages, "", "{words:?}");
    }
}

#[test]
fn pictures_of_other_primaries_are_a_warning() {
    let folder = folder();
    let run = run_in(&folder, &["pcomb", "a.hdr", "xyz.hdr", "b.hdr"]);
    let expected = "pcomb: warning - \"xyz.hdr\" is 32-bit_rle_xyze, but the first picture 32-bit_rle_rgbe; \
        its numbers are combined as they are\n";
    assert_eq!((run.code, run.messages.as_str()), (0, expected));
    assert_eq!(run_in(&folder, &["pcomb", "-w", "a.hdr", "xyz.hdr"]).messages, "");
    assert_eq!(run_in(&folder, &["pcomb", "xyz.hdr"]).messages, "");
}
