//! `radsight install-links`: links by whose name the program becomes one of Radiance's.

use crate::args::InstallLinks;
use crate::commands::radiance_programs;
use crate::failure::{Failure, Outcome, reason};
use crate::output::write_standard_output;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(arguments: &InstallLinks) -> Outcome {
    let folder = Path::new(&arguments.folder);
    let fault = |what: &Path, error: &std::io::Error| {
        Failure::fault(format!("cannot make \"{}\": {}", what.display(), reason(error)))
    };
    std::fs::create_dir_all(folder).map_err(|error| fault(folder, &error))?;
    let program = std::env::current_exe().map_err(|error| fault(folder, &error))?;
    for name in radiance_programs() {
        let link = folder.join(name);
        match std::fs::symlink_metadata(&link) {
            Ok(found) if found.file_type().is_symlink() => {
                std::fs::remove_file(&link).map_err(|error| fault(&link, &error))?;
            }
            Ok(_) => return Err(Failure::input(format!("\"{}\" exists and is no link", link.display()))),
            Err(_) => {}
        }
        make_link(&program, &link).map_err(|error| fault(&link, &error))?;
        write_standard_output(format!("{}\n", link.display()).as_bytes())?;
    }
    Ok(())
}

#[cfg(unix)]
fn make_link(program: &Path, link: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(program, link)
}

#[cfg(not(unix))]
fn make_link(program: &Path, link: &Path) -> std::io::Result<()> {
    std::fs::copy(program, link.with_extension("exe")).map(|_| ())
}
