//! View options on the command line.

use crate::failure::Failure;
use crate::input::read_file;
use crate::render_args::number;
use radsight_picture::{View, ViewOptions};

/// Parses one view option at the front, including `-vf`; returns the number of words it used, 0 for
/// another option.
pub(crate) fn take_one(words: &[String], view: &mut ViewOptions) -> Result<usize, Failure> {
    if words[0] == "-vf" {
        let path: String = number(words, "-vf", "a view file")?;
        read_view_file(&path, view)?;
        return Ok(2);
    }
    if !words[0].starts_with("-v") || words[0].starts_with("-ve") {
        return Ok(0);
    }
    match view.apply_option(words) {
        Ok(0) => {
            let expected = match words[0].as_str() {
                "-vp" | "-vd" | "-vu" => "three numbers after it",
                "-vh" | "-vv" | "-vo" | "-va" | "-vs" | "-vl" => "a number after it",
                _ => "one of -vt[vlhcas] -vp -vd -vu -vh -vv -vo -va -vs -vl -vf",
            };
            Err(Failure::usage(format!("view option \"{}\": expected {expected}", words[0])))
        }
        Ok(used) => Ok(used),
        Err(error) => Err(Failure::usage(format!("option \"{}\": {error}", words[0]))),
    }
}

/// Applies a view file, or the view of a picture, to a view.
pub(crate) fn read_view_file(path: &str, view: &mut ViewOptions) -> Result<(), Failure> {
    let bytes = read_file(path, "view file")?;
    view.apply_file(&bytes).map_err(|error| Failure::input(format!("view file \"{path}\": {error}")))
}

/// Checks a view.
pub(crate) fn checked(view: ViewOptions) -> Result<View, Failure> {
    View::new(view).map_err(|error| Failure::usage(format!("bad view: {error}")))
}
