//! Parameter sets for checking a model.

use crate::{ModelInfo, ParameterInfo, ParameterKind, Range};
use radsight_brdf::check::Random;
use serde::{Deserialize, Serialize};

/// A model with parameters, as in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// Name of the model.
    pub model: String,
    /// Words after library and model.
    pub words: Vec<String>,
    /// Real arguments.
    pub numbers: Vec<f64>,
}

impl std::fmt::Display for Example {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let numbers = self.numbers.iter().map(|number| format!("{}", (number * 1e6).round() / 1e6));
        let tokens: Vec<String> = self.words.iter().cloned().chain(numbers).collect();
        write!(out, "{}({})", self.model, tokens.join(", "))
    }
}

/// Parameter sets from the table alone: the centre of each range, the centre with each other
/// choice, the lower end, the upper end, and random ones. In the first set optional parameters have
/// their defaults. Empty for a model that needs a word which cannot be generated.
pub(crate) fn generated(model: &ModelInfo, seed: u64) -> Vec<Example> {
    let words: Option<Vec<String>> = model.parameters.iter().filter_map(generated_word).collect();
    let Some(words) = words else { return Vec::new() };
    let mut random = Random::new(seed, 7);
    let place = |place: f64, random: &mut Random| -> Vec<f64> {
        let rows = model.parameters.iter().filter(|row| row.scene_numbers() > 0);
        let middle = place == 0.5;
        rows.flat_map(|row| {
            // The bands of a spectrum differ, so that a wrong order is detected.
            let count = row.scene_numbers();
            (0..count)
                .map(|index| match row.optional && middle {
                    true => row.default_number,
                    false if place < 0.0 => at(row, random.uniform()),
                    false => at(row, (place * (1.0 - 0.1 * index as f64)).max(0.0)),
                })
                .collect::<Vec<f64>>()
        })
        .collect()
    };
    let mut example =
        |share: f64| Example { model: model.name.clone(), words: words.clone(), numbers: place(share, &mut random) };
    let mut examples = vec![example(0.5)];
    examples.extend(other_choices(model, &examples[0]));
    examples.extend([0.01, 1.0].into_iter().chain([-1.0; RANDOM]).map(example));
    examples.dedup();
    examples
}

/// Number of random parameter sets. A plugin may reject combinations.
const RANDOM: usize = 8;

/// The first set with each other word of each choice.
fn other_choices(model: &ModelInfo, first: &Example) -> Vec<Example> {
    let mut examples = Vec::new();
    for (index, row) in model.parameters.iter().filter(|row| row.scene_numbers() == 0).enumerate() {
        let ParameterKind::Choice(choices) = &row.kind else { continue };
        for choice in choices.iter().filter(|choice| **choice != first.words[index]) {
            let mut example = first.clone();
            example.words[index].clone_from(choice);
            examples.push(example);
        }
    }
    examples
}

/// `None` for a number; `Some(None)` for a word that only the user knows.
fn generated_word(row: &ParameterInfo) -> Option<Option<String>> {
    match &row.kind {
        ParameterKind::Choice(choices) => Some(choices.first().cloned()),
        ParameterKind::Word | ParameterKind::File => Some(row.optional.then(|| row.default_word.clone())),
        _ => None,
    }
}

/// Number at the fraction `place` of its range; an open range counts as a few units wide.
fn at(row: &ParameterInfo, place: f64) -> f64 {
    let Range { minimum, maximum, flags } = row.range;
    let (low, high) = match (minimum.is_finite(), maximum.is_finite()) {
        (true, true) => (minimum, maximum),
        (true, false) => (minimum, minimum + 2.0),
        (false, true) => (maximum - 2.0, maximum),
        (false, false) => (-1.0, 1.0),
    };
    let margin = |excluded: u32| if flags & excluded == 0 { 0.0 } else { 0.01 };
    let share = place.clamp(
        margin(radsight_brdf_abi::parameter_flags::ABOVE_MINIMUM),
        1.0 - margin(radsight_brdf_abi::parameter_flags::BELOW_MAXIMUM),
    );
    let number = low + (high - low) * share;
    if row.kind == ParameterKind::Integer { number.round().clamp(low.ceil(), high.floor()) } else { number }
}
