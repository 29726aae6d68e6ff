//! Inputs are read once, from pipes as well as files, and text programs stream their output.

use crate::bash;
use crate::program::{Folder, command, gripps, run_with};
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

const ROOM: &str = "
void plastic wall 0 0 5 .5 .4 .3 0 0
void light lamp 0 0 3 1 1 1
lamp sphere bulb 0 0 4 0 5 3 .5
wall polygon floor 0 0 12 -10 0 0 10 0 0 10 20 0 -10 20 0
wall sphere ball 0 0 4 0 4 1 .8
";

fn bench() -> Folder {
    let folder = Folder::new();
    folder.file("s.rad", ROOM);
    folder.file("mods", "lamp\n");
    folder.file("f.cal", "f(x)=x*x+1;\n");
    folder.file("verts", "0 0  1 0  0 1\n");
    folder.file("mat.rad", "void plastic a 0 0 5 .5 .5 .5 0 0\n");
    folder.file("m.obj", "usemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.file("rays", "0 -3 1 0 1 0\n0 -3 1 0 1 .5\n");
    folder.file("w.wea", "place X\nlatitude 40\nlongitude 100\ntime_zone 105\nsite_elevation 100\nweather_data_file_units 1\n6 21 12 500 200\n");
    folder.file("view", "rvu -vp 0 -3 1 -vd 0 1 0\n");
    folder.file("options", "-vp 0 -3 1 -vd 0 1 0\n");
    let camera = fs::read_to_string(gripps("fig10.toml")).expect("a camera");
    folder.file("cam.toml", camera.replace("pixels = [192, 165]", "pixels = [8, 7]"));
    fs::copy(gripps("rig-table.rad"), folder.path("rig-table.rad")).expect("a scene");
    fs::copy(gripps("hlmp-8104.csv"), folder.path("hlmp-8104.csv")).expect("a table");
    bash(
        &folder,
        "$R oconv s.rad > s.oct && $R oconv -f s.rad > f.oct && $R rpict @options -x 16 -y 16 -z p.zbf s.rad > p.hdr",
    )
    .done();
    folder
}

/// A script with each `%file` replaced.
fn named(script: &str, name: impl Fn(&str) -> String) -> String {
    let word = |word: &str| word.strip_prefix('%').map_or_else(|| word.to_owned(), &name);
    script.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// The output without lines that name an input of the script or the time, and without blanks that
/// pad a header.
fn without_names(output: &[u8], script: &str) -> Vec<Vec<u8>> {
    let inputs = script.split(' ').filter_map(|word| word.strip_prefix('%'));
    let names: Vec<&str> = inputs.chain(["/dev/fd/", "GMT=", "CAPDATE="]).collect();
    let is_named = |line: &&[u8]| names.iter().any(|name| String::from_utf8_lossy(line).contains(name));
    output
        .split(|byte| *byte == b'\n')
        .filter(|line| !is_named(line))
        .map(|line| line.trim_ascii_end().to_vec())
        .collect()
}

#[test]
fn every_program_reads_its_files_from_pipes() {
    let folder = bench();
    for script in [
        "$R rpict -x 16 -y 16 @options %s.rad",
        "$R rpict -x 16 -y 16 @options %f.oct",
        "$R rpict -x 16 -y 16 @options %s.oct",
        "$R rpict -x 16 -y 16 -vf %view s.rad",
        "$R rtrace %s.rad < rays",
        "$R rtrace %f.oct < rays",
        "$R rcontrib -M %mods %s.rad < rays",
        "$R rcontrib -f %f.cal -b f(0)-1 -m lamp %f.oct < rays",
        "$R oconv -f %s.rad %mat.rad",
        "$R oconv -f -i %f.oct %mat.rad",
        "$R xform -t 1 0 0 %s.rad",
        "$R getbbox %s.rad",
        "$R genprism m n %verts",
        "$R obj2rad %m.obj",
        "$R obj2mesh -a %mat.rad %m.obj",
        "$R gendaymtx %w.wea",
        "$R replmarks -x %mat.rad wall %s.rad",
        "$R rcalc -f %f.cal -e $1=f($1) %rays",
        "$R total %rays",
        "$R rlam %rays %mods",
        "$R rcollate -h -fa1 -ic 6 -oc 3 %rays",
        "$R rmtxop %p.hdr + %p.hdr",
        "$R dctimestep %p.hdr %p.hdr",
        "$R pfilt -2 %p.hdr",
        "$R pfilt -1 -x /2 %p.hdr",
        "$R pvalue %p.hdr",
        "$R pcomb -e lo=li(1) %p.hdr %p.hdr",
        "$R pcond -h %p.hdr",
        "$R pextrem %p.hdr",
        "$R ra_ppm %p.hdr",
        "$R ra_bmp %p.hdr",
        "$R vwrays -d %p.hdr",
        "$R vwrays %p.hdr %p.zbf",
        "$R pinterp -vp 0 -3 1 -x 16 -y 16 -vf %view %p.hdr %p.zbf",
        "$R capture %cam.toml %rig-table.rad --samples 1 --exposure -",
        "$R rig %cam.toml",
        "$R check %s.rad",
    ] {
        let script = script.replace("$1", "\\$1").replace('(', "\\(").replace(')', "\\)");
        let from_files = bash(&folder, &named(&script, str::to_owned));
        let from_pipes = bash(&folder, &format!("timeout 60 {}", named(&script, |name| format!("<(cat {name})"))));
        let (files, pipes) = (from_files.done(), from_pipes.done());
        assert!(!files.is_empty(), "{script}");
        assert!(without_names(&files, &script) == without_names(&pipes, &script), "{script}");
    }
}

#[test]
fn scenes_come_from_standard_input_and_named_pipes() {
    let folder = bench();
    let rpict = |from: &str| {
        let picture =
            bash(&folder, &format!("timeout 60 {}", from.replace("RPICT", "$R rpict -x 16 -y 16 @options"))).done();
        let end = picture.windows(2).position(|pair| pair == b"\n\n").expect("a header");
        picture[end..].to_vec()
    };
    let whole = rpict("RPICT f.oct");
    for from in [
        "bash -c 'cat f.oct | RPICT -'",
        "bash -c 'cat f.oct | RPICT /dev/stdin'",
        "bash -c 'RPICT /dev/stdin < f.oct'",
        "bash -c 'mkfifo pipe; cat f.oct > pipe & RPICT pipe; rm pipe'",
    ] {
        assert!(rpict(from) == whole, "{from}");
    }
}

#[test]
fn a_pipe_that_a_scene_names_twice_is_read_once() {
    let folder = bench();
    let material = |name: &str| {
        format!(
            "void brightfunc p{name} 2 b g.cal 0 0\np{name} glow {name} 0 0 4 1 1 1 0\n{name} sphere s{name} 0 0 4 0 9 0 "
        )
    };
    folder.file("twice.rad", format!("{}1\n{}2\n", material("a"), material("b")));
    folder.file("g.txt", "b=7;\n");
    let script = "mkfifo g.cal; cat g.txt > g.cal & echo 0 0 0 0 1 0 | timeout 60 $R rtrace -h twice.rad";
    assert_eq!(bash(&folder, script).text().trim(), "7.000000e+00\t7.000000e+00\t7.000000e+00");
}

/// An interactive program.
struct Talk {
    child: Child,
    input: Option<ChildStdin>,
    answers: Receiver<String>,
}

impl Talk {
    fn with(folder: &Folder, words: &[&str]) -> Talk {
        let mut command = command(words);
        let mut child = command.current_dir(folder.path("")).stdin(Stdio::piped()).spawn().expect("the program starts");
        let (send, answers) = channel();
        let output = child.stdout.take().expect("it is piped");
        thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(Result::ok);
            lines.take_while(|line| send.send(line.clone()).is_ok()).for_each(drop);
        });
        let input = child.stdin.take();
        Talk { child, input, answers }
    }

    fn say(&mut self, line: &str) {
        let input = self.input.as_mut().expect("it is open");
        input.write_all(line.as_bytes()).and_then(|()| input.flush()).expect("the program reads");
    }

    /// The next line, while the input is still open.
    fn hear(&self) -> String {
        self.answers.recv_timeout(Duration::from_secs(30)).expect("an answer before the input ends")
    }

    fn end(mut self) -> (i32, String) {
        drop(self.input.take());
        let output = self.child.wait_with_output().expect("the program ends");
        (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

#[test]
fn text_programs_answer_each_line_as_it_comes() {
    let folder = Folder::new();
    folder.file("letters", "a\nb\nc\n");
    for (words, asked, answers) in [
        (&["rcalc", "-e", "$1=$1+$2"][..], ["1 2\n", "3 4\n"], ["3", "7"]),
        (&["rcalc", "-i", "${a} is ${b}", "-o", "${a+b}"], ["1 is 2\n", "3 is 4\n"], ["3", "7"]),
        (&["total", "-1"], ["1 2\n", "3 4\n"], ["1\t2", "3\t4"]),
        (&["total", "-2"], ["1 2\n3 4\n", "5 6\n7 8\n"], ["4\t6", "12\t14"]),
        (&["rlam", "-", "letters"], ["1\n", "2\n"], ["1\ta", "2\tb"]),
        (&["rlam", "letters", "!cat letters", "-"], ["1\n", "2\n"], ["a\ta\t1", "b\tb\t2"]),
        (&["rlam", "-in", "2", "!cnt 150000000 | rcalc -e '$1=$1*2'", "-"], ["1\n", "2\n"], ["0\t1", "2\t2"]),
        (&["rcollate", "-h", "-fa1", "-ic", "2", "-oc", "1"], ["1 2\n", "3 4\n"], ["1", "3"]),
        (&["rcollate", "-h", "-fa1", "-oc", "4"], ["1 2\n3 4\n", "5 6 7 8\n"], ["1\t2\t3\t4", "5\t6\t7\t8"]),
    ] {
        let mut talk = Talk::with(&folder, words);
        for (line, answer) in asked.iter().zip(answers) {
            talk.say(line);
            assert_eq!(talk.hear().trim(), answer, "{words:?}");
            if words.contains(&"1") && words[0] == "rcollate" {
                talk.hear();
            }
        }
        let (code, messages) = talk.end();
        assert_eq!(code, 0, "{words:?}: {messages}");
    }
}

#[test]
fn lines_before_a_mistake_are_processed_and_its_line_is_reported() {
    let folder = Folder::new();
    let words = ["rcalc", "-e", "$1=in($1)"];
    let run = run_with(command(&words).current_dir(folder.path("")), b"1\n1 2\n-2\n1\n");
    assert_eq!((run.code, String::from_utf8_lossy(&run.output).as_ref()), (1, "1\n1\n"));
    assert!(
        run.messages.contains("standard input, line 3") || run.messages.contains("standard input: line 3"),
        "{}",
        run.messages
    );
    let words = ["rcollate", "-h", "-fa2", "-oc", "1"];
    let run = run_with(command(&words).current_dir(folder.path("")), b"1 2\n3 4\n5\n");
    assert_eq!((run.code, String::from_utf8_lossy(&run.output).as_ref()), (1, "1 2\n3 4\n"));
    assert!(run.messages.contains("line 3 of the data ends after 1 of 2 components"), "{}", run.messages);
}

/// Bytes of input that no program may hold at once.
const MUCH: usize = 300_000_000;

#[test]
fn text_programs_take_the_memory_of_a_line() {
    for words in [
        "rcalc -e '$1=recno'",
        "rcalc -i '${a} x' -o '${a}'",
        "total -m",
        "total -1000",
        "histo 0 10 5",
        "rlam -",
        "rcollate -h -fa1 -oc 1",
        "rcollate -ho -hi -fb1000 -oc 1",
    ] {
        let script = format!("ulimit -v 150000; exec \"$R\" {words} > /dev/null");
        let mut bash = Command::new("bash");
        bash.args(["-c", &script]).env("R", env!("CARGO_BIN_EXE_radsight"));
        let mut child = bash.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let mut input = child.stdin.take().expect("it is piped");
        let mut line = [b'x'; 1000];
        line[..2].copy_from_slice(b"1 ");
        line[999] = b'\n';
        let piece = line.repeat(100);
        (0..MUCH / piece.len()).for_each(|_| input.write_all(&piece).expect("the program reads"));
        drop(input);
        let mut messages = String::new();
        child.stderr.take().expect("it is piped").read_to_string(&mut messages).expect("text");
        assert!(child.wait().expect("the program ends").success(), "{words}: {messages}");
    }
}

#[test]
fn counts_without_end_go_out_as_they_are_counted() {
    let folder = Folder::new();
    let mut child = command(&["cnt", "150000000"]).current_dir(folder.path("")).spawn().expect("the program starts");
    let mut start = [0; 9];
    let mut output = child.stdout.take().expect("it is piped");
    output.read_exact(&mut start).expect("it counts");
    assert_eq!(&start, b"\t0\n\t1\n\t2\n");
    drop(output);
    assert!(child.wait().expect("the program ends").success(), "who does not want the rest is no fault");
}

#[test]
fn records_of_a_known_shape_go_out_as_those_that_are_counted_first() {
    let folder = Folder::new();
    let collate = |words: &[&str], input: &[u8]| {
        run_with(command(&[&["rcollate"], words].concat()).current_dir(folder.path("")), input).done()
    };
    let text = b"1 2 3\n4 5 6\n7 8 9\n10 11 12\n";
    let known = collate(&["-hi", "-ho", "-fa1", "-ic", "3", "-ir", "4", "-oc", "2"], text);
    assert_eq!(known, collate(&["-hi", "-ho", "-fa1", "-or", "6"], text));
    let numbers: Vec<u8> = (0..24).collect();
    assert_eq!(collate(&["-hi", "-ho", "-fb2", "-ic", "3", "-ir", "4", "-oc", "2"], &numbers), numbers);
    let words = ["rcollate", "-hi", "-ho", "-fb2", "-ic", "3", "-ir", "3", "-oc", "3"];
    let behind = run_with(command(&words).current_dir(folder.path("")), &numbers);
    assert_eq!((behind.code, &behind.output[..]), (0, &numbers[..18]));
    assert!(behind.messages.contains("6 bytes follow 3 × 3 records, expected none"), "{}", behind.messages);
    let header = b"NCOMP=1\nNROWS=4\nNCOLS=3\nFORMAT=ascii\n\n";
    let headed = collate(&["-oc", "6"], &[&header[..], text].concat());
    assert!(headed.ends_with(b"NROWS=2\nNCOLS=6\nFORMAT=ascii\n\n1\t2\t3\t4\t5\t6\n7\t8\t9\t10\t11\t12\n"));
}

/// A file would be read while it grows, and a message would be added to a picture.
#[test]
fn no_picture_is_read_to_which_the_output_is_added() {
    let folder = Folder::new();
    let picture = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x80";
    for script in [
        "\"$R\" getinfo a.hdr >> a.hdr",
        "\"$R\" getinfo -d a.hdr >> a.hdr",
        "\"$R\" getinfo < a.hdr >> a.hdr",
        "\"$R\" getinfo - < a.hdr >> a.hdr",
        "\"$R\" getinfo -a A=1 < a.hdr >> a.hdr",
        "\"$R\" pvalue < a.hdr >> a.hdr",
        "\"$R\" falsecolor -e < a.hdr >> a.hdr",
        "\"$R\" pcomb - < a.hdr >> a.hdr",
    ] {
        folder.file("a.hdr", picture);
        let run = bash(&folder, script);
        assert_eq!(run.code, 2, "{script}: {}", run.messages);
        assert!(run.messages.contains("standard output goes to the same file"), "{script}: {}", run.messages);
        assert_eq!(std::fs::read(folder.path("a.hdr")).expect("it is there"), picture, "{script}");
    }
}

#[test]
fn mkillum_leaves_no_data_files_of_a_text_that_cannot_be_written() {
    let folder = Folder::new();
    folder.file("room.rad", "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n");
    folder.file(
        "window.rad",
        "#@mkillum m=lit d=6 s=1 f=first\nvoid glass pane 0 0 3 .9 .9 .9\n\
         pane polygon w 0 0 12 -1 -1 0 -1 1 0 1 1 0 1 -1 0\npane polygon v 0 0 12 -1 -1 1 -1 1 1 1 1 1 1 -1 1\n",
    );
    folder.file("a.oct", "");
    let before = folder.names();
    let script = "\"$R\" oconv room.rad window.rad > a.oct; \"$R\" mkillum -ab 0 a.oct < window.rad";
    let run = bash(&folder, &format!("{script} > /dev/full"));
    assert_eq!(run.code, 3, "{}", run.messages);
    assert_eq!(folder.names(), before);
    // Both windows have data of their own.
    bash(&folder, script).done();
    assert!(folder.path("first.dat").exists() && folder.path("first1.dat").exists(), "{:?}", folder.names());
}
