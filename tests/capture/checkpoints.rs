//! Checkpoints of captures can be read at any moment.

use crate::program::gripps;
use radsight::{Capture, Progress, Scene};
use radsight_capture::Checkpoint;
use radsight_pinhole::{BandWeights, Rays};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

const KEY: [u8; 32] = [7; 32];

/// Reports between checkpoints.
const INTERVAL: u64 = 8;

/// Wants checkpoints all the time, and reads them.
struct ReadsCheckpoints {
    rays: Rays,
    weights: BandWeights,
    since_last: AtomicU64,
    read: AtomicU64,
}

impl Progress for ReadsCheckpoints {
    fn report(&self, _done: u64, _total: u64) {
        self.since_last.fetch_add(1, Relaxed);
    }

    fn wants_checkpoint(&self) -> bool {
        self.since_last.load(Relaxed) >= INTERVAL
    }

    fn save(&self, checkpoint: Checkpoint) {
        self.since_last.store(0, Relaxed);
        let read = Checkpoint::from_bytes(&checkpoint.to_bytes(&KEY), &KEY, &self.rays, &self.weights);
        if let Err(error) = read {
            panic!("after {} checkpoints: {error}", self.read.load(Relaxed));
        }
        self.read.fetch_add(1, Relaxed);
    }
}

#[test]
fn every_checkpoint_can_be_read() {
    // Pixels that share rays on a lattice, and pixels by themselves.
    for size in ["[32, 28]", "[16, 12]"] {
        let camera = gripps("fig11.toml");
        let capture = Capture::load_with_keys(&camera, &[("camera.pixels", size)]).expect("a camera").error(0.02);
        let files = [gripps("sheet-retro.rad")];
        let scene = capture.with_ring(Scene::builder().files(&files).expect("files")).build().expect("a scene");
        let progress = ReadsCheckpoints {
            rays: Rays::new(&capture.camera_file().camera, 1, 0),
            weights: capture.camera_file().band_weights_for(1).expect("one band"),
            since_last: AtomicU64::new(0),
            read: AtomicU64::new(0),
        };
        let image = capture.expose_with_progress(&scene, &progress).expect("an exposure");
        assert!(!image.is_stopped && progress.read.into_inner() > 0, "{size}");
    }
}
