//! What `lumbre::spirv` makes of modules: valid for any values of the constants, the same bits as the driver's own way, and an error
//! where words are broken.

use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, mpsc};
use std::time::{Duration, Instant};

use crate::common::mutation::Mutator;
use crate::common::{backends, canon, has_time, render, settings, with_gpu};
use lumbre::gpu;
use lumbre::layout::backend::Backend;
use lumbre::layout::{CAMERA_ORTHOGRAPHIC, FILTER_MITCHELL, INLINE_FIRST_ID, INLINE_MAX, specialisation};
use lumbre::render::Settings;
use lumbre::spirv::{Arithmetic, Specialised, specialise};

/// Which values constants have.
#[derive(Clone, Copy, Debug)]
enum Values {
    /// Nothing takes part: `false`, and the least that a size may be.
    Least,
    /// Everything takes part.
    Most,
    /// Each by chance, from this seed.
    Random(u64),
}

/// The least and the most that an unsigned constant of this name may be.
fn range(name: &str) -> (u32, u32) {
    match name {
        "FILTER" => (0, FILTER_MITCHELL),
        "CAMERA" => (0, CAMERA_ORTHOGRAPHIC),
        "INLINE_COUNT" => (0, INLINE_MAX),
        "LENGTH_LAYERS" => (0, 12),
        "STACK_SIZE" => (1, 64),
        "MAX_DEPTH" => (1, u32::MAX),
        "LIGHT_COUNT" | "SURFACE_COUNT" | "MATERIAL_COUNT" => (0, 1 << 20),
        // What techniques take them for differs: numbers, switches, the bits of real numbers.
        _ => (0, u32::MAX),
    }
}

/// Values of all constants there are.
fn constants(values: Values) -> Vec<(u32, u32)> {
    let mut random = match values {
        Values::Random(seed) => Mutator::new(seed),
        _ => Mutator::new(1),
    };
    let mut pick = |least: u32, most: u32| match values {
        Values::Least => least,
        Values::Most => most,
        // Small numbers as often as those of any size: many constants are compared with small ones.
        Values::Random(_) if most > 16 && random.below(2) == 0 => least + random.below(16) as u32,
        Values::Random(_) => least + random.below((most - least) as usize + 1) as u32,
    };
    let mut all: Vec<(u32, u32)> = Vec::new();
    let mut triangles = 0;
    for constant in specialisation() {
        let value = match constant.kind {
            "bool" => pick(0, 1),
            "uint" => {
                let (least, most) = range(constant.name);
                pick(least, most)
            }
            "float" => (pick(0, 1 << 20) as f32 / 65536.0).to_bits(),
            kind => panic!("{}: constants of the kind {kind} have no values here", constant.name),
        };
        if constant.name == "INLINE_COUNT" {
            triangles = value;
        }
        all.push((constant.id, value));
    }
    all.extend((0..9 * triangles).map(|k| (INLINE_FIRST_ID + k, (pick(0, 1 << 20) as f32 / 65536.0).to_bits())));
    all
}

/// What spirv-val has against a module, which is given to it through a pipe.
fn faults(words: &[u32]) -> Option<String> {
    let mut command = Command::new("spirv-val");
    command.args(["--target-env", "vulkan1.3", "--scalar-block-layout", "-"]);
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("spirv-val, of the package spirv-tools: `.ci/setup test` installs it");
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    // Where it has seen enough it does not read on.
    let _ = child.stdin.take().unwrap().write_all(&bytes);
    let output = child.wait_with_output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    (!output.status.success()).then(|| String::from_utf8_lossy(&said).into_owned())
}

/// Runs over a list on every core; what failed.
fn on_all_cores<T: Sync>(list: &[T], run: impl Fn(&T) -> Option<String> + Sync) -> Vec<String> {
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(item) = list.get(next.fetch_add(1, Ordering::Relaxed)) {
                    failed.lock().unwrap().extend(run(item));
                }
            });
        }
    });
    failed.into_inner().unwrap()
}

/// Of every module, with nothing, with everything and with what chance chooses.
#[test]
fn every_module_is_valid() {
    let mut list = Vec::new();
    for (index, name) in gpu::module_names().enumerate() {
        // Both backends share all code but that of traversal: chance gives each of them other values.
        let draws = if has_time() { 12 } else { 1 };
        let random = (0..draws).map(|draw| Values::Random(1000 * draw + index as u64));
        list.extend([Values::Least, Values::Most].into_iter().chain(random).map(|values| (name, values)));
    }
    let (left, of) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let failed = on_all_cores(&list, |(name, values)| {
        let words = gpu::module(name).unwrap();
        let arithmetic = if matches!(values, Values::Most) { Arithmetic::Exact } else { Arithmetic::Free };
        let made = specialise(&words, &constants(*values), arithmetic);
        let Specialised { words, before, after } = match made {
            Ok(made) => made,
            Err(error) => return Some(format!("{name}, {values:?}: {error}")),
        };
        left.fetch_add(after, Ordering::Relaxed);
        of.fetch_add(before, Ordering::Relaxed);
        faults(&words).map(|fault| format!("{name}, {values:?}: {fault}"))
    });
    println!("{} modules: {left:?} of {of:?} instructions are left", list.len());
    assert!(failed.is_empty(), "{} of {} modules:\n{}", failed.len(), list.len(), failed.join("\n"));
}

/// A module that is not valid is found to be so: spirv-val is there and is asked the right thing.
#[test]
fn a_planted_fault_is_found() {
    let module = gpu::module("test/random.bvh").unwrap();
    let made = specialise(&module, &constants(Values::Least), Arithmetic::Free).unwrap();
    assert_eq!(faults(&made.words), None);
    let mut broken = made.words.clone();
    // The last instruction but one, a return or a jump, becomes one that does nothing.
    let last = broken.len() - 2;
    broken[last] = 1 << 16;
    assert!(faults(&broken).is_some());
}

/// What is specialised here renders the bits of what the driver specialises.
#[test]
fn the_image_is_that_of_the_drivers_own_way() {
    // The driver's own way takes it seconds. The kernels of `vcm` hold those of `bdpt`.
    const PAIRS: [(&str, &str, Backend, u32); 7] = [
        ("cornell.xml", "path", Backend::Bvh, 32),
        ("cornell.xml", "radiosity:patches=4", Backend::Bvh, 32),
        ("veach_mis.xml", "path", Backend::RayQuery, 32),
        ("gltf_room/room.gltf", "path", Backend::Bvh, 12),
        ("small_vcm.xml", "vcm", Backend::Bvh, 32),
        ("cornell_spheres.xml", "bdpt", Backend::Bvh, 32),
        ("cornell.xml", "mlt:form=paths:candidates=65536:chains=1024", Backend::Bvh, 32),
    ];
    with_gpu(|gpu| {
        for (name, technique, backend, size) in PAIRS.into_iter().take(if has_time() { 7 } else { 5 }) {
            if !backends(gpu).contains(&backend) {
                continue;
            }
            let scene = canon(name, &[]);
            let ours = Settings { width: size, height: size, ..settings(&scene, technique, backend) };
            let drivers = Settings { driver_specialises: true, ..ours.clone() };
            let started = Instant::now();
            let [ours, drivers] = [ours, drivers].map(|settings| render(gpu, &scene, &settings, 3));
            println!("{name}, {technique}: {:.1} s", started.elapsed().as_secs_f64());
            assert!(ours.average()[1] > 0.0, "{name}, {technique} is dark");
            assert!(ours.sums == drivers.sums && ours.squares == drivers.squares, "{name}, {technique}: other bits");
        }
    });
}

/// A change to a module, of the kinds that files are changed by: words are missing at the end or in the middle, are others, or are there
/// twice.
fn mutate(words: &mut Vec<u32>, random: &mut Mutator) {
    if words.is_empty() {
        return; // a change before this one has left nothing
    }
    let at = random.below(words.len());
    let end = (at + 1 + random.below(8)).min(words.len());
    match random.below(8) {
        0 => words.truncate(at),
        1 => drop(words.drain(at..end)),
        2 => {
            let again = words[at..end].to_vec();
            words.splice(at..at, again);
        }
        3 => words[at] = random.next() as u32,
        4 => words[at] = words[at].wrapping_add(1),
        5 => words[at] = words[at].wrapping_sub(1),
        6 => words[at] = words[random.below(words.len())],
        _ => words[at] ^= 1 << random.below(32),
    }
}

/// Words that are no module, or one of another kind: an error or a module, never a panic, and none takes for ever.
#[test]
fn broken_words_are_refused() {
    const MUTATIONS: u32 = 6000;
    let module = gpu::module("test/random.bvh").unwrap();
    let (sender, receiver) = mpsc::channel();
    // On a thread of its own, which can be given up.
    std::thread::spawn(move || {
        let mut random = Mutator::new(20_251_129);
        for mutation in 0..MUTATIONS {
            let special = constants(Values::Random(u64::from(mutation % 16)));
            let mut words = module.clone();
            (0..=random.below(3)).for_each(|_| mutate(&mut words, &mut random));
            let made = std::panic::catch_unwind(|| specialise(&words, &special, Arithmetic::Free));
            if sender.send(made.map(|made| made.is_err())).is_err() {
                break;
            }
        }
    });
    let mut refused = 0;
    let mut panicked = Vec::new();
    for mutation in 0..MUTATIONS {
        match receiver.recv_timeout(Duration::from_secs(20)) {
            Ok(Ok(is_refused)) => refused += u32::from(is_refused),
            Ok(Err(_)) => panicked.push(mutation),
            Err(error) => panic!("mutation {mutation}: {error}"),
        }
    }
    println!("{refused} of {MUTATIONS} mutations were refused");
    assert!(panicked.is_empty(), "these mutations made it panic: {panicked:?}");
    assert!(refused > MUTATIONS / 3 && refused < MUTATIONS, "{refused} were refused: mutations of no use");
}
