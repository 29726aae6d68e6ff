//! The options with which `rcontrib` sorts the rays of a receiver by direction.

use crate::{Basis, FluxError, Group, Hand, Klems};
use std::f64::consts::PI;

/// Makes the options of the receivers, one after the other.
#[derive(Clone, Debug, Default)]
pub struct ReceiverWords {
    /// Function files that are already loaded.
    loaded: Vec<&'static str>,
    /// Jitter of a direction within its patch (`-bj`).
    jitter: Option<String>,
}

/// Binning of a basis.
struct Bins {
    file: &'static str,
    /// Number of bins.
    count: &'static str,
    /// Variable, or function of the normal and the up direction, that gives a ray's bin.
    bin: &'static str,
    is_function: bool,
    /// Definitions that precede those of the frame.
    size: String,
}

/// Tolerance of a hemisphere's projected solid angle.
const HEMISPHERE_TOLERANCE: f64 = 1e-3;

impl ReceiverWords {
    /// With a range of jitter within bins, as an expression.
    #[must_use]
    pub fn with_jitter(jitter: Option<String>) -> ReceiverWords {
        ReceiverWords { jitter, ..ReceiverWords::default() }
    }

    /// Options of a receiver; its modifier is the last.
    ///
    /// # Errors
    /// If the receiver has no basis, no surface or no normal, or a source that is not a hemisphere.
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
    /// Binning of a basis; `None` if there is one bin.
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
