//! What the command line allows input files to cause: the one gate before commands, libraries and
//! files that are written.
//!
//! A scene, a receiver, a project or a file of options may ask for all three. [`Trust`] is made in
//! `main` and grows by the options of the command line alone: [`Trust::take`] refuses to grow while
//! the word in hand comes from a file. Nothing else makes a [`CommandPermit`], and [`shell`] and
//! [`program`] start nothing without one. A name that a file gives to an output becomes a name to
//! be written by [`Trust::output`] and [`Trust::output_of_file`] alone. `docs/security.md` has the
//! rules.

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

/// This program once more, with words that a file gives, and no more allowed than here.
pub(crate) fn own_program(trust: &Trust) -> io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(trust.words_for_file());
    Ok(command)
}

/// What makes all words after the program's name those of a file. Options of trust count before it.
pub(crate) const WORDS_OF_FILE: &str = "--words-of-file";

/// Who wrote the words of a command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The user, at the command line.
    CommandLine,
    /// Somebody else, in a file.
    #[default]
    File,
}

/// What the command line allows files to cause. As it is made by default it allows nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trust {
    /// Who wrote the words that this process was started with.
    process: Origin,
    /// Who wrote the word in hand.
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
    /// `--allow-output`: what a program that calls this one has looked at already.
    outputs: Vec<String>,
    /// Folders of files on the command line that may name outputs beside them.
    folders: Vec<PathBuf>,
    /// `--project`: the file of `rad` or the receiver for which something is made.
    project: Option<String>,
}

/// Whether commands that a file names may run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Commands {
    #[default]
    Refused,
    Allowed(CommandPermit),
}

/// The permission to start a process. Only [`Trust`] makes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CommandPermit(());

/// A shell with a command that it runs.
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
    /// What the words of this process allow before its program reads them, and the words that the
    /// program reads. A process that is told [`WORDS_OF_FILE`] has words of a file: then the
    /// options before that count, and none behind it.
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

    /// The same for words that a file holds.
    pub(crate) fn for_file(&self) -> Trust {
        Trust { process: Origin::File, word: Origin::File, grants: self.grants.clone() }
    }

    /// Lets a file on the command line name new files in its own folder, which need not be below the current one.
    pub(crate) fn allow_outputs_beside(&mut self, file: &str) {
        let folder = Path::new(file).parent().map(|folder| match folder.as_os_str().is_empty() {
            true => PathBuf::from("."),
            false => folder.to_owned(),
        });
        if let Some(folder) = folder.and_then(|folder| fs::canonicalize(folder).ok()) {
            add(&mut self.grants.folders, folder);
        }
    }

    /// The options that give another process of radsight the same trust, and say that the words
    /// after them are those of a file.
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

    /// Says who wrote the next word. A process whose words are those of a file has no others.
    pub(crate) fn reads_word_of(&mut self, origin: Origin) {
        self.word = if self.process == Origin::File { Origin::File } else { origin };
    }

    /// Who wrote the word in hand.
    pub(crate) fn word_origin(&self) -> Origin {
        self.word
    }

    /// Who wrote the words that this process was started with.
    pub(crate) fn origin(&self) -> Origin {
        self.process
    }

    /// Takes one option of trust from the front; gives how many words it used, 0 for something
    /// else.
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
                "option \"{}\" comes from a file and is not obeyed\nhint: only the command line itself may give it",
                words[..used].join(" ")
            )));
        }
        self.grants = grants;
        Ok(used)
    }

    /// Allows exactly one file to be written, which was looked at by [`Trust::output_of_file`].
    pub(crate) fn allow_output(&mut self, name: String) {
        add(&mut self.grants.outputs, name);
    }

    /// Says for which project or receiver the work is done, for the headers of what is made.
    pub(crate) fn work_for(&mut self, project: &str) {
        self.grants.project = Some(project.to_owned());
    }

    /// The project that this is done for.
    pub(crate) fn project(&self) -> Option<&str> {
        self.grants.project.as_deref()
    }

    /// Whether commands that files name may run.
    pub(crate) fn commands(&self) -> Commands {
        self.grants.commands
    }

    /// Whether commands that files name run.
    pub(crate) fn runs_commands(&self) -> bool {
        self.grants.commands != Commands::Refused
    }

    /// Whether commands may run that the words of the command line name, as after `!` in the place
    /// of a file.
    pub(crate) fn own_commands(&self) -> Commands {
        match self.process {
            Origin::CommandLine => Commands::Allowed(CommandPermit(())),
            Origin::File => self.grants.commands,
        }
    }

    /// Checks a word that may name a command after `!`, by who wrote it.
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

    /// Whether a library beside the scene may be one to load: all of them are, or some are named.
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
    /// The permission, for a command that is named in the error.
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
