//! A soak: scenes and settings that chance chooses, one after the other, for as long as `LUMBRE_SOAK_SECONDS` says (`make soak`: an hour),
//! with validation on. Nothing may stay behind: neither memory of the device or of the host, nor a validation message. Each run is made
//! of its number alone; `LUMBRE_SOAK_FIRST` begins with another one than 0. What takes long is told.

use std::path::Path;
use std::time::Instant;

use crate::common::alone::alone;
use crate::common::{backends, canon, settings, with_gpu};
use lumbre::error::Error;
use lumbre::layout::backend::Backend;
use lumbre::render::{Renderer, Settings};
use lumbre::techniques::{Strategies, TECHNIQUES};

/// Seconds of a soak where nobody says.
const SECONDS: f64 = 20.0;
/// Seconds after which a run is told of.
const LONG: f64 = 30.0;
/// Bytes that the host's memory may grow by from the second quarter of a soak to its end, whatever its length, because the largest kernel
/// may be compiled late; and for each run in between. A short soak sees large leaks of the host alone, a long one small ones as well.
const MAY_GROW: f64 = 256.0 * 1024.0 * 1024.0;
const MAY_GROW_BY_RUN: f64 = 16.0 * 1024.0;

const SCENES: [&str; 6] = [
    "cornell.xml",
    "cornell_spheres.xml",
    "veach_mis.xml",
    "bidirectional_room.xml",
    "small_vcm.xml",
    "furnace_box.xml",
];

struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    fn of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }
}

/// Bytes of the host's memory that this process holds, without what the allocator keeps for later: a CPU device compiles its largest
/// kernel in 1.3 GB, and most of that would count from then on.
fn resident() -> f64 {
    #[cfg(target_env = "gnu")]
    // SAFETY: it has no conditions; the allocator takes its own locks.
    unsafe {
        libc::malloc_trim(0);
    }
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() * 1024.0
}

fn any_settings(random: &mut Random, scene: &lumbre::scene::Scene, backend: Backend) -> Settings {
    let row = random.of(&TECHNIQUES.iter().collect::<Vec<_>>());
    let technique = match row.name {
        "radiosity" => random.of(&["radiosity:patches=4", "radiosity:patches=4:solver=shoot", "radiosity:patches=8"]),
        "mlt" => random.of(&[
            "mlt:chains=128:candidates=4096",
            "mlt:chains=256:form=multiplexed:candidates=4096",
            "mlt:chains=256:form=paths:candidates=4096",
        ]),
        name => name,
    };
    let mut any = settings(scene, technique, backend);
    (any.width, any.height) = (1 + random.below(48) as u32, 1 + random.below(48) as u32);
    any.seed = random.below(1000) as u32;
    any.max_depth = random.of(&[Some(1), Some(2), Some(5), None]);
    any.sampler = random.of(&row.samplers().iter().map(|row| row.sampler).collect::<Vec<_>>());
    match random.below(4) {
        0 => any.lengths = 1 + random.below(5) as u32,
        1 if row.tells_strategies => {
            any.strategies = Some(Strategies::of(4, scene.camera(None).unwrap()));
            any.max_depth = Some(4);
        }
        _ => {}
    }
    any
}

#[test]
fn nothing_stays_behind() {
    // The memory is that of the whole process.
    alone(|| {
        let asked = std::env::var("LUMBRE_SOAK_SECONDS").ok();
        let seconds: f64 =
            asked.map_or(SECONDS, |text| text.parse().expect("LUMBRE_SOAK_SECONDS: a number of seconds"));
        let scenes: Vec<_> = SCENES.iter().map(|name| canon(name, &[])).collect();
        with_gpu(|gpu| {
            let backends = backends(gpu);
            let first: u64 =
                std::env::var("LUMBRE_SOAK_FIRST").map_or(0, |text| text.parse().expect("LUMBRE_SOAK_FIRST: a number"));
            let (held, begun) = (gpu.bytes_in_use(), Instant::now());
            let (mut runs, mut without_light, mut peak, mut told) = (first, 0, 0.0f64, 0);
            let mut at_second_quarter: Option<(f64, u64)> = None;
            while begun.elapsed().as_secs_f64() < seconds {
                let mut random = Random(runs.wrapping_mul(0x9e37_79b9_7f4a_7c15));
                let scene = &scenes[random.below(scenes.len())];
                let backend = random.of(&backends);
                let settings = any_settings(&mut random, scene, backend);
                let what = format!("run {runs}: {} {settings:?}", scene.source.display());
                let spp = 1 + random.below(12) as u32;
                let started = Instant::now();
                match one(gpu, scene, &settings, spp, &mut random) {
                    Ok(()) => {}
                    Err(Error::NothingFound(_)) => without_light += 1,
                    Err(error) => panic!("{what}: {error}"),
                }
                if started.elapsed().as_secs_f64() > LONG {
                    println!("{:.0} s, {what}, {spp} spp", started.elapsed().as_secs_f64());
                }
                let messages = gpu.take_validation_messages();
                assert!(messages.is_empty(), "{what}: {messages:#?}");
                assert_eq!(gpu.bytes_in_use(), held, "{what}: bytes on the device");
                (runs, peak) = (runs + 1, peak.max(resident()));
                let share = begun.elapsed().as_secs_f64() / seconds;
                if share >= 0.25 && at_second_quarter.is_none() {
                    at_second_quarter = Some((resident(), runs));
                }
                if (share * 12.0) as u32 > told {
                    told = (share * 12.0) as u32;
                    println!("{:6.0} s, {runs:6} runs, {:7.1} MiB", share * seconds, resident() / 1048576.0);
                }
            }
            let (before, runs_before) = at_second_quarter.expect("more than one run in the time");
            let grown = resident() - before;
            println!(
                "{} runs, {without_light} without light; peak {:.1} MiB, grown by {:.1} MiB in the last three quarters",
                runs - first,
                peak / 1048576.0,
                grown / 1048576.0
            );
            assert!(
                grown < MAY_GROW + MAY_GROW_BY_RUN * (runs - runs_before) as f64,
                "grown by {grown} bytes in {runs} runs"
            );
        });
    });
}

/// A rendering that is written down somewhere and goes on in another renderer.
fn one(
    gpu: &lumbre::gpu::Gpu,
    scene: &lumbre::scene::Scene,
    settings: &Settings,
    spp: u32,
    random: &mut Random,
) -> lumbre::Result<()> {
    let mut renderer = Renderer::new(gpu, scene, settings)?;
    renderer.bound_frames(1 << (8 + random.below(8)));
    let mut bytes = Vec::new();
    let stops = random.below(20);
    for _ in 0..stops {
        if !renderer.advance(spp)? {
            break;
        }
    }
    if random.below(3) == 0 {
        renderer.save(Path::new("state"), &mut bytes)?;
        drop(renderer);
        renderer = Renderer::new(gpu, scene, settings)?;
        renderer.restore(Path::new("state"), &mut bytes.as_slice())?;
    }
    while renderer.advance(spp)? {}
    let film = renderer.film()?;
    assert!(film.mean().pixels.iter().flatten().all(|value| value.is_finite()));
    Ok(())
}
