//! Checkpoints: what goes on from one has the bits of what was never interrupted, wherever that was; and what is not whole or not of
//! this rendering is refused.

use std::path::Path;

use crate::common::program::{fails, render, works};
use crate::common::{canon, has_time, settings, with_gpu};
use lumbre::checkpoint::{Checkpoints, Header, Identity};
use lumbre::gpu::Gpu;
use lumbre::layout::backend::Backend;
use lumbre::render::film::Film;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::{Filter, LoadOptions, Scene};
use lumbre::spirv::Arithmetic;
use lumbre::techniques::{Sampler, Strategies, TECHNIQUES};

const SPP: u32 = 3;

/// Everything in a film that could differ.
fn bits(renderer: &Renderer) -> String {
    let film: Film = renderer.film().unwrap();
    let flat = |sums: &[[f64; 3]]| sums.iter().flatten().map(|sum| sum.to_bits()).collect::<Vec<_>>();
    let layers: Vec<_> = film.lengths.iter().map(|layer| flat(layer)).collect();
    let strategies: Vec<_> =
        film.strategies.iter().map(|layer| (flat(&layer.unweighted), flat(&layer.weighted))).collect();
    let own = (&film.counts, flat(&film.sums), flat(&film.squares), layers, strategies);
    format!("{own:?} {} {:?} {}", film.nonfinite, film.bad_samples, renderer.rays())
}

/// Renders in frames as small as they can be, and after each of them goes on in another renderer, which knows nothing of it but what
/// was written down, and holds the remains of older states. `seconds`: what the renderer expects to have. Returns the states that were
/// handed over.
fn handed_over(gpu: &Gpu, scene: &Scene, settings: &Settings, seconds: Option<f64>, what: &str) -> usize {
    let path = Path::new("state");
    let begun = || {
        let mut renderer = Renderer::new(gpu, scene, settings).unwrap();
        if let Some(seconds) = seconds {
            renderer.set_time_budget(seconds);
        }
        renderer
    };
    let mut plain = begun();
    while plain.advance(SPP).unwrap() {}
    let expected = bits(&plain);
    // Another seed and the frames of another speed, left in the middle of a pass.
    let mut other = plain;
    other.restart(settings.seed + 1).unwrap();
    other.bound_frames(64);
    (0..2).for_each(|_| assert!(other.advance(SPP).unwrap(), "{what}: too few frames to tell"));
    other.restart(settings.seed).unwrap();
    let mut own = begun();
    own.bound_frames(64);
    let mut handed = 0;
    loop {
        let more = own.advance(SPP).unwrap();
        let mut bytes = Vec::new();
        own.save(path, &mut bytes).unwrap();
        let mut left = bytes.as_slice();
        other.restore(path, &mut left).unwrap();
        assert!(left.is_empty(), "{what}: all of it is read");
        std::mem::swap(&mut own, &mut other);
        handed += 1;
        assert!(handed < 2000, "{what}: what is handed over makes no progress");
        if !more {
            break;
        }
    }
    assert!(bits(&own) == expected, "{what}: not the same bits after {handed} hand-overs");
    handed
}

/// Every technique, interrupted after each single frame: within passes, between stages, while chains begin and patches prepare.
#[test]
fn every_technique_goes_on_from_every_frame() {
    let scene = canon("cornell.xml", &[("size", "16")]);
    with_gpu(|gpu| {
        for row in TECHNIQUES {
            let name = if row.name == "radiosity" { "radiosity:patches=4" } else { row.name };
            let frames = handed_over(gpu, &scene, &settings(&scene, name, Backend::Bvh), None, name);
            println!("{name}: {frames} frames");
            assert!(frames >= SPP as usize, "{name}");
        }
    });
}

/// Resuming with all else that a film may hold, and the forms that keep more.
#[test]
fn layers_forms_and_seeds_go_on_as_well() {
    let scene = canon("cornell.xml", &[("size", "16")]);
    with_gpu(|gpu| {
        let of = |technique: &str| Settings { seed: 7, ..settings(&scene, technique, Backend::Bvh) };
        let layers = Some(Strategies::of(3, scene.camera(None).unwrap()));
        let strategies = |technique: &str| Settings { strategies: layers, max_depth: Some(3), ..of(technique) };
        // The last ones keep nothing that another here or in tests/killed.rs does not keep.
        let cases = [
            ("path by length", Settings { lengths: 3, ..of("path") }),
            ("bdpt by strategy", strategies("bdpt")),
            ("mlt multiplexed", of("mlt:form=multiplexed:chains=1024:candidates=65536")),
            ("mlt of paths", of("mlt:form=paths:chains=1024:candidates=65536")),
            ("radiosity, shot", Settings { lengths: 3, ..of("radiosity:patches=4:solver=shoot") }),
            ("radiosity, quartered", of("radiosity:patches=4:adaptive=0.5:shown=patches")),
            ("path, independent", Settings { sampler: Sampler::Independent, ..of("path") }),
            ("bdpt by length", Settings { lengths: 3, ..of("bdpt") }),
            ("mlt by length", Settings { lengths: 3, ..of("mlt:chains=128:candidates=65536") }),
            ("vcm, large radius", of("vcm:radius=0.2:alpha=0.5")),
            ("photon maps", of("photon:direct=photons")),
            ("radiosity, short", Settings { max_depth: Some(3), ..of("radiosity:patches=4") }),
        ];
        for (what, settings) in cases.into_iter().take(if has_time() { 12 } else { 6 }) {
            println!("{what}: {} frames", handed_over(gpu, &scene, &settings, None, what));
        }
        // With time for the fewest candidates only.
        let what = "mlt in a hurry";
        println!("{what}: {} frames", handed_over(gpu, &scene, &of("mlt:chains=128"), Some(0.0), what));
        if gpu.require(Backend::RayQuery).is_ok() {
            let settings = Settings { seed: 7, ..settings(&scene, "path", Backend::RayQuery) };
            handed_over(gpu, &scene, &settings, None, "path on ray-query");
        }
    });
}

/// What was dropped stays counted and located: what a lamp over nearly the half space sheds on a rectangle is beyond single precision.
#[test]
fn dropped_samples_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let body = r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="20"/>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film></sensor>
        <shape type="rectangle"><transform name="to_world"><translate x="-1"/></transform></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="200"/><rotate y="1" angle="180"/><translate z="20"/></transform>
        <emitter type="area"><rgb name="radiance" value="3e38, 1, 1"/></emitter></shape></scene>"#;
    std::fs::write(folder.path().join("scene.xml"), body).unwrap();
    let scene = lumbre::scene::load(&folder.path().join("scene.xml"), &LoadOptions::default()).unwrap();
    with_gpu(|gpu| {
        let settings = Settings { max_depth: Some(2), ..settings(&scene, "path", Backend::Bvh) };
        // The 16 that are located first hang on the frames: all samples of pixels in the first frame come first. So they are compared
        // within the same frames, and the count with any.
        let mut own = Renderer::new(gpu, &scene, &settings).unwrap();
        own.bound_frames(64);
        let mut other = Renderer::new(gpu, &scene, &settings).unwrap();
        other.bound_frames(64);
        let path = Path::new("state");
        for _ in 0..5 {
            own.advance(2).unwrap();
        }
        let mut bytes = Vec::new();
        own.save(path, &mut bytes).unwrap();
        other.restore(path, &mut bytes.as_slice()).unwrap();
        while own.advance(2).unwrap() {}
        while other.advance(2).unwrap() {}
        let (own, other) = (own.film().unwrap(), other.film().unwrap());
        assert_eq!((own.nonfinite, &own.bad_samples), (other.nonfinite, &other.bad_samples));
        assert_eq!(other.nonfinite, 16 * 8 * 2);
    });
}

/// A rendering with two checkpoints on disk; the header of the newest.
fn two_checkpoints(gpu: &Gpu, scene: &Scene, path: &Path) -> (Settings, Header) {
    let settings = settings(scene, "path", Backend::Bvh);
    let mut renderer = Renderer::new(gpu, scene, &settings).unwrap();
    let mut files = Checkpoints::open(path).unwrap();
    let header = |renderer: &Renderer| Header {
        spent: 0.1 + 0.2,
        next_look: Some(73),
        ..Header::of(renderer, Identity::of(scene, &settings, gpu), serde_json::Value::Null).unwrap()
    };
    for spp in [1, 2] {
        while renderer.advance(spp).unwrap() {}
        files.save(&header(&renderer), &mut renderer).unwrap();
    }
    let newest = header(&renderer);
    (settings, newest)
}

/// Whatever byte of a checkpoint is wrong and wherever it ends, it is refused, and the one before it is taken; that one stays until
/// there is a better one.
#[test]
fn damaged_files_are_refused() {
    let scene = canon("cornell.xml", &[("size", "8")]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ckpt");
    let previous = folder.path().join("a.ckpt.previous");
    with_gpu(|gpu| {
        let (settings, newest) = two_checkpoints(gpu, &scene, &path);
        let identity = Identity::of(&scene, &settings, gpu);
        let mut files = Checkpoints::open(&path).unwrap();
        let found = files.find(&identity).unwrap().unwrap();
        assert_eq!((&found.header, found.warning), (&newest, None));
        let whole = std::fs::read(&path).unwrap();
        // Every length that is too short, and every byte with a bit turned over; in the pixels, every eleventh.
        let step = |at: usize| if at < 2000 || at + 8 > whole.len() { 1 } else { 11 };
        let mut at = 0;
        while at < whole.len() {
            let mut turned = whole.clone();
            turned[at] ^= 1 << (at % 8);
            for bytes in [&turned[..], &whole[..at]] {
                std::fs::write(&path, bytes).unwrap();
                let found = files.find(&identity).unwrap().unwrap();
                let warning = found.warning.unwrap_or_else(|| panic!("byte {at} of {} was not missed", whole.len()));
                assert!(warning.starts_with(&format!("{}: it ", path.display())), "{warning}");
                assert!(warning.contains("a.ckpt.previous, the one before it") && !warning.contains('\n'), "{warning}");
                assert_eq!(found.header.spp, 1);
            }
            at += step(at);
        }
        let longer = [&whole[..], b"more"].concat();
        std::fs::write(&path, &longer).unwrap();
        assert_eq!(files.find(&identity).unwrap().unwrap().header.spp, 1);

        // The damaged one does not push out the good one.
        let good = std::fs::read(&previous).unwrap();
        let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
        let found = files.find(&identity).unwrap().unwrap();
        files.restore(&found, &mut renderer).unwrap();
        assert_eq!(renderer.spp(), 1);
        files.save(&found.header, &mut renderer).unwrap();
        assert_eq!(std::fs::read(&previous).unwrap(), good);
        files.save(&found.header, &mut renderer).unwrap();
        assert!(files.find(&identity).unwrap().unwrap().warning.is_none());

        // Both damaged: one message that names both.
        std::fs::write(&path, b"").unwrap();
        std::fs::write(&previous, b"lumbreCP and more than that").unwrap();
        let error = files.find(&identity).unwrap_err();
        let message = error.to_string();
        assert!(error.exit_status() == 2 && message.contains("a.ckpt: it is cut short: 0 bytes"), "{message}");
        assert!(message.contains("a.ckpt.previous: it has version"), "{message}");
        std::fs::remove_file(&path).unwrap();
        std::fs::remove_file(&previous).unwrap();
        assert!(files.find(&identity).unwrap().is_none());
    });
}

/// A checkpoint that may not be on the disk yet takes the place of none: a pipe takes all its bytes, and cannot be synced.
#[test]
fn what_cannot_be_synced_takes_no_place() {
    let scene = canon("cornell.xml", &[("size", "8")]);
    let folder = tempfile::tempdir().unwrap();
    let [path, previous, partial] =
        ["a.ckpt", "a.ckpt.previous", "a.ckpt.partial"].map(|name| folder.path().join(name));
    with_gpu(|gpu| {
        let (settings, newest) = two_checkpoints(gpu, &scene, &path);
        let before = [&path, &previous].map(|file| std::fs::read(file).unwrap());
        let mut renderer = Renderer::new(gpu, &scene, &settings).unwrap();
        let mut files = Checkpoints::open(&path).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&partial).status().unwrap().success());
        let pipe = partial.clone();
        let reader = std::thread::spawn(move || std::fs::read(pipe).unwrap());
        let error = files.save(&newest, &mut renderer).expect_err("it was not synced, or not before it was let in");
        assert!(error.to_string().starts_with(&format!("cannot write {}: ", path.display())), "{error}");
        assert_eq!(reader.join().unwrap().len(), before[0].len(), "it was written whole");
        // A pipe in the place of a checkpoint would be read for ever.
        assert!([&path, &previous].iter().all(|file| file.metadata().unwrap().is_file()), "a pipe took its place");
        assert!([&path, &previous].map(|file| std::fs::read(file).unwrap()) == before, "the checkpoints changed");
        assert!(!partial.exists(), "what was not let in is left behind");
        std::fs::write(&partial, b"").unwrap();
        files.save(&newest, &mut renderer).unwrap();
        assert!(std::fs::read(&previous).unwrap() == before[0], "the newest one became the one before it");
    });
}

/// A checkpoint of another rendering is refused, and the message names what differs and nothing else.
#[test]
fn checkpoints_of_other_renderings_are_refused() {
    let scene = canon("cornell.xml", &[("size", "8")]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ckpt");
    with_gpu(|gpu| {
        let (settings, _) = two_checkpoints(gpu, &scene, &path);
        let mut files = Checkpoints::open(&path).unwrap();
        let mut refused = |scene: &Scene, settings: &Settings, expected: &[&str]| {
            let error = files.find(&Identity::of(scene, settings, gpu)).unwrap_err();
            let message = error.to_string();
            assert_eq!(error.exit_status(), 2, "{message}");
            assert!(message.contains("a.ckpt is of another rendering; what differs is "), "{message}");
            expected.iter().for_each(|part| assert!(message.contains(part), "'{part}' is not in: {message}"));
            assert_eq!(message.matches(" there, ").count(), expected.len(), "{message}");
        };
        let with = |change: &dyn Fn(&mut Settings)| {
            let mut changed = settings.clone();
            change(&mut changed);
            changed
        };
        refused(&scene, &with(&|it| it.seed = 5), &["seed (0 there, 5 asked for)"]);
        refused(&scene, &with(&|it| it.width = 9), &["size (8x8 there, 9x8 asked for)"]);
        refused(&scene, &with(&|it| it.max_depth = Some(4)), &["longest path (none there, 4 asked for)"]);
        refused(&scene, &with(&|it| it.lengths = 4), &["layers by length"]);
        refused(&scene, &with(&|it| it.rr_depth = 99), &["roulette from segment"]);
        refused(
            &scene,
            &with(&|it| it.sampler = Sampler::Independent),
            &["sampler (sobol there, independent asked for)"],
        );
        let vcm = crate::common::settings(&scene, "vcm:radius=0.5", Backend::Bvh).technique;
        let both = with(&|it| (it.technique, it.seed) = (vcm.clone(), 1));
        refused(&scene, &both, &["technique (path", "seed (0 there, 1 asked for)"]);
        refused(&scene, &with(&|it| it.backend = Backend::RayQuery), &["backend (bvh there, ray-query asked for)"]);
        let other = canon("cornell_spheres.xml", &[("size", "8")]);
        refused(&other, &settings, &["scene ("]);
        let camera = with(&|it| it.camera = Some(String::from("0")));
        refused(&scene, &camera, &["camera (the first there, '0' asked for)"]);
        refused(&scene, &with(&|it| it.filter = Filter::Tent { radius: 1.0 }), &["filter ("]);
        let strategies = Some(Strategies::of(3, scene.camera(None).unwrap()));
        refused(&scene, &with(&|it| it.strategies = strategies), &["layers by strategy (0 there, 3 asked for)"]);
        refused(&scene, &with(&|it| it.specialise = false), &["specialised (true there, false asked for)"]);
        refused(&scene, &with(&|it| it.driver_specialises = true), &["specialised by the driver (false there"]);
        refused(&scene, &with(&|it| it.arithmetic = Arithmetic::Exact), &["arithmetic (Free there, Exact asked for)"]);
        refused(&scene, &with(&|it| it.chunk = 5), &["chunk ("]);
        // The header keeps it, and what goes on takes it from there.
        let expected_samples = with(&|it| it.expected_samples = 1);
        assert!(files.find(&Identity::of(&scene, &expected_samples, gpu)).unwrap().is_some());
    });
    another_environment_is_refused(folder.path());
}

/// On the command line: a sky that is turned is another scene, though its texels and what they are sampled by are the same.
fn another_environment_is_refused(folder: &Path) {
    let sky = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references/sky.exr");
    let body = format!(
        r#"<scene version="3.0.0"><default name="angle" value="0"/>
        <sensor type="perspective"><film type="hdrfilm"><rfilter type="box"/></film></sensor>
        <emitter type="envmap"><string name="filename" value="{}"/>
        <transform name="to_world"><rotate y="1" angle="$angle"/></transform></emitter></scene>"#,
        sky.display()
    );
    let file = folder.join("sky.xml");
    std::fs::write(&file, body).unwrap();
    let line = |more: &str| {
        render(
            folder,
            file.to_str().unwrap(),
            &format!("-i path -n 1 --size 8x8 -o sky.exr --checkpoint sky.ckpt --resume {more}"),
        )
    };
    works(line(""));
    assert!(works(line("-D angle=0")).starts_with("note: going on from sky.ckpt: 1 spp"));
    let said = fails(line("-D angle=40"), 2);
    assert!(said.starts_with("error: sky.ckpt is of another rendering; what differs is scene ("), "{said}");
    assert_eq!(said.matches(" there, ").count(), 1, "{said}");
}
