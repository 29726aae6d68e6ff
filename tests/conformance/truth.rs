//! Compares the errors of our pictures and real Radiance's in the render tests with the truth.
//!
//! Real `rpict` caches irradiance and interpolates between pixels, and ours caches it, too. Real
//! `rtrace -aa 0` does neither: many rays through a block of pixels, jittered as in `rpict`
//! (`-pj`), give the block's radiance and its standard error. This is not the truth where Radiance
//! makes another approximation (`docs/differences.md`). The results are kept in the folder that
//! `RADSIGHT_ORACLE` names.

use crate::blocks::{Block, Noise, is_near, outside};
use crate::commands::{Reference, RtraceProgram, Scenes, oracle, radiance_values, repeats};
use crate::exceptions::{self, Shown};
use crate::shared;
use radsight_picture::Image;
use radsight_test_support::Radiance;
use std::collections::HashSet;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Side of a block, pixels.
const SIDE: usize = 8;

/// Rays per pixel.
const RAYS: usize = 100;

/// The blocks of a picture whose truth is computed.
struct BlockSelection {
    /// Largest number of blocks.
    blocks: usize,
    /// Results are kept in `PICTURE-KIND.tsv`.
    kind: &'static str,
}

/// Any blocks.
const ANYWHERE: BlockSelection = BlockSelection { blocks: 24, kind: "anywhere" };

/// Blocks in which ours and the reference differ.
const OUTSIDE: BlockSelection = BlockSelection { blocks: 24, kind: "outside" };

/// All blocks.
const EVERYWHERE: BlockSelection = BlockSelection { blocks: usize::MAX, kind: "everywhere" };

impl BlockSelection {
    fn path(&self, folder: &Path, reference: &Reference) -> PathBuf {
        folder.join(format!("{}-{}.tsv", reference.name, self.kind))
    }
}

/// Every light is tested, in small jittered pieces, and paths continue at any weight. With more
/// than one hemisphere sample, real Radiance would stratify them away from the edges of their
/// cells, which biases small features.
const UNBIASED: &str = "-u+ -aa 0 -ad 1 -as 0 -lw 1e-7 -dt 0 -ds .01 -dj .9 -ss 1";

/// Sums differ if their difference exceeds this many standard errors.
const SURE: f64 = 3.0;

/// Relative differences below this are equal.
const SAME: f64 = 0.01;

/// A block and its radiance, the mean of the bands.
#[derive(Clone, Copy, Debug)]
struct Truth {
    block: Block,
    radiance: f64,
    error: f64,
}

impl Truth {
    /// Relative difference of a picture from it.
    fn difference(&self, picture: &Image<f32>) -> f64 {
        (self.block.mean(picture) / self.radiance - 1.0).abs()
    }

    fn is_near(&self, picture: &Image<f32>) -> bool {
        is_near(self.block.mean(picture), self.radiance, self.error)
    }
}

/// Reads stored results: left, top, radiance, standard error per line.
fn read_truths(path: &Path, reference: &Reference) -> Vec<Truth> {
    let read = |line: &str| {
        let numbers: Vec<f64> = line.split('\t').map(|word| word.parse().expect("a number")).collect();
        let corner = (numbers[0] as usize, numbers[1] as usize);
        Truth { block: Block::new(corner, reference.size(), SIDE), radiance: numbers[2], error: numbers[3] }
    };
    fs::read_to_string(path).unwrap_or_default().lines().map(read).collect()
}

fn write_truths(path: &Path, truths: &[Truth]) {
    let write =
        |Truth { block, radiance, error }: &Truth| format!("{}\t{}\t{radiance:e}\t{error:e}\n", block.left, block.top);
    fs::write(path, truths.iter().map(write).collect::<String>()).expect("the truth is written");
}

/// The truth of these blocks: stored results, and new ones up to the required number.
fn truths_of(
    blocks: &[Block],
    selection: &BlockSelection,
    folder: &Path,
    scenes: &mut Scenes<'_>,
    reference: &Reference,
) -> Vec<Truth> {
    let path = selection.path(folder, reference);
    let mut truths = read_truths(&path, reference);
    let corner = |block: &Block| (block.left, block.top);
    let known: HashSet<_> = truths.iter().map(|truth| corner(&truth.block)).collect();
    let mut unknown: Vec<Block> = blocks.iter().filter(|block| !known.contains(&corner(block))).copied().collect();
    let missing = selection.blocks.saturating_sub(blocks.len() - unknown.len()).min(unknown.len());
    let mut random = Random(0x5eed);
    let drawn: Vec<_> = (0..missing).map(|_| unknown.swap_remove(random.below(unknown.len()))).collect();
    if !drawn.is_empty() {
        scenes.build(reference);
        truths.extend(find_truths(scenes, RtraceProgram::Real, reference, &drawn));
        write_truths(&path, &truths);
    }
    let wanted: HashSet<_> = blocks.iter().map(corner).collect();
    truths.retain(|truth| wanted.contains(&corner(&truth.block)));
    truths
}

/// The radiance that a program computes in these blocks.
fn find_truths(scenes: &Scenes<'_>, program: RtraceProgram, reference: &Reference, blocks: &[Block]) -> Vec<Truth> {
    let mut random = Random(0x5eed ^ blocks.len() as u64);
    let mut places = Vec::new();
    let jitter = reference.jitter();
    for block in blocks {
        for _ in 0..RAYS {
            for pixel in 0..SIDE * SIDE {
                let (x, y) = (block.left + pixel % SIDE, block.top + pixel / SIDE);
                places.push((random.within(x, jitter), random.within(y, jitter)));
            }
        }
    }
    let values = scenes.radiance_at(program, reference, &places, UNBIASED);
    let truth = |(block, values): (&Block, &[f64])| {
        let means: Vec<f64> =
            values.chunks_exact(SIDE * SIDE).map(|pass| pass.iter().sum::<f64>() / pass.len() as f64).collect();
        let radiance = means.iter().sum::<f64>() / RAYS as f64;
        let squares: f64 = means.iter().map(|value| (value - radiance).powi(2)).sum();
        Truth { block: *block, radiance, error: (squares / (RAYS * (RAYS - 1)) as f64).sqrt() }
    };
    blocks.iter().zip(values.chunks_exact(RAYS * SIDE * SIDE)).map(truth).collect()
}

/// Random positions of blocks and rays: the constants of Knuth's MMIX.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A position within this central share of a pixel.
    fn within(&mut self, pixel: usize, share: f64) -> f64 {
        pixel as f64 + 0.5 + share * (self.unit() - 0.5)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }
}

/// The median of the relative differences from the truth.
fn median_difference(picture: &Image<f32>, truths: &[Truth]) -> f64 {
    let mut differences: Vec<f64> = truths.iter().map(|truth| truth.difference(picture)).collect();
    differences.sort_by(f64::total_cmp);
    differences.get(differences.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Options without random numbers.
const CERTAIN: &str = "-u- -ab 0 -dj 0 -ds 0 -st 1 -ss 0";

/// The share of the pixels that real `rtrace` reproduces, with rays at this offset from the pixels'
/// left and upper edges.
fn pixels_found(scenes: &Scenes<'_>, reference: &Reference, picture: &Image<f32>, from_edges: f64) -> f64 {
    let (width, height) = reference.size();
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let places: Vec<_> = pixels().map(|(x, y)| (x as f64 + from_edges, y as f64 + from_edges)).collect();
    let values = scenes.radiance_at(RtraceProgram::Real, reference, &places, CERTAIN);
    // The picture's values are rounded to eight bits.
    let found = pixels().zip(values).filter(|((x, y), value)| {
        let pixel = Block::new((*x, *y), (width, height), 1).mean(picture);
        (pixel - value).abs() <= 0.01 * value
    });
    found.count() as f64 / places.len() as f64
}

/// Pixels within half a pixel of edges and lamps are excluded.
#[test]
#[ignore = "needs the scenes of the render tests, and real Radiance"]
fn rays_of_blocks_go_where_rpict_looks() {
    let (Some(shared), Some(radiance)) = (shared(), Radiance::find()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    for reference in Reference::all(&shared).iter().filter(|reference| reference.name.starts_with("patterns")) {
        scenes.build(reference);
        let options = format!("{CERTAIN} -ps 1 -pj 0");
        let picture = radiance_values(&scenes.real("rpict", &reference.words(&options)[1..], None).done());
        let found = |from_edges| pixels_found(&scenes, reference, &picture, from_edges);
        let [in_the_middle, in_a_corner] = [0.5, 1.0].map(found);
        assert!(in_the_middle > 0.99, "{}: {in_the_middle} of the pixels are found again", reference.name);
        assert!(in_a_corner < 0.9, "{}: {in_a_corner} of the pixels do not care where rays go", reference.name);
    }
}

fn all_blocks(reference: &Reference) -> Vec<Block> {
    Block::all(reference.size(), SIDE).collect()
}

/// Compares both errors in the blocks in which our pictures differ from the references. Where the
/// reference is an exception, ours must be close in more blocks, or closer in total.
#[test]
#[ignore = "traces many rays with real Radiance, once; needs the pictures of radiance_render_tests"]
fn blocks_outside_against_their_truth() {
    against_truth(&OUTSIDE, None, |folder, reference, ours| {
        outside(ours, &reference.picture, Noise::of(&repeats(folder, reference)), SIDE)
    });
}

/// The same in whole pictures.
#[test]
#[ignore = "traces many rays with real Radiance, once; needs the pictures of radiance_render_tests"]
fn whole_pictures_against_their_truth() {
    against_truth(&EVERYWHERE, Some(Shown::ManyRaysEverywhere), |_, reference, _| all_blocks(reference));
}

/// Prints a line of a table of `docs/render-tests.md` for each picture, or for those with this
/// evidence.
fn against_truth(
    selection: &BlockSelection,
    only: Option<Shown>,
    blocks: impl Fn(&Path, &Reference, &Image<f32>) -> Vec<Block>,
) {
    let (Some(shared), Some(radiance), Some(folder)) = (shared(), Radiance::find(), oracle()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    let mut wrong = Vec::new();
    for reference in Reference::all(&shared) {
        let shown = exceptions::shown(&reference.name);
        let Some(ours) = reference.our_picture().filter(|_| only.is_none() || shown == only) else { continue };
        let blocks = blocks(&folder, &reference, &ours);
        let truths = truths_of(&blocks, selection, &folder, &mut scenes, &reference);
        let row = BesideTruth::new(&ours, &reference.picture, &truths);
        println!("| `{}` | {} | {row}", reference.name, blocks.len());
        if shown == only.or(Some(Shown::ManyRays)) && !row.ours_is_right() {
            wrong.push(reference.name.clone());
        }
    }
    assert!(wrong.is_empty(), "many rays do not show that ours is right in {wrong:?}");
}

/// Compares both programs in random blocks without a cache: only formulas differ.
#[test]
#[ignore = "traces many rays with real Radiance, once"]
fn without_sharing_both_find_the_same() {
    let (Some(shared), Some(radiance), Some(folder)) = (shared(), Radiance::find(), oracle()) else { return };
    let mut scenes = Scenes::new(&shared, &radiance);
    let mut wrong = Vec::new();
    for reference in Reference::all(&shared) {
        let real = truths_of(&all_blocks(&reference), &ANYWHERE, &folder, &mut scenes, &reference);
        let blocks: Vec<Block> = real.iter().map(|truth| truth.block).collect();
        scenes.build(&reference);
        let ours = find_truths(&scenes, RtraceProgram::Ours, &reference, &blocks);
        let (difference, error) = difference_of(&ours, &real);
        println!("| `{}` | {:+.2} ± {:.2} |", reference.name, 100.0 * difference, 100.0 * error);
        let differs = difference.abs() > f64::max(SAME, SURE * error);
        if differs && !matches!(exceptions::shown(&reference.name), Some(Shown::SunsImage | Shown::SingleRays)) {
            wrong.push(reference.name.clone());
        }
    }
    assert!(wrong.is_empty(), "the programs differ in {wrong:?}");
}

/// The relative difference between two results in blocks, and its standard error: the mean,
/// weighted by the uncertainty of each, which is at least [`SAME`].
fn difference_of(found: &[Truth], otherwise: &[Truth]) -> (f64, f64) {
    let (mut sum, mut weights, mut squares) = (0.0, 0.0, 0.0);
    for (one, other) in found.iter().zip(otherwise).filter(|(_, other)| other.radiance > 0.0) {
        let variance = (one.error.powi(2) + other.error.powi(2)) / other.radiance.powi(2);
        let weight = 1.0 / (variance + SAME * SAME);
        sum += weight * (one.radiance / other.radiance - 1.0);
        weights += weight;
        squares += weight * weight * variance;
    }
    (sum / weights, squares.sqrt() / weights)
}

/// A line of a table: ours, and the reference.
struct BesideTruth {
    count: usize,
    near: [usize; 2],
    difference: [f64; 2],
    /// The relative difference of the sum over all blocks from the sum of their truths, and its
    /// standard error: blocks with large uncertainty can be significant together.
    sum: [f64; 2],
    sum_error: f64,
}

impl BesideTruth {
    fn new(ours: &Image<f32>, reference: &Image<f32>, truths: &[Truth]) -> BesideTruth {
        let near = |picture| truths.iter().filter(|truth| truth.is_near(picture)).count();
        let all: f64 = truths.iter().map(|truth| truth.radiance).sum();
        let sum = |picture| truths.iter().map(|truth| truth.block.mean(picture)).sum::<f64>() / all - 1.0;
        BesideTruth {
            count: truths.len(),
            near: [ours, reference].map(near),
            difference: [ours, reference].map(|picture| median_difference(picture, truths)),
            sum: [ours, reference].map(sum),
            sum_error: truths.iter().map(|truth| truth.error.powi(2)).sum::<f64>().sqrt() / all,
        }
    }

    fn ours_is_right(&self) -> bool {
        let [ours, reference] = self.sum.map(f64::abs);
        let by_blocks = self.near[0] > self.near[1] && self.difference[0] < self.difference[1];
        by_blocks || ours + SURE * self.sum_error < reference
    }
}

impl fmt::Display for BesideTruth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ours, reference] = self.difference.map(|share| 100.0 * share);
        let [sum, reference_sum] = self.sum.map(|share| 100.0 * share);
        let [near, reference_near] = self.near;
        let error = 100.0 * self.sum_error;
        write!(
            f,
            "{} | {near} | {reference_near} | {ours:.1} % | {reference:.1} % | {sum:+.1} % | {reference_sum:+.1} % | {error:.1} % |",
            self.count
        )
    }
}
