//! The number, names and ranges of the arguments of each type.

use crate::Kind;
use std::fmt;

/// The arguments of a type.
pub(crate) struct Signature {
    pub(crate) strings: Count,
    pub(crate) reals: Count,
    /// The real arguments with fixed positions, in order.
    pub(crate) arguments: &'static [Argument],
}

/// The allowed numbers of arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Count {
    Exactly(usize),
    AtLeast(usize),
    OneOf(&'static [usize]),
    /// At least the first number, and a multiple of the second.
    MultipleOf(usize, usize),
    /// Any number; Radiance reads and ignores them.
    Ignored,
}

impl Count {
    pub(crate) fn allows(self, count: usize) -> bool {
        match self {
            Count::Exactly(right) => count == right,
            Count::AtLeast(least) => count >= least,
            Count::OneOf(right) => right.contains(&count),
            Count::MultipleOf(least, step) => count >= least && count.is_multiple_of(step),
            Count::Ignored => true,
        }
    }
}

impl fmt::Display for Count {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Count::Exactly(right) => write!(formatter, "{right}"),
            Count::AtLeast(least) => write!(formatter, "at least {least}"),
            Count::OneOf(right) => {
                let words: Vec<String> = right.iter().map(usize::to_string).collect();
                formatter.write_str(&words.join(" or "))
            }
            Count::MultipleOf(least, step) => write!(formatter, "a multiple of {step}, at least {least}"),
            Count::Ignored => formatter.write_str("any number"),
        }
    }
}

/// One real argument.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument {
    pub(crate) name: &'static str,
    pub(crate) range: Range,
}

/// The plausible range of a value. Radiance accepts any value, so one outside gives a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Range {
    Any,
    NotNegative,
    Positive,
    /// 0 to 1.
    Share,
}

impl Range {
    pub(crate) fn holds(self, value: f64) -> bool {
        match self {
            Range::Any => true,
            Range::NotNegative => value >= 0.0,
            Range::Positive => value > 0.0,
            Range::Share => (0.0..=1.0).contains(&value),
        }
    }

    pub(crate) fn words(self) -> &'static str {
        match self {
            Range::Any => "any number",
            Range::NotNegative => "a number not below zero",
            Range::Positive => "a number above zero",
            Range::Share => "a number from 0 to 1",
        }
    }
}

const fn argument(name: &'static str, range: Range) -> Argument {
    Argument { name, range }
}

use Range::{Any, NotNegative, Positive, Share};

const RED: Argument = argument("red", NotNegative);
const GREEN: Argument = argument("green", NotNegative);
const BLUE: Argument = argument("blue", NotNegative);
const X: Argument = argument("x", Any);
const Y: Argument = argument("y", Any);
const Z: Argument = argument("z", Any);
const SPECULARITY: Argument = argument("specularity", Share);
const TRANSMISSIVITY: Argument = argument("transmissivity", Share);
const TRANSMITTED: Argument = argument("transmitted specularity", Share);
const INDEX: Argument = argument("refractive index", Positive);
const RADIUS: Argument = argument("radius", Any);
const FIRST_RADIUS: Argument = argument("first radius", Any);
const SECOND_RADIUS: Argument = argument("second radius", Any);
const ANGLE: Argument = argument("angle in degrees", Any);
const MAXIMUM_RADIUS: Argument = argument("maximum radius", Any);
const ECCENTRICITY: Argument = argument("eccentricity", Share);
const ROUGHNESS: Argument = argument("roughness", NotNegative);
const U_ROUGHNESS: Argument = argument("u roughness", Positive);
const V_ROUGHNESS: Argument = argument("v roughness", Positive);
const U_POWER: Argument = argument("u power", NotNegative);
const V_POWER: Argument = argument("v power", NotNegative);
const HARTMANN: Argument = argument("Hartmann's constant", Any);
const FIRST_WAVELENGTH: Argument = argument("first wavelength in nm", Positive);
const LAST_WAVELENGTH: Argument = argument("last wavelength in nm", Positive);
const DIFFUSE_NINE: &[Argument] = &[RED, GREEN, BLUE, RED, GREEN, BLUE, RED, GREEN, BLUE];

/// The arguments of a type.
pub(crate) fn signature(kind: Kind) -> Signature {
    let exactly = |arguments: &'static [Argument]| Signature {
        strings: Count::Ignored,
        reals: Count::Exactly(arguments.len()),
        arguments,
    };
    let function =
        |strings: usize| Signature { strings: Count::AtLeast(strings), reals: Count::AtLeast(0), arguments: &[] };
    let with_strings =
        |strings: usize, signature: Signature| Signature { strings: Count::AtLeast(strings), ..signature };
    let at_least = |signature: Signature| Signature { reals: Count::AtLeast(signature.arguments.len()), ..signature };
    match kind {
        Kind::Polygon => Signature { strings: Count::Ignored, reals: Count::MultipleOf(9, 3), arguments: &[] },
        Kind::Sphere | Kind::Bubble => exactly(&[X, Y, Z, RADIUS]),
        Kind::Cone | Kind::Cup => exactly(&[X, Y, Z, X, Y, Z, FIRST_RADIUS, SECOND_RADIUS]),
        Kind::Cylinder | Kind::Tube => exactly(&[X, Y, Z, X, Y, Z, RADIUS]),
        Kind::Ring => exactly(&[X, Y, Z, X, Y, Z, FIRST_RADIUS, SECOND_RADIUS]),
        Kind::Source => exactly(&[X, Y, Z, ANGLE]),
        Kind::Mesh | Kind::Instance => function(1),
        Kind::Alias => function(0),
        Kind::Light | Kind::Illum | Kind::Mirror => exactly(&[RED, GREEN, BLUE]),
        Kind::Glow => exactly(&[RED, GREEN, BLUE, MAXIMUM_RADIUS]),
        Kind::Spotlight => exactly(&[RED, GREEN, BLUE, ANGLE, X, Y, Z]),
        Kind::Prism1 => function(5),
        Kind::Prism2 => function(9),
        Kind::Mist => Signature {
            strings: Count::AtLeast(0),
            reals: Count::OneOf(&[0, 3, 6, 7]),
            arguments: &[RED, GREEN, BLUE, RED, GREEN, BLUE, ECCENTRICITY],
        },
        Kind::Plastic | Kind::Metal => exactly(&[RED, GREEN, BLUE, SPECULARITY, ROUGHNESS]),
        Kind::Trans => exactly(&[RED, GREEN, BLUE, SPECULARITY, ROUGHNESS, TRANSMISSIVITY, TRANSMITTED]),
        Kind::Plastic2 | Kind::Metal2 => {
            with_strings(4, exactly(&[RED, GREEN, BLUE, SPECULARITY, U_ROUGHNESS, V_ROUGHNESS]))
        }
        Kind::Trans2 => with_strings(
            4,
            exactly(&[RED, GREEN, BLUE, SPECULARITY, U_ROUGHNESS, V_ROUGHNESS, TRANSMISSIVITY, TRANSMITTED]),
        ),
        Kind::Ashik2 => with_strings(4, exactly(&[RED, GREEN, BLUE, RED, GREEN, BLUE, U_POWER, V_POWER])),
        Kind::WgmdFunc => with_strings(13, at_least(exactly(DIFFUSE_NINE))),
        Kind::Dielectric => exactly(&[RED, GREEN, BLUE, INDEX, HARTMANN]),
        Kind::Interface => exactly(&[RED, GREEN, BLUE, INDEX, RED, GREEN, BLUE, INDEX]),
        Kind::Glass => Signature { reals: Count::OneOf(&[3, 4]), ..exactly(&[RED, GREEN, BLUE, INDEX]) },
        Kind::PlasFunc | Kind::MetFunc => with_strings(2, at_least(exactly(&[RED, GREEN, BLUE, SPECULARITY]))),
        Kind::TransFunc => {
            with_strings(2, at_least(exactly(&[RED, GREEN, BLUE, SPECULARITY, TRANSMISSIVITY, TRANSMITTED])))
        }
        Kind::BrtdFunc => with_strings(10, at_least(exactly(DIFFUSE_NINE))),
        Kind::PlasData | Kind::MetData => with_strings(4, at_least(exactly(&[RED, GREEN, BLUE, SPECULARITY]))),
        Kind::TransData => {
            with_strings(4, at_least(exactly(&[RED, GREEN, BLUE, SPECULARITY, TRANSMISSIVITY, TRANSMITTED])))
        }
        Kind::Bsdf => {
            Signature { strings: Count::AtLeast(6), reals: Count::OneOf(&[0, 3, 6, 9]), arguments: DIFFUSE_NINE }
        }
        Kind::ApertureBsdf => {
            Signature { strings: Count::AtLeast(5), reals: Count::OneOf(&[0, 3, 6, 9]), arguments: DIFFUSE_NINE }
        }
        Kind::Antimatter => function(1),
        Kind::BrdfPlugin => function(2),
        Kind::TexFunc | Kind::ColorFunc | Kind::MixFunc => function(4),
        Kind::BrightFunc => function(2),
        Kind::TexData | Kind::ColorData => function(8),
        Kind::BrightData | Kind::SpecData => function(4),
        Kind::ColorPict | Kind::MixPict => function(7),
        Kind::SpecPict => function(5),
        Kind::MixData => function(6),
        Kind::BrightText => Signature { reals: Count::OneOf(&[11, 12]), ..function(2) },
        Kind::ColorText => Signature { reals: Count::OneOf(&[15, 16]), ..function(2) },
        Kind::MixText => Signature { reals: Count::OneOf(&[9, 10]), ..function(4) },
        Kind::Spectrum => Signature {
            strings: Count::Ignored,
            reals: Count::AtLeast(5),
            arguments: &[FIRST_WAVELENGTH, LAST_WAVELENGTH],
        },
        Kind::SpecFile => Signature { strings: Count::Exactly(1), reals: Count::AtLeast(0), arguments: &[] },
        Kind::SpecFunc => Signature {
            strings: Count::AtLeast(2),
            reals: Count::AtLeast(2),
            arguments: &[FIRST_WAVELENGTH, LAST_WAVELENGTH],
        },
    }
}

impl Signature {
    /// The names of the real arguments, for a hint; `None` if they have no fixed positions.
    pub(crate) fn hint(&self) -> Option<String> {
        let names: Vec<&str> = self.arguments.iter().map(|argument| argument.name).collect();
        (!names.is_empty()).then(|| format!("the real arguments are {}", names.join(", ")))
    }
}
