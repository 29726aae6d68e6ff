//! The function language in programs: definitions from `-e` and `-f`, functions from arguments.

use radsight_cal::{Environment, Handle, Host, NoHost};
use radsight_diag::{Diagnostic, SourceMap};
use radsight_loader::{FileKind, Loader};

use crate::Error;
use crate::arguments::Arguments;

/// The definitions of one run of a program.
pub(crate) struct Functions {
    pub(crate) environment: Environment,
    sources: SourceMap,
    program: String,
    /// Warnings of evaluations, without duplicates.
    pub(crate) warnings: Vec<String>,
}

impl Functions {
    /// Defines `PI`, `hermite`, `bezier` and `bspline`, as in Radiance's generators.
    pub(crate) fn for_generators(arguments: &Arguments<'_>) -> Self {
        Functions::over(Environment::for_generators(), arguments)
    }

    pub(crate) fn over(environment: Environment, arguments: &Arguments<'_>) -> Self {
        let (sources, program) = (SourceMap::default(), arguments.program().to_owned());
        Functions { environment, sources, program, warnings: Vec::new() }
    }

    /// Parses the value of an option `-e`.
    pub(crate) fn take_definitions(&mut self, arguments: &mut Arguments<'_>) -> Result<(), Error> {
        let position = arguments.position();
        let text = arguments.required("definitions (-e)")?;
        self.define(text, "-e", position)
    }

    /// Parses the file of an option `-f`. If the loader lacks it, a built-in file is used.
    pub(crate) fn take_file(&mut self, arguments: &mut Arguments<'_>, loader: &dyn Loader) -> Result<(), Error> {
        let position = arguments.position();
        let name = arguments.required("function file (-f)")?;
        let (path, bytes) = match (loader.load(name, FileKind::Function), radsight_cal::library::file(name)) {
            (Ok(loaded), _) => (loaded.path, loaded.bytes),
            (Err(_), Some(text)) => (name.to_owned(), text.as_bytes().to_vec()),
            (Err(error), None) => return Err(error.into()),
        };
        let source = self.sources.add(path, &bytes[..], None);
        self.environment.define(source, &bytes).map_err(|problems| self.error(&problems, Some(position)))
    }

    /// Adds the definitions in a text. `name` denotes the text in errors.
    pub(crate) fn define(&mut self, text: &str, name: &str, argument: usize) -> Result<(), Error> {
        let source = self.sources.add(name, text.as_bytes(), None);
        self.environment.define(source, text.as_bytes()).map_err(|problems| self.error(&problems, Some(argument)))
    }

    /// Defines a function whose body is the next argument. A context mark hides its name from other
    /// definitions.
    pub(crate) fn take_function(
        &mut self,
        arguments: &mut Arguments<'_>,
        name: &str,
        parameters: &str,
    ) -> Result<Handle, Error> {
        let position = arguments.position();
        let body = arguments.required(&format!("{name}({parameters})"))?;
        self.define(&format!("{name}`SYS({parameters})={body};"), &format!("{name}({parameters})"), position)?;
        let arity = parameters.split(',').count() as u16;
        Ok(self.environment.function(&format!("{name}`SYS"), arity))
    }

    /// Parses the next argument as an expression for a positive count, rounded.
    pub(crate) fn take_count(&mut self, arguments: &mut Arguments<'_>, name: &str) -> Result<usize, Error> {
        let position = arguments.position();
        let text = arguments.required(name)?;
        let value = self.number(text, name, position)?;
        let rounded = value + 0.5;
        if (1.0..9e15).contains(&rounded) {
            return Ok(rounded as usize);
        }
        Err(arguments.mistake(position, format!("{name} is {value}, expected a count of at least 1")))
    }

    /// The value of an expression with the current definitions.
    pub(crate) fn number(&mut self, text: &str, name: &str, argument: usize) -> Result<f64, Error> {
        let handle = self.expression(text, name, argument)?;
        self.value(handle, &[], &NoHost)
    }

    /// An expression to evaluate later, with the definitions at that time.
    pub(crate) fn expression(&mut self, text: &str, name: &str, argument: usize) -> Result<Handle, Error> {
        let source = self.sources.add(name, text.as_bytes(), None);
        let handle = self.environment.expression(source, text.as_bytes());
        handle.map_err(|problem| self.error(&[problem], Some(argument)))
    }

    /// The value of a definition.
    pub(crate) fn value<H: Host + ?Sized>(&mut self, handle: Handle, values: &[f64], host: &H) -> Result<f64, Error> {
        let value = self.environment.eval(handle, values, host).map_err(|problems| self.error(&problems, None))?;
        self.environment.list_warnings(&mut self.warnings);
        Ok(value)
    }

    /// The value as a finite coordinate. `name` and `values` describe the request in the error.
    pub(crate) fn coordinate(&mut self, handle: Handle, name: &str, values: &[f64]) -> Result<f64, Error> {
        let value = self.value(handle, values, &NoHost)?;
        if value.is_finite() {
            return Ok(value);
        }
        let at: Vec<String> = values.iter().map(f64::to_string).collect();
        let mistake = format!("{name}({}) is {value}, expected a finite number", at.join(","));
        Err(Error::Impossible { program: self.program.clone(), mistake })
    }

    /// All warnings of the run.
    pub(crate) fn all_warnings(self, arguments: Arguments<'_>) -> Vec<String> {
        let mut warnings = arguments.warnings;
        warnings.extend(self.warnings);
        warnings
    }

    fn error(&self, problems: &[Diagnostic], argument: Option<usize>) -> Error {
        let rendered: Vec<String> = problems.iter().map(|problem| problem.render(&self.sources)).collect();
        Error::Expression { program: self.program.clone(), message: rendered.concat().trim_end().to_owned(), argument }
    }
}
