//! The options of `rsplit`.

use crate::commands::words::Words;
use crate::disk::Commands;
use crate::failure::Failure;
use radsight_picture::Resolution;

/// Largest size of one part's numbers, bytes.
const LARGEST_PART: usize = 1 << 14;

/// The format of a part's fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    Binary {
        /// The name in a header.
        name: &'static str,
        /// Size of a number, bytes.
        size: usize,
    },
}

impl Form {
    fn of_letter(letter: char) -> Option<Form> {
        Some(match letter {
            'a' => Form::Text,
            'f' => Form::Binary { name: "float", size: 4 },
            'd' => Form::Binary { name: "double", size: 8 },
            'i' => Form::Binary { name: "int", size: 4 },
            'w' => Form::Binary { name: "16-bit", size: 2 },
            'b' => Form::Binary { name: "byte", size: 1 },
            _ => return None,
        })
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Form::Text => "ascii",
            Form::Binary { name, .. } => name,
        }
    }

    /// Bytes of a number; `None` for text.
    pub(super) fn size(self) -> Option<usize> {
        match self {
            Form::Text => None,
            Form::Binary { size, .. } => Some(size),
        }
    }
}

/// The part of each record for one output.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// The output: a file, `-`, `.`, or a command after `!`.
    pub(super) name: String,
    pub(super) form: Form,
    /// Number of fields.
    pub(super) count: usize,
    /// Separator after a field of text.
    pub(super) separator: u8,
    /// `-oh`
    pub(super) header: bool,
    /// `-oH`
    pub(super) resolution: bool,
    /// `-f`
    pub(super) overwrites: bool,
    /// `-a`
    pub(super) appends: bool,
}

#[derive(Debug)]
pub(super) struct Options {
    /// `-ih`
    pub(super) input_header: bool,
    /// `-iH`
    pub(super) input_resolution: bool,
    /// `-on`; `None` for all.
    pub(super) records: Option<u64>,
    /// `-x`, `-y`
    pub(super) resolution: Option<Resolution>,
    /// Whether commands may run in place of files.
    pub(super) commands: Commands,
    /// At least one.
    pub(super) parts: Vec<Part>,
}

impl Options {
    pub(super) fn read(mut words: Words<'_>) -> Result<Options, Failure> {
        let mut options = Options {
            input_header: false,
            input_resolution: false,
            records: None,
            resolution: None,
            commands: words.commands(),
            parts: Vec::new(),
        };
        let mut now = Part {
            name: String::new(),
            form: Form::Text,
            count: 1,
            separator: b'\n',
            header: false,
            resolution: false,
            overwrites: false,
            appends: false,
        };
        let mut size = [0usize; 2];
        while let Some(word) = words.next_if(|_| true) {
            if word.len() > 1 && word.starts_with('-') {
                words.meant(word)?;
            }
            let count = |words: &mut Words<'_>| words.integer(word).map(|count| usize::try_from(count).unwrap_or(0));
            match word {
                "-ih" => options.input_header = !options.input_header,
                "-iH" => options.input_resolution = !options.input_resolution,
                "-f" => now.overwrites = !now.overwrites,
                "-a" => now.appends = !now.appends,
                "-x" => size[0] = count(&mut words)?,
                "-y" => size[1] = count(&mut words)?,
                "-on" => options.records = Some(count(&mut words)? as u64).filter(|count| *count > 0),
                "-oh" => now.header = !now.header,
                "-oH" => now.resolution = !now.resolution,
                _ if word.starts_with("-t") => now.separator = word.as_bytes().get(2).copied().unwrap_or(b'\n'),
                _ if word.starts_with("-o") => {
                    let unknown = || words.unknown(word);
                    let letter = word[2..].chars().next().ok_or_else(unknown)?;
                    now.form = Form::of_letter(letter).ok_or_else(unknown)?;
                    now.count = match &word[3..] {
                        "" => 1,
                        digits => digits.parse().ok().filter(|count| *count > 0).ok_or_else(unknown)?,
                    };
                    if now.form.size().unwrap_or(0).saturating_mul(now.count) > LARGEST_PART {
                        let message =
                            format!("rsplit: option \"{word}\" requests more than {LARGEST_PART} bytes per record");
                        return Err(Failure::usage(message));
                    }
                }
                _ if word.len() > 1 && word.starts_with('-') => return Err(words.unknown(word)),
                name if name.starts_with('!') || name == "." => {
                    options.add(Part { name: name.to_owned(), ..now.clone() })?
                }
                name => options.add(Part { name: words.output(name)?.to_string(), ..now.clone() })?,
            }
        }
        if size[0] > 0 && size[1] > 0 {
            options.resolution = Some(Resolution::standard(size[0], size[1]));
        }
        options.check()?;
        Ok(options)
    }

    fn add(&mut self, part: Part) -> Result<(), Failure> {
        let is_file = !matches!(part.name.as_str(), "-" | ".") && !part.name.starts_with('!');
        if is_file && self.parts.iter().any(|known| known.name == part.name) {
            return Err(Failure::usage(format!(
                "rsplit: \"{}\" is named twice, expected one output for each file",
                part.name
            )));
        }
        if is_file && part.appends && (part.header || part.resolution) {
            return Err(Failure::usage(
                "rsplit: option \"-a\" appends to files, so it cannot be combined with -oh or -oH",
            ));
        }
        self.parts.push(part);
        Ok(())
    }

    fn check(&self) -> Result<(), Failure> {
        if self.parts.is_empty() {
            return Err(Failure::usage(
                "rsplit: no output is given, expected files, \"-\", \".\" or commands after \"!\"",
            ));
        }
        let wants_resolution = self.parts.iter().any(|part| part.resolution && part.name != ".");
        if wants_resolution && !self.input_resolution && self.resolution.is_none() {
            return Err(Failure::usage("rsplit: option \"-oH\" lacks a resolution, expected -iH, or -x and -y"));
        }
        Ok(())
    }

    /// Whether a line end after a field is skipped: in text whose fields do not end with lines.
    pub(super) fn skips_line_ends(&self) -> bool {
        let is_text = self.parts.iter().all(|part| part.form == Form::Text);
        is_text && self.parts.last().is_some_and(|part| part.separator != b'\n')
    }
}
