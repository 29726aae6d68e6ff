//! `radsight retro`: retroreflectors in the terms of photometry: coefficients R_A in cd/(lx m²),
//! angles in degrees.

mod csv;

use crate::failure::{Failure, Outcome};
use crate::input::read_file;
use crate::output::write_standard_output;
use clap::{Args, Subcommand};
use csv::{Column, read_rows};
use radsight_diag::{SourceMap, hint_nearest};
use radsight_retro::{
    Fit, Geometry, MINIMUM_TABLES, MODELS, MinimumTable, ModelInfo, Row, Sheeting, Weights, fit, minimum_table, model,
};
use radsight_sensor::plot::{self, Mark, Scale};
use std::fmt::Write;

/// The subcommands of `radsight retro`.
#[derive(Debug, Subcommand)]
pub(crate) enum Retro {
    /// Lists the models and their parameters
    Models,
    /// Prints R_A of a model as CSV
    Table(Table),
    /// Plots R_A of a model against the observation angle as SVG on standard output, optionally
    /// with measured rows
    Plot(Plot),
    /// Fits a model to measured R_A by least squares: parameters, their intervals, residuals
    Fit(FitData),
    /// Converts R_A to BRDF values in 1/sr, or back
    Convert(Convert),
    /// Prints the minimum R_A of a sheeting type, such as III, as CSV; of all types without a name
    Minimum(Minimum),
    /// Prints a Radiance material of a model, or of measured R_A, for a scene
    Material(MaterialText),
}

/// A model as written in a scene.
#[derive(Args, Debug)]
pub(crate) struct ModelWords {
    /// Name of the model
    #[arg(value_name = "MODEL")]
    model: String,
    /// Its numbers, as in a scene
    #[arg(value_name = "NUMBER", allow_negative_numbers = true)]
    numbers: Vec<f64>,
    /// Its word, such as `paint` for glass_bead
    #[arg(long)]
    word: Option<String>,
}

#[derive(Args, Clone, Debug)]
pub(crate) struct Angles {
    /// Observation angles, degrees
    #[arg(long, value_delimiter = ',', default_values_t = [0.1, 0.2, 0.33, 0.5, 1.0, 2.0])]
    observation: Vec<f64>,
    /// Entrance angles, degrees
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, default_values_t = [-4.0, 5.0, 15.0, 30.0, 45.0])]
    entrance: Vec<f64>,
    /// Rotation angles, degrees
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, default_values_t = [0.0])]
    rotation: Vec<f64>,
}

#[derive(Args, Debug)]
pub(crate) struct Table {
    #[command(flatten)]
    model: ModelWords,
    #[command(flatten)]
    angles: Angles,
}

#[derive(Args, Debug)]
pub(crate) struct Plot {
    #[command(flatten)]
    model: ModelWords,
    /// Entrance angles, degrees, one curve each
    #[arg(long, value_delimiter = ',', allow_hyphen_values = true, default_values_t = [5.0, 30.0, 45.0])]
    entrance: Vec<f64>,
    /// Measured rows to plot: observation, entrance, [rotation,] R_A
    #[arg(long, value_name = "DATA.csv")]
    data: Option<String>,
    /// Largest observation angle, degrees
    #[arg(long, default_value_t = 2.0)]
    to: f64,
}

#[derive(Args, Debug)]
pub(crate) struct FitData {
    /// Rows of observation, entrance, [rotation,] R_A; degrees, cd/(lx m²)
    #[arg(value_name = "DATA.csv")]
    data: String,
    /// Name of the model
    #[arg(long)]
    model: String,
    /// Its word, such as `paint` for glass_bead
    #[arg(long)]
    word: Option<String>,
    /// Minimise absolute residuals in cd/(lx m²) instead of relative ones
    #[arg(long)]
    absolute: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Convert {
    /// Rows of observation, entrance, [rotation,] value; degrees
    #[arg(value_name = "DATA.csv")]
    data: String,
    /// The target quantity
    #[arg(long, value_enum)]
    to: Quantity,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Quantity {
    /// BRDF, 1/sr
    Brdf,
    /// Coefficient of retroreflection, cd/(lx m²)
    Ra,
}

#[derive(Args, Debug)]
pub(crate) struct Minimum {
    /// Name of the type, such as III
    #[arg(value_name = "TYPE")]
    name: Option<String>,
}

#[derive(Args, Debug)]
pub(crate) struct MaterialText {
    /// Name of the material
    #[arg(value_name = "NAME")]
    name: String,
    #[command(flatten)]
    model: ModelWords,
    /// Rows for the model `table`: observation, entrance, [rotation,] R_A
    #[arg(long, value_name = "DATA.csv")]
    data: Option<String>,
}

/// Runs the command.
pub(crate) fn run(command: &Retro) -> Outcome {
    let text = match command {
        Retro::Models => models_text(),
        Retro::Table(arguments) => table_text(&sheeting(&arguments.model)?, &arguments.angles)?,
        Retro::Plot(arguments) => plot_text(arguments)?,
        Retro::Fit(arguments) => fit_text(arguments)?,
        Retro::Convert(arguments) => convert_text(arguments)?,
        Retro::Minimum(arguments) => minimum_text(arguments)?,
        Retro::Material(arguments) => material_text(arguments)?,
    };
    write_standard_output(text.as_bytes())
}

fn models_text() -> String {
    let mut text = String::new();
    for ModelInfo { name, summary, words, parameters, reciprocal } in &MODELS {
        let words = if words.is_empty() { String::new() } else { format!(" [{}]", words.join("|")) };
        let kind = if *reciprocal { "reciprocal" } else { "not reciprocal" };
        let _ = writeln!(text, "{name}{words}: {summary}; {kind}");
        for row in *parameters {
            let [least, most] = row.range;
            let default = row.default.map_or(String::new(), |default| format!(", default {default}"));
            let _ = writeln!(text, "    {:<18} {least} … {most} {}{default}: {}", row.name, row.unit, row.doc);
        }
    }
    text
}

fn sheeting(words: &ModelWords) -> Result<Sheeting, Failure> {
    let further: Vec<String> = words.word.iter().cloned().collect();
    model(&words.model, &further, &words.numbers).map_err(|error| unknown_model(&words.model, error.to_string()))
}

/// An error about a model on the command line, with the most similar name if there is no such
/// model.
fn unknown_model(name: &str, message: String) -> Failure {
    let is_known = MODELS.iter().any(|model| model.name == name);
    let hint = if is_known { None } else { hint_nearest(name, MODELS.iter().map(|model| model.name)) };
    Failure::usage(match hint {
        Some(hint) => format!("{message}\nhint: {hint}"),
        None => message,
    })
}

/// R_A of a model.
fn coefficient(sheet: &Sheeting, at: Geometry) -> f64 {
    let (observer, light) = at.directions();
    at.coefficient(sheet.value_and_pdf(observer, light).0)
}

fn table_text(sheet: &Sheeting, angles: &Angles) -> Result<String, Failure> {
    check_angles("observation", &angles.observation, 0.0, 90.0)?;
    check_angles("entrance", &angles.entrance, -89.0, 89.0)?;
    check_angles("rotation", &angles.rotation, -360.0, 360.0)?;
    let mut text = "observation_deg,entrance_deg,rotation_deg,ra_cd_per_lx_m2\n".to_owned();
    for rotation in &angles.rotation {
        for entrance in &angles.entrance {
            for observation in &angles.observation {
                let found = coefficient(sheet, Geometry::from_degrees(*observation, *entrance, *rotation));
                let _ = writeln!(text, "{observation},{entrance},{rotation},{found}");
            }
        }
    }
    Ok(text)
}

fn check_angles(name: &str, angles: &[f64], least: f64, most: f64) -> Outcome {
    match angles.iter().find(|angle| !(least..=most).contains(*angle)) {
        Some(wrong) => {
            Err(Failure::usage(format!("option \"--{name}\" has {wrong}, expected {least} to {most} degrees")))
        }
        None => Ok(()),
    }
}

fn plot_text(arguments: &Plot) -> Result<String, Failure> {
    check_angles("entrance", &arguments.entrance, -89.0, 89.0)?;
    if !(0.01..=90.0).contains(&arguments.to) {
        return Err(Failure::usage(format!("option \"--to\" is {}, expected 0.01 to 90 degrees", arguments.to)));
    }
    let sheet = sheeting(&arguments.model)?;
    let rows = arguments.data.as_ref().map_or(Ok(Vec::new()), |path| rows_of(path, Column::Coefficient))?;
    let line = |entrance: &f64| plot::Curve {
        name: format!("entrance {entrance}°"),
        mark: Mark::Line,
        values: (0..=400)
            .map(|step| arguments.to * f64::from(step) / 400.0)
            .map(|angle| [angle, coefficient(&sheet, Geometry::from_degrees(angle, *entrance, 0.0))])
            .collect(),
    };
    let mut curves: Vec<plot::Curve> = arguments.entrance.iter().map(line).collect();
    // Values below a hundred-thousandth of the maximum only stretch the axis.
    let brightest = curves.iter().flat_map(|curve| &curve.values).map(|[_, value]| *value).fold(0.0, f64::max);
    curves.iter_mut().for_each(|curve| curve.values.retain(|[_, value]| *value >= 1e-5 * brightest));
    if !rows.is_empty() {
        let values = rows.iter().map(|row| [row.geometry.observation.to_degrees(), row.coefficient]).collect();
        curves.push(plot::Curve { name: "measured".to_owned(), mark: Mark::Points, values });
    }
    let plot = plot::Plot {
        title: format!("{}: coefficient of retroreflection", arguments.model.model),
        axes: ["observation angle [°]".to_owned(), "R_A [cd/(lx m²)]".to_owned()],
        scales: [Scale::Linear, Scale::Logarithmic],
        curves,
    };
    Ok(plot.svg())
}

fn rows_of(path: &str, column: Column) -> Result<Vec<Row>, Failure> {
    let bytes = read_file(path, "table")?;
    let mut sources = SourceMap::default();
    let source = sources.add(path, bytes, None);
    read_rows(source, &sources, column).map_err(|errors| Failure::diagnostics(&errors, &sources))
}

fn fit_text(arguments: &FitData) -> Result<String, Failure> {
    if !MODELS.iter().any(|model| model.name == arguments.model) {
        return Err(unknown_model(&arguments.model, format!("unknown model \"{}\"", arguments.model)));
    }
    let rows = rows_of(&arguments.data, Column::Coefficient)?;
    let words: Vec<String> = arguments.word.iter().cloned().collect();
    let weights = if arguments.absolute { Weights::Absolute } else { Weights::Relative };
    let found = fit(&arguments.model, &words, &rows, weights)
        .map_err(|error| Failure::input(format!("\"{}\": {error}", arguments.data)))?;
    Ok(report(&found, &rows))
}

fn report(found: &Fit, rows: &[Row]) -> String {
    let mut text = format!("model,{}\nrms_relative_residual,{:.6}\n", found.model, found.rms);
    text.push_str("parameter,unit,value,low_95,high_95\n");
    for parameter in &found.parameters {
        let _ = write!(text, "{},{},{}", parameter.name, parameter.unit, parameter.value);
        match parameter.interval {
            Some([low, high]) => _ = writeln!(text, ",{low},{high}"),
            None => text.push_str(",,\n"),
        }
    }
    text.push_str("observation_deg,entrance_deg,rotation_deg,ra_measured,ra_model,relative_residual\n");
    for ((row, predicted), residual) in rows.iter().zip(&found.predicted).zip(&found.residuals) {
        let _ = writeln!(text, "{},{},{predicted:.4},{residual:.5}", angles_text(row.geometry), row.coefficient);
    }
    text
}

/// Angles as in data sheets, without the rounding of the conversion to radians.
fn angles_text(at: Geometry) -> String {
    let degrees = |angle: f64| (angle.to_degrees() * 1e9).round() / 1e9;
    format!("{},{},{}", degrees(at.observation), degrees(at.entrance), degrees(at.rotation))
}

fn convert_text(arguments: &Convert) -> Result<String, Failure> {
    let (column, name) = match arguments.to {
        Quantity::Brdf => (Column::Coefficient, "brdf_per_sr"),
        Quantity::Ra => (Column::Brdf, "ra_cd_per_lx_m2"),
    };
    let mut text = format!("observation_deg,entrance_deg,rotation_deg,{name}\n");
    for Row { geometry, coefficient } in rows_of(&arguments.data, column)? {
        let value = match arguments.to {
            Quantity::Brdf => geometry.brdf(coefficient),
            Quantity::Ra => geometry.coefficient(coefficient),
        };
        let _ = writeln!(text, "{},{value}", angles_text(geometry));
    }
    Ok(text)
}

fn minimum_text(arguments: &Minimum) -> Result<String, Failure> {
    let known = || MINIMUM_TABLES.iter().map(|table| table.name).collect::<Vec<_>>().join(", ");
    let tables: Vec<&MinimumTable> = match &arguments.name {
        None => MINIMUM_TABLES.iter().collect(),
        Some(name) => vec![minimum_table(name).ok_or_else(|| {
            Failure::usage(format!("no minimum table of type \"{name}\" is known, expected one of {}", known()))
        })?],
    };
    let mut text = String::new();
    for table in tables {
        let colours = MinimumTable::COLOURS.join(",");
        let _ = writeln!(text, "# type {}: {}; {}", table.name, table.construction, table.source);
        let _ = writeln!(text, "observation_deg,entrance_deg,{colours}");
        for row in table.rows {
            let _ = write!(text, "{},{}", row.observation_deg, row.entrance_deg);
            for coefficient in row.coefficients {
                text.push_str(&coefficient.map_or(",".to_owned(), |coefficient| format!(",{coefficient}")));
            }
            text.push('\n');
        }
    }
    Ok(text)
}

fn material_text(arguments: &MaterialText) -> Result<String, Failure> {
    let name = &arguments.name;
    if name.is_empty() || name.contains(char::is_whitespace) {
        return Err(Failure::usage(format!("material \"{name}\", expected a name without spaces")));
    }
    let ModelWords { model: model_name, numbers, word } = &arguments.model;
    let mut words: Vec<String> = word.iter().cloned().collect();
    let mut numbers = numbers.clone();
    if let Some(path) = &arguments.data {
        if model_name != "table" {
            return Err(Failure::usage("option \"--data\" is for the model \"table\""));
        }
        let rows = rows_of(path, Column::Coefficient)?;
        let defaults = [0.0, 1.0, 0.1];
        numbers.extend(defaults.iter().skip(numbers.len()));
        let has_rotation = rows.iter().any(|row| row.geometry.rotation != 0.0);
        words = vec![if has_rotation { "three_angles" } else { "two_angles" }.to_owned()];
        for row in rows {
            let degrees = |angle: f64| (angle.to_degrees() * 1e9).round() / 1e9;
            numbers.extend([degrees(row.geometry.observation), degrees(row.geometry.entrance)]);
            numbers.extend(has_rotation.then(|| degrees(row.geometry.rotation)));
            numbers.push(row.coefficient);
        }
    }
    model(model_name, &words, &numbers).map_err(|error| match &arguments.data {
        Some(path) => Failure::input(format!("\"{path}\": {error}")),
        None => unknown_model(model_name, error.to_string()),
    })?;
    let further: String = words.iter().map(|word| format!(" {word}")).collect();
    let mut text =
        format!("void brdfplugin {name}\n{} retro {model_name}{further}\n0\n{}", words.len() + 2, numbers.len());
    for number in numbers {
        let _ = write!(text, " {number}");
    }
    text.push('\n');
    Ok(text)
}
