//! Files that appear whole or not at all.
//!
//! A [`WholeFile`] is written under a random hidden name in the folder of its target and takes the
//! target's name when it is complete and on the disk. What a killed program leaves behind is such a
//! hidden file, never a half of the target; the next program that writes the target removes it, and
//! [`leftovers`] finds it for who wants to go on with it.
//!
//! Guarantees: a hidden file is opened with `O_CREAT | O_EXCL`, so that no link planted under its
//! name is followed; at SIGINT, SIGTERM and SIGHUP all hidden files are removed before the program
//! ends by that signal ([`interrupt`]); a file that was read can be told from a target
//! ([`inputs`]), through links and hard links too.
//!
//! This crate may not know formats, options or messages. It is the only one besides the program
//! that writes to the disk.
//!
//! ```
//! use std::io::Write;
//! let folder = tempfile::tempdir().unwrap();
//! let target = folder.path().join("picture.hdr");
//! let mut file = radsight_output::WholeFile::create(&target).unwrap();
//! file.write_all(b"#?RADIANCE\n").unwrap();
//! assert!(!target.exists());
//! file.commit().unwrap();
//! assert_eq!(std::fs::read(&target).unwrap(), b"#?RADIANCE\n");
//! ```
#![forbid(unsafe_code)]

mod closed_file;
pub mod inputs;
pub mod interrupt;
mod leftovers;
mod place;
mod shared_file;
mod whole_file;

pub use closed_file::ClosedFile;
pub use leftovers::leftovers;
pub use place::Place;
pub use shared_file::SharedFile;
pub use whole_file::WholeFile;
