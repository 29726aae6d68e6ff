//! Compares the C header with the Rust types: sizes, offsets and constants, as compiled by a C
//! compiler.

use radsight_brdf_abi::*;
use std::mem::{offset_of, size_of};
use std::process::Command;

/// Pairs of a C expression and its expected value.
fn expectations() -> Vec<(String, u64)> {
    let mut all = Vec::new();
    macro_rules! structure {
        ($rust:ident, $c:literal: $($field:ident)*) => {
            all.push((format!("sizeof({})", $c), size_of::<$rust>() as u64));
            $(all.push((format!("offsetof({}, {})", $c, stringify!($field)), offset_of!($rust, $field) as u64));)*
        };
    }
    structure!(Parameter, "RadsightBrdfParameter": name unit doc kind flags default_number minimum maximum default_word choices);
    structure!(Model, "RadsightBrdfModel": struct_size flags parameter_count parameter_size parameters name summary citation);
    structure!(Band, "RadsightBrdfBand": centre_m low_m high_m);
    structure!(Error, "RadsightBrdfError": struct_size parameter message);
    structure!(Host, "RadsightBrdfHost": struct_size abi_major abi_minor reserved log extension);
    structure!(Create, "RadsightBrdfCreate": struct_size band_count bands numbers words number_count word_count host error);
    structure!(Eval, "RadsightBrdfEval": struct_size count outgoing incident_x incident_y incident_z values pdfs scratch);
    structure!(Sample, "RadsightBrdfSample": struct_size count outgoing u0 u1 u2 incident_x incident_y incident_z weights pdfs kinds scratch);
    structure!(Instance, "RadsightBrdfInstance": struct_size flags scratch_bytes scratch_bytes_per_direction data eval_pdf sample destroy);
    structure!(Entry, "RadsightBrdfEntry": magic abi_major abi_minor struct_size reserved count describe create extension);
    macro_rules! constants {
        ($($c:ident $rust:expr),* $(,)?) => { $(all.push((stringify!($c).to_owned(), u64::from($rust)));)* };
    }
    constants!(
        RADSIGHT_BRDF_MAGIC MAGIC, RADSIGHT_BRDF_ABI_MAJOR ABI_MAJOR, RADSIGHT_BRDF_ABI_MINOR ABI_MINOR,
        RADSIGHT_BRDF_OK status::OK, RADSIGHT_BRDF_BAD_ARGUMENT status::BAD_ARGUMENT,
        RADSIGHT_BRDF_BAD_PARAMETER status::BAD_PARAMETER, RADSIGHT_BRDF_FILE_ERROR status::FILE_ERROR,
        RADSIGHT_BRDF_OUT_OF_MEMORY status::OUT_OF_MEMORY, RADSIGHT_BRDF_UNSUPPORTED status::UNSUPPORTED,
        RADSIGHT_BRDF_INTERNAL status::INTERNAL, RADSIGHT_BRDF_PANIC status::PANIC,
        RADSIGHT_BRDF_DIFFUSE flags::DIFFUSE, RADSIGHT_BRDF_GLOSSY flags::GLOSSY, RADSIGHT_BRDF_DELTA flags::DELTA,
        RADSIGHT_BRDF_TRANSMISSION flags::TRANSMISSION, RADSIGHT_BRDF_ANISOTROPIC flags::ANISOTROPIC,
        RADSIGHT_BRDF_RECIPROCAL flags::RECIPROCAL, RADSIGHT_BRDF_NUMBER kind::NUMBER, RADSIGHT_BRDF_INTEGER kind::INTEGER,
        RADSIGHT_BRDF_SPECTRUM kind::SPECTRUM, RADSIGHT_BRDF_WORD kind::WORD, RADSIGHT_BRDF_CHOICE kind::CHOICE,
        RADSIGHT_BRDF_FILE kind::FILE, RADSIGHT_BRDF_OPTIONAL parameter_flags::OPTIONAL,
        RADSIGHT_BRDF_ABOVE_MINIMUM parameter_flags::ABOVE_MINIMUM,
        RADSIGHT_BRDF_BELOW_MAXIMUM parameter_flags::BELOW_MAXIMUM,
        RADSIGHT_BRDF_ABSORBED sample_kind::ABSORBED, RADSIGHT_BRDF_CONTINUOUS sample_kind::CONTINUOUS,
        RADSIGHT_BRDF_DELTA_HIT sample_kind::DELTA,
    );
    all
}

#[test]
fn the_c_header_equals_the_rust_types() {
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    if Command::new(&compiler).arg("--version").output().is_err() {
        eprintln!("skipped: no C compiler found");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let expectations = expectations();
    let lines: String =
        expectations.iter().map(|(c, _)| format!("    printf(\"%llu\\n\", (unsigned long long)({c}));\n")).collect();
    let program =
        format!("#include <stdio.h>\n#include \"radsight_brdf.h\"\nint main(void) {{\n{lines}    return 0;\n}}\n");
    let (source, binary) = (folder.path().join("layout.c"), folder.path().join("layout"));
    std::fs::write(&source, program).unwrap();
    let include = concat!(env!("CARGO_MANIFEST_DIR"), "/include");
    let compiled = Command::new(&compiler)
        .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I", include, "-o"])
        .args([&binary, &source])
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let output = Command::new(&binary).output().unwrap();
    let measured: Vec<u64> = String::from_utf8(output.stdout).unwrap().lines().map(|l| l.parse().unwrap()).collect();
    assert_eq!(measured.len(), expectations.len());
    for ((c, rust), measured) in expectations.iter().zip(measured) {
        assert_eq!(*rust, measured, "{c}: the Rust type says {rust}, the C header {measured}");
    }
}

/// A constant missing from the list above would let the two diverge unnoticed.
#[test]
fn every_constant_of_the_header_is_compared() {
    let compared: Vec<String> = expectations().into_iter().map(|(c, _)| c).collect();
    for line in HEADER.lines().filter(|line| line.starts_with("#define RADSIGHT_BRDF_")) {
        let name = line.split_whitespace().nth(1).unwrap();
        let is_attribute = name.ends_with("_VISIBLE") || name.ends_with("_EXPORT") || name == "RADSIGHT_BRDF_H";
        assert!(is_attribute || compared.iter().any(|c| c == name), "{name} is not compared");
    }
}
