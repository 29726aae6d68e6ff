#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| radsight_fuzz::job(bytes));
