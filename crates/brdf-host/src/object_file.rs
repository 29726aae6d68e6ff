//! Identifies a file before the system's loader opens it, because the loader's own errors are
//! unhelpful.
//!
//! Layouts: "System V Application Binary Interface", chapter 4 (ELF header); Apple,
//! `mach-o/loader.h`; Microsoft, "PE Format".

use crate::Error;
use std::io::Read;
use std::path::Path;

/// Checks that the file can be a plugin for this machine. Loading a file runs its code, so other
/// files are rejected first.
pub(crate) fn examine(path: &Path) -> Result<(), Error> {
    let unreadable = |reason: std::io::Error| Error::Unreadable { path: path.to_owned(), reason: reason.to_string() };
    let mut file = std::fs::File::open(path).map_err(unreadable)?;
    let mut head = Vec::new();
    file.by_ref().take(4096).read_to_end(&mut head).map_err(unreadable)?;
    identify_for_host(path, &head)?;
    let names_entry = mentions_entry(head, file).map_err(unreadable)?;
    if names_entry { Ok(()) } else { Err(Error::MissingEntry { path: path.to_owned() }) }
}

/// Whether the name of the exported constant occurs in a file, of which the beginning was already
/// read.
fn mentions_entry(mut window: Vec<u8>, mut file: std::fs::File) -> std::io::Result<bool> {
    const CHUNK_BYTES: u64 = 1 << 20;
    let name = radsight_brdf_abi::ENTRY_SYMBOL;
    loop {
        if window.windows(name.len()).any(|part| part == name) {
            return Ok(true);
        }
        // The name may span the end of a chunk.
        window.drain(..window.len().saturating_sub(name.len()));
        if file.by_ref().take(CHUNK_BYTES).read_to_end(&mut window)? == 0 {
            return Ok(false);
        }
    }
}

fn identify_for_host(path: &Path, head: &[u8]) -> Result<(), Error> {
    let wrong = |found: String| {
        let expected = format!("{} {}", std::env::consts::ARCH, std::env::consts::OS);
        Err(Error::WrongArchitecture { path: path.to_owned(), found, expected })
    };
    match identify(head) {
        Identity::Library { system, machine } if system == OWN_SYSTEM && machine == std::env::consts::ARCH => Ok(()),
        Identity::Library { system, machine } => wrong(format!("{machine} {system}")),
        Identity::Fat if OWN_SYSTEM == "macos" => Ok(()),
        Identity::Fat => wrong("macos".to_owned()),
        Identity::Other(found) => Err(Error::NotALibrary { path: path.to_owned(), found }),
    }
}

#[derive(Debug, PartialEq, Eq)]
enum Identity {
    Library {
        system: &'static str,
        machine: &'static str,
    },
    /// A macOS library for several architectures.
    Fat,
    Other(String),
}

/// File formats of this system's loader.
const OWN_SYSTEM: &str = if cfg!(windows) {
    "windows"
} else if cfg!(target_vendor = "apple") {
    "macos"
} else {
    "elf"
};

fn identify(head: &[u8]) -> Identity {
    if head.is_empty() {
        return Identity::Other("it is empty".to_owned());
    }
    if head.starts_with(b"\x7fELF") {
        return identify_elf(head);
    }
    if let Some([0xcf, 0xfa, 0xed, 0xfe]) = head.first_chunk() {
        let machine = match field(head, 4, 4) {
            Some(0x0100_0007) => "x86_64",
            Some(0x0100_000c) => "aarch64",
            _ => "an unknown processor",
        };
        return Identity::Library { system: "macos", machine };
    }
    if head.starts_with(&[0xca, 0xfe, 0xba, 0xbe]) {
        return Identity::Fat;
    }
    if head.starts_with(b"MZ") {
        return identify_pe(head);
    }
    let text = String::from_utf8_lossy(&head[..head.len().min(12)]).into_owned();
    Identity::Other(format!("it begins with {text:?}"))
}

fn identify_elf(head: &[u8]) -> Identity {
    const SHARED_OBJECT: u64 = 3;
    if head.len() < 20 {
        return Identity::Other("it is cut off".to_owned());
    }
    let little_endian = head[5] == 1;
    let machine = match (field(head, 18, 2), head[4], little_endian) {
        (Some(62), 2, true) => "x86_64",
        (Some(62), 1, true) => "x32",
        (Some(183), 2, true) => "aarch64",
        (Some(3), ..) => "x86",
        (Some(40), ..) => "arm",
        (Some(243), 2, _) => "riscv64",
        (Some(21), 2, true) => "powerpc64",
        (Some(22 | 0x1600), ..) => "s390x",
        _ => "an unknown processor",
    };
    if little_endian && field(head, 16, 2) != Some(SHARED_OBJECT) {
        return Identity::Other("it is an ELF file, but a program or an object file".to_owned());
    }
    Identity::Library { system: "elf", machine }
}

fn identify_pe(head: &[u8]) -> Identity {
    let machine = field(head, 0x3c, 4)
        .and_then(|at| usize::try_from(at).ok())
        .and_then(|at| field(head, at.saturating_add(4), 2));
    let machine = match machine {
        Some(0x8664) => "x86_64",
        Some(0xaa64) => "aarch64",
        Some(0x014c) => "x86",
        _ => "an unknown processor",
    };
    Identity::Library { system: "windows", machine }
}

/// A little-endian number of `bytes` bytes.
fn field(head: &[u8], at: usize, bytes: usize) -> Option<u64> {
    let part = head.get(at..at.checked_add(bytes)?)?;
    Some(part.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_files_are_identified() {
        assert_eq!(identify(b""), Identity::Other("it is empty".to_owned()));
        assert_eq!(identify(b"#!/bin/sh\n"), Identity::Other("it begins with \"#!/bin/sh\\n\"".to_owned()));
        let mut elf = b"\x7fELF\x02\x01\x01\0\0\0\0\0\0\0\0\0\x03\0\xb7\0".to_vec();
        assert_eq!(identify(&elf), Identity::Library { system: "elf", machine: "aarch64" });
        elf[16] = 2;
        assert!(matches!(identify(&elf), Identity::Other(_)));
        assert!(matches!(identify(b"\x7fELF"), Identity::Other(_)));
    }
}
