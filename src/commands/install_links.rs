//! `radsight install-links`: links with the names of Radiance's programs, with manual pages and
//! completions.

use crate::args::{InstallLinks, Program};
use crate::failure::{Failure, Outcome, reason};
use crate::output::{replace_file, write_standard_output};
use clap::CommandFactory;
use radsight_options::{Shell, manual_page, manual_page_file, programs};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Each of our pages and completions contains this word; a file without it is not ours.
const MARK: &str = "radsight";

/// Runs the command.
pub(crate) fn run(arguments: &InstallLinks) -> Outcome {
    let folder = Path::new(&arguments.folder);
    make_folder(folder)?;
    let program = std::env::current_exe().map_err(|error| fault(folder, &error))?;
    for linked in programs() {
        let link = folder.join(linked.name);
        match fs::symlink_metadata(&link) {
            Ok(found) if found.file_type().is_symlink() => {
                fs::remove_file(&link).map_err(|error| fault(&link, &error))?;
            }
            Ok(_) => return Err(Failure::input(format!("\"{}\" exists and is not a link", link.display()))),
            Err(_) => {}
        }
        make_link(&program, &link).map_err(|error| fault(&link, &error))?;
        tell(&link)?;
    }
    if arguments.only_links {
        return Ok(());
    }
    let share = arguments.share.as_ref().map_or_else(|| folder.join("share"), PathBuf::from);
    for linked in programs() {
        write_page(&share.join("man").join(manual_page_file(linked.name)), manual_page(linked).as_bytes())?;
        for shell in Shell::ALL {
            write_page(&share.join(shell.file(linked.name)), shell.completion(linked).as_bytes())?;
        }
    }
    write_own_pages(&share)
}

/// The manual pages of `radsight` and its commands, and its completions.
fn write_own_pages(share: &Path) -> Outcome {
    let mut command = Program::command();
    command.build();
    let commands = command.get_subcommands().filter(|command| command.get_name() != "help");
    for command in std::iter::once(&command).chain(commands) {
        let name = command.get_display_name().unwrap_or(command.get_name()).to_owned();
        let path = share.join("man").join(manual_page_file(&name));
        let mut page = Vec::new();
        clap_mangen::Man::new(command.clone()).render(&mut page).map_err(|error| fault(&path, &error))?;
        write_page(&path, &page)?;
    }
    for shell in Shell::ALL {
        let generator = match shell {
            Shell::Bash => clap_complete::Shell::Bash,
            Shell::Zsh => clap_complete::Shell::Zsh,
            Shell::Fish => clap_complete::Shell::Fish,
        };
        let mut completion = Vec::new();
        clap_complete::generate(generator, &mut Program::command(), MARK, &mut completion);
        write_page(&share.join(shell.file(MARK)), &completion)?;
    }
    Ok(())
}

/// Writes a page, replacing an older one of ours.
fn write_page(path: &Path, bytes: &[u8]) -> Outcome {
    if let Some(folder) = path.parent() {
        make_folder(folder)?;
    }
    if fs::read(path).is_ok_and(|old| !old.windows(MARK.len()).any(|word| word == MARK.as_bytes())) {
        return Err(Failure::input(format!(
            "\"{}\" exists and was not written by radsight\nhint: --share names another folder, --only-links omits the pages",
            path.display()
        )));
    }
    replace_file(&path.display().to_string(), bytes)?;
    tell(path)
}

fn make_folder(folder: &Path) -> Outcome {
    fs::create_dir_all(folder).map_err(|error| fault(folder, &error))
}

fn fault(what: &Path, error: &io::Error) -> Failure {
    Failure::fault(format!("cannot make \"{}\": {}", what.display(), reason(error)))
}

fn tell(made: &Path) -> Outcome {
    write_standard_output(format!("{}\n", made.display()).as_bytes())
}

#[cfg(unix)]
fn make_link(program: &Path, link: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(program, link)
}

#[cfg(not(unix))]
fn make_link(program: &Path, link: &Path) -> io::Result<()> {
    fs::copy(program, link.with_extension("exe")).map(|_| ())
}
