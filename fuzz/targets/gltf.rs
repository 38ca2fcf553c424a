#![no_main]

use lumbre_fuzz::{Format, run};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(Format::Gltf, bytes));
