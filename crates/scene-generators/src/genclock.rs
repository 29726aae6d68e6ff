//! `genclock [-f face_mat] [-c case_mat] [-n name] {HH:MM | HH.hh}`: a clock of radius 1.1 on the
//! wall x = 0, facing +x.
//!
//! The face shows the text file `clockface.hex` in the font `hexbit4x1.fnt`.

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::arguments::Arguments;
use crate::number_text::{leading_integer, leading_number};
use crate::text::{Text, padded};
use crate::{Error, Invocation, Output};

pub(crate) fn run(invocation: &Invocation<'_>) -> Result<Output, Error> {
    let mut arguments = Arguments::new(invocation.argv);
    let (mut face, mut case, mut name) = (None, None, "clock");
    while let Some(option) = arguments.option()? {
        match option.name {
            "-f" => face = Some(arguments.required("face material (-f)")?),
            "-c" => case = Some(arguments.required("case material (-c)")?),
            "-n" => name = arguments.required("name (-n)")?,
            _ => return Err(arguments.unknown()),
        }
    }
    let position = arguments.position();
    let time = arguments.required("time")?;
    let Some(hour) = read_time(time) else {
        return Err(arguments.mistake(position, format!("time is \"{time}\", expected HH:MM or HH.hh")));
    };
    if !arguments.rest().is_empty() {
        arguments.warnings.push(format!("arguments after the time are ignored: {}", arguments.rest().join(" ")));
    }
    let mut text = Text::default();
    text.plain_command_comment(invocation.argv)?;
    write_materials(&mut text, face, case)?;
    write_body(&mut text, case.unwrap_or("black_plastic"), name)?;
    let hands: [(&str, f64, f64, [[f64; 2]; 4]); 2] = [
        ("hour", TAU / 12.0 * hour, 0.06, [[-0.03, -0.06], [0.03, -0.06], [0.025, 0.5], [-0.025, 0.5]]),
        ("minute", TAU * hour.fract(), 0.07, [[-0.02, -0.1], [0.02, -0.1], [0.01, 0.9], [-0.01, 0.9]]),
    ];
    for (hand, turn, x, outline) in hands {
        text.primitive("hand_paint", "polygon", format_args!("{name}.{hand}_hand"), 12)?;
        let (sine, cosine) = (-turn).sin_cos();
        for [y, z] in outline {
            let corner = [x, y * cosine - z * sine, z * cosine + y * sine];
            let [x, y, z] = corner.map(|value| padded(value, 15, 12));
            writeln!(text, "{x} {y} {z}")?;
        }
    }
    Ok(Output { standard_output: text.into_bytes(), warnings: arguments.warnings, ..Output::default() })
}

/// Hours since midnight.
fn read_time(time: &str) -> Option<f64> {
    let digits = time.bytes().take_while(u8::is_ascii_digit).count();
    let hour = match time.as_bytes().get(digits) {
        _ if digits == 0 => return None,
        Some(b':') => {
            let minutes = leading_integer(&time[digits + 1..]).map_or(0, |(minutes, _)| minutes);
            leading_integer(time)?.0 as f64 + minutes as f64 / 60.0
        }
        None | Some(b'.') => leading_number(time)?.0,
        Some(_) => return None,
    };
    hour.is_finite().then_some(hour)
}

fn write_materials(text: &mut Text, face: Option<&str>, case: Option<&str>) -> Result<(), Error> {
    let mut plastic = |name: &str, numbers: [f64; 5]| -> Result<(), Error> {
        let [r, g, b, specular, rough] = numbers;
        Ok(write!(text, "\nvoid plastic {name}\n0\n0\n5 {r:.6} {g:.6} {b:.6} {specular:.6} {rough:.6}\n")?)
    };
    if face.is_none() {
        plastic("white_plastic", [0.85, 0.85, 0.85, 0.0, 0.0])?;
    }
    if case.is_none() {
        plastic("black_plastic", [0.08, 0.08, 0.08, 0.03, 0.04])?;
    }
    let face = face.unwrap_or("white_plastic");
    write!(text, "\n{face} brighttext clock_face_paint\n2 hexbit4x1.fnt clockface.hex\n")?;
    write!(text, "0\n11\n\t0\t-1\t1\n\t0\t.0185\t0\n\t0\t0\t-.00463\n\t.02\t1\n")?;
    write!(text, "\nvoid glass clock_crystal\n0\n0\n3 .95 .95 .95\n")?;
    Ok(write!(text, "\nvoid plastic hand_paint\n0\n0\n5 .03 .03 .03 0 0\n")?)
}

fn write_body(text: &mut Text, case: &str, name: &str) -> Result<(), Error> {
    let ring = |x: &str, normal: &str, radii: &str| format!("8\t{x}\t0\t0\n\t{normal}\t0\t0\n\t{radii}");
    let tube = |from: &str, to: &str, radius: &str| format!("7\t{from}\t0\t0\n\t{to}\t0\t0\n\t{radius}");
    let parts = [
        (case, "ring", "case_back", ring("0", "-1", "0\t1.1")),
        (case, "cylinder", "case_outer", tube("0", ".12", "1.1")),
        (case, "ring", "case_front", ring(".12", "1", "1\t1.1")),
        (case, "cylinder", "case_inner", tube(".05", ".12", "1")),
        ("clock_crystal", "ring", "crystal", ring(".10", "1", "0\t1")),
        ("clock_face_paint", "ring", "face", ring(".05", "1", "0\t1")),
    ];
    for (modifier, kind, part, numbers) in parts {
        write!(text, "\n{modifier} {kind} {name}.{part}\n0\n0\n{numbers}\n")?;
    }
    Ok(())
}
