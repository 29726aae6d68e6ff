//! Pictures of `rpict` without `--error` or `--samples`: smooth regions are interpolated, by `-ps`
//! and `-pt`.

use crate::program::{Folder, command, run_with};
use std::f64::consts::TAU;
use std::fmt::Write as _;

const SIDE: usize = 128;

/// A floor under a lamp, with a ball and a thin bar, and a disk with a soft shadow.
const TABLE: &str = "
void plastic grey 0 0 5 .5 .4 .3 0 0
void plastic red 0 0 5 .7 .1 .1 .03 .05
void light bright 0 0 3 40 40 40
bright ring lamp 0 0 8 0 0 6 0 0 -1 0 .5
grey polygon floor 0 0 12 -8 -8 0 8 -8 0 8 8 0 -8 8 0
red sphere ball 0 0 4 1 1 .6 .6
grey ring disk 0 0 8 -1.5 0 1 0 0 1 0 .8
red cylinder bar 0 0 7 -3 -2 .03 3 -1 .03 .03
void glow dim 0 0 4 .1 .1 .1 0
dim source sky 0 0 4 0 0 1 180
";

const VIEW: &str = "-vp 0 -7 5 -vd 0 1.4 -1 -vh 45 -vv 45 -x 128 -y 128 -ff -h-";

/// The pixels of a picture of floats of [`SIDE`] columns and rows, in the red band, top row first.
fn red(scene: &str, options: &str) -> Vec<f64> {
    red_of(SIDE, scene, options)
}

/// The same for a picture of so many columns and rows.
pub(crate) fn red_of(side: usize, scene: &str, options: &str) -> Vec<f64> {
    let folder = Folder::new();
    folder.file("scene.rad", scene);
    let options = options.split_whitespace().filter(|word| *word != "-h-");
    let words: Vec<&str> = ["rpict"].into_iter().chain(options).chain(["scene.rad"]).collect();
    let bytes = run_with(command(&words).current_dir(folder.path("")), b"").done();
    let floats: Vec<f32> = bytes[bytes.len() - side * side * 12..]
        .as_chunks::<4>()
        .0
        .iter()
        .map(|bytes| f32::from_ne_bytes(*bytes))
        .collect();
    floats.chunks(3).map(|pixel| f64::from(pixel[0])).collect()
}

/// Means over blocks of 8 × 8 pixels.
fn blocks(pixels: &[f64]) -> Vec<f64> {
    let side = SIDE / 8;
    let block = |index: usize| {
        let (left, top) = (index % side * 8, index / side * 8);
        let pixel = |at: usize| pixels[(top + at / 8) * SIDE + left + at % 8];
        (0..64).map(pixel).sum::<f64>() / 64.0
    };
    (0..side * side).map(block).collect()
}

#[test]
fn blocks_of_an_interpolated_picture_are_those_of_one_that_is_not() {
    let exact = blocks(&red(TABLE, &format!("{VIEW} -pj 1 --samples 128")));
    for options in ["", "-ps 8", "-ps 1", "-ps 8 -pt .1", "-pj 1 -ps 3"] {
        let quick = blocks(&red(TABLE, &format!("{VIEW} {options}")));
        let [sum, expected] = [&quick, &exact].map(|blocks| blocks.iter().sum::<f64>());
        let dark = 0.01 * expected / exact.len() as f64;
        let is_near = |(quick, exact): &(&f64, &f64)| (*quick - *exact).abs() < 0.05 * *exact + dark;
        let near = quick.iter().zip(&exact).filter(is_near).count();
        assert!(near * 100 >= exact.len() * 93, "{options}: {near} of {} blocks", exact.len());
        assert!((sum / expected - 1.0).abs() < 0.01, "{options}: {sum} instead of {expected}");
    }
}

#[test]
fn smooth_light_has_no_grain() {
    // The floor below the centre of the picture, away from all shadows.
    let rows = [SIDE - 12, SIDE - 9, SIDE - 6];
    let pixels = red(TABLE, VIEW);
    for row in rows {
        let line = &pixels[row * SIDE + 40..row * SIDE + 88];
        for triple in line.windows(3) {
            let curvature = (triple[1] - 0.5 * (triple[0] + triple[2])).abs() / triple[1];
            assert!(curvature < 0.01, "row {row}: {triple:?}");
        }
    }
}

/// A floor below a small bright ball, which its highlight rarely meets.
const GLINT: &str = "
void glow hot 0 0 4 400 380 300 0
hot sphere ball 0 0 4 0 3 2 .12
void metal rough 0 0 5 .7 .7 .7 .9 .2
rough ring floor 0 0 8 0 0 0 0 0 1 0 30
void glow sky 0 0 4 1 1 1 0
sky source dome 0 0 4 0 0 1 360
";

/// A floor that reflects a large window, less than the specular threshold.
const WINDOW: &str = "
void light panel 0 0 3 10 10 10
panel polygon window 0 0 12 -2 6 .5  2 6 .5  2 6 2.5  -2 6 2.5
void plastic gloss 0 0 5 .2 .2 .2 .04 .05
gloss ring floor 0 0 8 0 0 0 0 0 1 0 30
";

/// A floor with a ball's shadow in the light of a panel.
const PENUMBRA: &str = "
void light panel 0 0 3 10 10 10
panel polygon window 0 0 12 -1 1 4  -1 3 4  1 3 4  1 1 4
void plastic grey 0 0 5 .5 .5 .5 0 0
grey ring floor 0 0 8 0 0 0 0 0 1 0 30
grey sphere ball 0 0 4 0 2 1.2 .7
";

/// A floor with the shadows of a wall under a strong lamp and 50 weak ones.
fn lamps() -> String {
    let lamp = |index: i32| {
        let (column, row) = (index % 10, index / 10);
        format!("weak sphere lamp{index} 0 0 4 {} {} 4 .1\n", column - 5, row)
    };
    let lamps: String = (0..50).map(lamp).collect();
    format!(
        "void light weak 0 0 3 8 8 8
        void light strong 0 0 3 100 100 100
        strong sphere lamp 0 0 4 2 2 5 .1
        void plastic grey 0 0 5 .5 .5 .5 0 0
        grey ring floor 0 0 8 0 0 0 0 0 1 0 30
        grey polygon wall 0 0 12 -1 -1 .001  -1 6 .001  -1 6 2.5  -1 -1 2.5
        {lamps}"
    )
}

const FLOOR_VIEW: &str = "-vp 0 -5 1.5 -vd 0 1 -.15 -vh 50 -vv 50 -x 128 -y 128 -ff -pj 1";

/// The pixels of the floor, the lower half of the picture.
fn floor(scene: &str, options: &str) -> Vec<f64> {
    red(scene, &format!("{FLOOR_VIEW} {options}")).split_off(70 * SIDE)
}

/// The mean of the floor with some seeds, relative to many rays through each pixel; `bounces` is
/// `-ab`.
fn mean_of_seeds(scene: &str, bounces: u32, options: &str) -> f64 {
    let seeds = 0..4;
    let sum = |options: &str| floor(scene, &format!("-ab {bounces} {options}")).iter().sum::<f64>();
    let quick: f64 = seeds.clone().map(|seed| sum(&format!("{options} --seed {seed}"))).sum();
    quick / f64::from(seeds.end) / sum("-aa 0 --samples 256")
}

/// The rms difference of the floor between two seeds.
fn grain(scene: &str, options: &str) -> f64 {
    let [one, other] = [1, 2].map(|seed| floor(scene, &format!("{options} --seed {seed}")));
    let squares: f64 = one.iter().zip(&other).map(|(one, other)| (one - other).powi(2)).sum();
    (squares / one.len() as f64).sqrt()
}

#[test]
fn rare_bright_reflections_keep_their_light() {
    let mean = mean_of_seeds(GLINT, 0, "-ss 16");
    assert!((mean - 1.0).abs() < 0.1, "{mean} of the light");
}

#[test]
fn windows_reflected_below_the_threshold_keep_their_light() {
    let mean = mean_of_seeds(WINDOW, 0, "-ps 4");
    assert!((mean - 1.0).abs() < 0.03, "{mean} of the light");
}

#[test]
fn highlights_take_as_many_samples_as_requested() {
    let [one, many] = ["1", "16"].map(|samples| grain(GLINT, &format!("-ps 1 -ss {samples}")));
    assert!(many < 0.5 * one, "{one} with one sample, {many} with sixteen");
}

#[test]
fn single_rays_divide_lights() {
    let [whole, divided] = ["0", ".2"].map(|size| grain(PENUMBRA, &format!("-ps 1 -ds {size}")));
    assert!(divided < 0.25 * whole, "{whole} with whole lights, {divided} with divided ones");
}

/// A floor under a panel that only the rays of a hemisphere find.
const SKYLIGHT: &str = "
void glow panel 0 0 4 10 10 10 0
panel polygon window 0 0 12 -1 1 4  -1 3 4  1 3 4  1 1 4
void plastic grey 0 0 5 .5 .5 .5 0 0
grey ring floor 0 0 8 0 0 0 0 0 1 0 30
";

#[test]
fn pictures_without_cache_take_as_many_rays_as_requested() {
    for spacing in ["-ps 1", "-ps 4"] {
        let options = |rays: u32| format!("{spacing} -aa 0 -ad {rays}");
        let [few, many] = [16, 400].map(|rays| grain(SKYLIGHT, &format!("-ab 1 {}", options(rays))));
        assert!(many < 0.35 * few, "{spacing}: {few} with 16 rays, {many} with 400");
        let mean = mean_of_seeds(SKYLIGHT, 1, &options(400));
        assert!((mean - 1.0).abs() < 0.01, "{spacing}: {mean} of the light");
    }
}

#[test]
fn silhouettes_are_averaged_over_pixels() {
    // A disk that fills a known share of a parallel view, with nothing around it.
    let scene = "void glow white 0 0 4 1 1 1 0\nwhite ring disk 0 0 8 0 5 0 0 -1 0 0 .8\n";
    let view = "-vtl -vp 0 0 0 -vd 0 1 0 -vh 2 -vv 2 -x 128 -y 128 -ff -pj 1";
    let pixels = red(scene, view);
    let share = pixels.iter().sum::<f64>() / (SIDE * SIDE) as f64;
    let expected = std::f64::consts::PI * 0.64 / 4.0;
    assert!((share / expected - 1.0).abs() < 0.003, "{share} instead of {expected}");
    let partial = pixels.iter().filter(|value| **value > 0.01 && **value < 0.99).count();
    assert!(partial > 200, "{partial} pixels on the rim are partly covered");
}

/// A wall of light with oblique stripes that are narrower than a pixel, bright in a share of its area.
#[test]
fn small_pictures_average_patterns_in_pixels_without_bias() {
    let side = 40;
    for (share, tolerance, noise) in [(0.5, 0.01, 0.4), (0.05, 0.05, 0.9)] {
        let scene = format!(
            "void brightfunc stripes 2 \"if({share}-A1*Px-A2*Pz+floor(A1*Px+A2*Pz),1,0)\" . 0 2 21.3 5.7\n\
             stripes glow white 0 0 4 1 1 1 0\nwhite polygon wall 0 0 12 -2 5 -2 2 5 -2 2 5 2 -2 5 2\n"
        );
        let view = format!("-vtl -vp 0 0 0 -vd 0 1 0 -vh 2 -vv 2 -ff -pj 1 -ps 1 -x {side} -y {side}");
        let picture = |options: &str| red_of(side, &scene, &format!("{view} {options}"));
        let exact = picture("--samples 4096");
        let seeds: Vec<Vec<f64>> = (0..40).map(|seed| picture(&format!("--seed {seed}"))).collect();
        let count = (seeds.len() * side * side) as f64;
        let mean = seeds.iter().flatten().sum::<f64>() / count;
        assert!((mean / share - 1.0).abs() < tolerance, "{mean} instead of {share}");
        let squares =
            seeds.iter().flat_map(|seed| seed.iter().zip(&exact)).map(|(value, exact)| (value - exact).powi(2));
        let (rms, of_ray) = ((squares.sum::<f64>() / count).sqrt(), (share * (1.0 - share)).sqrt());
        assert!(rms < noise * of_ray, "{share}: pixels have an error of {rms}, single rays of {of_ray}");
    }
}

/// Balls of half a pixel, and a ball out of focus: most rays of their pixels pass beside them.
#[test]
fn what_covers_parts_of_pixels_keeps_its_light() {
    let mut balls = "void glow white 0 0 4 1 1 1 0\n".to_owned();
    for index in 0..400 {
        let [x, z] = [0.754_877_666, 0.569_840_291].map(|step| (f64::from(index) * step).fract() * 1.8 - 0.9);
        let _ = writeln!(balls, "white sphere b{index} 0 0 4 {x:.4} 5 {z:.4} .004");
    }
    let blurred = "void glow white 0 0 4 1 1 1 0\nwhite sphere ball 0 0 4 0 2 0 .1\n";
    let parallel = "-vtl -vp 0 0 0 -vd 0 1 0 -vh 2 -vv 2 -x 128 -y 128 -ff -pj 1";
    let open = "-vp 0 0 0 -vd 0 6 0 -vh 20 -vv 20 -x 128 -y 128 -ff -pj 1 -pd .2";
    for (scene, view) in [(balls.as_str(), parallel), (blurred, open)] {
        let mean = |options: &str| red(scene, &format!("{view} {options}")).iter().sum::<f64>() / (SIDE * SIDE) as f64;
        let expected = mean("--samples 64");
        let seeds = 6;
        let found = (0..seeds).map(|seed| mean(&format!("-ps 1 --seed {seed}"))).sum::<f64>() / f64::from(seeds);
        assert!((found / expected - 1.0).abs() < 0.08, "{view}: {found} instead of {expected}");
    }
}

#[test]
fn stripes_of_the_width_of_a_pixel_keep_their_mean() {
    // Three tenths of each pixel are dark, and its centre is bright.
    let stripes = "void brightfunc stripes 2 if(frac(64*Px)-.7,.1,1) .\n0 0\nstripes glow white 0 0 4 1 1 1 0\n";
    let scene = format!("{stripes}white polygon sheet 0 0 12 -2 5 -2 2 5 -2 2 5 2 -2 5 2\n");
    let view = "-vtl -vp 0 0 0 -vd 0 1 0 -vh 2 -vv 2 -x 128 -y 128 -ff -pj 1 -ps 1";
    let mean = red(&scene, view).iter().sum::<f64>() / (SIDE * SIDE) as f64;
    assert!((mean / 0.73 - 1.0).abs() < 0.03, "{mean} instead of 0.73");
}

#[test]
fn what_is_thinner_than_a_cell_is_found() {
    // A wire about two pixels wide.
    let scene = "void glow white 0 0 4 1 1 1 0\nwhite polygon wire 0 0 12 -.1 5 -1 -.06 5 -1 .14 5 1 .1 5 1\n";
    let view = "-vtl -vp 0 0 0 -vd 0 1 0 -vh 2 -vv 2 -x 128 -y 128 -ff";
    let pixels = red(scene, view);
    let crossed = pixels.chunks(SIDE).filter(|row| row.iter().any(|value| *value > 0.5)).count();
    assert!(crossed * 10 >= SIDE * 9, "{crossed} of {SIDE} rows show the wire");
}

#[test]
fn threads_do_not_change_an_interpolated_picture() {
    let of = |threads: usize| red(TABLE, &format!("{VIEW} -n {threads} -ab 1 -ad 64 -aa .3"));
    let one = of(1);
    assert!(one == of(2) && one == of(5));
}

#[test]
fn weak_lights_keep_their_light_with_fewer_shadow_rays() {
    let scene = lamps();
    let mean = |pixels: &[f64]| pixels.iter().sum::<f64>() / pixels.len() as f64;
    let exact = floor(&scene, "--samples 16");
    let expected = mean(&exact);
    let quick: Vec<f64> = (1..=4).map(|seed| mean(&floor(&scene, &format!("-ps 1 --seed {seed}")))).collect();
    let error = mean(&quick) / expected - 1.0;
    assert!(error.abs() < 0.005, "{quick:?} instead of {expected}");
}

/// Two spheres of chrome under the sun and a sky.
const CHROME: &str = "
void metal chrome 0 0 5 .8 .8 .82 .95 0
void plastic grey 0 0 5 .2 .2 .2 0 0
void light bright 0 0 3 2e4 2e4 2e4
bright source sun 0 0 4 -.5 -.6 .7 3
void brightfunc gradient 2 .5+.5*Dz . 0 0
gradient glow dim 0 0 4 1 1 1 0
dim source sky 0 0 4 0 0 1 360
grey ring floor 0 0 8 0 0 0 0 0 1 0 60
chrome sphere left 0 0 4 -.5 0 1 1
chrome sphere right 0 0 4 1.5 .4 .8 .8
";

#[test]
fn the_sun_in_a_mirror_stays_in_its_pixel() {
    // The sun is seen near a pixel of the grid, which has several rays.
    let view = "-vp 0 -7 3 -vd 0 1 -.25 -vh 51.8 -vv 52.15 -vs .0078125 -vl .0078125 -x 128 -y 128 -pa 0 -ff -ab 0";
    let mut suns = 0;
    for seed in 1..=8 {
        let pixels = red(CHROME, &format!("{view} --seed {seed}"));
        let bright = pixels.iter().filter(|value| **value > 4.0).count();
        assert!(bright <= 4, "seed {seed}: {bright} pixels are brighter than all but the sun");
        suns += bright;
    }
    assert!(suns > 0, "no picture shows the sun");
}

/// Mean over some columns and rows.
fn area(pixels: &[f64], columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> f64 {
    let count = (columns.len() * rows.len()) as f64;
    rows.map(|row| pixels[row * SIDE..][columns.clone()].iter().sum::<f64>()).sum::<f64>() / count
}

/// A thin partition that stands on the floor of a room, with a lamp on one side of it. The view from
/// above sees it edge-on, so that nothing but irradiance tells one side of the floor from the other.
const PARTITION: &str = "
void plastic white 0 0 5 .8 .8 .8 0 0
void plastic grey 0 0 5 .4 .4 .4 0 0
void light lamp 0 0 3 50 50 50
white polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0
white polygon ceiling 0 0 12 0 4 3 4 4 3 4 0 3 0 0 3
grey polygon left 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
grey polygon right 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0
grey polygon back 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3
white polygon partition 0 0 12 2 0 0 2 4 0 2 4 2.7 2 0 2.7
lamp polygon l 0 0 12 .5 1 2.9 .5 3 2.9 .7 3 2.9 .7 1 2.9
";

#[test]
fn a_partition_keeps_irradiance_on_its_side() {
    let view = "-vtl -vp 2.008 2 2.6 -vd 0 0 -1 -vu 0 1 0 -vh 3.98 -vv 3.98 -pa 1 -x 128 -y 128 -ff -ab 1";
    let truth = red(PARTITION, &format!("{view} -aa 0 -ad 1 --samples 256"));
    for options in ["", "-ps 1"] {
        let found = red(PARTITION, &format!("{view} {options}"));
        // Two columns on each side, beside those that the partition halves.
        let (lit, dark) = (61..63, 65..67);
        let [in_dark, expected] = [&found, &truth].map(|pixels| area(pixels, dark.clone(), 12..116));
        assert!(in_dark < 2.0 * expected + 1e-3, "{options}: {in_dark} in the dark, expected {expected}");
        let [in_light, expected] = [&found, &truth].map(|pixels| area(pixels, lit.clone(), 12..116));
        assert!((in_light / expected - 1.0).abs() < 0.03, "{options}: {in_light} in the light, expected {expected}");
    }
}

#[test]
fn silhouettes_end_at_the_aft_clipping_plane() {
    let floor = "void glow one 0 0 4 1 1 1 0\none polygon floor 0 0 12 -20 -20 0 20 -20 0 20 40 0 -20 40 0\n";
    let view = "-vp 0 -7 2.5 -vd 0 1 -.22 -vh 50 -vv 50 -va 9.5 -pj 1 -x 128 -y 128 -ff";
    let rows = |options: &str| -> Vec<f64> {
        let pixels = red(floor, &format!("{view} {options}"));
        (0..SIDE).map(|row| area(&pixels, 0..SIDE, row..row + 1)).collect()
    };
    let truth = rows("--samples 64");
    assert!(truth.contains(&0.0) && truth.contains(&1.0));
    for options in ["", "-ps 1"] {
        for (row, (found, expected)) in rows(options).iter().zip(&truth).enumerate() {
            assert!((found - expected).abs() < 0.15, "{options}: row {row} is {found}, expected {expected}");
        }
    }
}

/// Small surfaces in random positions within a ball.
fn leaves(count: u32) -> String {
    let mut text =
        "void plastic leaf 0 0 5 .5 .5 .5 0 0\nvoid glow white 0 0 4 1 1 1 0\nwhite source sky 0 0 4 0 0 1 360\n"
            .to_owned();
    let number = |index: u32, step: f64| (f64::from(index + 1) * step).fract();
    for index in 0..count {
        let radius = 1.5 * number(index, 0.819_172_5).cbrt();
        let (z, turn) = (2.0 * number(index, 0.671_043_6) - 1.0, TAU * number(index, 0.549_700_5));
        let across = radius * (1.0 - z * z).sqrt();
        let center = [across * turn.cos(), across * turn.sin(), radius * z];
        let (tilt, side) = (TAU * number(index, 0.324_717_9), 0.06);
        let (along, beside) =
            ([side * tilt.cos(), side * tilt.sin(), 0.0], [0.0, 0.5 * side, side * (3.0 * tilt).sin()]);
        let corner = |a: f64, b: f64| {
            let at = |axis: usize| (center[axis] + a * along[axis] + b * beside[axis]).to_string();
            [at(0), at(1), at(2)].join(" ")
        };
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)].join(" ");
        writeln!(text, "leaf polygon l{index} 0 0 12 {corners}").unwrap();
    }
    text
}

/// A single ray from a point between leaves meets either a leaf or the sky.
#[test]
fn leaves_that_no_record_reaches_are_not_black() {
    let scene = leaves(2500);
    let view = "-vp 0 -9 0 -vd 0 1 0 -vh 20 -vv 20 -x 128 -y 128 -ff -ab 1";
    let (preview, correct) = (red(&scene, view), red(&scene, &format!("{view} --samples 64 -aa 0")));
    let is_dark = |value: &&f64| **value < 0.02;
    let [dark, dark_correct] = [&preview, &correct].map(|pixels| pixels.iter().filter(is_dark).count());
    assert!(dark < dark_correct + preview.len() / 500, "{dark} of {} dark pixels, {dark_correct} are", preview.len());
    let [mean, expected] = [&preview, &correct].map(|pixels| pixels.iter().sum::<f64>() / pixels.len() as f64);
    assert!((mean / expected - 1.0).abs() < 0.01, "{mean} for {expected}");
}

/// A room with a small lamp closely below its ceiling: half of the lamp's light comes from a spot of
/// the ceiling, which few gather rays meet.
const SPOT: &str = "
void plastic grey 0 0 5 .7 .7 .7 0 0
void light bright 0 0 3 400 400 400
bright sphere lamp 0 0 4 3 3 4.4 .1
!genbox grey room 6 6 4.5 -i
";

/// Records that found the spot seem noisy. If they alone got further rays, the picture would be 4 %
/// too dark, as those that missed it would keep their low values.
#[test]
fn rare_bright_light_is_neither_lost_nor_gained_by_more_rays_where_it_is_found() {
    let view = "-vp 3 .1 2.25 -vd 0 1 0 -vu 0 0 1 -vh 90 -vv 90 -x 128 -y 128 -ff -ab 1";
    // The lower half of the room.
    let low = |options: &str| blocks(&red(SPOT, &format!("{view} {options}"))).split_off(8 * SIDE / 8);
    let truth = low("-aa 0 -ps 1 -pj 1 -ad 1 --samples 400");
    let seeds = 12;
    let found: Vec<f64> = (0..seeds)
        .map(|seed| {
            let found = low(&format!("-aa .3 -ad 128 -as 0 -ar 256 -ps 1 --seed {seed}"));
            found.iter().zip(&truth).map(|(found, truth)| found / truth).sum::<f64>() / truth.len() as f64
        })
        .collect();
    let mean = found.iter().sum::<f64>() / f64::from(seeds);
    let squares: f64 = found.iter().map(|found| (found - mean).powi(2)).sum();
    let error = (squares / f64::from(seeds * (seeds - 1))).sqrt();
    assert!((mean - 1.0).abs() < 3.0 * error, "{mean} ± {error}");
    assert!(error < 0.01, "too noisy to tell: ± {error}");
}
