//! Turns exposure into grey values.
#![forbid(unsafe_code)]
