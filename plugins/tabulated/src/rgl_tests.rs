//! Tests with a file made from a known model.

use super::*;
use radsight_brdf_sdk::Ggx;

const FACETS: Ggx = Ggx { roughness: 0.35 };
const COLOUR: [f32; 3] = [0.9, 0.5, 0.2];

fn field(name: &str, shape: &[usize], numbers: Vec<f32>) -> Field {
    assert_eq!(shape.iter().product::<usize>(), numbers.len());
    Field { name: name.to_owned(), shape: shape.to_vec(), numbers }
}

/// Writes fields as RGL does.
fn write(fields: &[Field]) -> Vec<u8> {
    let header: usize =
        18 + fields.iter().map(|field| 2 + field.name.len() + 2 + 1 + 8 + 8 * field.shape.len()).sum::<usize>();
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    let mut offset = header;
    for field in fields {
        bytes.extend((field.name.len() as u16).to_le_bytes());
        bytes.extend(field.name.as_bytes());
        bytes.extend((field.shape.len() as u16).to_le_bytes());
        bytes.push(10);
        bytes.extend((offset as u64).to_le_bytes());
        field.shape.iter().for_each(|&size| bytes.extend((size as u64).to_le_bytes()));
        offset += 4 * field.numbers.len();
    }
    assert_eq!(bytes.len(), header);
    fields.iter().flat_map(|field| &field.numbers).for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// Points of a grid with `size` rows and columns.
fn unit_grid(size: usize) -> impl Iterator<Item = (f64, f64)> {
    let at = move |k: usize| k as f64 / (size - 1) as f64;
    (0..size).flat_map(move |row| (0..size).map(move |column| (at(column), at(row))))
}

fn half_vector(x: f64, y: f64) -> DVec3 {
    let (theta, phi) = (FRAC_PI_2 * x * x, (2.0 * y - 1.0) * PI);
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos().max(0.0))
}

/// GGX as an isotropic measurement: the factor besides the facets is `G₂/G₁(o)` times a colour.
fn ggx_file(size: usize, angles: u32) -> Vec<u8> {
    let theta: Vec<f32> =
        (0..angles).map(|k| (FRAC_PI_2 * 0.98 * f64::from(k) / f64::from(angles - 1)) as f32).collect();
    let outgoing = |theta: f32| DVec3::new(f64::from(theta).sin(), 0.0, f64::from(theta).cos());
    let ndf = unit_grid(size).map(|(x, y)| FACETS.density(half_vector(x, y)) as f32).collect();
    let sigma = unit_grid(size)
        .map(|(x, _)| {
            let theta = (FRAC_PI_2 * x * x).min(1.57);
            let o = DVec3::new(theta.sin(), 0.0, theta.cos());
            (o.z * (1.0 + FACETS.lambda(o))) as f32
        })
        .collect();
    let (mut vndf, mut rgb) = (Vec::new(), Vec::new());
    for &angle in &theta {
        let o = outgoing(angle);
        let density = |(x, y): (f64, f64)| {
            let half = half_vector(x, y);
            (FACETS.density(half) * half.dot(o).max(0.0) * x * half.x.hypot(half.y) + 1e-4) as f32
        };
        let grid: Vec<f32> = unit_grid(size).map(density).collect();
        let warp = Warp::new(Grids::new(grid.clone(), 1, size, size).unwrap());
        vndf.extend(grid);
        let shading: Vec<f32> = unit_grid(size)
            .map(|(u, v)| {
                let (x, y) = warp.sample(&ONLY, (u, v));
                let half = half_vector(x, y);
                let i = half * (2.0 * half.dot(o)) - o;
                if i.z <= 0.0 {
                    return 0.0;
                }
                ((1.0 + FACETS.lambda(o)) / (1.0 + FACETS.lambda(o) + FACETS.lambda(i))) as f32
            })
            .collect();
        COLOUR.iter().for_each(|colour| rgb.extend(shading.iter().map(|value| value * colour)));
    }
    let directions = theta.len();
    write(&[
        field("phi_i", &[1], vec![0.0]),
        field("theta_i", &[directions], theta),
        field("ndf", &[size, size], ndf),
        field("sigma", &[size, size], sigma),
        field("vndf", &[1, directions, size, size], vndf),
        field("luminance", &[1, directions, 2, 2], vec![1.0; 4 * directions]),
        field("rgb", &[1, directions, 3, size, size], rgb),
    ])
}

const RGB: [Band; 3] = [
    Band { centre_m: 650e-9, low_m: 588e-9, high_m: 780e-9 },
    Band { centre_m: 534e-9, low_m: 480e-9, high_m: 588e-9 },
    Band { centre_m: 430e-9, low_m: 380e-9, high_m: 480e-9 },
];

#[test]
fn a_known_model_is_reconstructed_from_its_tables() {
    let measurement = Measurement::read(&ggx_file(48, 24), &RGB, 1.0).unwrap();
    for (outgoing, incident) in [
        (DVec3::new(0.0, 0.3, 0.9), DVec3::new(0.05, -0.2, 0.9)),
        (DVec3::new(0.6, 0.1, 0.7), DVec3::new(-0.5, 0.1, 0.8)),
        (DVec3::new(0.3, -0.3, 0.6), DVec3::new(0.2, 0.4, 0.7)),
    ] {
        let (outgoing, incident) = (outgoing.normalize(), incident.normalize());
        let mut values = [0.0; 3];
        let pdf = measurement.eval_pdf(outgoing, incident, &mut values);
        let right = FACETS.reflect(outgoing, incident);
        for (value, colour) in values.iter().zip(COLOUR) {
            let off = value / (right.value * f64::from(colour)) - 1.0;
            assert!(off.abs() < 0.05, "{value} is {off} off for {outgoing} {incident}");
        }
        assert!((pdf / right.pdf - 1.0).abs() < 0.1, "{pdf}, expected about {}", right.pdf);
    }
}

#[test]
fn damaged_files_are_rejected_with_a_reason() {
    let whole = ggx_file(48, 24);
    let refusal = |bytes: &[u8]| Measurement::read(bytes, &RGB, 1.0).err().unwrap();
    assert_eq!(refusal(b"MERL"), "it is no RGL file: it does not begin with \"tensor_file\"");
    assert_eq!(refusal(&whole[..40]), "it ends in its table of contents, at byte 40");
    assert!(refusal(&whole[..whole.len() / 2]).ends_with("does not fit into the file"));
    let mut huge = whole.clone();
    // The first size of "phi_i".
    huge[18 + 2 + 5 + 2 + 1 + 8..][..8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(refusal(&huge).contains("does not fit into the file"), "{}", refusal(&huge));
}

#[test]
fn spectra_are_averaged_over_a_band() {
    let shares = channel_shares(&[400.0, 500.0, 600.0], &Band { centre_m: 525e-9, low_m: 522e-9, high_m: 528e-9 });
    assert_eq!(shares.len(), 2);
    assert!((shares[0].1 - 0.75).abs() < 1e-6 && shares[0].0 == 1, "{shares:?}");
}

/// Not a test: writes the file of the example scene.
#[test]
#[ignore = "writes into the sources"]
fn write_the_example_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/example.bsdf");
    std::fs::write(path, ggx_file(20, 9)).unwrap();
}
