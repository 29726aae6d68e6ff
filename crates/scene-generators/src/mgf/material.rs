//! MGF materials, written as Radiance materials.

use std::fmt::Write;

use super::color::{Color, FIRST_NM, LAST_NM, SAMPLES, STEP_NM};
use crate::Error;
use crate::cie::{brightness, rgb_of_chromaticity};
use crate::text::{Text, general};
use radsight_units::photometry::WHITE_EFFICACY;

/// Thickness of one-sided glass, metres.
const GLASS_THICKNESS: f64 = 0.005;
const TINY: f64 = 1e-6;

/// A reflectance or transmittance with its colour.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub(crate) level: f32,
    pub(crate) color: Color,
    /// Roughness of a specular component.
    pub(crate) roughness: f32,
}

/// The optical properties of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Material {
    pub(crate) one_sided: bool,
    /// Real part of the refractive index.
    pub(crate) index: f32,
    pub(crate) diffuse_reflected: Part,
    pub(crate) diffuse_transmitted: Part,
    pub(crate) specular_reflected: Part,
    pub(crate) specular_transmitted: Part,
    /// Exitance, lm/m².
    pub(crate) emitted: Part,
    /// Whether it changed since it was written.
    pub(crate) is_new: bool,
}

impl Default for Material {
    fn default() -> Self {
        Material {
            one_sided: false,
            index: 1.0,
            diffuse_reflected: Part::default(),
            diffuse_transmitted: Part::default(),
            specular_reflected: Part::default(),
            specular_transmitted: Part::default(),
            emitted: Part::default(),
            is_new: true,
        }
    }
}

impl Part {
    fn level(&self) -> f64 {
        f64::from(self.level)
    }

    fn roughness(&self) -> f64 {
        f64::from(self.roughness)
    }

    /// Red, green and blue of the colour at another level.
    fn rgb(&self, level: f64) -> [f64; 3] {
        rgb_of_chromaticity(self.color.chromaticity(), level)
    }

    /// Whether both components are significant and have different colours.
    fn clashes(&self, other: &Part) -> bool {
        self.level() > 0.01 && other.level() > 0.01 && !self.color.is_equivalent(&other.color)
    }
}

/// Writes materials and tracks the spectra written.
pub(crate) struct MaterialWriter {
    /// Write spectra instead of red, green and blue.
    pub(crate) spectral: bool,
    /// Radius of influence of a `glow`, metres; without it emitters are `light`.
    pub(crate) glow_distance: Option<f64>,
    pub(crate) emitter_multiplier: f64,
    known_spectra: Vec<(String, Color)>,
}

impl Default for MaterialWriter {
    fn default() -> Self {
        MaterialWriter { spectral: false, glow_distance: None, emitter_multiplier: 1.0, known_spectra: Vec::new() }
    }
}

impl MaterialWriter {
    /// Writes a material under a name. The error describes a mistake in it.
    pub(crate) fn write(
        &mut self,
        text: &mut Text,
        name: &str,
        material: &Material,
    ) -> Result<Result<(), String>, Error> {
        let Material { diffuse_reflected: rd, diffuse_transmitted: td, .. } = material;
        let Material { specular_reflected: rs, specular_transmitted: ts, emitted: ed, .. } = material;
        if ed.level() > 0.1 {
            self.write_emitter(text, name, ed)?;
            return Ok(Ok(()));
        }
        let sum = rd.level() + td.level() + rs.level() + ts.level();
        if !(0.0..=1.0 + 1e-7).contains(&sum) {
            return Ok(Err(format!("material \"{name}\": its parts add up to {sum}, expected at most 1")));
        }
        let is_clear = material.index > 1.1 && ts.level() > 0.25 && rs.level() <= 0.125;
        let is_smooth = td.level() <= 0.01 && rd.level() <= 0.01 && rs.roughness() <= 0.01 && ts.roughness() <= 0.01;
        if is_clear && is_smooth {
            write_glass(text, name, material)?;
        } else if needs_separate_paths(material) {
            self.write_separate(text, name, material)?;
        } else if td.level() + ts.level() > 0.01 {
            write_trans(text, name, material)?;
        } else if rs.level() < 0.1 && (rs.level() < 0.1 * rd.level() || rs.color.is_grey()) {
            let (pattern, rgb) = self.color(text, rd, rd.level() / (1.0 - rs.level()), "spec*")?;
            self.write_opaque(text, &pattern, "plastic", name, rgb, [rs.level(), rs.roughness()])?;
        } else {
            self.write_metal(text, name, material)?;
        }
        Ok(Ok(()))
    }

    fn write_opaque(
        &self,
        text: &mut Text,
        pattern: &str,
        kind: &str,
        name: &str,
        [r, g, b]: [f64; 3],
        [specular, roughness]: [f64; 2],
    ) -> Result<(), Error> {
        write!(text, "\n{pattern} {kind} {name}\n0\n0\n")?;
        Ok(writeln!(text, "5 {r:.6} {g:.6} {b:.6} {specular:.6} {roughness:.6}")?)
    }

    fn write_emitter(&mut self, text: &mut Text, name: &str, part: &Part) -> Result<(), Error> {
        let level = self.emitter_multiplier * part.level() / (std::f64::consts::PI * WHITE_EFFICACY);
        let (pattern, [r, g, b]) = self.color(text, part, level, "spec*")?;
        match self.glow_distance {
            Some(distance) => write!(text, "\n{pattern} glow {name}\n0\n0\n4 {r:.6} {g:.6} {b:.6} {distance:.6}\n")?,
            None => write!(text, "\n{pattern} light {name}\n0\n0\n3 {r:.6} {g:.6} {b:.6}\n")?,
        }
        Ok(())
    }

    fn write_metal(&mut self, text: &mut Text, name: &str, material: &Material) -> Result<(), Error> {
        let (rd, rs) = (&material.diffuse_reflected, &material.specular_reflected);
        let sum = rd.level() + rs.level();
        let add = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|band| a[band] + b[band]);
        let (pattern, rgb) = if rd.color.is_equivalent(&rs.color) {
            self.color(text, rs, sum, "spec*")?
        } else if rd.level() <= 0.05 {
            let (pattern, rgb) = self.color(text, rs, rs.level(), "spec*")?;
            (pattern, add(rgb, rd.rgb(rd.level())))
        } else {
            ("void".to_owned(), add(rd.rgb(rd.level()), rs.rgb(rs.level())))
        };
        self.write_opaque(text, &pattern, "metal", name, rgb, [rs.level() / sum, rs.roughness()])
    }

    /// Writes a `WGMDfunc`, in which every component has its own colour.
    fn write_separate(&mut self, text: &mut Text, name: &str, material: &Material) -> Result<(), Error> {
        let Material { diffuse_reflected: rd, diffuse_transmitted: td, .. } = material;
        let Material { specular_reflected: rs, specular_transmitted: ts, .. } = material;
        let (mut rs_pattern, mut rs_rgb) = self.color(text, rs, rs.level(), "rs_spec*")?;
        let (mut ts_pattern, mut ts_rgb) = self.color(text, ts, ts.level(), "ts_spec*")?;
        let (td_pattern, td_rgb) = self.color(text, td, td.level(), "td_spec*")?;
        let (rd_pattern, rd_rgb) = self.color(text, rd, rd.level(), "spec*")?;
        for (pattern, rgb, pattern_name) in
            [(&mut rs_pattern, &mut rs_rgb, "rs_rgb*"), (&mut ts_pattern, &mut ts_rgb, "ts_rgb*")]
        {
            if pattern == "void" && !is_grey(*rgb) {
                let [r, g, b] = *rgb;
                write!(text, "\nvoid colorfunc {pattern_name}\n4 {r:.6} {g:.6} {b:.6} .\n0\n0\n")?;
                (*pattern, rgb[1]) = (pattern_name.to_owned(), 1.0);
            }
        }
        write!(text, "\n{rd_pattern} WGMDfunc {name}\n13")?;
        for (pattern, rgb, roughness) in [(rs_pattern, rs_rgb, rs.roughness()), (ts_pattern, ts_rgb, ts.roughness())] {
            writeln!(text, "\t{pattern} {:.6} {roughness:.6} {roughness:.6}", rgb[1])?;
        }
        write!(text, "\t{td_pattern}\n\t0 0 1 .\n0\n9")?;
        for [r, g, b] in [rd_rgb, rd_rgb, td_rgb] {
            writeln!(text, "\t{r:.6} {g:.6} {b:.6}")?;
        }
        Ok(())
    }

    /// The pattern and the colour of a component: a spectrum with a grey, or red, green and blue.
    fn color(&mut self, text: &mut Text, part: &Part, level: f64, unnamed: &str) -> Result<(String, [f64; 3]), Error> {
        let spectrum = part.color.scaled_spectrum().filter(|_| self.spectral && level > TINY);
        let Some(spectrum) = spectrum else { return Ok(("void".to_owned(), part.rgb(level))) };
        let visible: Vec<usize> = (0..SAMPLES).filter(|index| spectrum[*index] != 0.0).collect();
        let (Some(&first), Some(&last)) = (visible.first(), visible.last()) else {
            return Ok(("void".to_owned(), [level; 3]));
        };
        let name = part.color.spectrum_name.as_ref().map_or(unnamed.to_owned(), |name| format!("{name}*"));
        if part.color.spectrum_name.is_some() {
            match self.known_spectra.iter_mut().find(|known| known.0 == name) {
                Some(known) if known.1.is_equivalent(&part.color) => return Ok((name, [level; 3])),
                Some(known) => known.1 = part.color.clone(),
                None => self.known_spectra.push((name.clone(), part.color.clone())),
            }
        }
        let nm = |index: usize| FIRST_NM + STEP_NM * index as i32;
        debug_assert_eq!(nm(SAMPLES - 1), LAST_NM);
        write!(text, "\nvoid spectrum {name}\n0\n0\n{} {} {}", last - first + 3, nm(first), nm(last))?;
        for (place, value) in spectrum[first..=last].iter().enumerate() {
            let before = if (place + 1) % 6 == 0 { "\n\t" } else { "\t" };
            write!(text, "{before}{value:.5}")?;
        }
        writeln!(text)?;
        Ok((name, [level; 3]))
    }
}

/// Whether a simpler Radiance material would confuse roughnesses or colours.
fn needs_separate_paths(material: &Material) -> bool {
    let Material { diffuse_reflected: rd, diffuse_transmitted: td, .. } = material;
    let Material { specular_reflected: rs, specular_transmitted: ts, .. } = material;
    let different_roughness = rs.level() > 0.02 && ts.level() > 0.02 && (rs.roughness() - ts.roughness()).abs() > 0.02;
    let coloured_gloss =
        rs.level() > 0.05 && rd.level() > 0.05 && !rs.color.is_grey() && !rd.color.is_equivalent(&rs.color);
    different_roughness || coloured_gloss || ts.clashes(td) || td.clashes(rd) || rd.clashes(ts)
}

fn write_glass(text: &mut Text, name: &str, material: &Material) -> Result<(), Error> {
    let (rs, ts, index) = (&material.specular_reflected, &material.specular_transmitted, f64::from(material.index));
    let rgb = ts.rgb(ts.level() + rs.level());
    if !material.one_sided {
        let [r, g, b] = rgb;
        return Ok(write!(text, "\nvoid glass {name}\n0\n0\n4 {r:.6} {g:.6} {b:.6} {index:.6}\n")?);
    }
    let [r, g, b] = rgb.map(|value| general(value.powf(1.0 / GLASS_THICKNESS), 6));
    Ok(write!(text, "\nvoid dielectric {name}\n0\n0\n5 {r} {g} {b} {index:.6} 0\n")?)
}

fn write_trans(text: &mut Text, name: &str, material: &Material) -> Result<(), Error> {
    let Material { diffuse_reflected: rd, diffuse_transmitted: td, .. } = material;
    let Material { specular_reflected: rs, specular_transmitted: ts, .. } = material;
    let through = td.level() + ts.level();
    let sum = rd.level() + through;
    let parts = [rd, td, ts].map(|part| part.rgb(part.level() / sum));
    let specular = rs.level() + ts.level();
    let roughness =
        if specular > 0.0001 { (rs.level() * rs.roughness() + ts.level() * ts.roughness()) / specular } else { 0.0 };
    let transmitted = through / sum;
    let scale = if transmitted < 0.999 { rd.level() / (1.0 - rs.level()) / (1.0 - transmitted) } else { through };
    let [r, g, b]: [f64; 3] = std::array::from_fn(|band| scale * parts.iter().map(|part| part[band]).sum::<f64>());
    write!(text, "\nvoid trans {name}\n0\n0\n7 {r:.6} {g:.6} {b:.6}\n")?;
    let [rs, share] = [rs.level(), ts.level() / through];
    Ok(writeln!(text, "\t{rs:.6} {roughness:.6} {transmitted:.6} {share:.6}")?)
}

fn is_grey(rgb: [f64; 3]) -> bool {
    let mean = brightness(rgb);
    rgb.iter().map(|value| (mean - value) * (mean - value)).sum::<f64>() <= mean * mean * 0.0025
}
