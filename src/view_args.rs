//! View options on the command line.

use crate::failure::Failure;
use crate::input::read_file;
use crate::render_args::number;
use radsight_picture::{Header, View, ViewOptions};

/// Parses one view option at the front, including `-vf`; returns the number of words it used, 0 for
/// another option.
pub(crate) fn take_one(words: &[String], view: &mut ViewOptions, origin: &mut ViewOrigin) -> Result<usize, Failure> {
    if words[0] == "-vf" {
        let path: String = number(words, "-vf", "a view file")?;
        read_view_file(&path, view, origin)?;
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
        Ok(used) => {
            if View::new(*view).is_ok() {
                *origin = ViewOrigin::default();
            }
            Ok(used)
        }
        Err(error) => Err(Failure::usage(format!("option \"{}\": {error}", words[0]))),
    }
}

/// Where an impossible view was read, unless on the command line.
#[derive(Clone, Debug, Default)]
pub(crate) struct ViewOrigin(Option<String>);

impl ViewOrigin {
    /// A whole input, such as a picture.
    pub(crate) fn input(name: String) -> ViewOrigin {
        ViewOrigin(Some(name))
    }
}

/// Applies a view file, or the view of a picture, to a view. The origin becomes the file if the view is impossible
/// because of it; options that follow may still change that.
fn read_view_file(path: &str, view: &mut ViewOptions, origin: &mut ViewOrigin) -> Result<(), Failure> {
    let bytes = read_file(path, "view file")?;
    let (before, file) = (*view, format!("view file \"{path}\""));
    let place = || match faulty_line(&bytes, before) {
        Some(number) => format!("{file}: line {number}"),
        None => file.clone(),
    };
    view.apply_file(&bytes).map_err(|error| Failure::input(format!("{}: {error}", place())))?;
    if View::new(*view).is_ok() {
        *origin = ViewOrigin::default();
    } else if View::new(before).is_ok() {
        *origin = ViewOrigin::input(place());
    }
    Ok(())
}

/// The line that makes the view of a file impossible, from 1.
fn faulty_line(bytes: &[u8], mut view: ViewOptions) -> Option<usize> {
    let mut faulty = None;
    for (number, line) in (1..).zip(Header::read_text(bytes).lines()) {
        let line = String::from_utf8_lossy(line);
        if !ViewOptions::is_view_line(&line) {
            continue;
        }
        if view.apply_line(&line).is_err() {
            return Some(number);
        }
        let is_possible = View::new(view).is_ok();
        faulty = if is_possible { None } else { faulty.or(Some(number)) };
    }
    faulty
}

/// Checks a view.
pub(crate) fn checked(view: ViewOptions, origin: &ViewOrigin) -> Result<View, Failure> {
    View::new(view).map_err(|error| match &origin.0 {
        Some(place) => Failure::input(format!("{place}: bad view: {error}")),
        None => Failure::usage(format!("bad view: {error}")),
    })
}
