//! Command that starts this program again, to run a plugin in a separate process.

use std::path::PathBuf;
use std::process::Command;

/// Command that starts a child.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChildCommand {
    /// The program, usually this one.
    pub program: PathBuf,
    /// Its arguments: the hidden command that calls [`crate::check::child_main`] or
    /// [`crate::isolate::child_main`].
    pub arguments: Vec<String>,
}

impl ChildCommand {
    /// This program with these arguments; if its file is unknown, the program of that name in the
    /// path.
    #[must_use]
    pub fn this_program(arguments: &[&str]) -> ChildCommand {
        let arguments = arguments.iter().map(|&word| word.to_owned()).collect();
        ChildCommand { program: own_file().unwrap_or_else(|_| PathBuf::from("radsight")), arguments }
    }

    /// The command, in a process group of its own.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.args(&self.arguments);
        set_apart(&mut command);
        command
    }
}

/// Prevents a link's name from selecting another program, and keeps the terminal's signals from the
/// child.
pub(crate) fn set_apart(command: &mut Command) {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        command.arg0("radsight").process_group(0);
    }
    #[cfg(not(unix))]
    let _ = command;
}

/// File of this program. On Linux it is the running file, even if it was replaced.
pub(crate) fn own_file() -> std::io::Result<PathBuf> {
    let running = PathBuf::from("/proc/self/exe");
    if cfg!(target_os = "linux") && running.exists() { Ok(running) } else { std::env::current_exe() }
}
