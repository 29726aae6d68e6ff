//! The permissions of input files: the single gate before commands, libraries and output files.
//!
//! A scene, a receiver, a project or an option file may request all three. [`Trust`] is created in
//! `main` and grows only by options of the command line: [`Trust::take`] refuses to grow while the
//! current word comes from a file. Only [`Trust`] creates a [`CommandPermit`], and [`shell`] and
//! [`program`] start nothing without one. A name that a file gives to an output becomes an
//! [`OutputName`] only in [`Trust::output`] and [`Trust::output_of_file`]. `docs/security.md` has
//! the rules.

mod existing;
mod outputs;

pub(crate) use existing::{Existing, PROJECT};
pub(crate) use outputs::{OutputName, Refusal};

use crate::failure::Failure;
use radsight_parse::BrdfReplacement;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// This program with words of a file, and the same permissions.
pub(crate) fn own_program(trust: &Trust) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(trust.words_for_file());
    Ok(command)
}

/// Marks all words after the program's name as those of a file. Permission options before it apply.
pub(crate) const WORDS_OF_FILE: &str = "--words-of-file";

/// The origin of the words of a command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The user on the command line.
    CommandLine,
    /// The author of a file.
    #[default]
    File,
}

/// The permissions that the command line gives to files. The default permits nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trust {
    /// The origin of the words of this process.
    process: Origin,
    /// The origin of the current word.
    word: Origin,
    grants: Grants,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Grants {
    /// `--allow-commands`
    commands: Commands,
    /// `--allow-plugins`: libraries beside the scene are loaded.
    plugins_of_scenes: bool,
    /// `--plugin-path`
    plugin_folders: Vec<PathBuf>,
    /// `--brdf`
    replacements: Vec<String>,
    /// `--allow-outputs`
    all_outputs: bool,
    /// `--allow-output`: files that the calling program has checked.
    outputs: Vec<String>,
    /// Folders of files on the command line that may name outputs beside them.
    folders: Vec<PathBuf>,
    /// `--project`: the project of `rad`, or the receiver, for which the work is done.
    project: Option<String>,
}

/// Whether commands named in files may run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Commands {
    #[default]
    Refused,
    Allowed(CommandPermit),
}

/// The permission to start a process. Only [`Trust`] creates one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CommandPermit(());

/// A shell that runs a command.
pub(crate) fn shell(_permit: CommandPermit, command: &str) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", command]);
    shell
}

/// Another program, without a shell.
pub(crate) fn program(_permit: CommandPermit, name: &OsStr) -> Command {
    Command::new(name)
}

impl Trust {
    /// The permissions of this process before its program parses its words, and the words for the
    /// program. After [`WORDS_OF_FILE`] come words of a file: only options before it change
    /// permissions.
    pub(crate) fn of_process(words: Vec<String>) -> Result<(Trust, Vec<String>), Failure> {
        let own = Trust { process: Origin::CommandLine, word: Origin::CommandLine, ..Trust::default() };
        let mut given = own.clone();
        let mut at = 1;
        while let Some(rest) = words.get(at..).filter(|rest| !rest.is_empty()) {
            if rest[0] == WORDS_OF_FILE {
                let meant = words[..1].iter().chain(&rest[1..]).cloned().collect();
                return Ok((given.for_file(), meant));
            }
            match given.take(rest)? {
                0 => break,
                used => at += used,
            }
        }
        Ok((own, words))
    }

    /// The same permissions for words of a file.
    pub(crate) fn for_file(&self) -> Trust {
        Trust { process: Origin::File, word: Origin::File, grants: self.grants.clone() }
    }

    /// Lets a file on the command line name new files in its own folder, which need not be below
    /// the current one.
    pub(crate) fn allow_outputs_beside(&mut self, file: &str) {
        let folder = Path::new(file).parent().map(|folder| match folder.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => folder.to_owned(),
        });
        if let Some(folder) = folder.and_then(|folder| fs::canonicalize(folder).ok()) {
            add(&mut self.grants.folders, folder);
        }
    }

    /// The options that give another process of radsight the same permissions, and mark the words
    /// after them as those of a file.
    pub(crate) fn words_for_file(&self) -> Vec<String> {
        let Grants {
            commands,
            plugins_of_scenes,
            plugin_folders,
            replacements,
            all_outputs,
            outputs,
            folders: _,
            project,
        } = &self.grants;
        let mut words = Vec::new();
        let mut flag = |name: &str, is_set: bool| words.extend(is_set.then(|| name.to_owned()));
        flag("--allow-commands", *commands != Commands::Refused);
        flag("--allow-plugins", *plugins_of_scenes);
        flag("--allow-outputs", *all_outputs);
        let mut values = |name: &str, values: Vec<String>| {
            words.extend(values.into_iter().flat_map(|value| [name.to_owned(), value]));
        };
        values("--plugin-path", plugin_folders.iter().map(|folder| folder.display().to_string()).collect());
        values("--brdf", replacements.clone());
        values("--allow-output", outputs.clone());
        values("--project", project.iter().cloned().collect());
        words.push(WORDS_OF_FILE.to_owned());
        words
    }

    /// Sets the origin of the next word. A process with words of a file has no others.
    pub(crate) fn reads_word_of(&mut self, origin: Origin) {
        self.word = if self.process == Origin::File { Origin::File } else { origin };
    }

    /// The origin of the current word.
    pub(crate) fn word_origin(&self) -> Origin {
        self.word
    }

    /// The origin of the words of this process.
    pub(crate) fn origin(&self) -> Origin {
        self.process
    }

    /// Parses one permission option at the front; returns the number of words it used, 0 for
    /// another option.
    pub(crate) fn take(&mut self, words: &[String]) -> Result<usize, Failure> {
        let word = words[0].as_str();
        let mut grants = self.grants.clone();
        let value = |expected: &str| {
            words.get(1).cloned().ok_or_else(|| {
                Failure::usage(format!("option \"{word}\" ends the command line, expected {expected} after it"))
            })
        };
        let used = match word {
            "--allow-commands" => {
                grants.commands = Commands::Allowed(CommandPermit(()));
                1
            }
            "--allow-plugins" => {
                grants.plugins_of_scenes = true;
                1
            }
            "--allow-outputs" => {
                grants.all_outputs = true;
                1
            }
            "--plugin-path" => {
                add(&mut grants.plugin_folders, PathBuf::from(value("a folder")?));
                2
            }
            "--brdf" => {
                add(&mut grants.replacements, value("MATERIAL=LIBRARY:MODEL(number,…)")?);
                2
            }
            "--allow-output" => {
                add(&mut grants.outputs, value("a file")?);
                2
            }
            "--project" => {
                grants.project = Some(value("a file")?);
                2
            }
            _ => return Ok(0),
        };
        if self.word == Origin::File && grants != self.grants {
            return Err(Failure::input(format!(
                "option \"{}\" comes from a file and is refused\nhint: only the command line may give it",
                words[..used].join(" ")
            )));
        }
        self.grants = grants;
        Ok(used)
    }

    /// Permits one output file, which [`Trust::output_of_file`] has checked.
    pub(crate) fn allow_output(&mut self, name: String) {
        add(&mut self.grants.outputs, name);
    }

    /// Sets the project or receiver for which the work is done, for output headers.
    pub(crate) fn work_for(&mut self, project: &str) {
        self.grants.project = Some(project.to_owned());
    }

    /// The project for which this is done.
    pub(crate) fn project(&self) -> Option<&str> {
        self.grants.project.as_deref()
    }

    /// Whether commands named in files may run.
    pub(crate) fn commands(&self) -> Commands {
        self.grants.commands
    }

    /// Whether commands named in files run.
    pub(crate) fn runs_commands(&self) -> bool {
        self.grants.commands != Commands::Refused
    }

    /// Whether commands named on the command line may run, as after `!` in place of a file.
    pub(crate) fn own_commands(&self) -> Commands {
        match self.process {
            Origin::CommandLine => Commands::Allowed(CommandPermit(())),
            Origin::File => self.grants.commands,
        }
    }

    /// Checks a word that may name a command after `!`, by its origin.
    pub(crate) fn check_command(&self, word: &str) -> Result<(), Failure> {
        match (self.word, self.grants.commands) {
            (Origin::File, Commands::Refused) if word.starts_with('!') => Err(refused_command(&word[1..])),
            _ => Ok(()),
        }
    }

    /// Whether libraries beside the scene are loaded.
    pub(crate) fn allows_plugins_of_scenes(&self) -> bool {
        self.grants.plugins_of_scenes
    }

    /// Whether the command line names this library.
    pub(crate) fn names_library(&self, library: &str) -> bool {
        let replacements = self.grants.replacements.iter().filter_map(|text| BrdfReplacement::parse(text).ok());
        replacements.into_iter().any(|replacement| replacement.library == library)
    }

    /// Whether some library beside the scene may be loaded: all of them, or named ones.
    pub(crate) fn may_load_beside_scenes(&self) -> bool {
        self.grants.plugins_of_scenes || !self.grants.replacements.is_empty()
    }

    /// The folders of `--plugin-path`.
    pub(crate) fn plugin_folders(&self) -> &[PathBuf] {
        &self.grants.plugin_folders
    }

    /// The values of `--brdf`.
    pub(crate) fn replacements(&self) -> &[String] {
        &self.grants.replacements
    }
}

impl Commands {
    /// The permission; an error names the command.
    pub(crate) fn permit(self, command: &str) -> Result<CommandPermit, Failure> {
        match self {
            Commands::Allowed(permit) => Ok(permit),
            Commands::Refused => Err(refused_command(command)),
        }
    }
}

fn refused_command(command: &str) -> Failure {
    Failure::input(format!(
        "refused to run \"{command}\", which comes from a file\nhint: --allow-commands lets input files run commands"
    ))
}

fn add<T: PartialEq>(list: &mut Vec<T>, new: T) {
    if !list.contains(&new) {
        list.push(new);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        text.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn words_of_a_file_cannot_widen_what_is_allowed() {
        let (mut trust, _) = Trust::of_process(words("radsight rpict")).unwrap();
        trust.reads_word_of(Origin::File);
        for option in ["--allow-commands", "--allow-plugins", "--allow-outputs", "--plugin-path x", "--brdf a=b:c()"] {
            assert!(trust.take(&words(option)).is_err(), "{option}");
        }
        assert_eq!((trust.commands(), trust.plugin_folders().len()), (Commands::Refused, 0));
        trust.reads_word_of(Origin::CommandLine);
        assert_eq!(trust.take(&words("--plugin-path x y")).unwrap(), 2);
        trust.reads_word_of(Origin::File);
        assert_eq!(trust.take(&words("--plugin-path x")).unwrap(), 2, "the command line said so before");
    }

    #[test]
    fn options_count_before_the_words_of_a_file_and_not_behind() {
        let all = words("radsight --allow-outputs --words-of-file rpict --allow-commands a.rad");
        let (mut trust, rest) = Trust::of_process(all).unwrap();
        assert_eq!(rest, words("radsight rpict --allow-commands a.rad"));
        trust.reads_word_of(Origin::CommandLine);
        assert!(trust.take(&rest[2..]).is_err());
        assert!(trust.own_commands() == Commands::Refused && trust.output("/tmp/x", Existing::Kept).is_ok());
        let (again, _) = Trust::of_process([words("radsight"), trust.words_for_file()].concat()).unwrap();
        assert_eq!(again.grants, trust.grants);
    }

    #[test]
    fn options_without_that_word_are_left_to_the_program() {
        let all = words("rpict --allow-commands --words --words-of-file a.rad");
        let (trust, rest) = Trust::of_process(all.clone()).unwrap();
        assert_eq!((trust.commands(), rest), (Commands::Refused, all));
    }

    #[test]
    fn nothing_is_allowed_by_default() {
        let trust = Trust::default();
        assert!(trust.own_commands().permit("true").is_err() && trust.output("../x", Existing::Kept).is_err());
    }
}
