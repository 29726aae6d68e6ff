//! Names of output files that come from files.

use super::{Commands, Existing, Origin, Trust};
use crate::failure::{Failure, reason};
use radsight_diag::{Diagnostic, Span};
use radsight_output::folder_of;
use std::fs;
use std::io::ErrorKind;
use std::ops::Deref;
use std::path::{Component, Path, PathBuf};

const HINT: &str =
    "--allow-outputs lets input files name any output; by default only new files below the current folder";

const COMMAND_HINT: &str = "--allow-commands lets input files run commands";

/// The null device.
const NOWHERE: &str = "/dev/null";

/// Characters with a meaning in a shell.
const SHELL_SIGNS: [char; 13] = ['`', '$', ';', '|', '&', '<', '>', '"', '\'', '\\', '*', '?', '#'];

/// The name of an output file. [`Trust`] creates it from a name on the command line or in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct OutputName(String);

impl OutputName {
    /// The names that programs take for standard output.
    pub(crate) fn standard_output() -> OutputName {
        OutputName("-".to_owned())
    }

    /// The name with a number in place of its pattern.
    pub(crate) fn numbered(&self, number: impl Fn(&str) -> String) -> OutputName {
        OutputName(number(&self.0))
    }
}

impl Deref for OutputName {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

/// Why an output named by an input file is not written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    name: String,
    why: String,
    hint: &'static str,
}

impl Refusal {
    fn message(&self) -> String {
        format!("\"{}\" comes from a file and is not written: {}", self.name, self.why)
    }

    /// The diagnostic at the span that names the output.
    pub(crate) fn at(&self, span: Span) -> Diagnostic {
        Diagnostic::error(self.message()).at(span).hint(self.hint)
    }
}

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Failure {
        Failure::input(format!("{}\nhint: {}", refusal.message(), refusal.hint))
    }
}

impl Trust {
    /// The output file named by the current word: any file if the user wrote the word.
    pub(crate) fn output(&self, name: &str, existing: Existing<'_>) -> Result<OutputName, Failure> {
        if self.word == Origin::CommandLine {
            return Ok(OutputName(name.to_owned()));
        }
        // The expanded names of a pattern are unknown here, and could exist.
        if name.contains('%') && !self.allows_output(name) {
            return Err(refused(name, "it is a pattern").into());
        }
        Ok(self.output_of_file(name, existing)?)
    }

    /// The name, or pattern of names, of files that must not exist: any name if the user wrote the
    /// word.
    pub(crate) fn new_output(&self, name: &str) -> Result<OutputName, Failure> {
        match self.word {
            Origin::CommandLine => Ok(OutputName(name.to_owned())),
            Origin::File => Ok(self.output_of_file(name, Existing::Kept)?),
        }
    }

    /// The output file named by a file: a new one below the current folder, or an existing one of a
    /// kind that may be replaced.
    pub(crate) fn output_of_file(&self, name: &str, existing: Existing<'_>) -> Result<OutputName, Refusal> {
        if self.allows_output(name) || name == NOWHERE {
            return Ok(OutputName(name.to_owned()));
        }
        let refused = |why: &str| refused(name, why);
        if !self.is_beside_its_file(Path::new(name)) {
            check_parts(name).map_err(refused)?;
            check_folder(Path::new(name)).map_err(|why| refused(&why))?;
        }
        match fs::symlink_metadata(name) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(OutputName(name.to_owned())),
            Err(error) => Err(refused(&reason(&error))),
            Ok(found) if found.is_symlink() => Err(refused("it is a symbolic link")),
            Ok(found) if found.is_dir() => Err(refused("it is a folder")),
            Ok(found) if !found.is_file() => Err(refused("it is a device or pipe")),
            Ok(_) => match existing.may_replace(Path::new(name)) {
                true => Ok(OutputName(name.to_owned())),
                false => Err(refused(&existing.why_kept())),
            },
        }
    }

    /// The output file named by the user, with a word of a file inserted.
    pub(crate) fn output_with_part(&self, name: &str, part: Option<&str>) -> Result<OutputName, Refusal> {
        part.map_or(Ok(()), |part| self.check_name_part(part))?;
        Ok(OutputName(name.to_owned()))
    }

    /// The refusal of an output that is a command.
    pub(crate) fn refused_output_command(name: &str) -> Refusal {
        Refusal { hint: COMMAND_HINT, ..refused(name, "it is a command") }
    }

    /// Checks that a file not named by a file is at least not a symbolic link, where the folder may
    /// belong to somebody else.
    pub(crate) fn check_link(&self, name: &str) -> Result<(), Refusal> {
        let is_link = fs::symlink_metadata(name).is_ok_and(|found| found.is_symlink());
        if is_link && !self.allows_output(name) { Err(refused(name, "it is a symbolic link")) } else { Ok(()) }
    }

    /// Checks a word of a file that becomes a part of the user's output name.
    fn check_name_part(&self, part: &str) -> Result<(), Refusal> {
        let check = match part.contains('/') {
            true => Err("it names a folder"),
            false => check_parts(part),
        };
        if self.grants.all_outputs { Ok(()) } else { check.map_err(|why| refused(part, why)) }
    }

    /// Checks a word of a file that becomes a part of the user's command.
    pub(crate) fn check_command_part(&self, part: &str) -> Result<(), Failure> {
        let is_plain = !part.is_empty()
            && !part.starts_with('-')
            && part.chars().all(|c| c.is_alphanumeric() || "_-.,+:@=".contains(c));
        match (is_plain, self.commands()) {
            (false, Commands::Refused) => Err(Failure::input(format!(
                "\"{part}\" comes from a file and is not put into a command: a shell could read more than a name in it\n\
                 hint: --allow-commands lets input files run commands"
            ))),
            _ => Ok(()),
        }
    }

    /// Checks an option that permits overwriting, by its origin.
    pub(crate) fn check_overwriting(&self, option: &str) -> Result<(), Failure> {
        if self.word == Origin::CommandLine || self.grants.all_outputs {
            return Ok(());
        }
        Err(Failure::input(format!(
            "option \"{option}\" comes from a file and is refused\nhint: the command line may give it, or --allow-outputs"
        )))
    }

    /// Whether a file is in the folder of a command-line file that may name outputs there.
    fn is_beside_its_file(&self, path: &Path) -> bool {
        let name = path.file_name().and_then(|name| name.to_str());
        let folder = path.parent().filter(|_| path.is_absolute()).and_then(|folder| fs::canonicalize(folder).ok());
        // `..` as the last part is not a name.
        name.is_some_and(|name| check_parts(name).is_ok())
            && folder.is_some_and(|folder| self.grants.folders.contains(&folder))
    }

    /// Whether the command line permits this file.
    fn allows_output(&self, name: &str) -> bool {
        self.grants.all_outputs || self.grants.outputs.iter().any(|known| known == name)
    }
}

fn refused(name: &str, why: &str) -> Refusal {
    Refusal { name: name.to_owned(), why: why.to_owned(), hint: HINT }
}

/// Whether a name leads down from the current folder, by folders and a file that are not hidden and
/// do not look like an option.
fn check_parts(name: &str) -> Result<(), &'static str> {
    if name.is_empty() || name.contains(char::is_control) {
        return Err("it is not a file name");
    }
    if name.starts_with(['!', '|']) {
        return Err("it is a command");
    }
    // Scripts may process all files of a folder.
    if name.contains(SHELL_SIGNS) {
        return Err("it has characters with a meaning in a shell");
    }
    for part in Path::new(name).components() {
        match part {
            Component::CurDir => {}
            Component::Normal(part) => {
                let part = part.to_str().ok_or("it is not a file name")?;
                if part.starts_with('.') {
                    return Err("it is hidden");
                }
                if part.starts_with('-') {
                    return Err("it looks like an option");
                }
            }
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                return Err("it is not below the current folder");
            }
        }
    }
    Ok(())
}

/// Whether the file's folder lies below the current one after following symbolic links.
fn check_folder(path: &Path) -> Result<(), String> {
    let real = |path: &Path| -> Result<PathBuf, String> {
        fs::canonicalize(path).map_err(|error| format!("folder \"{}\": {}", path.display(), reason(&error)))
    };
    let (folder, current) = (real(folder_of(path))?, real(Path::new("."))?);
    let below = folder.strip_prefix(&current).map_err(|_| "a symbolic link leads out of the current folder")?;
    // A link may lead to a hidden folder.
    let is_hidden = below.components().any(|part| part.as_os_str().to_string_lossy().starts_with('.'));
    if is_hidden { Err("it is hidden".to_owned()) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_elsewhere_are_refused() {
        for (name, why) in [
            ("", "it is not a file name"),
            ("a\nb", "it is not a file name"),
            ("!touch x", "it is a command"),
            ("|touch x", "it is a command"),
            ("$(touch x)", "it has characters with a meaning in a shell"),
            ("a;b", "it has characters with a meaning in a shell"),
            ("../x", "it is not below the current folder"),
            ("src/../x", "it is not below the current folder"),
            ("/tmp/x", "it is not below the current folder"),
            ("/dev/stdout", "it is not below the current folder"),
            (".bashrc", "it is hidden"),
            ("a/.git/hooks", "it is hidden"),
            ("-rf", "it looks like an option"),
            ("-", "it looks like an option"),
            ("src", "it is a folder"),
            ("no_such_folder/x", "folder \"no_such_folder\": no such file or directory"),
            ("Cargo.toml", "it exists"),
        ] {
            let refusal = Trust::default().output_of_file(name, Existing::Kept).unwrap_err();
            assert_eq!(refusal.why, why, "{name}");
        }
        for name in ["new.mtx", "./new.mtx", "src/new.mtx", "/dev/null"] {
            assert_eq!(Trust::default().output_of_file(name, Existing::Kept).as_deref(), Ok(name));
        }
    }

    #[test]
    fn a_file_names_new_ones_in_its_own_folder_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        fs::write(at("precious"), "years of work").unwrap();
        fs::create_dir(at("inner")).unwrap();
        let mut trust = Trust::default();
        assert!(trust.output_of_file(&at("new.mtx"), Existing::Kept).is_err());
        trust.allow_outputs_beside(&at("receiver.rad"));
        assert_eq!(trust.output_of_file(&at("new.mtx"), Existing::Kept).as_deref(), Ok(at("new.mtx").as_str()));
        for name in ["precious", ".hidden", "-rf", "a;b", "inner/new.mtx", "../new.mtx", "inner/../../x"] {
            assert!(trust.output_of_file(&at(name), Existing::Kept).is_err(), "{name}");
        }
    }

    #[test]
    fn patterns_of_files_are_refused() {
        assert!(Trust::default().output("frame%04d.hdr", Existing::Kept).is_err());
    }

    #[test]
    fn names_of_files_are_no_more_than_words_of_commands() {
        let trust = Trust::default();
        assert!(trust.check_command_part("glass_2.1").is_ok());
        for part in ["$(id)", "a b", "", "a;b", "../x/y", "-rf"] {
            assert!(trust.check_command_part(part).is_err() && trust.check_name_part(&format!("{part}/x")).is_err());
        }
    }
}
