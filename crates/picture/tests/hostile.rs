//! No input makes a reader panic.

mod mutation;

use mutation::{Random, read_all_ways, seeds, spoil};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        read_all_ways(&bytes);
    }

    #[test]
    fn spoiled_files_never_panic(which in any::<prop::sample::Index>(), seed in 1u64..) {
        let seeds = seeds();
        let mut bytes = which.get(&seeds).clone();
        spoil(&mut bytes, &mut Random(seed));
        read_all_ways(&bytes);
    }

    #[test]
    fn pictures_keep_their_pixels(width in 1usize..200, height in 1usize..6, runs in 1usize..30, seed in 1u64..) {
        let mut random = Random(seed);
        let mut value = 0.0;
        let data = (0..width * height * 3).map(|_| {
            if random.below(runs) == 0 { value = random.below(1000) as f32 / 100.0; }
            value
        }).collect();
        let image = radsight_picture::Image::new(width, height, 3, data).unwrap();
        let picture = radsight_picture::Picture::from_rgb(Default::default(), &image).unwrap();
        let read = radsight_picture::Picture::read(&picture.to_bytes()).unwrap();
        prop_assert_eq!(read.pixels(), picture.pixels());
        for (a, b) in read.values().data().iter().zip(image.data()) {
            // Half a step of the largest of the three, which is below 16 here.
            prop_assert!((a - b).abs() <= 16.0 / 256.0 / 2.0 + 1e-6, "{} {}", a, b);
        }
    }
}

#[test]
fn every_prefix_of_every_kind_is_read_or_refused() {
    for seed in seeds() {
        for length in 0..seed.len() {
            read_all_ways(&seed[..length]);
        }
    }
}
