//! The programs around the renderer: scenes, pictures, matrices and text, compared with Radiance's
//! programs of the same names.

#[path = "../program/mod.rs"]
mod program;

mod beside;
mod commands;
mod converters;
mod falsecolor;
mod files_as_they_are;
mod matrix_programs;
mod mkillum;
mod obj2mesh;
mod oconv;
mod options;
mod pcomb;
mod picture_programs;
mod pinterp;
mod rad;
mod report;
mod rfluxmtx;
mod rsplit;
mod tone_mapping;
