#![no_main]
libfuzzer_sys::fuzz_target!(|scene: radsight_fuzz::SmallScene| radsight_fuzz::render(&scene));
