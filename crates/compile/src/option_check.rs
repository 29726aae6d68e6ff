//! Ranges of the numeric rendering options.

use crate::options::{Gathering, GlobalMedium, LightDivision, RenderOptions};

/// A rendering option with a value out of its range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OptionOutOfRange {
    /// Name of the option.
    pub option: &'static str,
    /// Its value.
    pub value: String,
    /// The valid range.
    pub expected: &'static str,
}

/// Ranges, as they stand in messages.
const NOT_NEGATIVE: Range = Range { expected: "0 or more", holds: |value| value >= 0.0 && value.is_finite() };
const NOT_NEGATIVE_OR_INFINITE: Range = Range { expected: "0 or more, or infinity", holds: |value| value >= 0.0 };
const POSITIVE: Range = Range { expected: "above 0", holds: |value| value > 0.0 && value.is_finite() };
const POSITIVE_OR_INFINITE: Range = Range { expected: "above 0, or infinity", holds: |value| value > 0.0 };
const UNIT: Range = Range { expected: "a number from 0 to 1", holds: |value| (0.0..=1.0).contains(&value) };

struct Range {
    expected: &'static str,
    holds: fn(f64) -> bool,
}

impl Range {
    fn check(&self, option: &'static str, value: f64) -> Result<(), OptionOutOfRange> {
        if (self.holds)(value) {
            return Ok(());
        }
        Err(OptionOutOfRange { option, value: value.to_string(), expected: self.expected })
    }

    fn check_bands(&self, option: &'static str, values: [f64; 3]) -> Result<(), OptionOutOfRange> {
        if values.iter().all(|value| (self.holds)(*value)) {
            return Ok(());
        }
        let value = values.map(|value| value.to_string()).join(" ");
        Err(OptionOutOfRange { option, value, expected: self.expected })
    }
}

impl RenderOptions {
    /// Checks every number. The program checks its options itself; this is for callers that set
    /// fields.
    ///
    /// ```
    /// use radsight_compile::RenderOptions;
    /// assert!(RenderOptions::default().check().is_ok());
    /// let options = RenderOptions { least_weight: f64::NAN, ..RenderOptions::default() };
    /// assert_eq!(options.check().unwrap_err().option, "least_weight");
    /// ```
    ///
    /// # Errors
    /// The first option that is out of its range.
    pub fn check(&self) -> Result<(), OptionOutOfRange> {
        NOT_NEGATIVE.check("camera_rays", self.camera_rays)?;
        NOT_NEGATIVE.check_bands("ambient_value", self.ambient_value.0)?;
        self.gathering.check()?;
        NOT_NEGATIVE.check("highlight_threshold", self.highlight_threshold)?;
        NOT_NEGATIVE.check("source_sampling", self.source_sampling)?;
        if let LightDivision::BySize(density) | LightDivision::Shared(density) = self.light_division {
            POSITIVE.check("light_division", density)?;
        }
        NOT_NEGATIVE.check("highlight_samples", self.highlight_samples)?;
        NOT_NEGATIVE.check("least_weight", self.least_weight)?;
        NOT_NEGATIVE.check("mist_sample_length", self.mist_sample_length)?;
        self.medium.check()
    }
}

impl Gathering {
    fn check(&self) -> Result<(), OptionOutOfRange> {
        NOT_NEGATIVE.check("ambient_accuracy", self.accuracy)?;
        POSITIVE.check("gathering.noise", self.noise)?;
        let number = |option, value: u32| match value {
            0..=Gathering::MOST_RAYS => Ok(()),
            _ => Err(OptionOutOfRange { option, value: value.to_string(), expected: "0 to 1048576" }),
        };
        number("ambient_divisions", self.divisions)?;
        number("ambient_super_samples", self.super_samples)?;
        NOT_NEGATIVE_OR_INFINITE.check("gathering.caustic_error", self.caustic_error)?;
        NOT_NEGATIVE_OR_INFINITE.check("gathering.most_residual", self.most_residual)?;
        POSITIVE_OR_INFINITE.check("gathering.record_share", self.record_share)?;
        NOT_NEGATIVE.check("gathering.allocation_floor", self.allocation_floor)
    }
}

impl GlobalMedium {
    fn check(&self) -> Result<(), OptionOutOfRange> {
        NOT_NEGATIVE.check_bands("medium.extinction", self.extinction.0)?;
        UNIT.check_bands("medium.albedo", self.albedo.0)?;
        UNIT.check("medium.eccentricity", self.eccentricity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use radsight_ir::Rgb;

    /// The message of the options after a change.
    fn wrong(change: impl FnOnce(&mut RenderOptions)) -> String {
        let mut options = RenderOptions::default();
        change(&mut options);
        let OptionOutOfRange { option, value, expected } = options.check().unwrap_err();
        format!("{option} is {value}, expected {expected}")
    }

    type Field = fn(&mut RenderOptions) -> &mut f64;

    #[test]
    fn numbers_that_are_negative_or_no_number_are_refused() {
        let fields: [(&str, Field); 13] = [
            ("camera_rays", |options| &mut options.camera_rays),
            ("ambient_value", |options| &mut options.ambient_value.0[1]),
            ("ambient_accuracy", |options| &mut options.gathering.accuracy),
            ("gathering.noise", |options| &mut options.gathering.noise),
            ("gathering.caustic_error", |options| &mut options.gathering.caustic_error),
            ("gathering.most_residual", |options| &mut options.gathering.most_residual),
            ("gathering.record_share", |options| &mut options.gathering.record_share),
            ("gathering.allocation_floor", |options| &mut options.gathering.allocation_floor),
            ("highlight_threshold", |options| &mut options.highlight_threshold),
            ("source_sampling", |options| &mut options.source_sampling),
            ("least_weight", |options| &mut options.least_weight),
            ("medium.extinction", |options| &mut options.medium.extinction.0[2]),
            ("medium.eccentricity", |options| &mut options.medium.eccentricity),
        ];
        for (name, field) in fields {
            for value in [f64::NAN, -1.0] {
                assert!(wrong(|options| *field(options) = value).starts_with(&format!("{name} is ")), "{name}");
            }
        }
    }

    #[test]
    fn messages_name_option_value_and_range() {
        assert_eq!(
            wrong(|options| options.gathering.accuracy = f64::INFINITY),
            "ambient_accuracy is inf, expected 0 or more"
        );
        assert_eq!(
            wrong(|options| options.gathering.divisions = u32::MAX),
            "ambient_divisions is 4294967295, expected 0 to 1048576"
        );
        assert_eq!(
            wrong(|options| options.medium.albedo = Rgb([0.5, 1.5, 0.5])),
            "medium.albedo is 0.5 1.5 0.5, expected a number from 0 to 1"
        );
        assert_eq!(
            wrong(|options| options.light_division = LightDivision::Shared(f64::INFINITY)),
            "light_division is inf, expected above 0"
        );
    }

    #[test]
    fn infinite_limits_are_no_limits() {
        let gathering = Gathering { most_residual: f64::INFINITY, record_share: f64::INFINITY, ..Gathering::default() };
        assert_eq!(RenderOptions { gathering, ..RenderOptions::default() }.check(), Ok(()));
    }
}
