//! Quantum efficiency by wavelength.

use crate::SensorError;
use crate::error::within;

/// Quantum efficiency in electrons per photon by wavelength, linear between rows and undefined
/// outside of them.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantumEfficiencyTable {
    /// (wavelength in metres, electrons per photon), by ascending wavelength.
    rows: Vec<[f64; 2]>,
}

impl QuantumEfficiencyTable {
    /// Checks rows of (wavelength in metres, electrons per photon), in any order.
    ///
    /// # Errors
    /// If there are none, a value is out of range, or two rows have the same wavelength.
    pub fn new(rows: &[[f64; 2]]) -> Result<Self, SensorError> {
        let mut rows = rows.to_vec();
        for [wavelength, efficiency] in &rows {
            within("wavelength_nm", nanometres(*wavelength), "positive and finite", |value| value > 0.0)?;
            within("quantum_efficiency", *efficiency, "from 0 to 1", |value| (0.0..=1.0).contains(&value))?;
        }
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if let Some(pair) = rows.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            let (quantity, expected) = ("wavelength_nm", "different in each row");
            return Err(SensorError::OutOfRange { quantity, expected, value: nanometres(pair[0][0]) });
        }
        if rows.is_empty() {
            let (quantity, expected) = ("rows of the quantum efficiency", "at least 1");
            return Err(SensorError::OutOfRange { quantity, expected, value: 0.0 });
        }
        Ok(QuantumEfficiencyTable { rows })
    }

    /// Quantum efficiency at a wavelength in metres, electrons per photon.
    ///
    /// # Errors
    /// If the wavelength is outside the table.
    pub fn at(&self, wavelength_m: f64) -> Result<f64, SensorError> {
        let after = self.rows.partition_point(|row| row[0] < wavelength_m);
        match (after.checked_sub(1).map(|before| self.rows[before]), self.rows.get(after)) {
            (_, Some([wavelength, efficiency])) if *wavelength == wavelength_m => Ok(*efficiency),
            (Some([low, from]), Some([high, to])) => Ok(from + (to - from) * (wavelength_m - low) / (high - low)),
            _ => Err(SensorError::OutsideTable {
                wavelength_nm: nanometres(wavelength_m),
                first_nm: nanometres(self.rows[0][0]),
                last_nm: nanometres(self.rows[self.rows.len() - 1][0]),
            }),
        }
    }
}

/// Metres as nanometres for messages, rounded to remove the digits that the conversion adds.
fn nanometres(metres: f64) -> f64 {
    (metres * 1e15).round() / 1e6
}

/// Dark current at a temperature: it doubles every `doubling_k` kelvin (EMVA Standard 1288, release
/// 4.0, section on dark current; about 8 K for silicon).
#[must_use]
pub fn dark_current_at(temperature_c: f64, reference: f64, reference_c: f64, doubling_k: f64) -> f64 {
    reference * ((temperature_c - reference_c) / doubling_k).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_linear_between_rows_and_ends() {
        let table = QuantumEfficiencyTable::new(&[[600e-9, 0.6], [500e-9, 0.7]]).unwrap();
        assert_eq!(table.at(500e-9).unwrap(), 0.7);
        assert!((table.at(525e-9).unwrap() - 0.675).abs() < 1e-12);
        let message = table.at(601e-9).unwrap_err().to_string();
        assert!(message.starts_with("the quantum efficiency is known from 500 to 600 nm"), "{message}");
        assert!(QuantumEfficiencyTable::new(&[[5e-7, 60.0]]).is_err());
        let twice = QuantumEfficiencyTable::new(&[[400.0 * 1e-9, 0.6], [400.0 * 1e-9, 0.5]]).unwrap_err().to_string();
        assert_eq!(twice, "wavelength_nm must be different in each row, not 400");
        assert!(QuantumEfficiencyTable::new(&[]).is_err());
    }

    #[test]
    fn dark_current_doubles() {
        assert!((dark_current_at(41.0, 5.0, 25.0, 8.0) - 20.0).abs() < 1e-12);
    }
}
