//! The .cal function language of Radiance: parse, compile, evaluate.
#![forbid(unsafe_code)]
