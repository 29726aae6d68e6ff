//! The built-in functions of the language.

use crate::noise;

/// A built-in function of the language.
///
/// `if`, `select`, `min` and `max` decide which of their arguments they evaluate; the machines
/// implement them directly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Builtin {
    Acos,
    Arg,
    Asin,
    Atan,
    Atan2,
    Ceil,
    Cos,
    Erf,
    Erfc,
    Exp,
    FractalNoise,
    Floor,
    If,
    J0,
    J1,
    Jn,
    Log,
    Log10,
    Max,
    Min,
    Noise,
    NoiseX,
    NoiseY,
    NoiseZ,
    Rand,
    Select,
    Sin,
    Sqrt,
    Tan,
    Y0,
    Y1,
    Yn,
}

/// Every built-in function with its name.
const NAMES: [(&str, Builtin); 32] = [
    ("acos", Builtin::Acos),
    ("arg", Builtin::Arg),
    ("asin", Builtin::Asin),
    ("atan", Builtin::Atan),
    ("atan2", Builtin::Atan2),
    ("ceil", Builtin::Ceil),
    ("cos", Builtin::Cos),
    ("erf", Builtin::Erf),
    ("erfc", Builtin::Erfc),
    ("exp", Builtin::Exp),
    ("floor", Builtin::Floor),
    ("fnoise3", Builtin::FractalNoise),
    ("if", Builtin::If),
    ("j0", Builtin::J0),
    ("j1", Builtin::J1),
    ("jn", Builtin::Jn),
    ("log", Builtin::Log),
    ("log10", Builtin::Log10),
    ("max", Builtin::Max),
    ("min", Builtin::Min),
    ("noise3", Builtin::Noise),
    ("noise3x", Builtin::NoiseX),
    ("noise3y", Builtin::NoiseY),
    ("noise3z", Builtin::NoiseZ),
    ("rand", Builtin::Rand),
    ("select", Builtin::Select),
    ("sin", Builtin::Sin),
    ("sqrt", Builtin::Sqrt),
    ("tan", Builtin::Tan),
    ("y0", Builtin::Y0),
    ("y1", Builtin::Y1),
    ("yn", Builtin::Yn),
];

/// Maximum number of arguments of a function without branches.
pub(crate) const WIDEST: usize = 3;

impl Builtin {
    /// All names, in alphabetical order.
    pub(crate) fn all() -> impl Iterator<Item = (&'static str, Builtin)> {
        NAMES.into_iter()
    }

    /// Name of the function in files.
    pub(crate) fn name(self) -> &'static str {
        NAMES.iter().find(|(_, builtin)| *builtin == self).map_or("?", |(name, _)| name)
    }

    /// Required number of arguments; `select`, `min` and `max` accept more.
    pub(crate) fn arity(self) -> usize {
        match self {
            Builtin::If | Builtin::FractalNoise => 3,
            Builtin::Noise | Builtin::NoiseX | Builtin::NoiseY | Builtin::NoiseZ => 3,
            Builtin::Atan2 | Builtin::Jn | Builtin::Yn => 2,
            _ => 1,
        }
    }

    /// Number of arguments that every call evaluates.
    pub(crate) fn least_arity(self) -> usize {
        if self == Builtin::If { 1 } else { self.arity() }
    }

    /// Whether it depends on its arguments alone, so that a call with constants is constant.
    pub(crate) fn is_constant(self) -> bool {
        self != Builtin::Arg
    }

    /// Value of a function that evaluates all its arguments. It may be infinite or not a number:
    /// the caller turns that into a fault. Missing arguments count as zero; callers check the arity
    /// beforehand.
    pub(crate) fn apply(self, arguments: &[f64]) -> f64 {
        let at = |index: usize| arguments.get(index).copied().unwrap_or(0.0);
        match self {
            Builtin::Atan2 => at(0).atan2(at(1)),
            Builtin::Jn => libm::jn(rounded(at(0)), at(1)),
            Builtin::Yn => libm::yn(rounded(at(0)), at(1)),
            Builtin::FractalNoise => noise::fractal([at(0), at(1), at(2)]),
            Builtin::Noise => noise::value([at(0), at(1), at(2)]),
            Builtin::NoiseX => noise::slope([at(0), at(1), at(2)], 0),
            Builtin::NoiseY => noise::slope([at(0), at(1), at(2)], 1),
            Builtin::NoiseZ => noise::slope([at(0), at(1), at(2)], 2),
            _ => self.apply_to_one(at(0)),
        }
    }

    /// Value of a function of one argument.
    #[inline]
    pub(crate) fn apply_to_one(self, x: f64) -> f64 {
        match self {
            Builtin::Acos => x.acos(),
            Builtin::Asin => x.asin(),
            Builtin::Atan => x.atan(),
            Builtin::Ceil => x.ceil(),
            Builtin::Cos => x.cos(),
            Builtin::Erf => libm::erf(x),
            Builtin::Erfc => libm::erfc(x),
            Builtin::Exp => x.exp(),
            Builtin::Floor => x.floor(),
            Builtin::J0 => libm::j0(x),
            Builtin::J1 => libm::j1(x),
            Builtin::Log => x.ln(),
            Builtin::Log10 => x.log10(),
            Builtin::Rand => random(x),
            Builtin::Sin => x.sin(),
            Builtin::Sqrt => x.sqrt(),
            Builtin::Tan => x.tan(),
            Builtin::Y0 => libm::y0(x),
            Builtin::Y1 => libm::y1(x),
            Builtin::Min | Builtin::Max => x,
            _ => f64::NAN,
        }
    }
}

/// The order of a Bessel function is rounded half up, like the index of `select`.
fn rounded(order: f64) -> i32 {
    truncated(order + 0.5)
}

/// A C cast to `int` as on x86: a value out of range becomes the smallest integer.
#[inline]
pub(crate) fn truncated(x: f64) -> i32 {
    if x > -2_147_483_649.0 && x < 2_147_483_648.0 { x as i32 } else { i32::MIN }
}

/// `rand(x)` of the language: a fixed hash of `x` to [0, 1), with the constants of calcomp's
/// `rand`.
#[inline]
#[must_use]
#[expect(clippy::approx_constant, reason = "the digits that Radiance has; more would change every value")]
pub fn random(x: f64) -> f64 {
    let spread = x * (1.0 / (1.0 + x * x) + 2.718_281_828_459_04);
    let positive = spread + (0.785_398_163_397_447 - spread.floor());
    let scrambled = 1e5 / positive;
    scrambled - scrambled.floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cast_out_of_range_gives_the_least_integer() {
        assert_eq!(truncated(-1.9), -1);
        assert_eq!(truncated(3e9), i32::MIN);
        assert_eq!(truncated(f64::NAN), i32::MIN);
    }

    #[test]
    fn every_builtin_has_a_name() {
        for (name, builtin) in Builtin::all() {
            assert_eq!(builtin.name(), name);
        }
    }
}
