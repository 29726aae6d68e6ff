//! Compares `rsplit` with the real one.

use crate::program::{Folder, command, run_with};
use radsight_test_support::Radiance;

/// Runs a shell command in a folder of its own and returns its output and new files.
fn made(program: &mut std::process::Command, folder: &Folder, input: &[u8]) -> (Vec<u8>, Vec<(String, Vec<u8>)>) {
    let output = run_with(program.current_dir(folder.path("")), input).done();
    let mut files: Vec<_> = folder.names().into_iter().map(|name| (name.clone(), folder.read(&name))).collect();
    files.sort();
    (output, files)
}

/// The real program pads the names of formats.
fn unpadded(line: &[u8]) -> Vec<u8> {
    if line.starts_with(b"FORMAT=") { line.trim_ascii_end().to_vec() } else { line.to_vec() }
}

fn records(count: u32) -> Vec<u8> {
    (0..count)
        .map(|i| format!("{i} {}\t{}\t{:.2}\n", i * i, i % 3, f64::from(i) / 7.0))
        .collect::<String>()
        .into_bytes()
}

fn bytes(count: u32) -> Vec<u8> {
    (0..count).map(|i| (i * 37 % 251) as u8).collect()
}

fn headed(body: &[u8], more: &str) -> Vec<u8> {
    [b"#?RADIANCE\nrtrace -x 3\nNCOMP=4\nNROWS=7\nSOFTWARE= x\nBigEndian=0\nFORMAT=float\n\n", more.as_bytes(), body]
        .concat()
}

#[test]
fn parts_are_those_of_the_real_program() {
    let Some(radiance) = Radiance::find() else { return };
    for (words, input) in [
        ("a b", records(6)),
        ("a . -", records(7)),
        ("-t\t - - a -", records(4)),
        ("-t\t -oa2 a -oa1 b", records(4)),
        ("-t  - a", records(5)),
        ("-t. a -", b"1 2.3.a\nb..5.6.".to_vec()),
        ("-t, a b", b"1,2,3,4,\n5,6,\n".to_vec()),
        ("-on 2 a b", records(9)),
        ("-on 11 -f -t  - . third", records(11)),
        ("-oa3 a -oa1 b", records(12)),
        ("-of3 a -od b -ow2 - -ob .", bytes(250)),
        ("-oi a -ob3 !cat b", bytes(70)),
        ("-of - a", bytes(61)),
        ("-on 3 -of2 a -", bytes(200)),
        ("-oh -x 2 -y 3 -oH a -oH b -", records(30)),
        ("-oh -of3 a -oh -of b", bytes(160)),
        ("-ih -oh -of3 a -od -", headed(&bytes(200), "")),
        ("-ih -iH -oh -oH -of a -oh b", headed(&bytes(64), "-Y 2 +X 4\n")),
        ("-ih -iH -oH -ob2 - -ob", headed(&bytes(64), "+Y 2 -X 4\n")),
        ("-ih -oa a -", headed(&records(6), "")),
    ] {
        // Each blank separates, but a following blank belongs to the word.
        let words: Vec<&str> = match words.split_once("-t  ") {
            Some((before, after)) => before.split_whitespace().chain(["-t "]).chain(after.split_whitespace()).collect(),
            None => words.split(' ').filter(|word| !word.is_empty()).collect(),
        };
        let [real, ours] = [Folder::new(), Folder::new()];
        let real = made(&mut radiance.command("rsplit", &words), &real, &input);
        let ours = made(&mut command(&[&["rsplit"], &words[..]].concat()), &ours, &input);
        // The command lines of the headers contain the programs' paths.
        let text = |bytes: &[u8]| {
            let line =
                |line: &[u8]| if line.windows(7).any(|part| part == b"rsplit ") { Vec::new() } else { unpadded(line) };
            bytes.split(|byte| *byte == b'\n').map(line).collect::<Vec<_>>()
        };
        assert_eq!(text(&ours.0), text(&real.0), "{words:?}: standard output");
        assert_eq!(ours.1.len(), real.1.len(), "{words:?}");
        for ((name, ours), (other, real)) in ours.1.iter().zip(&real.1) {
            assert_eq!((name, text(ours)), (other, text(real)), "{words:?}: {name}");
        }
    }
}

#[test]
fn headers_name_the_command_and_the_form() {
    let folder = Folder::new();
    let words = ["rsplit", "-x", "1", "-y", "1", "-oh", "-oH", "-od2", "-", "-oi", "-", "."];
    let output = run_with(command(&words).current_dir(folder.path("")), &bytes(24)).done();
    let head = "#?RADIANCE\nrsplit -x 1 -y 1 -oh -oH -od2 - -oi - .\nNCOMP=3\nBigEndian=0\nFORMAT=int\n\n-Y        1 +X        1\n";
    assert_eq!(String::from_utf8_lossy(&output[..head.len()]), head);
    assert_eq!(output[head.len()..], bytes(20));
}

#[test]
fn a_last_line_without_an_end_is_kept() {
    let folder = Folder::new();
    let output = run_with(command(&["rsplit", "a", "-"]).current_dir(folder.path("")), b"1\n2\n3\n4").text();
    assert_eq!((output.as_str(), &folder.read("a")[..]), ("2\n4\n", &b"1\n3\n"[..]));
}

#[test]
fn files_are_overwritten_or_added_to_when_asked() {
    let folder = Folder::new();
    folder.file("a", "old\n");
    let run =
        |words: &[&str]| run_with(command(&[&["rsplit"], words].concat()).current_dir(folder.path("")), b"1\n2\n");
    let refused = run(&["a"]);
    assert_eq!((refused.code, &folder.read("a")[..]), (2, &b"old\n"[..]));
    assert!(refused.messages.contains("\"a\" exists, expected -f before it to overwrite it, or -a to add to it"));
    run(&["-a", "a"]).done();
    assert_eq!(folder.read("a"), b"old\n1\n2\n");
    run(&["-f", "a"]).done();
    assert_eq!(folder.read("a"), b"1\n2\n");
}

#[test]
fn wrong_command_lines_of_rsplit_are_reported() {
    let folder = Folder::new();
    let run = |words: &[&str], input: &[u8]| {
        run_with(command(&[&["rsplit"], words].concat()).current_dir(folder.path("")), input)
    };
    for (words, input, code, message) in [
        (&[][..], "", 2, "no output is given"),
        (&["-q", "a"], "", 2, "option \"-q\" is unknown\nhint: expected -ih"),
        (&["-o", "a"], "", 2, "option \"-o\" is unknown"),
        (&["-ox", "a"], "", 2, "option \"-ox\" is unknown"),
        (&["-of0", "a"], "", 2, "option \"-of0\" is unknown"),
        (&["-od99999", "a"], "", 2, "option \"-od99999\" requests more than 16384 bytes per record"),
        (&["b", "b"], "", 2, "\"b\" is named twice"),
        (&["-a", "-oh", "c"], "", 2, "option \"-a\" appends to files"),
        (&["-oH", "-"], "", 2, "option \"-oH\" lacks a resolution, expected -iH, or -x and -y"),
        (&["-on"], "", 2, "ends the command line"),
        (&["-ih", "-"], "#?RADIANCE\n", 1, "the header of standard input (-ih) has no end"),
        (&["-iH", "-"], "no size\n", 1, "standard input"),
        (&["nowhere/d"], "1\n", 3, "cannot write \"nowhere/d\""),
        (&["!exit 4"], "1\n", 1, "command \"exit 4\" failed"),
    ] {
        let run = run(words, input.as_bytes());
        assert!(run.messages.contains(message), "{words:?}: {}", run.messages);
        assert_eq!(run.code, code, "{words:?}: {}", run.messages);
    }
    let short = run(&["-on", "3", "-"], b"1\n2\n");
    assert_eq!((short.code, &short.output[..]), (0, &b"1\n2\n"[..]));
    assert!(short.messages.contains("warning - the input ends after 2 of 3 records"), "{}", short.messages);
}
