//! The options with which `rcontrib` sorts what a receiver gets.

use crate::{Basis, FluxError, Group, Hand, Klems};
use std::f64::consts::PI;

/// Makes the options of one receiver after another.
#[derive(Clone, Debug, Default)]
pub struct ReceiverWords {
    /// Function files that were named already.
    loaded: Vec<&'static str>,
    /// Where in its patch a direction counts (`-bj`).
    jitter: Option<String>,
}

/// What a basis asks for.
struct Bins {
    file: &'static str,
    /// The number of bins.
    count: &'static str,
    /// The variable, or function of the normal and the up direction, that gives a ray's bin.
    bin: &'static str,
    is_function: bool,
    /// The definitions before the frame's.
    size: String,
}

/// How far the projected solid angle of a hemisphere may be off.
const HEMISPHERE_TOLERANCE: f64 = 1e-3;

impl ReceiverWords {
    /// With a range of jitter within bins, as an expression.
    #[must_use]
    pub fn with_jitter(jitter: Option<String>) -> ReceiverWords {
        ReceiverWords { jitter, ..ReceiverWords::default() }
    }

    /// The options of a receiver, its modifier's last.
    ///
    /// # Errors
    /// When the receiver has no basis, no surface or no normal, or a source that is no hemisphere.
    pub fn of(&mut self, group: &Group) -> Result<Vec<String>, FluxError> {
        let first = group.surfaces.first().ok_or(FluxError::Nothing)?;
        let missing = || FluxError::NoBasis { modifier: group.modifier.clone() };
        let basis = group.parameters.basis.ok_or_else(missing)?;
        let [normal, up] = group.frame()?;
        let (normal, up) = (normal.to_array(), up.to_array());
        let mut words = Vec::new();
        let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
        if let Some(output) = &group.parameters.output {
            option("-o", output.clone());
        }
        let bins = match basis.bins() {
            None => {
                let [x, y, z] = normal;
                let front = format!("if(-Dx*({x})-Dy*({y})-Dz*({z}),0,-1)");
                option("-bn", "1".to_owned());
                option("-b", if first.is_distant() { "0".to_owned() } else { front });
                option("-m", group.modifier.clone());
                return Ok(words);
            }
            Some(bins) => bins,
        };
        let small = |area: f64| (area - PI).abs() > HEMISPHERE_TOLERANCE;
        if let Some(source) = group.surfaces.iter().find(|surface| surface.is_distant() && small(surface.area)) {
            return Err(FluxError::SmallSource { surface: source.name.clone() });
        }
        if !self.loaded.contains(&bins.file) {
            self.loaded.push(bins.file);
            option("-f", bins.file.to_owned());
        }
        let hand = if group.parameters.hand == Hand::Left { "-1" } else { "+1" };
        let jitter = self.jitter.as_ref().map_or(String::new(), |jitter| format!(",JTR={jitter}"));
        let frame = if bins.is_function {
            String::new()
        } else {
            let [[x, y, z], [u, v, w]] = [normal, up];
            format!("{}rNx={x},rNy={y},rNz={z},Ux={u},Uy={v},Uz={w},", bins.size)
        };
        option("-p", format!("{frame}RHS={hand}{jitter}"));
        option("-bn", bins.count.to_owned());
        let [[x, y, z], [u, v, w]] = [normal, up];
        let of_frame = format!("{}({x},{y},{z},{u},{v},{w})", bins.bin);
        option("-b", if bins.is_function { of_frame } else { bins.bin.to_owned() });
        option("-m", group.modifier.clone());
        Ok(words)
    }
}

impl Basis {
    /// `None` where there is one bin.
    fn bins(self) -> Option<Bins> {
        let klems = |file, count, bin| Bins { file, count, bin, is_function: true, size: String::new() };
        let variable = |file, count, bin, size| Bins { file, count, bin, is_function: false, size };
        Some(match self {
            Basis::Uniform => return None,
            Basis::ShirleyChiu(size) => variable("disk2square.cal", "SCdim*SCdim", "scbin", format!("SCdim={size},")),
            Basis::Reinhart(size) => variable("reinhartb.cal", "Nrbins", "rbin", format!("MF={size},")),
            Basis::Cie => variable("cieskyscan.cal", "Ncbins", "cbin", String::new()),
            Basis::Klems(Klems::Full) => klems("klems_full.cal", "Nkbins", "kbin"),
            Basis::Klems(Klems::Half) => klems("klems_half.cal", "Nkhbins", "khbin"),
            Basis::Klems(Klems::Quarter) => klems("klems_quarter.cal", "Nkqbins", "kqbin"),
        })
    }
}
