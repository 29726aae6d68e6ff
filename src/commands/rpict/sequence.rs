//! Sequences of frames (`-S`): views on standard input, a picture for each.

use super::options::Options;
use crate::failure::{Failure, reason};
use radsight_picture::{View, ViewOptions};
use std::io::{self, BufRead};
use std::path::Path;

/// The views of the frames.
pub(super) struct Sequence<'o> {
    options: &'o Options,
    number: i64,
    view: ViewOptions,
    before: Option<ViewOptions>,
}

impl<'o> Sequence<'o> {
    /// Starts a sequence. With `-r N` the frames before N are skipped.
    pub(super) fn new(options: &'o Options) -> Result<Sequence<'o>, Failure> {
        if options.scenes.iter().any(|scene| scene == "-") {
            return Err(Failure::usage("rpict: option \"-S\" reads views from standard input, expected named scenes"));
        }
        let first = options.first_frame;
        let mut sequence = Sequence { options, number: first - 1, view: options.view, before: None };
        if let Some(frame) = options.recovered_frame() {
            if frame < first {
                return Err(Failure::usage(format!("rpict: recover frame {frame} is before start frame {first}")));
            }
            if options.output.is_none() {
                return Err(Failure::usage("rpict: recovering a frame needs an output name (-o)"));
            }
            for skipped in first..frame {
                if sequence.next_view()?.is_none() {
                    return Err(Failure::input(format!("rpict: the views end before frame {}", skipped + 1)));
                }
            }
        }
        Ok(sequence)
    }

    /// View and number of the next frame whose picture is missing or to be recovered.
    pub(super) fn next(&mut self) -> Result<Option<(ViewOptions, i64)>, Failure> {
        while let Some(view) = self.next_view()? {
            let is_recovered = match self.options.recovered_frame() {
                Some(frame) => frame == self.number,
                None => self.options.recover.is_some(),
            };
            let is_there = |name: &str| !is_recovered && Path::new(&numbered(name, self.number)).exists();
            let alike = |name: &str| numbered(name, self.number) == *name;
            if self.options.output.as_deref().is_none_or(|name| alike(name) || !is_there(name)) {
                return Ok(Some((view, self.number)));
            }
        }
        Ok(None)
    }

    /// The view of the previous frame; `None` for the first.
    pub(super) fn view_before(&self) -> Option<View> {
        self.before.and_then(|view| View::new(view).ok())
    }

    fn next_view(&mut self) -> Result<Option<ViewOptions>, Failure> {
        let mut line = String::new();
        let mut view = self.view;
        loop {
            line.clear();
            let read = io::stdin().lock().read_line(&mut line);
            let read =
                read.map_err(|error| Failure::input(format!("cannot read standard input: {}", reason(&error))))?;
            if read == 0 {
                return Ok(None);
            }
            let wrong = |error| Failure::input(format!("rpict: standard input: {error}"));
            if ViewOptions::is_view_line(&line) && view.apply_line(&line).map_err(wrong)? > 0 {
                break;
            }
        }
        self.before = (self.number >= self.options.first_frame).then_some(self.view);
        self.view = view;
        self.number += 1;
        Ok(Some(view))
    }
}

/// A file name with the frame number in place of `%d`, or `%04d` for leading zeros.
pub(super) fn numbered(name: &str, number: i64) -> String {
    let Some((before, rest)) = name.split_once('%') else { return name.to_owned() };
    let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let (width, after) = rest.split_at(digits);
    let Some(after) = after.strip_prefix('d') else { return name.to_owned() };
    // File systems limit names to 255 bytes.
    let fill = width.parse::<usize>().unwrap_or(0).min(255);
    if width.starts_with('0') {
        format!("{before}{number:0fill$}{after}")
    } else {
        format!("{before}{number:fill$}{after}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_take_the_number_as_c_prints_it() {
        assert_eq!(numbered("frame%04d.hdr", 7), "frame0007.hdr");
        assert_eq!(numbered("f%d", 12), "f12");
        assert_eq!(numbered("f%3d", 12), "f 12");
        assert_eq!(numbered("100%", 12), "100%");
        assert_eq!(numbered("plain", 12), "plain");
    }
}
