//! Files that appear whole or not at all.
//!
//! A [`WholeFile`] is written under a random hidden name in the folder of its target. It takes the
//! target's name when it is complete and on the disk. A killed program leaves such a hidden file
//! behind, never a part of the target. The next program that writes the target removes it, and
//! [`leftovers`] finds it for a program that continues it.
//!
//! Guarantees: a hidden file is opened with `O_CREAT | O_EXCL`, so a link planted under its name is
//! not followed. At SIGINT, SIGTERM and the like all hidden files are removed before the program ends
//! by that signal ([`interrupt`]). Files that were read are recognised as targets, also through
//! links and hard links ([`inputs`]).
//!
//! This crate may not know formats, options or messages. Apart from the program, no other crate
//! writes to the disk.
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
mod destination;
pub mod inputs;
pub mod interrupt;
mod leftovers;
mod reserved;
mod shared_file;
mod whole_file;

pub use closed_file::ClosedFile;
pub use destination::Destination;
pub use leftovers::{folder_of, leftovers, remove};
pub use reserved::reserve;
pub use shared_file::SharedFile;
pub use whole_file::WholeFile;
