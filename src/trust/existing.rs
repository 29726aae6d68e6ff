//! The existing files that may be replaced if a file names them: results of the same work.

use crate::ambient_file;
use crate::failure::MESSAGES_MARK;
use radsight_picture::Header;
use std::f64::consts::TAU;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Number of bytes by which a file's kind is recognised.
const BEGINNING: u64 = 1 << 16;

/// The kind of existing file that may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing<'a> {
    /// None: existing files are kept.
    Kept,
    /// Any regular file: the command line allows it (`-fo`).
    Replaced,
    /// An octree, which can be compiled again from its scene.
    Octree,
    /// A picture or matrix whose header names this project or receiver.
    MadeBy(&'a str),
    /// Distances of `rpict -z`.
    Distances,
    /// Rendering options, as `rad` writes them (`OPTFILE`).
    Options,
    /// Values of `-af`.
    AmbientValues,
    /// Messages of our programs, which are appended.
    Messages,
    /// Scene text from `mkillum`.
    IllumScene,
    /// A data file from `mkillum`.
    IllumData,
}

impl Existing<'_> {
    /// Whether this file may be replaced. An unreadable file may not.
    pub(super) fn may_replace(self, path: &Path) -> bool {
        match self {
            Existing::Kept => return false,
            Existing::Replaced => return true,
            _ => {}
        }
        let mut start = Vec::new();
        let read = File::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut start));
        // A file that was created and never written holds nothing to lose.
        read.is_ok() && (start.is_empty() || self.is_kind_of(&start))
    }

    fn is_kind_of(self, start: &[u8]) -> bool {
        match self {
            Existing::Kept => false,
            Existing::Replaced => true,
            Existing::Octree => has_format(start, "Radiance_octree"),
            Existing::MadeBy(project) => is_made_by(start, project),
            Existing::Distances => are_distances(start),
            Existing::Options => are_options(start),
            Existing::AmbientValues => has_format(start, ambient_file::FORMAT),
            Existing::Messages => are_messages(start),
            Existing::IllumScene => is_text(start) && lines(start).take(2).any(|line| line == "#@mkillum !"),
            Existing::IllumData => is_illum_data(start),
        }
    }

    pub(super) fn why_kept(self) -> String {
        let expected = match self {
            Existing::Kept | Existing::Replaced => return "it exists".to_owned(),
            Existing::Octree => "an octree".to_owned(),
            Existing::MadeBy(project) => format!("made by \"{project}\""),
            Existing::Distances => "distances of rpict -z".to_owned(),
            Existing::Options => "rendering options".to_owned(),
            Existing::AmbientValues => "ambient values".to_owned(),
            Existing::Messages => "messages of rpict".to_owned(),
            Existing::IllumScene => "scene text from mkillum".to_owned(),
            Existing::IllumData => "data from mkillum".to_owned(),
        };
        format!("it exists and is not {expected}")
    }
}

fn header(start: &[u8]) -> Option<Header> {
    start.starts_with(b"#?").then(|| Header::read(start).ok()).flatten().map(|(header, _)| header)
}

fn has_format(start: &[u8], format: &str) -> bool {
    header(start).is_some_and(|header| header.format().is_some_and(|found| found == format))
}

/// The header variable with the project or receiver for which a picture or matrix was made.
pub(crate) const PROJECT: &str = "RADPROJECT";

/// Whether the header names this project.
fn is_made_by(start: &[u8], project: &str) -> bool {
    let line = format!("{PROJECT}= {project}");
    header(start).is_some_and(|header| header.lines().any(|found| found == line.as_bytes()))
}

/// Whether bytes are distances in native single precision, which no text is.
fn are_distances(start: &[u8]) -> bool {
    let (numbers, rest) = start.as_chunks::<{ size_of::<f32>() }>();
    let is_distance = |bytes: &[u8; 4]| {
        let value = f32::from_ne_bytes(*bytes);
        value == 0.0 || value == f32::INFINITY || (1e-3..1e11).contains(&value)
    };
    rest.is_empty() && !is_text(start) && numbers.iter().all(is_distance)
}

/// Whether each line begins with a rendering option, as `rad` writes them.
fn are_options(start: &[u8]) -> bool {
    let is_option =
        |line: &str| line.strip_prefix('-').is_some_and(|name| name.starts_with(|c: char| c.is_ascii_alphabetic()));
    is_text(start) && lines(start).all(|line| is_option(&line))
}

fn are_messages(start: &[u8]) -> bool {
    let ours = [MESSAGES_MARK, "rpict:", "mkillum:", "radsight:"];
    is_text(start) && lines(start).next().is_some_and(|line| ours.iter().any(|name| line.starts_with(name)))
}

/// Whether it begins as data over all azimuths of a window.
fn is_illum_data(start: &[u8]) -> bool {
    let mut lines = lines(start);
    let axes = format!("{:.6} {TAU:.6} ", 0.0);
    is_text(start) && lines.next().is_some_and(|line| line == "2") && lines.nth(1).is_some_and(|l| l.starts_with(&axes))
}

fn is_text(start: &[u8]) -> bool {
    // The last character may be truncated.
    match std::str::from_utf8(start) {
        Ok(text) => !text.contains('\0'),
        Err(error) => error.error_len().is_none() && !start.contains(&0),
    }
}

fn lines(start: &[u8]) -> impl Iterator<Item = String> {
    start.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).map(|l| String::from_utf8_lossy(l).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_recognised_by_their_content() {
        let picture = b"#?RADIANCE\nrpict -vp 0 0 0\nRADPROJECT= room.rif\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
        let octree = b"#?RADIANCE\noconv room.rad\nFORMAT=Radiance_octree\n\n\x01";
        let precious = b"years of work";
        let distances: Vec<u8> = [2.5f32, 0.0, 1e10].iter().flat_map(|value| value.to_ne_bytes()).collect();
        let options = b"-ps 4 -pt .08\n-dj 0.5\n-ab 2 -aa .2\n";
        let data = b"2\n0.000000 1.500000 4\n0.000000 6.283185 9\n\n 1 2 3";
        let scene = b"# mkillum -ab 1 room.oct\n#@mkillum !\n\nvoid illum w\n";
        let messages = b"rpict: 10.00% after 0.1 hours\n";
        let kinds: [(Existing<'_>, &[u8]); 8] = [
            (Existing::MadeBy("room.rif"), picture),
            (Existing::Octree, octree),
            (Existing::Distances, &distances),
            (Existing::Options, options),
            (Existing::IllumData, data),
            (Existing::IllumScene, scene),
            (Existing::Messages, messages),
            (Existing::Kept, precious),
        ];
        for (kind, _) in &kinds {
            for (other, bytes) in &kinds {
                assert_eq!(kind.is_kind_of(bytes), kind == other && *kind != Existing::Kept, "{kind:?} of {other:?}");
            }
        }
        assert!(!Existing::MadeBy("other.rif").is_kind_of(picture));
    }
}
