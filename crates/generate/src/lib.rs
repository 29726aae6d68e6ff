//! In-process replacements of the commands that Radiance scenes call.
#![forbid(unsafe_code)]
