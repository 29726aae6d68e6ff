//! Whatever a plugin does, the program ends with code 3 and names the plugin, or continues;
//! standard output holds only data; no process of the plugin is left.

use radsight_test_support::plugins;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A folder with a scene and its plugin.
struct Bench {
    folder: TempDir,
}

/// The result of a run.
#[derive(Debug)]
struct Ended {
    code: Option<i32>,
    output: Vec<u8>,
    complaints: String,
    time: Duration,
}

const RAYS: &str = "0 0 3 0 0 -1\n1 0 3 0 0 -1\n";
const WHERE: &str = "plugin \"evil\", model \"lambert\", material \"sheet\" (s.rad:1:1), function ";

/// Set for every process of a run, so that remaining ones can be found.
const RUN_VARIABLE: &str = "RADSIGHT_TEST_RUN";

impl Bench {
    fn new() -> Option<Bench> {
        let folder = tempfile::tempdir().unwrap();
        plugins::c_plugin(folder.path(), "evil.c", "evil", &["-pthread"])?;
        let bench = Bench { folder };
        bench.write("s.rad", &scene("2 evil lambert 0 3 .5 .4 .3"));
        Some(bench)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join(name), text).unwrap();
    }

    /// Runs the program with its plugin; `words` begin with the name of the program.
    fn command(&self, deed: &str, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_radsight"));
        command.args(words).current_dir(self.folder.path());
        command.env("EVIL", deed).env(RUN_VARIABLE, self.folder.path()).env("RADSIGHT_PLUGIN_PATH", self.folder.path());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, deed: &str, words: &[&str]) -> Ended {
        finish(self.command(deed, words), RAYS)
    }

    /// Traces two rays with further options.
    fn trace(&self, deed: &str, options: &[&str]) -> Ended {
        let words = [&["rtrace", "-h", "-ab", "1"], options, &["s.rad"]].concat();
        self.run(deed, &words)
    }

    /// Remaining processes of this folder's runs.
    fn left(&self) -> Vec<PathBuf> {
        let mark = format!("{RUN_VARIABLE}={}", self.folder.path().display());
        let entries = std::fs::read_dir("/proc").unwrap().filter_map(|entry| Some(entry.ok()?.path()));
        let is_of_run = |path: &PathBuf| {
            let environment = std::fs::read(path.join("environ")).unwrap_or_default();
            environment.split(|&byte| byte == 0).any(|variable| variable == mark.as_bytes())
        };
        entries.filter(is_of_run).collect()
    }

    /// Fails if a process remains after a moment.
    fn assert_nothing_is_left(&self, after: &str) {
        let started = Instant::now();
        while !self.left().is_empty() {
            assert!(started.elapsed() < Duration::from_secs(5), "{after}: {:?} are left", self.left());
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// A floor of the plugin's material under a lamp.
fn scene(material: &str) -> String {
    format!(
        "void brdfplugin sheet {material}\nvoid light lamp 0 0 3 9 9 9\nlamp sphere bulb 0 0 4 0 0 5 .3\n\
         sheet ring floor 0 0 8 0 0 0 0 0 1 0 6\nvoid plastic grey 0 0 5 .5 .5 .5 0 0\ngrey sphere ball 0 0 4 1 1 .5 .5\n"
    )
}

fn finish(mut command: Command, input: &str) -> Ended {
    let started = Instant::now();
    let mut child = command.spawn().unwrap();
    // The program has ended and does not read.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    let output = read(child.stdout.take().unwrap());
    let complaints = read(child.stderr.take().unwrap());
    let code = wait(&mut child, Duration::from_secs(60)).code();
    let time = started.elapsed();
    let [output, complaints] = [output, complaints].map(|reader| reader.join().unwrap());
    Ended { code, output, complaints: String::from_utf8(complaints).unwrap(), time }
}

fn read(mut stream: impl Read + Send + 'static) -> std::thread::JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        bytes
    })
}

fn wait(child: &mut Child, limit: Duration) -> std::process::ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if started.elapsed() > limit {
            child.kill().unwrap();
            panic!("the program has not ended within {limit:?}");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// The text of the message after the function's name.
fn assert_fault(ended: &Ended, case: &str, function: &str, what: &str) {
    assert_eq!(ended.code, Some(3), "{case}: {ended:?}");
    let place = format!(" in {WHERE}{function}: ");
    let said = ended.complaints.split_once(&place).map(|(_, rest)| rest.to_owned());
    assert!(said.is_some_and(|said| said.contains(what)), "{case}: no {place:?} with {what:?} in {ended:?}");
}

/// Faults that are detected at once, and their messages.
const DEEDS: [(&str, &str); 11] = [
    ("segfault", "SIGSEGV, invalid memory access"),
    ("divide", "SIGFPE, arithmetic fault"),
    ("illegal", "SIG"),
    ("bus", "SIGBUS, invalid memory access"),
    ("abort", "SIGABRT, abort"),
    ("overflow", "SIGSEGV, stack overflow"),
    ("exit", "it called exit"),
    ("_exit", "it called _exit"),
    ("quick_exit", "it called quick_exit"),
    ("fork", "it called fork"),
    ("thread_exit", "SIGABRT, abort"),
];

/// The known part of the function name when an isolated plugin dies silently in the quick check of
/// each model.
const IN_SELF_CHECK: &str = "eval_pdf or sample";

/// Names of the faults in the plugin, and in the messages.
const FUNCTIONS: [(&str, &str); 6] = [
    ("load", "load"),
    ("count", "count"),
    ("describe", "describe"),
    ("create", "create"),
    ("eval", "eval_pdf"),
    ("sample", "sample"),
];

#[test]
fn crashes_and_exits_in_each_function_end_with_code_3_and_the_place() {
    let Some(bench) = Bench::new() else { return };
    for (deed, what) in DEEDS {
        for (function, name) in FUNCTIONS {
            let case = format!("{function}-{deed}");
            if case == "load-thread_exit" {
                // The frames of the dynamic linker unwind, and the call ends.
                continue;
            }
            let ended = bench.trace(&case, &[]);
            assert_fault(&ended, &case, name, what);
            assert_eq!(ended.output, b"", "{case}");
        }
    }
    let ended = bench.trace("eval-segfault", &[]);
    assert!(ended.complaints.contains("; outgoing direction in the surface's frame 0."), "{ended:?}");
}

#[test]
fn an_isolated_plugin_that_crashes_or_exits_ends_with_code_3_and_the_place() {
    let Some(bench) = Bench::new() else { return };
    for (function, name) in FUNCTIONS {
        for (deed, what) in DEEDS.into_iter().filter(|(deed, _)| function == "eval" || *deed == "segfault") {
            let case = format!("{function}-{deed}");
            let ended = bench.trace(&case, &["--isolate-plugins"]);
            assert_fault(&ended, &case, name, what);
            assert_eq!(ended.output, b"", "{case}");
        }
    }
    bench.assert_nothing_is_left("crashes");
}

#[test]
fn what_no_handler_sees_is_caught_in_an_isolated_plugin() {
    let Some(bench) = Bench::new() else { return };
    let cases = [
        ("kill", "its process was ended by signal 9"),
        ("terminate", "its process was ended by signal 15"),
        ("raw_exit", "its process ended with exit code 0"),
        ("close_and_exit", "its process ended with exit code 3"),
        ("thread", "its process was ended by signal 11"),
        ("kill_parent", "the supervisor of its process ended, signal: 9 (SIGKILL)"),
    ];
    for (deed, what) in cases {
        let case = format!("eval-{deed}");
        let ended = bench.trace(&case, &["--isolate-plugins"]);
        assert_fault(&ended, &case, IN_SELF_CHECK, what);
        assert_eq!(ended.output, b"", "{case}");
        if deed != "kill_parent" {
            bench.assert_nothing_is_left(&case);
        }
    }
    let ended = bench.trace("eval-orphan_and_exit", &["--isolate-plugins"]);
    assert_fault(&ended, "orphan", "eval_pdf", "it called _exit");
    bench.assert_nothing_is_left("an orphan");
}

#[test]
fn a_plugin_that_closes_the_programs_files_is_no_success() {
    let Some(bench) = Bench::new() else { return };
    for options in [&[][..], &["--isolate-plugins"]] {
        for case in ["load-close", "create-close", "eval-close"] {
            // In the same process, later output is lost.
            assert_eq!(bench.trace(case, options).code, Some(3), "{case} {options:?}");
        }
    }
}

#[test]
fn a_crash_in_a_thread_of_a_plugin_is_reported_with_the_loaded_plugins() {
    let Some(bench) = Bench::new() else { return };
    let ended = bench.trace("eval-thread", &[]);
    assert_eq!(ended.code, Some(3), "{ended:?}");
    let said = "crash outside of the calls of plugins: SIGSEGV, invalid memory access; loaded are \"evil\"";
    assert!(ended.complaints.contains(said), "{ended:?}");
}

#[test]
fn a_call_that_does_not_return_is_named_in_time() {
    let Some(bench) = Bench::new() else { return };
    for (case, name) in
        [("load-sleep", "load"), ("create-spin", "create"), ("eval-spin", "eval_pdf"), ("sample-sleep", "sample")]
    {
        for options in [&["--plugin-time-limit", ".3"][..], &["--plugin-time-limit", ".3", "--isolate-plugins"]] {
            let ended = bench.trace(case, options);
            let in_self_check = options.len() == 3 && matches!(name, "eval_pdf" | "sample");
            let name = if in_self_check { IN_SELF_CHECK } else { name };
            assert_fault(&ended, case, name, "it has not returned for 0.");
            assert!(ended.complaints.contains("(--plugin-time-limit)"), "{ended:?}");
            assert!(ended.time < Duration::from_secs(20), "{ended:?}");
        }
    }
    for case in ["eval-stop", "eval-orphan_and_sleep"] {
        let ended = bench.trace(case, &["--plugin-time-limit", ".3", "--isolate-plugins"]);
        assert_fault(&ended, case, IN_SELF_CHECK, "it has not returned for 0.");
    }
    bench.assert_nothing_is_left("calls without end");
}

#[test]
fn a_call_that_takes_all_memory_is_named() {
    let Some(bench) = Bench::new() else { return };
    let ended = limited(&bench, &["--plugin-memory-limit", "100"]);
    assert_fault(&ended, "hog", "eval_pdf", "MB in one call (--plugin-memory-limit)");
    let isolated = limited(&bench, &["--plugin-memory-limit", "100", "--isolate-plugins"]);
    assert_fault(&isolated, "hog", "eval_pdf", "SIGSEGV");
    assert!(isolated.complaints.contains("MB of memory, the limit is 100 MB (--plugin-memory-limit)"), "{isolated:?}");
    // Without our limit the system's applies, and the plugin dereferences a null pointer.
    let ended = limited(&bench, &["--plugin-memory-limit", "0"]);
    assert_fault(&ended, "hog", "eval_pdf", "SIGSEGV");
    bench.assert_nothing_is_left("hogs");
}

/// Traces with a plugin that allocates all available memory, which is limited.
fn limited(bench: &Bench, options: &[&str]) -> Ended {
    let words = format!("ulimit -v 2000000; exec \"$0\" rtrace -h {} s.rad", options.join(" "));
    let program = bench.command("eval-hog", &[]);
    let mut shell = Command::new("sh");
    shell.args(["-c", &words, env!("CARGO_BIN_EXE_radsight")]).current_dir(bench.folder.path());
    shell.envs(program.get_envs().filter_map(|(name, value)| Some((name, value?))));
    shell.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    finish(shell, RAYS)
}

#[test]
fn what_plugins_print_is_not_in_the_data() {
    let Some(bench) = Bench::new() else { return };
    let honest = bench.trace("", &[]);
    assert_eq!((honest.code, honest.complaints.as_str()), (Some(0), ""));
    assert_eq!(String::from_utf8_lossy(&honest.output).lines().count(), 2, "{honest:?}");
    for case in ["load-print", "create-print", "destroy-print"] {
        for options in [&[][..], &["--isolate-plugins"]] {
            let ended = bench.trace(case, options);
            assert_eq!((ended.code, &ended.output), (Some(0), &honest.output), "{case}: {ended:?}");
            for words in ["evil words by printf", "evil words by write"] {
                assert!(ended.complaints.contains(words), "{case}: {ended:?}");
            }
        }
    }
    let listed = bench.run("load-print", &["plugin", "list"]);
    assert!(listed.code == Some(0) && !String::from_utf8_lossy(&listed.output).contains("evil words"), "{listed:?}");
    let plotted = bench.run("create-print", &["plugin", "plot", "evil", "lambert(.5,.5,.5)"]);
    assert!(plotted.code == Some(0) && plotted.output.starts_with(b"<svg"), "{plotted:?}");
}

#[test]
fn a_closed_standard_file_is_a_fault_with_the_place() {
    let Some(bench) = Bench::new() else { return };
    for file in 0..3 {
        for (function, name) in FUNCTIONS {
            for options in [&[][..], &["--isolate-plugins"]] {
                let case = format!("{function}-close_fd{file}");
                let ended = bench.trace(&case, options);
                // The self-check calls both functions.
                let name = if ["eval", "sample"].contains(&function) { "" } else { name };
                let place = format!("fault in {WHERE}{name}");
                let what = ": it closed or replaced standard input, output or error";
                assert_eq!(ended.code, Some(3), "{case} {options:?}: {ended:?}");
                let said = ended.complaints.contains(&place) && ended.complaints.contains(what);
                assert!(said, "{case} {options:?}: no {place:?} in {ended:?}");
                assert_eq!(ended.output, b"", "{case}");
            }
        }
    }
    // A file that is closed after the last check is found at the end.
    let ended = bench.trace("destroy-close_fd1", &[]);
    assert_fault(&ended, "destroy", "destroy", "it closed or replaced");
    bench.assert_nothing_is_left("closed files");
}

#[test]
fn a_picture_that_was_not_finished_is_not_a_success() {
    let Some(bench) = Bench::new() else { return };
    let picture = |deed: &str, after: &str, options: &[&str]| {
        let view =
            ["-x", "128", "-y", "128", "-ps", "1", "-vp", "0", "0", "4", "-vd", "0", "0", "-1", "-vu", "0", "1", "0"];
        let words = [&["rpict"], &view[..], options, &["s.rad"]].concat();
        let mut command = bench.command(deed, &words);
        command.env("EVIL_AFTER", after);
        finish(command, "")
    };
    let whole = picture("", "0", &[]);
    assert_eq!(whole.code, Some(0), "{}", whole.complaints);
    // The quick check of a scene's models makes some 20,000 calls.
    for deed in ["eval-exit", "eval-_exit", "eval-segfault"] {
        for options in [&[][..], &["--isolate-plugins"]] {
            let ended = picture(deed, "25000", options);
            assert_eq!(ended.code, Some(3), "{deed}: {}", ended.complaints);
            assert!(ended.complaints.contains(WHERE), "{deed}: {}", ended.complaints);
            assert!(ended.output.len() < whole.output.len(), "{deed}");
        }
    }
    for (deed, what) in [("eval-raw_exit", "its process ended with exit code 0"), ("eval-stop", "it has not returned")]
    {
        let ended = picture(deed, "25000", &["--isolate-plugins", "--plugin-time-limit", ".5"]);
        // Another thread may have been in a call of the same plugin, which is then named as well.
        assert_eq!(ended.code, Some(3), "{deed}: {}", ended.complaints);
        assert!(ended.complaints.contains(WHERE) && ended.complaints.contains(what), "{deed}: {}", ended.complaints);
    }
}

#[test]
fn an_isolated_plugin_gives_the_same_bits() {
    let Some(bench) = Bench::new() else { return };
    let phong = plugins::c_plugin(bench.folder.path(), "../../../../plugins/phong/phong.c", "phong", &[]);
    assert!(phong.is_some());
    bench.write("p.rad", &scene("2 phong phong 0 7 .3 .2 .1 .4 .5 .6 20"));
    for file in ["s.rad", "p.rad"] {
        let picture = |options: &[&str]| {
            let view = ["-x", "48", "-y", "48", "-vp", "0", "-3", "3", "-vd", "0", "3", "-3", "-ab", "1", "-ad", "16"];
            let ended = bench.run("", &[&["rpict"], &view[..], options, &[file]].concat());
            assert_eq!(ended.code, Some(0), "{file}: {}", ended.complaints);
            pixels(&ended.output)
        };
        let here = picture(&[]);
        assert!(here.iter().any(|&byte| byte != here[0]), "something is seen");
        assert!(picture(&["--isolate-plugins"]) == here, "{file}: the pictures differ");
    }
    bench.assert_nothing_is_left("pictures");
}

/// The data after the header, whose command and date differ.
fn pixels(picture: &[u8]) -> Vec<u8> {
    let end = picture.windows(2).position(|pair| pair == b"\n\n").expect("a picture has a header");
    picture[end..].to_vec()
}

#[test]
fn handlers_that_a_plugin_replaces_are_put_back() {
    let Some(bench) = Bench::new() else { return };
    let ended = bench.trace("load-handlers", &[]);
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let said = format!("warning: {WHERE}load: it replaced the handlers of SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT");
    assert!(ended.complaints.contains(&said), "{ended:?}");
    for options in [&[][..], &["--isolate-plugins"]] {
        let ended = bench.trace("eval-handlers_and_segfault", options);
        assert_fault(&ended, "handlers", "eval_pdf", "SIGSEGV");
    }
}

#[test]
fn the_end_of_the_program_is_its_own() {
    let Some(bench) = Bench::new() else { return };
    let honest = bench.trace("", &[]);
    for case in ["end-segfault", "end-exit", "end-_exit", "end-spin", "load-at_exit"] {
        for options in [&[][..], &["--isolate-plugins"]] {
            let ended = bench.trace(case, options);
            assert_eq!((ended.code, &ended.output), (Some(0), &honest.output), "{case}: {ended:?}");
        }
        // An exit code for wrong input is kept.
        let wrong = finish(bench.command(case, &["rtrace", "-h", "s.rad"]), "0 0 3 0 0 -1\nx");
        assert_eq!(wrong.code, Some(1), "{case}: {wrong:?}");
    }
    bench.assert_nothing_is_left("ends");
}

#[test]
fn isolated_plugins_end_with_a_program_that_is_killed() {
    let Some(bench) = Bench::new() else { return };
    for deed in ["create-sleep", "create-orphan_and_sleep"] {
        let mut child = bench.command(deed, &["rtrace", "-h", "--isolate-plugins", "s.rad"]).spawn().unwrap();
        let started = Instant::now();
        // The program, the supervisor and the worker.
        while bench.left().len() < 3 {
            assert!(started.elapsed() < Duration::from_secs(20), "the plugin's process starts");
            std::thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        bench.assert_nothing_is_left(deed);
    }
}

#[test]
fn check_ends_in_time_and_leaves_nothing() {
    let Some(bench) = Bench::new() else { return };
    let cases = [
        ("load-sleep", "hang: no answer within 1 s"),
        ("create-spin", "hang: no answer within 1 s"),
        ("eval-stop", "hang: no answer within 1 s"),
        ("eval-orphan_and_sleep", "hang: no answer within 1 s"),
        ("load-orphan_and_exit", "function load: it called _exit"),
        ("load-exit", "function load: it called exit"),
        ("create-raw_exit", "the process ended without an answer"),
        ("create-fork", "function create: it called fork"),
        ("sample-overflow", "function sample: SIGSEGV, stack overflow"),
        ("create-kill", "the process was ended by signal 9"),
        ("create-kill_parent", "the process was ended by signal 9"),
        ("load-close", "crash: "),
    ];
    for (deed, what) in cases {
        let ended = bench.run(deed, &["plugin", "check", "evil", "--time-limit", "1"]);
        assert_eq!(ended.code, Some(1), "{deed}: {ended:?}");
        assert!(ended.complaints.contains(what), "{deed}: {ended:?}");
        assert!(ended.time < Duration::from_secs(20), "{deed}: {:?}", ended.time);
        if deed != "create-kill_parent" {
            bench.assert_nothing_is_left(deed);
        }
    }
}

#[test]
fn check_limits_the_memory_of_a_plugin() {
    let Some(bench) = Bench::new() else { return };
    let mut command = bench.command("create-hog", &["plugin", "check", "evil"]);
    command.env("RADSIGHT_PLUGIN_MEMORY_LIMIT", "100");
    let ended = finish(command, "");
    assert_eq!(ended.code, Some(1), "{ended:?}");
    assert!(ended.complaints.contains("MB of memory, the limit is 100 MB; crash in"), "{ended:?}");
}

#[test]
fn what_a_plugin_prints_is_not_in_the_report_of_its_check() {
    let Some(bench) = Bench::new() else { return };
    for deed in ["load-print", "create-orphan"] {
        let ended = bench.run(deed, &["plugin", "check", "evil", "--json"]);
        let report: serde_json::Value = serde_json::from_slice(&ended.output).unwrap();
        assert_eq!((ended.code, report["passed"].as_bool()), (Some(0), Some(true)), "{deed}: {ended:?}");
    }
    bench.assert_nothing_is_left("checks");
}

#[test]
fn a_panic_is_reported_and_does_not_end_the_program_wherever_the_plugin_runs() {
    let Some(bench) = Bench::new() else { return };
    let library = plugins::sdk_example("panics");
    let folder = library.parent().expect("the library is in a folder").to_str().expect("its name is text");
    let trace = |material: &str, options: &[&str]| {
        bench.write("panics.rad", &scene(material));
        let words = [&["rtrace", "-h", "-ab", "1", "--plugin-path", folder], options, &["panics.rad"]].concat();
        bench.run("", &words)
    };
    for (place, code, said) in [
        ("evaluating", 0, "panicked: there is no reflection at "),
        ("creating", 1, "panicked: cannot go on creating at "),
        ("dropping", 0, ""),
    ] {
        let material = format!("3 panics panics {place} 0 0");
        let here = trace(&material, &[]);
        assert!(here.code == Some(code) && here.complaints.contains(said), "{place}: {here:?}");
        let there = trace(&material, &["--isolate-plugins"]);
        assert_eq!((there.code, &there.output), (here.code, &here.output), "{place}: {there:?}");
        assert!(there.complaints.contains(said), "{place}: {there:?}");
    }
}

#[test]
fn limits_are_options_and_variables() {
    let Some(bench) = Bench::new() else { return };
    let wrong = bench.trace("", &["--plugin-time-limit", "-1"]);
    assert_eq!(wrong.code, Some(2), "{wrong:?}");
    assert!(wrong.complaints.contains("expected seconds, 0 for no limit"), "{wrong:?}");
    let with = |deed: &str, name: &str, value: &str| {
        let mut command = bench.command(deed, &["rtrace", "-h", "s.rad"]);
        command.env(name, value);
        finish(command, RAYS)
    };
    let ended = with("eval-sleep", "RADSIGHT_PLUGIN_TIME_LIMIT", ".2");
    assert_fault(&ended, "variable", "eval_pdf", "it has not returned for 0.");
    let ended = with("eval-kill", "RADSIGHT_ISOLATE_PLUGINS", "1");
    assert_fault(&ended, "variable", IN_SELF_CHECK, "its process was ended by signal 9");
    let ended = with("", "RADSIGHT_PLUGIN_MEMORY_LIMIT", "much");
    assert_eq!(ended.code, Some(2), "{ended:?}");
    let said = "the variable RADSIGHT_PLUGIN_MEMORY_LIMIT is \"much\", expected a number of MB, 0 for no limit";
    assert!(ended.complaints.contains(said), "{ended:?}");
    for words in [&["plugin", "list"][..], &["check", "s.rad"], &["plugin", "check", "evil"]] {
        let mut command = bench.command("", words);
        command.env("RADSIGHT_PLUGIN_TIME_LIMIT", "foo");
        let ended = finish(command, "");
        assert_eq!(ended.code, Some(2), "{words:?}: {ended:?}");
        let said = "the variable RADSIGHT_PLUGIN_TIME_LIMIT is \"foo\", expected seconds, 0 for no limit";
        assert!(ended.complaints.contains(said), "{words:?}: {ended:?}");
    }
}

#[test]
fn a_library_file_that_is_not_there_is_named_so() {
    let Some(bench) = Bench::new() else { return };
    for name in ["/nonexist.so", "./libevil", "evil.so"] {
        let ended = bench.run("", &["plugin", "check", name]);
        assert_eq!(ended.code, Some(1), "{ended:?}");
        let said = format!("cannot find plugin library \"{name}\": there is no such file");
        assert!(ended.complaints.contains(&said), "{ended:?}");
    }
    let folder = bench.run("", &["plugin", "check", "."]);
    assert!(folder.complaints.contains("\".\" is a folder, expected a plugin library"), "{folder:?}");
}

#[test]
fn an_isolated_plugin_is_refused_as_any_other() {
    let Some(bench) = Bench::new() else { return };
    let folder: &Path = bench.folder.path();
    assert!(plugins::c_plugin(folder, "lambert.c", "chalk", &[]).is_some());
    for material in
        ["2 chalk lambert 0 3 .125 .5 .5", "2 chalk lambert 0 3 .5 .5 1.5", "2 chalk velvet 0 0", "2 no m 0 0"]
    {
        bench.write("w.rad", &scene(material));
        let [here, there] = [&[][..], &["--isolate-plugins"]]
            .map(|options| bench.run("", &[&["rtrace", "-h"], options, &["w.rad"]].concat()));
        assert_eq!(here.code, Some(1), "{here:?}");
        assert_eq!((there.code, &there.complaints), (Some(1), &here.complaints), "{material}");
    }
    bench.assert_nothing_is_left("refusals");
}
