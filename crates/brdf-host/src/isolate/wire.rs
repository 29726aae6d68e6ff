//! Messages of program and worker through the socket, as lines of JSON.

use crate::library::Message;
use crate::table::Arguments;
use crate::{Error, Label, ModelInfo};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A request of the program. The worker answers each with one [`Answer`].
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Ask {
    /// The first request.
    Load {
        path: PathBuf,
        channels: usize,
        memory: Option<u64>,
        /// Model and material that need the library, for messages.
        user: Option<(String, Label)>,
    },
    Create {
        index: u32,
        arguments: Arguments,
        bands: Vec<WireBand>,
        label: Label,
    },
    Destroy(u32),
    SelfCheck(u32),
    Manual,
    Messages,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Answer {
    Loaded(Result<Description, Error>),
    /// Number and flags of the instance.
    Created(Result<(u32, u32), Error>),
    Destroyed,
    SelfChecked(Vec<String>),
    Manual(Option<String>),
    Messages(Vec<Message>),
}

/// Description of a library.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Description {
    pub(crate) abi_version: (u32, u32),
    pub(crate) models: Vec<ModelInfo>,
}

/// A spectral band: centre, start and end in metres.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct WireBand(#[serde(with = "bit_list")] pub(super) Vec<f64>);

/// Numbers as bit patterns: JSON has no infinity, and all bits must survive.
pub(crate) mod bits {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(number: &f64, to: S) -> Result<S::Ok, S::Error> {
        number.to_bits().serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        u64::deserialize(from).map(f64::from_bits)
    }
}

/// Lists of numbers as bit patterns.
pub(crate) mod bit_list {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(numbers: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(numbers.iter().map(|number| number.to_bits()))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        Ok(Vec::<u64>::deserialize(from)?.into_iter().map(f64::from_bits).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinities_and_all_bits_survive() {
        let numbers = vec![f64::INFINITY, -f64::INFINITY, -0.0, 0.1 + 0.2, f64::from_bits(0x7ff8_0000_0000_1234)];
        let text = serde_json::to_string(&WireBand(numbers.clone())).unwrap();
        let back: WireBand = serde_json::from_str(&text).unwrap();
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back.0), bits(&numbers));
    }
}
