//! Random BSDF files for tests: matrices and tensor trees.

use crate::Random;
use std::fmt::Write;

/// A scattering value: mostly small, some large.
fn value(random: &mut Random) -> f64 {
    0.02 + 0.4 * random.number().powi(3)
}

/// The four scattering directions, by their names in files.
pub const DIRECTIONS: [&str; 4] = ["Reflection Front", "Reflection Back", "Transmission Front", "Transmission Back"];

/// A file with the given `<DataDefinition>` and `<WavelengthData>`.
#[must_use]
pub fn file(structure: &str, bases: &str, data: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\">\n\
         <FileType>BSDF</FileType>\n<Optical>\n<Layer>\n\
         <Material><Name>sample</Name><Manufacturer>nobody</Manufacturer><Thickness unit=\"Millimeter\">2</Thickness></Material>\n\
         <DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>{bases}</DataDefinition>\n\
         {data}</Layer>\n</Optical>\n</WindowElement>\n"
    )
}

/// One block of data of one channel.
#[must_use]
pub fn block(channel: &str, direction: &str, bases: &str, data: &str) -> String {
    format!(
        "<WavelengthData><Wavelength unit=\"Integral\">{channel}</Wavelength><WavelengthDataBlock>\
         <WavelengthDataDirection>{direction}</WavelengthDataDirection>{bases}\
         <ScatteringData>\n{data}\n</ScatteringData></WavelengthDataBlock></WavelengthData>\n"
    )
}

/// The parameters of a random file.
#[derive(Clone, Copy, Debug)]
pub struct Recipe<'a> {
    /// The members of [`DIRECTIONS`] that have a block.
    pub directions: &'a [&'a str],
    /// Whether there are colour blocks.
    pub is_colored: bool,
    /// The same seed gives the same file.
    pub seed: u64,
}

/// Matrices between two bases of `columns` and `rows` patches.
#[must_use]
pub fn matrix(
    structure: &str,
    (column, columns): (&str, usize),
    (row, rows): (&str, usize),
    recipe: &Recipe<'_>,
) -> String {
    let mut random = Random(recipe.seed);
    let bases = format!("<ColumnAngleBasis>{column}</ColumnAngleBasis><RowAngleBasis>{row}</RowAngleBasis>");
    let mut data = String::new();
    for direction in recipe.directions {
        let values: Vec<f64> = (0..columns * rows).map(|_| value(&mut random)).collect();
        let channels: &[&str] = if recipe.is_colored { &["Visible", "CIE-X", "CIE-Z"] } else { &["Visible"] };
        for channel in channels {
            let mut text = String::new();
            for value in &values {
                let tint = if *channel == "Visible" { 1.0 } else { 0.85 + 0.3 * random.number() };
                write!(text, "{:.6}, ", value * tint).expect("a string is written");
            }
            data += &block(channel, direction, &bases, &text);
        }
    }
    file(structure, &own_basis(), &data)
}

/// A pane that only transmits, straight through within the resolution of Klems' quarter basis.
#[must_use]
pub fn clear(transmittance: f64) -> String {
    let rings = [(0.0_f64, 9.0_f64, 1), (9.0, 27.0, 8), (27.0, 45.0, 12), (45.0, 63.0, 12), (63.0, 90.0, 8)];
    let sine_squared = |degrees: f64| degrees.to_radians().sin().powi(2);
    let size = |(inner, outer, patches): (f64, f64, usize)| {
        let each = std::f64::consts::PI * (sine_squared(outer) - sine_squared(inner)) / patches as f64;
        vec![each; patches]
    };
    let sizes = rings.map(size).concat();
    let mut data = String::new();
    for (row, size) in sizes.iter().enumerate() {
        for column in 0..sizes.len() {
            write!(data, "{:.6} ", if row == column { transmittance / size } else { 0.0 })
                .expect("a string is written");
        }
    }
    let bases =
        "<ColumnAngleBasis>LBNL/Klems Quarter</ColumnAngleBasis><RowAngleBasis>LBNL/Klems Quarter</RowAngleBasis>";
    file("Columns", "", &block("Visible", DIRECTIONS[2], bases, &data))
}

/// A custom basis of 17 patches that ends before the horizon.
fn own_basis() -> String {
    let ring = |(lower, upper, patches): (f64, f64, usize)| {
        format!(
            "<AngleBasisBlock><nPhis>{patches}</nPhis><ThetaBounds><LowerTheta>{lower}</LowerTheta>\
             <UpperTheta>{upper}</UpperTheta></ThetaBounds></AngleBasisBlock>"
        )
    };
    let rings = [(0.0, 20.0, 1), (20.0, 50.0, 6), (50.0, 80.0, 10)].map(ring).concat();
    format!("<AngleBasis><AngleBasisName>Own</AngleBasisName>{rings}</AngleBasis>")
}

/// Tensor trees with a largest depth.
#[must_use]
pub fn tensor(dimensions: usize, halvings: u32, recipe: &Recipe<'_>) -> String {
    let mut random = Random(recipe.seed);
    let basis = "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>";
    let mut data = String::new();
    for direction in recipe.directions {
        if recipe.is_colored {
            // Radiance separates the Lambertian part correctly only if the three trees have the
            // same form.
            let channels: [(&str, f64, f64); 3] =
                [("Visible", 0.05, 0.4), ("CIE-u", 0.19, 0.04), ("CIE-v", 0.45, 0.04)];
            for (channel, least, range) in channels {
                let values = 1 << (dimensions * halvings as usize);
                let words: Vec<String> =
                    (0..values).map(|_| format!("{:.5}", least + range * random.number())).collect();
                data += &block(channel, direction, basis, &format!("{{ {} }}", words.join(" ")));
            }
        } else {
            data += &block("Visible", direction, basis, &branch(dimensions, halvings, &mut random));
        }
    }
    file(&format!("TensorTree{dimensions}"), "", &data)
}

fn tree(dimensions: usize, halvings: u32, random: &mut Random) -> String {
    let branches = 1 << dimensions;
    if halvings == 0 || random.number() < 0.2 {
        return format!("{{ {:.5} }}", value(random));
    }
    if halvings == 1 && random.number() < 0.5 {
        let words: Vec<String> = (0..branches).map(|_| format!("{:.5}", value(random))).collect();
        return format!("{{ {} }}", words.join(" "));
    }
    branch(dimensions, halvings, random)
}

fn branch(dimensions: usize, halvings: u32, random: &mut Random) -> String {
    let inner: Vec<String> = (0..1 << dimensions).map(|_| tree(dimensions, halvings - 1, random)).collect();
    format!("{{ {} }}", inner.join("\n"))
}

/// Files of every form, by name.
#[must_use]
pub fn all_forms() -> Vec<(&'static str, String)> {
    let all = |is_colored, seed| Recipe { directions: &DIRECTIONS, is_colored, seed };
    let one_way = |seed| Recipe { directions: &[DIRECTIONS[1], DIRECTIONS[3]], is_colored: false, seed };
    let (full, half) = (("LBNL/Klems Full", 145), ("LBNL/Klems Half", 77));
    let (quarter, own) = (("LBNL/Klems Quarter", 41), ("own", 17));
    vec![
        ("full matrix", matrix("Columns", full, full, &all(false, 1))),
        ("half matrix by rows", matrix("Rows", half, half, &all(false, 2))),
        ("matrix between two bases", matrix("Columns", quarter, half, &one_way(3))),
        ("matrix on a basis of the file's", matrix("Columns", own, own, &one_way(4))),
        ("coloured matrix", matrix("Columns", quarter, quarter, &all(true, 5))),
        ("isotropic tree", tensor(3, 4, &all(false, 6))),
        ("isotropic tree one way", tensor(3, 3, &one_way(7))),
        ("coloured isotropic tree", tensor(3, 3, &all(true, 8))),
        ("anisotropic tree", tensor(4, 3, &all(false, 9))),
        ("anisotropic tree one way", tensor(4, 3, &one_way(10))),
        ("coloured anisotropic tree", tensor(4, 2, &all(true, 11))),
    ]
}
