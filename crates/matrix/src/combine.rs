//! `rcomb`: matrices combined by functions of their elements.

use crate::{Matrix, MatrixError};
use radsight_cal::{Environment, Host};
use radsight_diag::SourceMap;
use std::f64::consts::PI;

/// Matrices of equal size and number of components, and the functions that combine them.
pub struct Combination {
    inputs: Vec<Matrix>,
    environment: Environment,
    /// Function numbers of `ci` and `wl`.
    functions: [u32; 2],
}

/// Definition of the result's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Defined {
    /// The sum of all inputs.
    Sum,
    /// `co(component)`.
    Function,
    /// `co`.
    Variable,
}

/// The element and component that are evaluated.
struct Site<'a> {
    inputs: &'a [Matrix],
    row: usize,
    column: usize,
    component: usize,
    /// Function numbers of `ci` and `wl`.
    functions: [u32; 2],
}

impl Combination {
    /// Prepares an environment for definitions over matrices: `ci(input,component) ri(input) gi bi
    /// wl(component) nfiles nrows ncols ncomp R G B PI`.
    ///
    /// # Errors
    /// If the matrices differ in size or components.
    pub fn new(inputs: Vec<Matrix>) -> Result<Combination, (usize, MatrixError)> {
        let mut environment = Environment::new();
        if let Some(first) = inputs.first() {
            for (index, other) in inputs.iter().enumerate() {
                first.check_alike(other).map_err(|error| (index, error))?;
            }
            let numbers = [inputs.len(), first.rows(), first.columns(), first.components()].map(|count| count as f64);
            for (name, value) in ["nfiles", "nrows", "ncols", "ncomp"].into_iter().zip(numbers) {
                environment.set_constant(name, value);
            }
        }
        for (name, value) in [("PI", PI), ("R", 1.0), ("G", 2.0), ("B", 3.0)] {
            environment.set_constant(name, value);
        }
        let functions = ["ci", "wl"].map(|name| environment.offer_function(name, 1));
        if let Err(error) = define(&mut environment, "ri(i)=ci(i,R);gi(i)=ci(i,G);bi(i)=ci(i,B);") {
            return Err((0, error));
        }
        Ok(Combination { inputs, environment, functions })
    }

    /// Environment of the definitions.
    pub fn environment(&mut self) -> &mut Environment {
        &mut self.environment
    }

    /// Computes all elements by `co(component)`, `co`, or `ro go bo`, whichever is defined,
    /// otherwise as sums. Also the mathematical errors, each once, as messages.
    ///
    /// # Errors
    /// If a definition cannot be evaluated.
    pub fn compute(self) -> Result<(Matrix, Vec<String>), MatrixError> {
        let Combination { inputs, mut environment, functions } = self;
        let Some(first) = inputs.first() else { return Err(MatrixError::TooLarge { size: [0, 0], components: 0 }) };
        let defined = defined(&mut environment, first.components())?;
        let mut stored = first.stored;
        inputs.iter().for_each(|input| stored = stored.with(input.stored).unwrap_or(stored));
        let mut result = first.clone();
        result.stored = stored;
        if defined == Defined::Sum {
            for input in &inputs[1..] {
                result.add(input)?;
            }
            return Ok((result, Vec::new()));
        }
        let mut warnings = Vec::new();
        let handle = match defined {
            Defined::Function => environment.function("co", 1),
            _ => environment.variable("co"),
        };
        let [row_slot, column_slot] = ["r", "c"].map(|name| environment.slot_if_needed(name));
        let (columns, components) = (first.columns(), first.components());
        for (element, values) in result.values_mut().chunks_exact_mut(components).enumerate() {
            let (row, column) = (element / columns, element % columns);
            if let (Some(slot), 0) = (row_slot, column) {
                environment.set(slot, row as f64);
            }
            if let Some(slot) = column_slot {
                environment.set(slot, column as f64);
            }
            for (component, value) in values.iter_mut().enumerate() {
                let site = Site { inputs: &inputs, row, column, component, functions };
                let arguments = [component as f64 + 1.0];
                let arguments = if defined == Defined::Function { &arguments[..] } else { &[] };
                let found = environment.eval(handle, arguments, &site);
                *value = found.map_err(MatrixError::Definition)? as f32;
                environment.list_warnings(&mut warnings);
            }
        }
        Ok((result, warnings))
    }
}

fn define(environment: &mut Environment, text: &str) -> Result<(), MatrixError> {
    let source = SourceMap::default().add("rcomb", text.as_bytes(), None);
    environment.define(source, text.as_bytes()).map_err(MatrixError::Definition)
}

fn defined(environment: &mut Environment, components: usize) -> Result<Defined, MatrixError> {
    if environment.function_arity("co").is_some() {
        return Ok(Defined::Function);
    }
    if environment.is_variable("co") {
        return Ok(Defined::Variable);
    }
    if components == 3 && ["ro", "go", "bo"].iter().all(|name| environment.is_variable(name)) {
        define(environment, "co(p)=select(p,ro,go,bo);")?;
        return Ok(Defined::Function);
    }
    Ok(Defined::Sum)
}

impl Site<'_> {
    /// Value of an input, numbered from 1; for 0 the number of inputs.
    fn input(&self, arguments: &[f64]) -> f64 {
        let number = arguments.first().copied().unwrap_or(f64::NAN);
        let count = self.inputs.len();
        if !(number > -0.5 && number < count as f64 + 0.5) {
            return 0.0;
        }
        if number < 0.5 {
            return count as f64;
        }
        let input = &self.inputs[(number - 0.5) as usize];
        let component = match arguments.get(1) {
            None => self.component,
            Some(wanted) if *wanted >= 0.5 && *wanted < input.components() as f64 + 0.5 => (*wanted - 0.5) as usize,
            Some(_) => return 0.0,
        };
        f64::from(input.row(self.row)[self.column * input.components() + component])
    }

    /// Centre wavelength of a component, nm; for 0 the number of components.
    fn wavelength(&self, arguments: &[f64]) -> f64 {
        let (component, input) = (arguments.first().copied().unwrap_or(f64::NAN), &self.inputs[0]);
        let (count, splits) = (input.components(), input.splits.map(f64::from));
        if !(component >= -0.5 && component < count as f64 + 0.5) {
            return 0.0;
        }
        if component < 0.5 {
            return count as f64;
        }
        if count == 3 {
            let part = (component - 0.5) as usize;
            return splits[part] + (component - 0.5) * (splits[part + 1] - splits[part]);
        }
        splits[0] + (component - 0.5) / count as f64 * (splits[3] - splits[0])
    }
}

impl Host for Site<'_> {
    fn channel(&self, _channel: u32) -> f64 {
        0.0
    }

    fn call(&self, function: u32, arguments: &[f64]) -> f64 {
        match self.functions.iter().position(|known| *known == function) {
            Some(0) => self.input(arguments),
            Some(_) => self.wavelength(arguments),
            None => 0.0,
        }
    }
}
