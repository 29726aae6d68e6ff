//! Custom colours as functions of the scale position.

use super::Palette;
use crate::ToolError;
use radsight_cal::{Bindings, Definitions, Host, Program, Root, Scope, Scratch};
use radsight_diag::SourceMap;
use std::sync::Arc;

/// One component of a colour, as an expression of the scale position `v`. It may call the palettes'
/// functions, `def_red(v)` and so on.
#[derive(Clone, Debug)]
pub struct OwnComponent {
    text: String,
    program: Arc<Program>,
}

impl PartialEq for OwnComponent {
    fn eq(&self, other: &OwnComponent) -> bool {
        self.text == other.text
    }
}

/// Definitions available to the expressions besides the library.
const DEFINITIONS: &str = "gamma : 2.2; clip(x) : min(1, max(x, 0)); frac(x) : x - floor(x);";

const COMPONENTS: [&str; 3] = ["red", "grn", "blu"];

/// The scale position: the value of the channel `v`.
struct ScalePosition(f64);

impl Host for ScalePosition {
    fn channel(&self, _channel: u32) -> f64 {
        self.0
    }

    fn call(&self, function: u32, arguments: &[f64]) -> f64 {
        let (palette, component) = (function as usize / 3, function as usize % 3);
        let value = arguments.first().copied().unwrap_or(0.0);
        Palette::ALL.get(palette).map_or(0.0, |(_, palette)| palette.color(value)[component])
    }
}

impl OwnComponent {
    /// Parses an expression.
    ///
    /// # Errors
    /// Its mistakes.
    pub fn read(text: &str) -> Result<OwnComponent, ToolError> {
        let mut sources = SourceMap::default();
        let mut definitions = Definitions::with_initial_library();
        let source = sources.add("falsecolor", DEFINITIONS.as_bytes(), None);
        let scope = Scope::global();
        definitions.load(source, DEFINITIONS.as_bytes(), &scope).map_err(ToolError::Definition)?;
        let names: Vec<String> = Palette::ALL
            .iter()
            .flat_map(|(palette, _)| COMPONENTS.map(|component| format!("{palette}_{component}")))
            .collect();
        let functions: Vec<(&str, usize)> = names.iter().map(|name| (name.as_str(), 1)).collect();
        let bindings = Bindings { variables: &[("v", 1)], functions: &functions, ..Bindings::default() };
        let source = sources.add("expression", text.as_bytes(), None);
        let root = Root::Expression { text, span: sources.span(source, 0, text.len()) };
        let program = Program::compile(&definitions, &scope, &[root], &bindings).map_err(ToolError::Definition)?;
        Ok(OwnComponent { text: text.to_owned(), program: Arc::new(program) })
    }

    /// The component at a scale position; 0 if it cannot be evaluated.
    #[must_use]
    pub fn at(&self, position: f64) -> f64 {
        self.program.eval(0, &[], &ScalePosition(position), &mut Scratch::new()).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expressions_use_the_scale_position_and_the_palettes() {
        assert_eq!(OwnComponent::read("v*v").unwrap().at(0.5), 0.25);
        let red = OwnComponent::read("clip(2*hot_red(v))").unwrap().at(0.2);
        assert!((red - (2.0 * 0.6f64.powf(2.2)).min(1.0)).abs() < 1e-9, "{red}");
        assert!(OwnComponent::read("w+1").is_err() && OwnComponent::read("v+").is_err());
    }
}
