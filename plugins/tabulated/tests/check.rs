//! Both models pass all checks, with files that are made here.

use radsight_brdf_host::check::{self, Example};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// A file in MERL's format with a matte and a glossy part.
fn write_merl(path: &Path) {
    let mut bytes: Vec<u8> = [90i32, 90, 180].into_iter().flat_map(i32::to_le_bytes).collect();
    for scale in [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0f64] {
        for cell in 0..90 * 90 * 180 {
            let share = (f64::from(cell / (90 * 180)) + 0.5) / 90.0;
            let half: f64 = FRAC_PI_2 * share * share;
            let value = 0.3 / PI + 0.5 * (-(half / 0.1).powi(2)).exp();
            bytes.extend((value / scale).to_le_bytes());
        }
    }
    std::fs::write(path, bytes).expect("the file is written");
}

/// A file in RGL's format: two angles, smooth tables.
fn write_rgl(path: &Path) {
    let theta = vec![0.0f32, 0.8, 1.5];
    let size = 16;
    let grid = |f: &dyn Fn(f32, f32) -> f32| -> Vec<f32> {
        let at = |k: usize| k as f32 / (size - 1) as f32;
        (0..size * size).map(|k| f(at(k % size), at(k / size))).collect()
    };
    let ndf = grid(&|x, _| 2.0 * (1.0 - 0.9 * x * x));
    let sigma = grid(&|_, _| 1.0);
    let visible: Vec<f32> =
        theta.iter().flat_map(|&t| grid(&|x, y| 0.2 + x * (1.0 - 0.4 * t * (y - 0.5).abs()))).collect();
    let luminance: Vec<f32> = theta.iter().flat_map(|_| vec![1.0f32, 0.8, 0.9, 1.1]).collect();
    let rgb: Vec<f32> =
        theta.iter().flat_map(|_| [0.3, 0.2, 0.1].map(|c| grid(&|x, _| c * (1.0 - 0.5 * x)))).flatten().collect();
    let fields: [(&str, &[u64], Vec<f32>); 7] = [
        ("phi_i", &[1], vec![0.0]),
        ("theta_i", &[3], theta),
        ("ndf", &[16, 16], ndf),
        ("sigma", &[16, 16], sigma),
        ("vndf", &[1, 3, 16, 16], visible),
        ("luminance", &[1, 3, 2, 2], luminance),
        ("rgb", &[1, 3, 3, 16, 16], rgb),
    ];
    let mut offset = 18 + fields.iter().map(|(name, shape, _)| 13 + name.len() + 8 * shape.len()).sum::<usize>();
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for (name, shape, numbers) in &fields {
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        bytes.push(10);
        bytes.extend((offset as u64).to_le_bytes());
        shape.iter().for_each(|size| bytes.extend(size.to_le_bytes()));
        offset += 4 * numbers.len();
    }
    fields.iter().flat_map(|(_, _, numbers)| numbers).for_each(|number| bytes.extend(number.to_le_bytes()));
    std::fs::write(path, bytes).expect("the file is written");
}

#[test]
fn the_plugin_passes_its_checks() {
    let library = check::library_beside(&std::env::current_exe().expect("tests have a program"), "tabulated");
    let folder = std::env::temp_dir().join(format!("radsight-tabulated-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the folder is made");
    let example = |model: &str, file: &str| Example {
        model: model.to_owned(),
        words: vec![folder.join(file).to_string_lossy().into_owned()],
        numbers: vec![],
    };
    write_merl(&folder.join("made.binary"));
    write_rgl(&folder.join("made.bsdf"));
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/example.bsdf");
    let examples = vec![example("merl", "made.binary"), example("rgl", "made.bsdf"), example("rgl", beside)];
    let report = check::run_in_process(&library, examples, 1);
    let _ = std::fs::remove_dir_all(&folder);
    assert!(report.passed(), "{}", report.text());
    assert_eq!(report.outcomes.len(), 19, "{}", report.text());
}
