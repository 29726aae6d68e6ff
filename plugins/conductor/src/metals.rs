//! Measured optical constants.
//!
//! Stainless steel: austenitic (Avesta 832 MV, near AISI 316), Karlsson and Ribbing, "Optical
//! constants and spectral selectivity of stainless steel and its oxides", J. Appl. Phys. 53, 6340,
//! 1982. Aluminium: McPeak et al., "Plasmonic Films Can Easily Be Better: Rules and Recipes", ACS
//! Photonics 2, 326, 2015. Copper: Johnson and Christy, "Optical Constants of the Noble Metals",
//! Phys. Rev. B 6, 4370, 1972. As tabulated by refractiveindex.info (CC0), thinned out.

/// Wavelength in nanometres, n, k.
type Row = (f64, f64, f64);

/// `n` and `k` of a metal at a wavelength (metres): linear between measured wavelengths, constant
/// outside.
pub(crate) fn optical_constants(table: &[Row], wavelength_m: f64) -> (f64, f64) {
    let wavelength = wavelength_m * 1e9;
    let above = table.partition_point(|row| row.0 < wavelength);
    match (above.checked_sub(1).map(|below| table[below]), table.get(above)) {
        (Some(below), Some(above)) => {
            let share = (wavelength - below.0) / (above.0 - below.0);
            (below.1 + share * (above.1 - below.1), below.2 + share * (above.2 - below.2))
        }
        (Some(row), None) | (None, Some(&row)) => (row.1, row.2),
        (None, None) => (1.0, 0.0),
    }
}

pub(crate) const STEEL: &[Row] = &[
    (380.0, 1.4786, 2.6681),
    (400.0, 1.5249, 2.7925),
    (420.0, 1.5762, 2.924),
    (440.0, 1.6386, 3.0555),
    (460.0, 1.7169, 3.1785),
    (480.0, 1.7921, 3.2933),
    (500.0, 1.8636, 3.401),
    (520.0, 1.9349, 3.5072),
    (540.0, 2.0072, 3.6166),
    (560.0, 2.0807, 3.7298),
    (580.0, 2.1557, 3.8451),
    (600.0, 2.2325, 3.9594),
    (620.0, 2.3122, 4.0504),
    (640.0, 2.3962, 4.1378),
    (660.0, 2.4839, 4.2261),
    (680.0, 2.5731, 4.3155),
    (700.0, 2.6617, 4.4066),
    (720.0, 2.7493, 4.5077),
    (740.0, 2.8446, 4.6053),
    (760.0, 2.9377, 4.7102),
    (780.0, 3.0323, 4.8118),
    (800.0, 3.1267, 4.9164),
    (840.0, 3.314, 5.1214),
    (880.0, 3.493, 5.3245),
    (920.0, 3.6643, 5.535),
    (960.0, 3.8331, 5.748),
    (1000.0, 3.9957, 5.948),
];

pub(crate) const ALUMINIUM: &[Row] = &[
    (375.0, 0.327, 3.946),
    (400.0, 0.375, 4.226),
    (425.0, 0.43, 4.503),
    (450.0, 0.489, 4.778),
    (475.0, 0.555, 5.051),
    (500.0, 0.626, 5.32),
    (525.0, 0.704, 5.588),
    (550.0, 0.789, 5.852),
    (575.0, 0.888, 6.113),
    (600.0, 0.992, 6.369),
    (625.0, 1.113, 6.615),
    (650.0, 1.246, 6.852),
    (675.0, 1.396, 7.071),
    (700.0, 1.56, 7.274),
    (725.0, 1.745, 7.447),
    (750.0, 1.958, 7.571),
    (775.0, 2.19, 7.611),
    (800.0, 2.374, 7.523),
    (825.0, 2.399, 7.326),
    (850.0, 2.205, 7.188),
    (875.0, 1.915, 7.218),
    (900.0, 1.647, 7.393),
    (950.0, 1.302, 7.929),
    (1000.0, 1.127, 8.512),
];

pub(crate) const COPPER: &[Row] = &[
    (367.9, 1.36, 1.975),
    (381.5, 1.33, 2.045),
    (397.4, 1.32, 2.116),
    (413.3, 1.28, 2.207),
    (430.5, 1.25, 2.305),
    (450.9, 1.24, 2.397),
    (471.4, 1.25, 2.483),
    (495.9, 1.22, 2.564),
    (520.9, 1.18, 2.608),
    (548.6, 1.02, 2.577),
    (582.1, 0.7, 2.704),
    (616.8, 0.3, 3.205),
    (659.5, 0.22, 3.747),
    (704.5, 0.21, 4.205),
    (756.0, 0.24, 4.665),
    (821.1, 0.26, 5.18),
    (892.0, 0.3, 5.768),
    (984.0, 0.32, 6.421),
    (1088.0, 0.36, 7.217),
];
