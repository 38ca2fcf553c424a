//! Every test that needs more than one module: one program, linked once, whose tests share what they compile.
//! `make test` runs it, and `cargo test --release --test tests NAME` a part of it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

/// It counts what the files that tests/hostile.rs reads take.
#[global_allocator]
static ALLOCATOR: common::hostile::Bounded = common::hostile::Bounded;

mod agreement;
mod analytic;
mod aovs;
mod architecture;
mod bench;
mod bidirectional;
mod bsdf;
mod caustic;
mod checkpoint;
mod cli;
mod cli_bench;
mod denoise;
mod docs;
mod error_target;
mod faults;
#[cfg(unix)]
mod files;
mod gltf;
mod gltf_broken;
mod gltf_extensions;
mod hostile;
mod installed;
mod killed;
mod layout;
mod lecture;
mod light_tree;
mod lights;
mod materials;
mod memory;
mod merging;
mod metrics;
mod metropolis;
mod mip_maps;
mod mitsuba;
mod narrow;
mod obj;
#[cfg(unix)]
mod peer;
mod ply;
mod radiosity;
mod ranges;
mod rays;
mod record;
mod recursion;
mod references;
mod report;
mod robustness;
mod sampling;
mod scenes;
mod shards;
mod soak;
mod spirv;
mod strategies;
mod tev;
mod tour;
mod trace;
mod trace_chains;
mod traversal;
mod verify;
#[cfg(feature = "view")]
mod view;
mod vpl;
mod whitted;
mod witness;
