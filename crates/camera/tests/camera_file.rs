//! Reading camera files: what is understood, and the whole text of the messages.

use radsight_camera::{CameraFile, LedEmission};
use radsight_diag::SourceMap;
use radsight_loader::MemoryLoader;
use radsight_pinhole::PinholeModel;
use radsight_sensor::{ExposureUnit, Sensor};

const CAMERA: &str = r#"[camera]
position_m = [0.0, 0.0, 0.48]
direction = [0.0, 0.0, -1.0]
up = [0.0, 1.0, 0.0]
pixels = [192, 165]
pixel_pitch_um = [13.75, 16.0]
focal_distance_mm = 6.75
pinhole_diameter_mm = 0.1
pinhole_model = "finite"          # "point" | "finite" | "diffraction"
exposure_ms = 10.0
wavelength_nm = 650.0
"#;

const RIG: &str = r#"
[rig]
leds = 12
ring_diameter_mm = 25.4
led_diameter_mm = 5.0
led_intensity_w_per_sr = 0.055    # on the axis of each LED
led_cone_deg = 7.0
"#;

const SENSOR: &str = r#"
[sensor]
response = "power-law"            # Eq. 5; or "emva1288"
k = 33844.0
gamma = 0.85
grey_background = 12
grey_max = 161
exposure_unit = "uJ/cm2"
bits = 8
band_weights = [1, 1, 1]
"#;

fn read_with(text: &str, loader: &MemoryLoader) -> Result<(CameraFile, String), String> {
    let mut sources = SourceMap::default();
    let file = CameraFile::read("rigs/camera.toml", text.as_bytes(), &mut sources, loader);
    let render = |messages: &[radsight_diag::Diagnostic]| messages.iter().map(|m| m.render(&sources)).collect();
    match file {
        Ok(file) => {
            let warnings = render(&file.warnings);
            Ok((file, warnings))
        }
        Err(errors) => {
            assert!(!errors.is_empty());
            Err(render(&errors))
        }
    }
}

fn read(text: &str) -> Result<(CameraFile, String), String> {
    read_with(text, &MemoryLoader::default())
}

fn errors(text: &str) -> String {
    read(text).map(|(file, _)| format!("{file:?}")).unwrap_err()
}

#[test]
fn the_papers_camera_is_understood() {
    let (file, warnings) = read(&format!("{CAMERA}{RIG}{SENSOR}")).unwrap();
    assert_eq!(warnings, "");
    assert_eq!((file.camera.columns(), file.camera.rows()), (192, 165));
    assert!((file.camera.focal_distance_m() - 6.75e-3).abs() < 1e-18);
    assert_eq!(file.camera.pinhole_model(), PinholeModel::Finite);
    assert_eq!(file.camera.wavelength_m().map(|w| (w * 1e9).round()), Some(650.0));
    let rig = file.rig.as_ref().unwrap();
    assert_eq!(rig.emission, LedEmission::Cone { full_angle_deg: 7.0 });
    // I₀/A = 0.055 W/sr over 19.635 mm².
    assert!((rig.axial_radiance() - 2801.13).abs() < 0.01, "{}", rig.axial_radiance());
    let Some(Sensor::PowerLaw(sensor)) = file.sensor else { panic!("a power law was asked for") };
    assert_eq!(sensor.description().exposure_unit, ExposureUnit::MicrojoulePerSquareCentimetre);
    assert_eq!(file.band_weights_for(3).unwrap().as_slice().len(), 3);
    assert_eq!(file.band_weights_for(1).unwrap().as_slice(), [1.0]);
}

#[test]
fn a_camera_alone_is_enough() {
    let minimal = CAMERA.lines().filter(|line| !line.contains("wavelength") && !line.contains("pinhole_model"));
    let (file, _) = read(&minimal.collect::<Vec<_>>().join("\r\n")).unwrap();
    assert!(file.rig.is_none() && file.sensor.is_none() && file.camera.wavelength_m().is_none());
    assert_eq!(file.camera.scene_unit_m(), 1.0);
}

#[test]
fn an_emva1288_sensor_takes_pixel_time_and_wavelength_from_the_camera() {
    let text = "[sensor]\nresponse = \"emva1288\"\nquantum_efficiency = 0.6\ngain_dn_per_e = 0.25\nfull_well_e = 14000\n\
                read_noise_e = 12\nbits = 12\n";
    let (file, _) = read(&format!("{CAMERA}{text}")).unwrap();
    let Some(Sensor::Emva1288(sensor)) = file.sensor else { panic!("a linear sensor was asked for") };
    assert_eq!(sensor.description().exposure_s, 0.01);
    assert!((sensor.description().pixel_area_m2 - 13.75e-6 * 16e-6).abs() < 1e-24);
    let without = CAMERA.replace("wavelength_nm = 650.0\n", "");
    insta::assert_snapshot!("emva1288_without_wavelength", errors(&format!("{without}{text}")));
}

#[test]
fn every_mistake_of_a_camera_is_shown() {
    let text = r#"[camera]
position_m = [0.0, 0.0]
direction = [0.0, nan, -1.0]
up = "y"
pixels = [192, 165.5]
pixel_pich_um = [13.75, 16.0]
focal_distance_mm = inf
pinhole_diameter_mm = -1e-1
pinhole_model = "finit"
exposure_ms = "10"
wavelength_nm = 0
zebra = 1
"#;
    insta::assert_snapshot!(errors(text));
}

#[test]
fn every_mistake_of_a_rig_is_shown() {
    let text = "[rig]\nleds = 0\nring_diameter_mm = 1e400\nled_diameter_mm = true\nled_cone_deg = 270\n";
    insta::assert_snapshot!(errors(&format!("{CAMERA}{text}")));
}

#[test]
fn every_mistake_of_a_sensor_is_shown() {
    let text = r#"[sensor]
response = "power-law"
k = [33844.0]
gama = 0.85
grey_background = -12
grey_max = 300
exposure_unit = "uJ/cm"
bits = 9
band_weights = [0, 0]
"#;
    insta::assert_snapshot!(errors(&format!("{CAMERA}{text}")));
}

#[test]
fn a_grey_max_that_the_bits_cannot_hold_is_shown() {
    insta::assert_snapshot!(errors(&format!("{CAMERA}{}", SENSOR.replace("161", "300"))));
}

#[test]
fn an_unknown_response_is_shown_once() {
    insta::assert_snapshot!(errors(&format!("{CAMERA}[sensor]\nresponse = \"powerlaw\"\nk = 1\n")));
}

#[test]
fn up_along_direction_is_shown_at_up() {
    insta::assert_snapshot!(errors(&CAMERA.replace("[0.0, 1.0, 0.0]", "[0.0, 0.0, 3.0]")));
}

#[test]
fn unknown_tables_and_a_missing_camera_are_shown() {
    insta::assert_snapshot!(errors("camra = 1\n[sensors]\nk = 1\n[rig]\n"));
}

#[test]
fn syntax_errors_are_shown() {
    insta::assert_snapshot!(errors("[camera]\npixels = [192, 165\nup = = 3\npixels = [1, 2]\n"));
}

#[test]
fn a_table_is_found_beside_the_camera_file() {
    let text = format!("{CAMERA}{}led_table = \"leds/hlmp.csv\"\n", RIG);
    let loader = MemoryLoader::default().with("rigs/leds/hlmp.csv", "angle_deg,relative_intensity\n0,1\n10,0.1\n");
    let (file, warnings) = read_with(&text, &loader).unwrap();
    assert!(matches!(file.rig.unwrap().emission, LedEmission::Table(_)));
    insta::assert_snapshot!(warnings);
}

#[test]
fn a_bad_table_is_shown_with_the_place_that_names_it() {
    let text = format!("{CAMERA}{}led_table = \"hlmp.csv\"\n", RIG.replace("led_cone_deg = 7.0\n", ""));
    insta::assert_snapshot!("missing_table", errors(&text));
    let loader = MemoryLoader::default().with("rigs/hlmp.csv", "angle_deg,relative_intensity\n0,1\n2,NaN\n");
    insta::assert_snapshot!("nan_in_table", read_with(&text, &loader).unwrap_err());
}

#[test]
fn suspicious_values_are_warned_of() {
    let text = CAMERA
        .replace("pinhole_diameter_mm = 0.1", "pinhole_diameter_mm = 10")
        .replace("[13.75, 16.0]", "[13750.0, 16000.0]")
        .replace("650.0", "0.65");
    let rig = RIG.replace("ring_diameter_mm = 25.4", "ring_diameter_mm = 12.0");
    insta::assert_snapshot!(read(&format!("{text}{rig}")).unwrap().1);
}

/// Cut at every byte, and with every byte replaced, a file must give an answer without a panic.
#[test]
fn damaged_files_never_panic() {
    let whole = format!("{CAMERA}{RIG}{SENSOR}");
    let bytes = whole.as_bytes();
    for at in 0..bytes.len() {
        for damage in [&b""[..], b"\xff", b"[", b"\"", b"-", b"9999999999", b"{"] {
            let damaged = [&bytes[..at], damage, &bytes[(at + 1).min(bytes.len())..]].concat();
            let mut sources = SourceMap::default();
            if let Err(errors) = CameraFile::read("c", &damaged, &mut sources, &MemoryLoader::default()) {
                assert!(errors.iter().all(|error| error.render(&sources).len() < 4000));
            }
        }
        let mut sources = SourceMap::default();
        let _ = CameraFile::read("c", &bytes[..at], &mut sources, &MemoryLoader::default());
    }
}

#[test]
fn deep_nesting_and_large_files_are_refused() {
    assert!(!errors(&format!("x = {}", "[".repeat(100_000))).is_empty());
    assert!(errors(&" ".repeat(2 << 20)).contains("expected at most"));
}

const LINEAR: &str = "\n[sensor]\nresponse = \"emva1288\"\nquantum_efficiency = 0.6\ngain_dn_per_e = 0.25\n\
                      full_well_e = 12000\nread_noise_e = 8\nbits = 12\n";

fn linear(text: &str, loader: &MemoryLoader) -> radsight_sensor::Emva1288 {
    let (file, _) = read_with(text, loader).unwrap();
    let Some(Sensor::Emva1288(sensor)) = file.sensor else { panic!("a linear sensor was asked for") };
    sensor
}

#[test]
fn differences_between_pixels_and_warm_dark_current_are_read() {
    let keys = "dsnu_e = 2.0\ndsnu_column_e = 1.0\nprnu_percent = 0.8\nspecimen = 3\n\
                dark_current_e_per_s = 5.0\ntemperature_c = 41.0\ndark_reference_c = 25.0\ndark_doubling_k = 8.0\n";
    let sensor = linear(&format!("{CAMERA}{LINEAR}{keys}"), &MemoryLoader::default());
    let uneven = sensor.non_uniformity().unwrap();
    assert_eq!((uneven.dsnu_e.pixel, uneven.dsnu_e.column, uneven.prnu.pixel), (2.0, 1.0, 0.008));
    assert_eq!((uneven.columns, uneven.specimen), (192, 3));
    assert!((sensor.description().dark_current_e_per_s - 20.0).abs() < 1e-9);
    let errors = read(&format!("{CAMERA}{LINEAR}temperature_c = 41.0\n")).unwrap_err();
    assert!(errors.contains("go together"), "{errors}");
    let errors = read(&format!("{CAMERA}{LINEAR}prnu_percent = 50\n")).unwrap_err();
    assert!(errors.contains("\nprnu_percent") || errors.contains("prnu_percent must be from 0 to 30"), "{errors}");
}

#[test]
fn a_table_of_quantum_efficiency_is_read_at_the_wavelength() {
    let loader = MemoryLoader::default().with("rigs/qe.csv", "wavelength_nm,quantum_efficiency\n600,0.7\n700,0.5\n");
    let text = format!("{CAMERA}{LINEAR}").replace("quantum_efficiency = 0.6", "quantum_efficiency_table = \"qe.csv\"");
    let found = linear(&text, &loader).description().quantum_efficiency;
    assert!((found - 0.6).abs() < 1e-12, "{found}");
    let far = text.replace("wavelength_nm = 650.0", "wavelength_nm = 850.0");
    let errors = read_with(&far, &loader).unwrap_err();
    assert!(errors.contains("is known from 600 to 700 nm, not at 850 nm"), "{errors}");
}

#[test]
fn a_preset_fills_in_what_its_source_states_and_nothing_else() {
    let sensor = "\n[sensor]\nresponse = \"emva1288\"\npreset = \"imx174\"\nbits = 12\n";
    let green = CAMERA.replace("650.0", "525.0");
    let found = linear(&format!("{green}{sensor}"), &MemoryLoader::default());
    let description = found.description();
    assert_eq!((description.quantum_efficiency, description.full_well_e), (0.77, 32_691.0));
    assert!((description.gain_dn_per_e - 1.0 / 8.16).abs() < 1e-12);
    let own = linear(&format!("{green}{sensor}full_well_e = 20000\n"), &MemoryLoader::default());
    assert_eq!(own.description().full_well_e, 20_000.0);
    // The source says nothing of red light.
    let errors = read(&format!("{CAMERA}{sensor}")).unwrap_err();
    let expected = "[sensor] has no \"quantum_efficiency\", and preset \"imx174\" states it at 525 nm alone";
    assert!(errors.contains(expected), "{errors}");
    let errors = read(&format!("{CAMERA}{}", sensor.replace("imx174", "imx250"))).unwrap_err();
    assert!(errors.contains("and preset \"imx250\" does not state it"), "{errors}");
    let errors = read(&format!("{}{sensor}", green.replace("= 525.0", "= \"green\""))).unwrap_err();
    assert!(!errors.contains("quantum_efficiency"), "a wrong camera has no wavelength to look for: {errors}");
    let errors = read(&format!("{CAMERA}{}", sensor.replace("imx174", "imx175"))).unwrap_err();
    assert!(errors.contains("hint: did you mean \"imx174\"?"), "{errors}");
}

#[test]
fn the_tc211_has_what_its_source_states_and_asks_for_the_rest() {
    let sensor = "\n[sensor]\nresponse = \"emva1288\"\npreset = \"tc211\"\nbits = 12\n";
    let whole = format!("{CAMERA}{sensor}quantum_efficiency = 0.5\ngain_dn_per_e = 0.02\n");
    let found = linear(&whole, &MemoryLoader::default());
    let description = found.description();
    assert_eq!((description.full_well_e, description.read_noise_e), (150_000.0, 12.0));
    let errors = read(&format!("{CAMERA}{sensor}")).unwrap_err();
    for key in ["quantum_efficiency", "gain_dn_per_e"] {
        assert!(errors.contains(&format!("[sensor] has no \"{key}\"")), "{errors}");
    }
}

#[test]
fn a_mosaic_has_its_filters_in_the_band_weights() {
    let (file, _) = read(&format!("{CAMERA}{LINEAR}mosaic = \"GRBG\"\nfilter_green = [0.1, 0.9, 0.2]\n")).unwrap();
    assert_eq!(file.mosaic.unwrap().name(), "GRBG");
    let weights = file.band_weights_for(3).unwrap();
    assert!((weights.combine_at(0, &[3.0, 6.0, 9.0]) - (0.1 + 1.8 + 0.6)).abs() < 1e-12);
    assert!((weights.combine_at(1, &[3.0, 6.0, 9.0]) - 1.0).abs() < 1e-12);
    let errors = read(&format!("{CAMERA}{LINEAR}mosaic = \"RGBG\"\n")).unwrap_err();
    assert!(errors.contains("unknown mosaic \"RGBG\""), "{errors}");
    let errors = read(&format!("{CAMERA}{LINEAR}mosaic = \"RGGB\"\nfilter_red = [1.5, 0, 0]\n")).unwrap_err();
    assert!(errors.contains("\"filter_red\" passes 1.5 of a band, expected 0 to 1"), "{errors}");
    assert!(errors.contains(" | filter_red = [1.5, 0, 0]\n"), "{errors}");
    let errors = read(&format!("{CAMERA}{LINEAR}filter_red = [1, 0, 0]\n")).unwrap_err();
    assert!(errors.contains("filter_red does not apply with a sensor without mosaic: "), "{errors}");
}

#[test]
fn diffraction_takes_its_wavelength_and_distance() {
    let text = CAMERA.replace("\"finite\" ", "\"diffraction\" ");
    let (file, _) = read(&format!("{text}object_distance_m = 0.48\nband_wavelengths_nm = [620, 540, 460]\n")).unwrap();
    assert_eq!(file.camera.pinhole_model(), PinholeModel::Diffraction);
    let errors = read(&text.replace("wavelength_nm = 650.0", "")).unwrap_err();
    assert!(errors.contains("needs the wavelength") && errors.contains("hint: for example"), "{errors}");
    let errors = read(&format!("{CAMERA}object_distance_m = 0.48\n")).unwrap_err();
    assert!(
        errors.contains("object_distance_m does not apply with pinhole_model = \"finite\": only pinhole_model"),
        "{errors}"
    );
}

#[test]
fn a_lens_stands_in_the_place_of_the_hole() {
    let without = CAMERA.replace("focal_distance_mm = 6.75\npinhole_diameter_mm = 0.1\n", "");
    let without = without.lines().filter(|line| !line.starts_with("pinhole_model")).collect::<Vec<_>>().join("\n");
    let lens = "\nlens_focal_length_mm = 8.0\nf_number = 2.0\nfocus_distance_m = 0.48\n";
    let (file, _) = read(&format!("{without}{lens}front_stop_mm = [20.0, 6.0]\n")).unwrap();
    let lens_read = file.camera.lens().unwrap();
    assert!((lens_read.aperture_m - 4e-3).abs() < 1e-15 && lens_read.front_stop.is_some());
    assert!((file.camera.focal_distance_m() - 1.0 / (1.0 / 8e-3 - 1.0 / 0.48)).abs() < 1e-12);
    let errors = read(&format!("{without}{}", lens.replace("0.48", "0.005"))).unwrap_err();
    assert!(errors.contains("cannot focus at 0.005 m"), "{errors}");
    let errors = read(&format!("{CAMERA}{lens}")).unwrap_err();
    for key in ["focal_distance_mm", "pinhole_diameter_mm", "pinhole_model"] {
        assert!(errors.contains(&format!("{key} does not apply with lens_focal_length_mm: ")), "{key}: {errors}");
    }
    assert_eq!(errors.matches("error: ").count(), 3, "{errors}");
}

const TELECENTRIC: &str = r#"[camera]
position_m = [0.0, 0.0, 0.11]
direction = [0.0, 0.0, -1.0]
up = [0.0, 1.0, 0.0]
pixels = [200, 150]
pixel_pitch_um = [5.0, 5.0]
projection = "parallel"
field_width_mm = 10.0
f_number = 8.0
focus_distance_m = 0.11
exposure_ms = 2.0
"#;

#[test]
fn a_parallel_view_has_the_field_and_the_aperture_of_a_telecentric_lens() {
    let (file, warnings) = read(TELECENTRIC).unwrap();
    assert_eq!(warnings, "");
    let lens = file.camera.telecentric_lens().expect("a telecentric lens");
    assert!((lens.magnification - 0.1).abs() < 1e-12 && lens.f_number == 8.0 && lens.focus_distance_m == 0.11);
    assert!(file.summary().starts_with("telecentric lens of f-number 8, magnification 0.1,"));
    // sin θ = m/(2 N), on the side of the scene.
    let angle = (0.1_f64 / 16.0).asin().to_degrees();
    let by_angle = TELECENTRIC.replace("f_number = 8.0", &format!("aperture_half_angle_deg = {angle}"));
    let (file, _) = read(&by_angle).unwrap();
    assert!((file.camera.telecentric_lens().unwrap().f_number - 8.0).abs() < 1e-9);
}

#[test]
fn keys_that_do_not_fit_a_parallel_view_are_shown_with_their_reason() {
    let pinhole = TELECENTRIC.replace("exposure_ms", "focal_distance_mm = 8.0\npinhole_model = \"point\"\nexposure_ms");
    let shown = errors(&pinhole);
    assert!(
        shown.contains("focal_distance_mm does not apply to projection \"parallel\": field_width_mm gives"),
        "{shown}"
    );
    assert!(shown.contains("pinhole_model does not apply") && shown.matches("error").count() == 2, "{shown}");
    let both = TELECENTRIC.replace("f_number = 8.0", "f_number = 8.0\naperture_half_angle_deg = 1.0");
    assert!(errors(&both).contains("both give the aperture"), "{}", errors(&both));
    let wide = TELECENTRIC.replace("f_number = 8.0", "f_number = 0.4");
    assert!(
        errors(&wide).contains("numerical aperture of the lens is 1.25: expected less than 1"),
        "{}",
        errors(&wide)
    );
    let none = TELECENTRIC.replace("field_width_mm = 10.0\n", "");
    assert!(errors(&none).contains("has no \"field_width_mm\""), "{}", errors(&none));
    let elsewhere = format!("{CAMERA}field_width_mm = 3.0\n");
    assert!(errors(&elsewhere).contains("field_width_mm applies to projection = \"parallel\" only"));
}

#[test]
fn a_calibrated_camera_gives_size_pitch_and_distortion() {
    let matrix = "image_width: 320\nimage_height: 240\ncamera_matrix: {data: [500, 0, 160, 0, 510, 121, 0, 0, 1]}\n\
                  distortion_coefficients: {data: [-0.1, 0.02, 0, 0, 0]}\n";
    let loader = MemoryLoader::default().with("rigs/calibrated.yaml", matrix);
    let text = CAMERA
        .replace("pixels = [192, 165]\npixel_pitch_um = [13.75, 16.0]\n", "camera_matrix = \"calibrated.yaml\"\n");
    let (file, warnings) = read_with(&text, &loader).unwrap();
    assert_eq!((file.camera.columns(), file.camera.rows(), warnings.as_str()), (320, 240, ""));
    assert!((file.camera.pixel_pitch_m()[0] - 6.75e-3 / 500.0).abs() < 1e-15);
    let (_, warnings) = read_with(&format!("{text}pixels = [100, 100]\n"), &loader).unwrap();
    assert!(warnings.contains("of a picture of 320 x 240 pixels"), "{warnings}");
    let broken = MemoryLoader::default().with("rigs/calibrated.yaml", "camera_matrix: [1, 2]\n");
    assert!(read_with(&text, &broken).unwrap_err().contains("has 2 numbers, expected 9"));
}

const TOLERANCES: &str = "\n[tolerances]\nspecimen = 4\ncamera_shift_mm = 0.5\ncamera_turn_deg = 0.3\nsensor_shift_um = 40\n\
                          sensor_tilt_deg = 0.5\nring_shift_mm = 0.2\nring_turn_deg = 0.4\nled_shift_mm = 0.1\n\
                          led_tilt_deg = 1.0\nled_intensity_percent = 8\n";

#[test]
fn what_was_drawn_can_be_read_back_and_is_the_same_specimen() {
    let (drawn, _) = read(&format!("{CAMERA}{RIG}{TOLERANCES}")).unwrap();
    let (again, _) = read(&format!("{CAMERA}{RIG}\n{}", drawn.alignment.as_ref().unwrap().to_toml())).unwrap();
    assert_eq!(drawn, again);
    assert_eq!(drawn.rig.as_ref().unwrap().scene_text(), again.rig.unwrap().scene_text());
    let (other, _) = read(&format!("{CAMERA}{RIG}{}", TOLERANCES.replace("specimen = 4", "specimen = 5"))).unwrap();
    assert_ne!(other.camera, drawn.camera);
}

#[test]
fn misalignment_moves_camera_ring_and_leds_as_it_says() {
    let (nominal, _) = read(&format!("{CAMERA}{RIG}")).unwrap();
    let stated = |text: &str| read(&format!("{CAMERA}{RIG}\n[alignment]\n{text}\n")).unwrap().0;
    // Moved to the picture's right, ring and all; turned about up to the left of the direction.
    let moved = stated("camera_shift_mm = [1.0, 0.0, 0.0]");
    assert!((moved.camera.position_m() - nominal.camera.position_m() - glam::DVec3::X * 1e-3).length() < 1e-12);
    let led = |file: &CameraFile, index| file.rig.as_ref().unwrap().led_centre_m(index);
    assert!((led(&moved, 3) - led(&nominal, 3) - glam::DVec3::X * 1e-3).length() < 1e-12);
    let turned = stated("camera_turn_deg = [0.0, 2.0, 0.0]");
    let angle = turned.camera.direction().dot(nominal.camera.direction()).acos().to_degrees();
    assert!((angle - 2.0).abs() < 1e-6, "{angle}");
    assert!((turned.camera.up() - nominal.camera.up()).length() < 1e-12);
    // A ring that is turned about the direction by 30 degrees has its LEDs one place on.
    let on = stated("ring_turn_deg = [0.0, 0.0, -30.0]");
    assert!((led(&on, 0) - led(&nominal, 1)).length() < 1e-12);
    assert_eq!(on.camera, nominal.camera);
    let dim = stated("led_intensity = [1, 1, 0.5, 1, 1, 1, 1, 1, 1, 1, 1, 1]").rig.unwrap().scene_text();
    let full = nominal.rig.as_ref().unwrap().axial_radiance();
    assert!(dim.contains(&format!("3 {0} {0} {0}", full)) || dim.contains(&format!("7 {0} {0} {0}", full)));
    assert!(dim.contains(&format!(" {0} {0} {0}\n", 0.5 * full)), "{dim}");
    let errors = read(&format!("{CAMERA}{RIG}\n[alignment]\nled_intensity = [1, 1]\n")).unwrap_err();
    assert!(errors.contains("must be a list of 12 numbers, not of 2"), "{errors}");
    let errors = read(&format!("{CAMERA}\n[alignment]\nled_intensity = [1, 1]\n")).unwrap_err();
    assert!(errors.contains("\"led_intensity\" needs LEDs, but the camera file has no [rig]"), "{errors}");
    let wrong_rig = RIG.replace("leds = 12", "leds = \"twelve\"");
    let errors = read(&format!("{CAMERA}{wrong_rig}\n[alignment]\nled_intensity = [1, 1]\n")).unwrap_err();
    assert!(errors.contains("twelve") || errors.contains("\"leds\""), "{errors}");
    assert!(!errors.contains("led_intensity"), "the ring is to be mended first: {errors}");
}

#[test]
fn wavelengths_of_bands_must_be_those_of_the_scene() {
    let text = CAMERA.replace("\"finite\" ", "\"diffraction\" ");
    let with = |bands: &str, sensor: &str| read(&format!("{text}band_wavelengths_nm = {bands}\n{sensor}"));
    let (file, _) = with("[620, 540, 460]", "").unwrap();
    assert!(file.band_weights_for(3).is_ok() && file.band_weights_for(1).is_ok());
    let message = file.band_weights_for(20).unwrap_err().to_string();
    assert_eq!(message, "3 band_wavelengths_nm for 20 band(s)");
    // A grey scene whose bands weigh differently would need each band's own pattern.
    let (file, _) = with("[620, 540, 460]", &format!("{LINEAR}band_weights = [2, 1, 1]\n")).unwrap();
    assert!(file.band_weights_for(3).is_ok() && file.band_weights_for(1).is_err());
    let errors = with("[100, 540, 460]", "").unwrap_err();
    assert!(errors.contains("expected a ratio of at most 4"), "{errors}");
}

#[test]
fn hostile_calibrations_end_in_errors_or_in_cameras_that_have_rays() {
    let good = "%YAML:1.0\nimage_width: 320\nimage_height: 240\ncamera_matrix: !!opencv-matrix\n  data: [500, 0, 160, 0, 510, 121, 0, 0, 1]\n\
                distortion_model: plumb_bob\ndistortion_coefficients: {data: [-0.1, 0.02, 0, 0, 0]}\n";
    let text = CAMERA.replace("pixels = [192, 165]\npixel_pitch_um = [13.75, 16.0]\n", "camera_matrix = \"m\"\n");
    let alphabet = b"0123456789.-e[]{},:# \n&*!%\"'|>\xff\x00nainf";
    let (mut state, mut read_well) = (1u64, 0);
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..4000 {
        let mut bytes = good.as_bytes().to_vec();
        for _ in 0..1 + next(4) {
            let at = next(bytes.len());
            bytes[at] = alphabet[next(alphabet.len())];
        }
        let loader = MemoryLoader::default().with("rigs/m", bytes);
        if let Ok((file, _)) = read_with(&text, &loader) {
            read_well += 1;
            let rays = radsight_pinhole::Rays::new(&file.camera, 1, 0);
            for pixel in [0, file.camera.pixel_count() - 1, file.camera.pixel_count() / 2] {
                let ray = rays.of_sample(pixel, 0);
                assert!(ray.cos4.is_finite() && ray.cos4 >= 0.0 && ray.direction.is_finite(), "{ray:?}");
            }
        }
    }
    assert!(read_well > 300, "{read_well}");
}

#[test]
fn keys_that_do_not_apply_are_told_from_unknown_ones() {
    let flicker = "\n[flicker.tube]\nfrequency_hz = 100.0\nmodulation = 0.4\n";
    let cases = [
        (CAMERA, "f_number = 2.0\n", "f_number does not apply with a pinhole: pinhole_diameter_mm gives its aperture"),
        (
            CAMERA,
            "band_wavelengths_nm = [600]\n",
            "band_wavelengths_nm does not apply with pinhole_model = \"finite\": ",
        ),
        (CAMERA, "line_time_us = 15.0\n", "line_time_us does not apply with shutter = \"global\": "),
        (flicker, "duty = 0.5\n", "duty does not apply with waveform = \"sine\": "),
        (SENSOR, "gain_dn_per_e = 0.5\n", "gain_dn_per_e does not apply with response = \"power-law\": "),
    ];
    for (table, key, expected) in cases {
        let camera = if table == CAMERA { "" } else { CAMERA };
        let shown = errors(&format!("{camera}{table}{key}"));
        assert!(shown.contains(expected) && !shown.contains("unknown key"), "{shown}");
        assert_eq!(shown.matches("error: ").count(), 1, "{shown}");
    }
    let square = errors(&format!("{CAMERA}{flicker}waveform = \"square\"\n"));
    assert!(square.contains("[flicker.tube] has no \"duty\""), "{square}");
    let unknown = errors(&format!("{CAMERA}pinhole_modle = 1\n"));
    assert!(unknown.contains("unknown key \"pinhole_modle\"") && unknown.contains("did you mean"), "{unknown}");
    let loader =
        MemoryLoader::default().with("rigs/c.yaml", "camera_matrix: {data: [500, 0, 9, 0, 510, 9, 0, 0, 1]}\n");
    let shown = read_with(&format!("{CAMERA}camera_matrix = \"c.yaml\"\n"), &loader).unwrap_err();
    assert!(shown.contains("pixel_pitch_um does not apply with camera_matrix: "), "{shown}");
}

/// A mistake elsewhere does not make a key of diffraction unknown.
#[test]
fn keys_of_diffraction_are_read_beside_other_mistakes() {
    let text = CAMERA.replace("\"finite\" ", "\"diffraction\" ").replace("exposure_ms = 10.0", "exposure_ms = 0");
    let shown = errors(&format!("{text}object_distance_m = 0.48\nband_wavelengths_nm = [620, 540, 460]\n"));
    assert_eq!(shown.matches("error: ").count(), 1, "{shown}");
}

#[test]
fn numbers_whose_pictures_would_not_be_finite_are_refused() {
    let cases = [
        (
            "focal_distance_mm = 6.75",
            "focal_distance_mm = 1e-320",
            "\"focal_distance_mm\" is 1e-320, expected a size from",
        ),
        ("focal_distance_mm = 6.75", "focal_distance_mm = 1e-40", "focal_distance_mm is out of range: "),
        ("exposure_ms = 10.0", "exposure_ms = 1e300", "\"exposure_ms\" is 1e300, expected a size from 1e-60 to 1e30"),
        ("pinhole_diameter_mm = 0.1", "pinhole_diameter_mm = 1e-50", "pinhole_diameter_mm is out of range: "),
        ("[0.0, 0.0, 0.48]", "[0.0, 0.0, -1e200]", "\"position_m\" is -1e200, expected a size from"),
        ("led_diameter_mm = 5.0", "led_diameter_mm = 1e-50", "the LEDs are too bright: "),
        ("led_intensity_w_per_sr = 0.055", "led_intensity_w_per_sr = 1e29", "the LEDs are too bright: "),
    ];
    for (from, to, expected) in cases {
        let shown = errors(&format!("{CAMERA}{RIG}").replace(from, to));
        assert!(shown.contains(expected), "{shown}");
        let key = to.split(' ').next().unwrap_or_default();
        assert!(
            !to.starts_with(|letter: char| letter.is_alphabetic()) || shown.contains(&format!("| {key} = ")),
            "{shown}"
        );
        assert_eq!(shown.matches("error: ").count(), 1, "{shown}");
    }
}

#[test]
fn a_number_without_a_digit_gets_a_hint() {
    for (number, hint) in [(".5", "0.5"), ("-.5", "-0.5"), ("5.", "5.0")] {
        let shown = errors(&CAMERA.replace("6.75", number));
        assert!(shown.contains(&format!("hint: write {hint}\n")), "{shown}");
    }
    let shown = errors(&CAMERA.replace("[0.0, 1.0, 0.0]", "[0, .25, 1] # .5"));
    assert!(shown.contains("hint: write 0.25\n"), "{shown}");
}
