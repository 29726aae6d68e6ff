//! Descriptions of models.

use radsight_brdf_abi::{flags, kind, parameter_flags};

/// Description of a model.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// Name in a scene: letters, digits, `_` and `-`.
    pub name: &'static str,
    /// Description in one line.
    pub summary: &'static str,
    /// Source of the formulas; may be empty.
    pub citation: &'static str,
    /// Kinds of scattering of the model.
    pub lobes: Lobes,
    /// Declares that `f(outgoing, incident) = f(incident, outgoing)`; the host checks it.
    pub reciprocal: bool,
    /// Parameter table. Words and numbers are separate lists in a scene, each in the order of this
    /// table.
    pub parameters: &'static [Parameter],
}

impl Description {
    /// A description without lobes, declarations and parameters, to be completed by struct update.
    #[must_use]
    pub const fn new(name: &'static str, summary: &'static str) -> Self {
        Description { name, summary, citation: "", lobes: Lobes::NONE, reciprocal: false, parameters: &[] }
    }

    pub(crate) fn flags(&self) -> u32 {
        self.lobes.flags() | if self.reciprocal { flags::RECIPROCAL } else { 0 }
    }
}

/// Kinds of scattering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lobes {
    /// Smooth functions of direction.
    pub diffuse: bool,
    /// Lobes of finite width.
    pub glossy: bool,
    /// Perfectly specular directions, which only [`sample`](crate::Model::sample) finds.
    pub delta: bool,
    /// Transmission through the surface.
    pub transmission: bool,
    /// The value depends on the azimuth of the frame's x axis.
    pub anisotropic: bool,
}

impl Lobes {
    /// No scattering.
    pub const NONE: Lobes =
        Lobes { diffuse: false, glossy: false, delta: false, transmission: false, anisotropic: false };

    pub(crate) fn flags(self) -> u32 {
        [
            (self.diffuse, flags::DIFFUSE),
            (self.glossy, flags::GLOSSY),
            (self.delta, flags::DELTA),
            (self.transmission, flags::TRANSMISSION),
            (self.anisotropic, flags::ANISOTROPIC),
        ]
        .into_iter()
        .filter(|(has, _)| *has)
        .fold(0, |all, (_, flag)| all | flag)
    }
}

/// A row of a parameter table.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) kind: u32,
    pub(crate) flags: u32,
    pub(crate) default_number: f64,
    pub(crate) minimum: f64,
    pub(crate) maximum: f64,
    pub(crate) default_word: &'static str,
    pub(crate) choices: &'static str,
}

impl Parameter {
    const fn row(name: &'static str, unit: &'static str, doc: &'static str, kind: u32) -> Self {
        Parameter {
            name,
            unit,
            doc,
            kind,
            flags: 0,
            default_number: 0.0,
            minimum: f64::NEG_INFINITY,
            maximum: f64::INFINITY,
            default_word: "",
            choices: "",
        }
    }

    /// One number.
    #[must_use]
    pub const fn number(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, unit, doc, kind::NUMBER)
    }

    /// One number without a fraction.
    #[must_use]
    pub const fn integer(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, unit, doc, kind::INTEGER)
    }

    /// Three numbers in a scene (red, green, blue); one per band for the model.
    #[must_use]
    pub const fn spectrum(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, unit, doc, kind::SPECTRUM)
    }

    /// One word.
    #[must_use]
    pub const fn word(name: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, "", doc, kind::WORD)
    }

    /// One of the words in `choices`, separated by `|`.
    #[must_use]
    pub const fn choice(name: &'static str, choices: &'static str, doc: &'static str) -> Self {
        let row = Parameter::row(name, "", doc, kind::CHOICE);
        Parameter { choices, ..row }
    }

    /// One word that names a file. A file in the scene's folder is passed by its path.
    #[must_use]
    pub const fn file(name: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, "", doc, kind::FILE)
    }

    /// Restricts the number to `minimum ..= maximum`.
    #[must_use]
    pub const fn within(self, minimum: f64, maximum: f64) -> Self {
        Parameter { minimum, maximum, ..self }
    }

    /// Restricts the number to values above `minimum`.
    #[must_use]
    pub const fn above(self, minimum: f64) -> Self {
        Parameter { minimum, flags: self.flags | parameter_flags::ABOVE_MINIMUM, ..self }
    }

    /// Restricts the number to values below `maximum`.
    #[must_use]
    pub const fn below(self, maximum: f64) -> Self {
        Parameter { maximum, flags: self.flags | parameter_flags::BELOW_MAXIMUM, ..self }
    }

    /// Restricts the number to at least `minimum`.
    #[must_use]
    pub const fn at_least(self, minimum: f64) -> Self {
        Parameter { minimum, ..self }
    }

    /// Restricts the number to at most `maximum`.
    #[must_use]
    pub const fn at_most(self, maximum: f64) -> Self {
        Parameter { maximum, ..self }
    }

    /// Makes the number optional, with all later ones, and sets the default, in each band of a
    /// spectrum.
    #[must_use]
    pub const fn or(self, default_number: f64) -> Self {
        Parameter { default_number, flags: self.flags | parameter_flags::OPTIONAL, ..self }
    }

    /// Makes the word optional, with all later ones, and sets the default.
    #[must_use]
    pub const fn or_word(self, default_word: &'static str) -> Self {
        Parameter { default_word, flags: self.flags | parameter_flags::OPTIONAL, ..self }
    }
}
