//! Runs a command line of known programs.

use std::ops::Range;

use radsight_loader::{FileKind, LoadError, Loader};

use crate::shell_words::{self, Command, Pipeline, Script, Stage, Word};
use crate::{Error, Extra, Output, run_with};

/// An error with its byte range in the command line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{error}")]
pub struct PipelineError {
    /// Range in the line passed to [`pipeline`].
    pub range: Range<usize>,
    /// The error.
    #[source]
    pub error: Error,
}

/// Runs a command line (without the leading `!`) and returns its output.
///
/// Programs of this crate run in process. Others are passed to `extra`, then to
/// [`Loader::run_program`], then to [`Loader::run_command`], which refuses unless the user allowed
/// external commands; the latter also runs a whole line that needs a real shell. Later programs can
/// read the files that earlier ones write ([`Output::files`]), and the caller receives them with
/// the output.
///
/// # Errors
/// When the line cannot be split, or when a command fails.
pub fn pipeline(line: &str, loader: &dyn Loader, extra: &Extra<'_>) -> Result<Output, PipelineError> {
    let script = match shell_words::split(line) {
        Ok(script) => script,
        Err(error) => {
            let refused = PipelineError { range: error.range(), error: Error::Syntax(error.clone()) };
            if !error.needs_shell() {
                return Err(refused);
            }
            return match loader.run_command(line, None) {
                Ok(bytes) => Ok(Output { standard_output: bytes, ..Output::default() }),
                Err(LoadError::CommandRefused { .. }) => Err(refused),
                Err(other) => Err(PipelineError { range: 0..line.len(), error: Error::Load(other) }),
            };
        }
    };
    let mut runner = Runner { loader, extra, output: Output::default() };
    let standard_output = runner.script(&script, None)?;
    Ok(Output { standard_output, ..runner.output })
}

struct Runner<'a> {
    loader: &'a dyn Loader,
    extra: &'a Extra<'a>,
    /// Collects warnings and files of all commands.
    output: Output,
}

impl Runner<'_> {
    fn script(&mut self, script: &Script, standard_input: Option<&[u8]>) -> Result<Vec<u8>, PipelineError> {
        let mut standard_output = Vec::new();
        for pipeline in &script.pipelines {
            let bytes = self.stages(pipeline, standard_input)?;
            if standard_output.is_empty() {
                standard_output = bytes;
            } else if standard_output.len() + bytes.len() > crate::MAX_OUTPUT_BYTES {
                let range = pipeline.range();
                return Err(PipelineError {
                    range,
                    error: Error::OutputTooLarge { limit_bytes: crate::MAX_OUTPUT_BYTES },
                });
            } else {
                standard_output.extend_from_slice(&bytes);
            }
        }
        Ok(standard_output)
    }

    fn stages(&mut self, pipeline: &Pipeline, standard_input: Option<&[u8]>) -> Result<Vec<u8>, PipelineError> {
        let mut previous: Option<Vec<u8>> = None;
        for stage in &pipeline.stages {
            let input = previous.as_deref().or(standard_input);
            previous = Some(match stage {
                Stage::Command(command) => self.command(command, input)?,
                Stage::Group { script, input: None } => self.script(script, input)?,
                Stage::Group { script, input: Some(file) } => {
                    let bytes = self.file(file)?;
                    self.script(script, Some(&bytes))?
                }
            });
        }
        Ok(previous.unwrap_or_default())
    }

    fn command(&mut self, command: &Command, standard_input: Option<&[u8]>) -> Result<Vec<u8>, PipelineError> {
        let words = shell_words::expanded(&command.words, self.loader);
        let argv: Vec<String> = words.iter().map(|word| word.text.clone()).collect();
        let redirected = command.input.as_ref().map(|file| self.file(file)).transpose()?;
        let input = redirected.as_deref().or(standard_input);
        let result = {
            let files = WrittenFiles::new(self.loader, &self.output.files);
            if crate::knows(&argv[0]) {
                run_with(&argv, &input.unwrap_or_default(), &files, self.extra)
            } else {
                (self.extra)(&argv, input).unwrap_or_else(|| external(&argv, input, self.loader))
            }
        };
        let output = result.map_err(|error| {
            let index = error.argument().unwrap_or(0);
            PipelineError { range: word_range(&words, index), error }
        })?;
        self.output.warnings.extend(output.warnings.into_iter().map(|warning| format!("{}: {warning}", argv[0])));
        self.output.files.extend(output.files);
        Ok(output.standard_output)
    }

    fn file(&self, name: &Word) -> Result<Vec<u8>, PipelineError> {
        let files = WrittenFiles::new(self.loader, &self.output.files);
        match files.load(&name.text, FileKind::Input) {
            Ok(loaded) => Ok(loaded.bytes),
            Err(error) => Err(PipelineError { range: name.range.clone(), error: Error::Load(error) }),
        }
    }
}

/// Runs a program that only the loader may provide in process, or by a shell if it allows that.
fn external(argv: &[String], standard_input: Option<&[u8]>, loader: &dyn Loader) -> Result<Output, Error> {
    let bytes = match loader.run_program(argv, standard_input) {
        Some(result) => result?,
        None => loader.run_command(&shell_words::join(argv), standard_input)?,
    };
    Ok(Output { standard_output: bytes, ..Output::default() })
}

/// The range of a word, or the end of the last one.
fn word_range(words: &[Word], index: usize) -> Range<usize> {
    match (words.get(index), words.last()) {
        (Some(word), _) => word.range.clone(),
        (None, Some(last)) => last.range.end..last.range.end,
        (None, None) => 0..0,
    }
}

impl Pipeline {
    /// The range from the first word to the last.
    fn range(&self) -> Range<usize> {
        let start = self.stages.first().map_or(0, |stage| stage.range().start);
        let end = self.stages.last().map_or(0, |stage| stage.range().end);
        start..end
    }
}

impl Stage {
    fn range(&self) -> Range<usize> {
        match self {
            Stage::Command(command) => {
                let start = command.words.first().map_or(0, |word| word.range.start);
                start..command.words.last().map_or(start, |word| word.range.end)
            }
            Stage::Group { script, .. } => {
                let start = script.pipelines.first().map_or(0, |pipeline| pipeline.range().start);
                start..script.pipelines.last().map_or(start, |pipeline| pipeline.range().end)
            }
        }
    }
}

/// Serves files that earlier commands wrote, then the loader's.
pub struct WrittenFiles<'a> {
    loader: &'a dyn Loader,
    files: &'a [(String, Vec<u8>)],
}

impl<'a> WrittenFiles<'a> {
    /// The loader, before which these files are found by name.
    #[must_use]
    pub fn new(loader: &'a dyn Loader, files: &'a [(String, Vec<u8>)]) -> WrittenFiles<'a> {
        WrittenFiles { loader, files }
    }
}

impl Loader for WrittenFiles<'_> {
    fn load(&self, name: &str, kind: FileKind) -> Result<radsight_loader::Loaded, LoadError> {
        match self.files.iter().rev().find(|file| file.0 == name) {
            Some((path, bytes)) => Ok(radsight_loader::Loaded { path: path.clone(), bytes: bytes.clone() }),
            None => self.loader.load(name, kind),
        }
    }

    fn written(&self, name: &str) -> Option<Vec<u8>> {
        let of_line = self.files.iter().rev().find(|file| file.0 == name);
        of_line.map(|(_, bytes)| bytes.clone()).or_else(|| self.loader.written(name))
    }

    fn names_like(&self, pattern: &str) -> Vec<String> {
        self.loader.names_like(pattern)
    }

    fn run_program(&self, argv: &[String], standard_input: Option<&[u8]>) -> Option<Result<Vec<u8>, LoadError>> {
        self.loader.run_program(argv, standard_input)
    }

    fn run_command(&self, command: &str, standard_input: Option<&[u8]>) -> Result<Vec<u8>, LoadError> {
        self.loader.run_command(command, standard_input)
    }
}
