//! A plugin that panics, for the host's tests of the SDK.

use radsight_brdf_sdk::{CreateError, DVec3, Description, Lobes, Model, Parameter, Parameters};

/// The function that panics.
enum Panics {
    Evaluating,
    Dropping,
}

impl Model for Panics {
    const DESCRIPTION: Description = Description {
        lobes: Lobes { diffuse: true, ..Lobes::NONE },
        parameters: &[Parameter::choice("place", "evaluating|creating|dropping", "where it panics")],
        ..Description::new("panics", "panics")
    };

    fn create(parameters: &Parameters<'_>) -> Result<Self, CreateError> {
        match parameters.word("place") {
            "evaluating" => Ok(Panics::Evaluating),
            "dropping" => Ok(Panics::Dropping),
            place => panic!("cannot go on {place}"),
        }
    }

    fn value(&self, _outgoing: DVec3, _incident: DVec3, values: &mut [f64]) {
        match self {
            Panics::Evaluating => panic!("there is no {}", "reflection"),
            Panics::Dropping => values.fill(0.1),
        }
    }
}

impl Drop for Panics {
    fn drop(&mut self) {
        if matches!(self, Panics::Dropping) {
            panic!("cannot let go");
        }
    }
}

radsight_brdf_sdk::export!(Panics);
