//! Whole small scenes, made of whatever bytes a fuzzer has: text that is valid, with hostile
//! numbers.

use arbitrary::{Arbitrary, Result, Unstructured};
use std::fmt::Write;

/// A scene, a view of it and how many diffuse bounces are followed.
#[derive(Clone, Debug)]
pub struct SmallScene {
    /// Scene text that names no file.
    pub text: String,
    /// View options.
    pub view: String,
    /// `-ab`
    pub bounces: u32,
}

/// Which materials a scene may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Materials {
    /// All of them, with hostile numbers.
    All,
    /// Those whose radiance real Radiance finds without noise: diffuse and mirror-like ones under
    /// distant lamps.
    Plain,
}

const MOST_MATERIALS: usize = 5;
const MOST_SURFACES: usize = 8;

impl<'a> Arbitrary<'a> for SmallScene {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> Result<SmallScene> {
        SmallScene::of(bytes, Materials::All)
    }
}

impl SmallScene {
    /// A scene of these materials.
    ///
    /// # Errors
    /// Too few bytes.
    pub fn of(bytes: &mut Unstructured<'_>, materials: Materials) -> Result<SmallScene> {
        let mut text = String::new();
        let count = bytes.int_in_range(1..=MOST_MATERIALS)?;
        for index in 0..count {
            material(bytes, index, materials, &mut text)?;
        }
        for index in 0..bytes.int_in_range(1..=MOST_SURFACES)? {
            let modifier = bytes.int_in_range(0..=count - 1)?;
            surface(bytes, index, &format!("m{modifier}"), materials, &mut text)?;
        }
        if materials == Materials::Plain {
            text.push_str("void light sun 0 0 3 3e4 2e4 1e4 sun source s 0 0 4 .3 -.5 1 .5\n");
        }
        let [x, y, z] = match materials {
            Materials::All => place(bytes)?,
            Materials::Plain => [tenths(bytes)?, tenths(bytes)? - 20.0, tenths(bytes)?],
        };
        let types = ["v", "v", "v", "l", "h", "a", "s", "c"];
        let kind = if materials == Materials::All { *bytes.choose(&types)? } else { "v" };
        let angle = bytes.int_in_range(1..=120)?;
        let view =
            format!("-vt{kind} -vp {x} {y} {z} -vd {} 1 {} -vh {angle} -vv {angle}", share(bytes)?, share(bytes)?);
        Ok(SmallScene { text, view, bounces: bytes.int_in_range(0..=2)? })
    }
}

/// A number from 0 to 1, its ends and what is next to them among them.
fn share(bytes: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match bytes.int_in_range(0..=255_u8)? {
        0..=9 => *bytes.choose(&[0.0, 1.0, 1e-7, 1.0 - 1e-7, 1e-30, 0.5])?,
        byte => f64::from(byte - 10) / 245.0,
    })
}

/// A positive length of any order.
fn length(bytes: &mut Unstructured<'_>) -> Result<f64> {
    let exponent = *bytes.choose(&[0, 0, 0, 0, -1, 1, -4, 4, -12, 12])?;
    Ok(f64::from(bytes.int_in_range(1..=999_u16)?) / 100.0 * 10f64.powi(exponent))
}

/// A coordinate; many are the same, so that surfaces touch.
fn coordinate(bytes: &mut Unstructured<'_>) -> Result<f64> {
    Ok(match bytes.int_in_range(0..=15_u8)? {
        0 => length(bytes)?,
        1 => -length(bytes)?,
        2 => *bytes.choose(&[1e-9, 1.0 + 1e-9, -1.0 - 1e-7])?,
        byte => f64::from(byte) - 9.0,
    })
}

fn place(bytes: &mut Unstructured<'_>) -> Result<[f64; 3]> {
    Ok([coordinate(bytes)?, coordinate(bytes)?, coordinate(bytes)?])
}

/// From −5 to 5 in tenths.
fn tenths(bytes: &mut Unstructured<'_>) -> Result<f64> {
    Ok(f64::from(bytes.int_in_range(-50..=50_i8)?) / 10.0)
}

fn shares(bytes: &mut Unstructured<'_>, count: usize) -> Result<String> {
    let mut text = String::new();
    for _ in 0..count {
        let _ = write!(text, " {}", share(bytes)?);
    }
    Ok(text)
}

fn material(bytes: &mut Unstructured<'_>, index: usize, materials: Materials, text: &mut String) -> Result<()> {
    let name = format!("m{index}");
    let before = if index > 0 { format!("m{}", index - 1) } else { "void".to_owned() };
    let kinds = if materials == Materials::All { 21 } else { 5 };
    let line = match bytes.int_in_range(0..=kinds - 1)? {
        0 => format!("void plastic {name} 0 0 5{} 0 0", shares(bytes, 3)?),
        1 => format!("void glass {name} 0 0 3{}", shares(bytes, 3)?),
        2 => format!("void mirror {name} 0 0 3{}", shares(bytes, 3)?),
        3 => format!("void trans {name} 0 0 7{} 0 0{} 0", shares(bytes, 3)?, shares(bytes, 1)?),
        4 => format!("void glow {name} 0 0 4{} 0", shares(bytes, 3)?),
        5 => format!("void plastic {name} 0 0 5{}", shares(bytes, 5)?),
        6 => format!("void metal {name} 0 0 5{}", shares(bytes, 5)?),
        7 => format!("void trans {name} 0 0 7{}", shares(bytes, 7)?),
        8 => format!("void metal2 {name} 4 0 0 1 . 0 6{}", shares(bytes, 6)?),
        9 => format!("void trans2 {name} 4 Ny 0 1 . 0 8{}", shares(bytes, 8)?),
        10 => format!("void ashik2 {name} 4 0 0 1 . 0 8{} {} {}", shares(bytes, 6)?, length(bytes)?, length(bytes)?),
        11 => format!("void dielectric {name} 0 0 5{} {} 0", shares(bytes, 3)?, length(bytes)?),
        12 => {
            let (inside, outside) = (shares(bytes, 3)?, shares(bytes, 3)?);
            format!("void interface {name} 0 0 8{inside} {}{outside} {}", length(bytes)?, length(bytes)?)
        }
        13 => format!("void light {name} 0 0 3{}", lengths(bytes, 3)?),
        14 => format!("void glow {name} 0 0 4{} {}", lengths(bytes, 3)?, length(bytes)?),
        15 => format!("void spotlight {name} 0 0 7{} {} 0 0 -1", lengths(bytes, 3)?, bytes.int_in_range(1..=360)?),
        16 => format!("void illum {name} 1 {before} 0 3{}", shares(bytes, 3)?),
        17 => format!("void mist {name} 0 0 7{}", shares(bytes, 7)?),
        18 => format!(
            "void texfunc t{name} 4 A1*Px A1*sin(Py) Nz . 0 1 {} t{name} metal {name} 0 0 5 .9 .9 .9 .8{}",
            length(bytes)?,
            shares(bytes, 1)?
        ),
        19 => format!(
            "void brightfunc p{name} 2 abs(Px/(Py-A1)) . 0 1 {} p{name} plastic {name} 0 0 5{} 0 0",
            length(bytes)?,
            shares(bytes, 3)?
        ),
        _ => format!("void mixfunc {name} 4 {before} void frac(Px*A1) . 0 1 {}", length(bytes)?),
    };
    text.push_str(&line);
    text.push('\n');
    Ok(())
}

fn lengths(bytes: &mut Unstructured<'_>, count: usize) -> Result<String> {
    let mut text = String::new();
    for _ in 0..count {
        let _ = write!(text, " {}", length(bytes)?);
    }
    Ok(text)
}

fn surface(
    bytes: &mut Unstructured<'_>,
    index: usize,
    modifier: &str,
    materials: Materials,
    text: &mut String,
) -> Result<()> {
    let point = |bytes: &mut Unstructured<'_>| match materials {
        Materials::All => place(bytes),
        Materials::Plain => Ok([tenths(bytes)?, tenths(bytes)?, tenths(bytes)?]),
    };
    let size = |bytes: &mut Unstructured<'_>| match materials {
        Materials::All => length(bytes),
        Materials::Plain => Ok(tenths(bytes)?.abs() + 0.5),
    };
    let told = |[x, y, z]: [f64; 3]| format!(" {x} {y} {z}");
    let kind = *bytes.choose(&["sphere", "polygon", "ring", "cylinder", "cone", "bubble", "tube", "cup", "source"])?;
    let numbers = match kind {
        "sphere" | "bubble" => format!("4{} {}", told(point(bytes)?), size(bytes)?),
        "cylinder" | "tube" => format!("7{}{} {}", told(point(bytes)?), told(point(bytes)?), size(bytes)?),
        "cone" | "cup" => {
            format!("8{}{} {} {}", told(point(bytes)?), told(point(bytes)?), size(bytes)?, size(bytes)? / 2.0)
        }
        "ring" => format!("8{}{} 0 {}", told(point(bytes)?), told(point(bytes)?), size(bytes)?),
        "source" if materials == Materials::All => format!("4{} {}", told(point(bytes)?), bytes.int_in_range(1..=360)?),
        _ => format!("9{}{}{}", told(point(bytes)?), told(point(bytes)?), told(point(bytes)?)),
    };
    let kind = if kind == "source" && materials == Materials::Plain { "polygon" } else { kind };
    let _ = writeln!(text, "{modifier} {kind} s{index} 0 0 {numbers}");
    Ok(())
}
