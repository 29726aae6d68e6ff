//! `rad`: renders the pictures of a `.rif` file.

use crate::failure::{Failure, Outcome, reason, say};
use crate::input::{read, read_file, scene_inputs};
use crate::option_table::{options_of, parse_option, unknown_option};
use crate::output::{Output, write_file, write_standard_output};
use crate::render_args::number;
use crate::trust::{Existing, Origin, Refusal, Trust, own_program};
use crate::view_args::{self, ViewOrigin};
use radsight_diag::{SourceMap, Span};
use radsight_output::interrupt::{ActionGuard, at_signal};
use radsight_output::leftovers;
use radsight_parse::{Input, ReadOptions, cube};
use radsight_picture::{Unfinished, ViewOptions};
use radsight_rad_project::{Cube, Date, How, NamedBy, OutputFile, OutputKind, Project, Site, Step};
use radsight_scene_generators::shell_words::{Stage, split};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};

/// The parsed arguments.
#[derive(Debug, Default)]
struct Arguments {
    how: How,
    /// `-n`, and `-t`, which runs nothing, either.
    is_dry: bool,
    /// `-s`
    is_silent: bool,
    /// `-w`
    no_warnings: bool,
    /// `-e`
    explains: bool,
    threads: Option<usize>,
    file: String,
    assignments: Vec<String>,
    /// Permissions that the command line gives to files.
    trust: Trust,
}

/// Runs the program.
pub(crate) fn run(words: &[String], trust: &Trust) -> Outcome {
    let mut arguments = Arguments::read(words, trust)?;
    let text = read_file(&arguments.file, "file")?;
    let wrong = |error: radsight_rad_project::ProjectError| Failure::input(format!("rad: {error}"));
    let mut project = Project::read(&arguments.file, &String::from_utf8_lossy(&text)).map_err(wrong)?;
    for assignment in &arguments.assignments {
        if !project.assign(assignment).map_err(wrong)? {
            say(&format!("rad: bad variable assignment: {assignment} (ignored)\n"));
        }
    }
    for warning in project.check().map_err(wrong)? {
        if !arguments.no_warnings {
            say(&format!("rad: warning - {warning}\n"));
        }
    }
    let steps = project.steps(&arguments.how, &Disk { trust: arguments.trust.clone() }).map_err(wrong)?;
    if arguments.explains {
        write_standard_output(project.explained().as_bytes())?;
    }
    arguments.check_outputs(&steps, &text)?;
    steps.iter().try_for_each(|step| arguments.take(step))
}

impl Arguments {
    fn read(words: &[String], trust: &Trust) -> Result<Arguments, Failure> {
        let mut arguments = Arguments { trust: trust.clone(), ..Arguments::default() };
        let program = options_of("rad");
        let mut at = 0;
        while let Some(word) = words.get(at).filter(|word| word.starts_with('-')) {
            let used = arguments.trust.take(&words[at..])?;
            if used > 0 {
                at += used;
                continue;
            }
            parse_option(program, word)?;
            match word.as_str() {
                "-s" => arguments.is_silent = true,
                "-n" => arguments.is_dry = true,
                "-t" => arguments.how.touch_only = true,
                "-e" => arguments.explains = true,
                "-V" => arguments.how.show_views = true,
                "-w" => arguments.no_warnings = true,
                "-N" => {
                    let threads = number(&words[at..], word, "a number of threads")?;
                    arguments.is_dry = threads == 0;
                    arguments.threads = Some(threads).filter(|threads| *threads > 0);
                    at += 1;
                }
                "-v" => {
                    arguments.how.view = Some(number(&words[at..], word, "a view")?);
                    at += 1;
                }
                "-o" => {
                    return Err(Failure::usage("rad: option \"-o\": rvu, the interactive viewer, is not supported"));
                }
                _ => return Err(unknown_option(program, word)),
            }
            at += 1;
        }
        let mut rest = words[at..].iter().cloned();
        let missing = || Failure::usage(format!("rad: no file is given; usage: {}", program.synopsis));
        arguments.file = rest.next().ok_or_else(missing)?;
        arguments.assignments = rest.collect();
        Ok(arguments)
    }

    /// Checks all files that the project names before anything is done, and permits those to the
    /// programs that are run.
    fn check_outputs(&mut self, steps: &[Step], text: &[u8]) -> Outcome {
        let is_done = |step: &&Step| !self.is_dry || matches!(step, Step::WriteOptions(..));
        let mut trust = self.trust.clone();
        let project = self.file.strip_prefix("./").unwrap_or(&self.file);
        trust.work_for(project);
        for output in steps.iter().filter(is_done).flat_map(Step::outputs) {
            match output.named_by {
                NamedBy::File { line } => {
                    let checked = trust.output_of_file(&output.name, existing(output, project));
                    checked.map_err(|refusal| at_line(&refusal, &self.file, text, line))?;
                }
                NamedBy::CommandLine if trust.origin() == Origin::File => {
                    trust.output_of_file(&output.name, existing(output, project))?;
                }
                // The owner of the folder may have put a link there.
                NamedBy::CommandLine => trust.check_link(&output.name)?,
            }
            trust.allow_output(output.name.clone());
        }
        self.trust = trust;
        Ok(())
    }

    fn take(&self, step: &Step) -> Outcome {
        match step {
            Step::ShowView(options) => write_standard_output(format!("VIEW={}\n", whole_view(options)?).as_bytes()),
            Step::Run { .. } => self.run(step),
            Step::Touch(OutputFile { name, .. }) => {
                self.announce(&format!("touch {name}"))?;
                self.unless_dry(name, |name| File::options().append(true).open(name)?.set_modified(SystemTime::now()))
            }
            Step::Remove(OutputFile { name, .. }) => {
                self.announce(&format!("rm -f {name}"))?;
                self.unless_dry(name, |name| fs::remove_file(name))
            }
            Step::Rename(from, to) => {
                let (from, to) = (&from.name, &to.name);
                self.announce(&format!("mv {from} {to}"))?;
                self.unless_dry(from, |from| fs::rename(from, to))
            }
            // Real rad writes this file even in a dry run.
            Step::WriteOptions(file, text) => write_file(&file.name, text.as_bytes()),
        }
    }

    fn announce(&self, line: &str) -> Outcome {
        if self.is_silent { Ok(()) } else { write_standard_output(format!("\t{line}\n").as_bytes()) }
    }

    fn unless_dry(&self, name: &str, act: impl Fn(&str) -> std::io::Result<()>) -> Outcome {
        if self.is_dry {
            return Ok(());
        }
        act(name).map_err(|error| Failure::fault(format!("rad: \"{name}\": {}", reason(&error))))
    }

    fn run(&self, step: &Step) -> Outcome {
        let Step::Run { command, output, removed_on_failure, .. } = step else { return Ok(()) };
        let output = output.as_ref().map(|file| file.name.as_str());
        if self.is_dry {
            return self.announce(&step.command_line());
        }
        // The overture fills an ambient file, which radsight does not need.
        if output == Some("/dev/null") {
            return Ok(());
        }
        self.announce(&step.command_line())?;
        let words = words(command)?;
        let done = match Path::new(&words[0]).file_name().and_then(|name| name.to_str()) {
            Some("mkpmap") => {
                self.note("mkpmap is not run: radsight needs no photon maps");
                Ok(())
            }
            Some(name @ ("oconv" | "mkillum" | "rpict" | "pfilt")) => self.run_own(name, &words[1..], output),
            _ => Err(Failure::input(format!(
                "rad: program \"{}\" is not part of radsight, expected oconv, mkillum, rpict or pfilt",
                words[0]
            ))),
        };
        if done.is_err() {
            removed_on_failure.iter().for_each(|name| drop(fs::remove_file(name)));
        }
        done
    }

    fn note(&self, text: &str) {
        if !self.no_warnings {
            say(&format!("rad: note: {text}\n"));
        }
    }

    /// Runs another program of ours with words of the project, and a file for its output.
    fn run_own(&self, name: &str, words: &[String], output: Option<&str>) -> Outcome {
        let fault = |error: std::io::Error| Failure::fault(format!("rad: cannot run {name}: {}", reason(&error)));
        let mut command = own_program(&self.trust).map_err(fault)?;
        command.arg(name);
        if let (Some(threads), "rpict" | "mkillum") = (self.threads, name) {
            command.args(["-n", &threads.to_string()]);
        }
        // The output file of rpict survives an interruption.
        let own = output.filter(|_| name == "rpict").zip(words.split_last());
        match own {
            Some((path, (octree, options))) => {
                // The file is older than the octree, or has no row.
                if fs::symlink_metadata(path).is_ok_and(|found| found.is_file()) {
                    fs::remove_file(path).map_err(|error| Failure::write(&format!("\"{path}\""), &error))?;
                }
                command.args(options).args(["-o", path, octree]);
            }
            None => drop(command.args(words)),
        }
        let output = output.filter(|_| own.is_none()).map(Output::create).transpose()?;
        if let Some(file) = output.as_ref().and_then(Output::file) {
            command.stdout(file.try_clone().map_err(fault)?);
        }
        let mut child = command.stdin(Stdio::null()).spawn().map_err(fault)?;
        let ended = end_at_signal(&child);
        let status = child.wait().map_err(fault)?;
        drop(ended);
        if status.success() {
            return output.map_or(Ok(()), Output::commit);
        }
        // The program itself has reported its mistake.
        Err(Failure::input(format!("rad: {name} failed ({status})")))
    }
}

/// Ends a child program with this one, so that it saves its work.
#[cfg(unix)]
fn end_at_signal(child: &Child) -> Option<ActionGuard> {
    use nix::sys::signal::{Signal, kill};
    let process = nix::unistd::Pid::from_raw(i32::try_from(child.id()).ok()?);
    Some(at_signal(move || {
        let _ = kill(process, Signal::SIGTERM);
    }))
}

#[cfg(not(unix))]
fn end_at_signal(_child: &Child) -> Option<ActionGuard> {
    None
}

/// A refusal at a line of the project.
fn at_line(refusal: &Refusal, file: &str, text: &[u8], line: usize) -> Failure {
    let before: usize = text.split_inclusive(|byte| *byte == b'\n').take(line - 1).map(<[u8]>::len).sum();
    let found = text[before..].split(|byte| *byte == b'\n').next().unwrap_or_default();
    let start = before + (found.len() - found.trim_ascii_start().len());
    let end = start + found.trim_ascii().len();
    let mut sources = SourceMap::default();
    let source = sources.add(file, text.to_vec(), None);
    let span = Span { source, start: start as u32, end: end as u32 };
    Failure::diagnostics(&[refusal.at(span)], &sources)
}

/// The required kind of an existing file that the project names.
fn existing<'a>(output: &OutputFile, project: &'a str) -> Existing<'a> {
    match &output.kind {
        OutputKind::Octree => Existing::Octree,
        OutputKind::IllumScene => Existing::IllumScene,
        OutputKind::Picture => Existing::MadeBy(project),
        OutputKind::Distances => Existing::Distances,
        OutputKind::Options => Existing::Options,
        OutputKind::AmbientValues => Existing::AmbientValues,
        OutputKind::Messages => Existing::Messages,
        // Only its date is changed.
        OutputKind::PhotonMap => Existing::Replaced,
    }
}

/// The words of a command without pipes.
fn words(command: &str) -> Result<Vec<String>, Failure> {
    let wrong =
        || Failure::input(format!("rad: \"{command}\": expected a program and its arguments, without a shell's signs"));
    let script = split(command).map_err(|_| wrong())?;
    match &script.pipelines[..] {
        [pipeline] => match &pipeline.stages[..] {
            [Stage::Command(command)] if command.input.is_none() => {
                Ok(command.words.iter().map(|word| word.text.clone()).collect())
            }
            _ => Err(wrong()),
        },
        _ => Err(wrong()),
    }
}

/// All options of a view.
fn whole_view(options: &str) -> Result<String, Failure> {
    let words = words(&format!("view {options}"))?;
    let (mut view, mut origin) = (ViewOptions::default(), ViewOrigin::default());
    let mut at = 1;
    while at < words.len() {
        at += view_args::take_one(&words[at..], &mut view, &mut origin)?.max(1);
    }
    Ok(view_args::checked(view, &origin)?.options().to_full_string())
}

/// Suffix of unfinished pictures.
const UNFINISHED: &str = ".unf";

/// The last modification of an unfinished picture, or of the leftover of a killed run. One without
/// a row counts as none.
fn unfinished_date(name: &str) -> Date {
    let has_rows = |path: &PathBuf| {
        let bytes = fs::read(path).unwrap_or_default();
        Unfinished::read(&bytes).is_ok_and(|unfinished| unfinished.scanlines > 0)
    };
    let places = [PathBuf::from(name)].into_iter().chain(leftovers(Path::new(name)));
    places.filter(has_rows).map(|path| date(&path)).max().unwrap_or(0)
}

fn date(path: &Path) -> Date {
    let modified = fs::metadata(path).and_then(|found| found.modified());
    let since = modified.ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    since.map_or(0, |since| since.as_secs() as Date)
}

/// The files of the working folder.
struct Disk {
    trust: Trust,
}

impl Site for Disk {
    fn date(&self, name: &str) -> Date {
        match name.ends_with(UNFINISHED) {
            true => unfinished_date(name),
            false => date(Path::new(name)),
        }
    }

    fn cube(&self, scene: &[String]) -> Option<Cube> {
        let mut inputs = Vec::new();
        for name in scene {
            match name.starts_with('!') {
                true => inputs.push(Input::File(name.clone())),
                false => inputs.extend(scene_inputs(std::slice::from_ref(name), None, &self.trust.for_file()).ok()?),
            }
        }
        let cube = cube(&read(inputs, self.trust.commands(), &ReadOptions::default()).scene)?;
        Some(Cube { corner: cube.origin.to_array(), size: cube.size })
    }
}
