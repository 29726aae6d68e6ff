//! How this program is started again, to run a plugin in a process of its own.

use std::path::PathBuf;
use std::process::Command;

/// How to start a child.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChildCommand {
    /// The program: this one, as a rule.
    pub program: PathBuf,
    /// Its arguments: the hidden command that leads to [`crate::check::child_main`] or
    /// [`crate::isolate::child_main`].
    pub arguments: Vec<String>,
}

impl ChildCommand {
    /// This program with these arguments; the one on the path if its own file is not known.
    #[must_use]
    pub fn this_program(arguments: &[&str]) -> ChildCommand {
        let arguments = arguments.iter().map(|&word| word.to_owned()).collect();
        ChildCommand { program: own_file().unwrap_or_else(|_| PathBuf::from("radsight")), arguments }
    }

    /// A command that leads to the child, in a process group of its own.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(&self.arguments);
        set_apart(&mut command);
        command
    }
}

/// The name that decides what the program is must not be that of a link; signals of the terminal go
/// to the parent alone.
pub(crate) fn set_apart(command: &mut Command) {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        command.arg0("radsight").process_group(0);
    }
    #[cfg(not(unix))]
    let _ = command;
}

/// The file of this program. On Linux that is what runs, even if the file was replaced meanwhile.
pub(crate) fn own_file() -> std::io::Result<PathBuf> {
    let running = PathBuf::from("/proc/self/exe");
    if cfg!(target_os = "linux") && running.exists() { Ok(running) } else { std::env::current_exe() }
}
