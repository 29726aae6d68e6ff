//! What a model says about itself.

use radsight_brdf_abi::{flags, kind, parameter_flags};

/// What a model is.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// As a scene writes it: letters, digits, `_` and `-`.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where the formulas are from; may be empty.
    pub citation: &'static str,
    /// The kinds of scattering that an instance may have.
    pub lobes: Lobes,
    /// Claims that `f(outgoing, incident) = f(incident, outgoing)`; the host checks it.
    pub reciprocal: bool,
    /// Words and numbers are separate lists in a scene, each in the order of this table.
    pub parameters: &'static [Parameter],
}

impl Description {
    /// A description without lobes, claims and parameters, to be completed by struct update.
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
    /// Peaks of finite width.
    pub glossy: bool,
    /// Perfectly specular directions, which only [`sample`](crate::Model::sample) finds.
    pub delta: bool,
    /// Light goes through the surface.
    pub transmission: bool,
    /// Depends on the azimuth of the frame's x axis.
    pub anisotropic: bool,
}

impl Lobes {
    /// None at all.
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

/// One row of a parameter table.
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

    /// Three numbers in a scene (red, green, blue); one for each band here.
    #[must_use]
    pub const fn spectrum(name: &'static str, unit: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, unit, doc, kind::SPECTRUM)
    }

    /// One word.
    #[must_use]
    pub const fn word(name: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, "", doc, kind::WORD)
    }

    /// One word out of `choices`, which `|` separates.
    #[must_use]
    pub const fn choice(name: &'static str, choices: &'static str, doc: &'static str) -> Self {
        let row = Parameter::row(name, "", doc, kind::CHOICE);
        Parameter { choices, ..row }
    }

    /// One word that names a file; a name that exists in the scene's folder arrives as the path to it.
    #[must_use]
    pub const fn file(name: &'static str, doc: &'static str) -> Self {
        Parameter::row(name, "", doc, kind::FILE)
    }

    /// The number must lie in `minimum ..= maximum`.
    #[must_use]
    pub const fn within(self, minimum: f64, maximum: f64) -> Self {
        Parameter { minimum, maximum, ..self }
    }

    /// The number must be above `minimum`.
    #[must_use]
    pub const fn above(self, minimum: f64) -> Self {
        Parameter { minimum, flags: self.flags | parameter_flags::ABOVE_MINIMUM, ..self }
    }

    /// The number must be below `maximum`.
    #[must_use]
    pub const fn below(self, maximum: f64) -> Self {
        Parameter { maximum, flags: self.flags | parameter_flags::BELOW_MAXIMUM, ..self }
    }

    /// The number must be at least `minimum`.
    #[must_use]
    pub const fn at_least(self, minimum: f64) -> Self {
        Parameter { minimum, ..self }
    }

    /// The number must be at most `maximum`.
    #[must_use]
    pub const fn at_most(self, maximum: f64) -> Self {
        Parameter { maximum, ..self }
    }

    /// May be left out, with all later numbers; the default, in each band of a spectrum.
    #[must_use]
    pub const fn or(self, default_number: f64) -> Self {
        Parameter { default_number, flags: self.flags | parameter_flags::OPTIONAL, ..self }
    }

    /// May be left out, with all later words; the default.
    #[must_use]
    pub const fn or_word(self, default_word: &'static str) -> Self {
        Parameter { default_word, flags: self.flags | parameter_flags::OPTIONAL, ..self }
    }
}
