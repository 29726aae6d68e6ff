//! Views as text: options on a command line, lines of view files and picture headers.

use super::{ViewError, ViewKind, ViewOptions};
use crate::Header;
use glam::DVec3;
use radsight_units::number::{general, is_number, number_or_zero};

/// The programs whose command lines define a view, and the variable that does.
const VIEW_LINES: [&str; 7] = ["VIEW=", "rpict", "rvu", "rpiece", "rxpiece", "pinterp", "rview"];

impl ViewOptions {
    /// Parses one view option at the start of a command line. Returns the number of words it took,
    /// including its name. 0 means that the first word is not a view option (`-vf` included) or
    /// that its numbers are missing or malformed.
    ///
    /// # Errors
    /// [`ViewError::UnknownKind`] for `-vt` with an unknown letter.
    pub fn apply_option<S: AsRef<str>>(&mut self, words: &[S]) -> Result<usize, ViewError> {
        let Some(name) = words.first().and_then(|word| word.as_ref().strip_prefix("-v")) else { return Ok(0) };
        if let Some(kind) = name.strip_prefix('t') {
            let mut letters = kind.chars();
            let (Some(letter), None) = (letters.next(), letters.next()) else { return Ok(0) };
            self.kind = ViewKind::from_letter(letter)?;
            return Ok(1);
        }
        match name {
            "p" | "d" | "u" => {
                let Some([x, y, z]) = numbers(&words[1..]) else { return Ok(0) };
                let vector = DVec3::new(x, y, z);
                match name {
                    "p" => self.point = vector,
                    "d" => self.direction = vector,
                    _ => self.up = vector,
                }
                Ok(4)
            }
            _ => {
                let Some(field) = self.number_option(name) else { return Ok(0) };
                let Some([value]) = numbers(&words[1..]) else { return Ok(0) };
                *field = value;
                Ok(2)
            }
        }
    }

    fn number_option(&mut self, name: &str) -> Option<&mut f64> {
        match name {
            "h" => Some(&mut self.horizontal),
            "v" => Some(&mut self.vertical),
            "o" => Some(&mut self.fore),
            "a" => Some(&mut self.aft),
            "s" => Some(&mut self.shift),
            "l" => Some(&mut self.lift),
            _ => None,
        }
    }

    /// Parses every view option of a line and returns their number. Other words and options with
    /// malformed numbers are skipped, since a command line has many options.
    ///
    /// # Errors
    /// [`ViewError::UnknownKind`] for `-vt` with an unknown letter.
    pub fn apply_line(&mut self, line: &str) -> Result<usize, ViewError> {
        if line.contains('\0') {
            return Err(ViewError::ZeroByte);
        }
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let (mut at, mut options) = (0, 0);
        while at < words.len() {
            let used = self.apply_option(&words[at..])?;
            options += usize::from(used > 0);
            at += used.max(1);
        }
        Ok(options)
    }

    /// Whether the line defines a view: `VIEW=…`, or a command line of `rpict`, `rvu`, `rview`,
    /// `rpiece`, `rxpiece` or `pinterp`, with or without a path.
    #[must_use]
    pub fn is_view_line(line: &str) -> bool {
        let command = line.split(|c: char| c.is_ascii_whitespace()).next().unwrap_or("");
        let name = command.rfind('/').map_or(line, |slash| &line[slash + 1..]);
        VIEW_LINES.iter().any(|known| name.starts_with(known))
    }

    /// The view defined by the lines of a picture's header or a view file, each modifying the one
    /// before; `None` if there is none.
    ///
    /// # Errors
    /// [`ViewError::UnknownKind`] for `-vt` with an unknown letter.
    pub fn from_header(header: &Header) -> Result<Option<ViewOptions>, ViewError> {
        Ok(ViewOptions::all_from_header(header)?.pop())
    }

    /// The view after each line that defines one, such as the frames of an animation.
    ///
    /// # Errors
    /// [`ViewError::UnknownKind`] for `-vt` with an unknown letter.
    pub fn all_from_header(header: &Header) -> Result<Vec<ViewOptions>, ViewError> {
        ViewOptions::default().all_upon(header)
    }

    fn all_upon(mut self, header: &Header) -> Result<Vec<ViewOptions>, ViewError> {
        let mut views = Vec::new();
        for line in header.lines().map(String::from_utf8_lossy) {
            if ViewOptions::is_view_line(&line) && self.apply_line(&line)? > 0 {
                views.push(self);
            }
        }
        Ok(views)
    }

    /// Applies a view file or the header of a picture (both end at an empty line) to this view, as
    /// `-vf` does.
    ///
    /// # Errors
    /// [`ViewError::Missing`] without a view, [`ViewError::UnknownKind`] for `-vt` with an unknown
    /// letter.
    pub fn apply_file(&mut self, bytes: &[u8]) -> Result<(), ViewError> {
        let views = self.all_upon(&Header::read_text(bytes))?;
        *self = *views.last().ok_or(ViewError::Missing)?;
        Ok(())
    }

    /// All options, each after a space, as in a `VIEW=` line and in `rvu` (seven digits for
    /// positions, five for the rest).
    #[must_use]
    pub fn to_full_string(&self) -> String {
        let ViewOptions { kind, point, direction, up, horizontal, vertical, fore, aft, shift, lift } = self;
        let g = |value: &f64| general(*value, 5);
        format!(
            " -vt{} -vp {} -vd {} -vu {} -vh {} -vv {} -vo {} -va {} -vs {} -vl {}",
            kind.letter(),
            triple(*point, 7),
            triple(*direction, 7),
            triple(*up, 5),
            g(horizontal),
            g(vertical),
            g(fore),
            g(aft),
            g(shift),
            g(lift)
        )
    }

    /// The options that differ from the default by more than 10⁻⁶, each after a space, with six
    /// digits.
    #[must_use]
    pub fn to_minimal_string(&self) -> String {
        const DIGITS: usize = 6;
        let standard = ViewOptions::default();
        let mut text = String::new();
        if self.kind != standard.kind {
            text.push_str(&format!(" -vt{}", self.kind.letter()));
        }
        for (name, value, usual) in
            [("p", self.point, standard.point), ("d", self.direction, standard.direction), ("u", self.up, standard.up)]
        {
            if (value - usual).abs().max_element() > SAME {
                text.push_str(&format!(" -v{name} {}", triple(value, DIGITS)));
            }
        }
        for (name, value, usual) in [
            ("h", self.horizontal, standard.horizontal),
            ("v", self.vertical, standard.vertical),
            ("o", self.fore, standard.fore),
            ("a", self.aft, standard.aft),
            ("s", self.shift, standard.shift),
            ("l", self.lift, standard.lift),
        ] {
            if (value - usual).abs() > SAME {
                text.push_str(&format!(" -v{name} {}", general(value, DIGITS)));
            }
        }
        text
    }
}

/// Options that differ by no more than this are equal.
const SAME: f64 = 1e-6;

fn triple(vector: DVec3, digits: usize) -> String {
    format!("{} {} {}", general(vector.x, digits), general(vector.y, digits), general(vector.z, digits))
}

fn numbers<S: AsRef<str>, const N: usize>(words: &[S]) -> Option<[f64; N]> {
    let words = words.get(..N)?;
    if !words.iter().all(|word| is_number(word.as_ref().as_bytes())) {
        return None;
    }
    Some(std::array::from_fn(|i| number_or_zero(words[i].as_ref().as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lines_of_a_file_accumulate() {
        let mut view = ViewOptions::default();
        let file =
            b"# fish\nrview -vta -vh 180 -vv 175 -x 3\nVIEW= -vp 1 2 3\nother -vh 3\nVIEW= -vh 90\n\nVIEW= -vh 7\n";
        view.apply_file(file).unwrap();
        let expected = ViewOptions {
            kind: ViewKind::Angular,
            point: DVec3::new(1.0, 2.0, 3.0),
            horizontal: 90.0,
            vertical: 175.0,
            ..ViewOptions::default()
        };
        assert_eq!(view, expected);
        assert_eq!(view.to_minimal_string(), " -vta -vp 1 2 3 -vh 90 -vv 175");
    }

    #[test]
    fn malformed_numbers_are_passed_over() {
        let mut view = ViewOptions::default();
        assert_eq!(view.apply_line("rview -vtv -vh 6- -vv 40 -vp 1 2").unwrap(), 2);
        assert_eq!((view.horizontal, view.vertical, view.point), (45.0, 40.0, DVec3::ZERO));
        assert_eq!(view.apply_line("rpict -vf x -vtlx -vd 1e0 .5 -2.").unwrap(), 1);
        assert_eq!(view.direction, DVec3::new(1.0, 0.5, -2.0));
        assert_eq!(view.apply_line("VIEW= -vtz"), Err(ViewError::UnknownKind('z')));
        assert_eq!(view.apply_line("VIEW= -vp 1 2 3\0 -vd 0 1 0"), Err(ViewError::ZeroByte));
    }

    #[test]
    fn view_lines_are_known_by_their_first_word() {
        for line in ["VIEW= -vtv", "VIEW=-vtv", "/usr/local/bin/rpict -vp 1 2 3", "rvu", "rview.old -vtl", "rpict"] {
            assert!(ViewOptions::is_view_line(line), "{line}");
        }
        for line in ["", "\tVIEW= -vtv", "pfilt -x 3 rpict", "oconv /rpict"] {
            assert!(!ViewOptions::is_view_line(line), "{line}");
        }
    }

    #[test]
    fn a_full_string_reads_back() {
        let text = " -vtv -vp 64.825 -90.7048 81.4822 -vd -0.399565 0.692276 -0.600917 -vu 0 0 1 -vh 30 -vv 25 -vo 0 -va 0 -vs 0 -vl 0";
        let mut view = ViewOptions::default();
        assert_eq!(view.apply_line(text).unwrap(), 10);
        assert_eq!(view.to_full_string(), text);
    }

    #[test]
    fn a_file_without_a_view_is_an_error() {
        assert_eq!(ViewOptions::default().apply_file(b"\nrpict -vtl\n"), Err(ViewError::Missing));
        assert_eq!(ViewOptions::default().apply_file(b""), Err(ViewError::Missing));
    }
}
