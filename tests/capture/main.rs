//! Pictures of a real camera: from the camera file to the grey values.

#[path = "../pictures/mod.rs"]
mod pictures;
#[path = "../program/mod.rs"]
mod program;

mod budget;
mod camera_models;
mod chain;
mod checkpoints;
mod cone_edges;
mod few_pixels;
mod flicker;
mod gripps_files;
mod job;
mod library_and_program;
mod narrow_features;
mod opencv_calibration;
mod parts;
mod series;
mod truth;
mod windows;
