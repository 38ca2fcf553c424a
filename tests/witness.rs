//! References: what a witness finds in faulty ones, who makes them, and the files and commands around them.

use std::io::{BufRead, BufReader};

use crate::common::program::{errors, fails, lumbre, signal, start, works};
use crate::common::{canon, scene_path, settings, with_gpu};
use lumbre::gpu::Gpu;
use lumbre::image::Image;
use lumbre::layout::backend::Backend;
use lumbre::reference::{
    Budget, Certificate, Kinds, Request, Series, Tile, TileMean, Truth, Witness, candidates, hold_against, make, read,
    write,
};
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;
use lumbre::techniques::Solves;

const SIDE: &str = "64";
const IMAGES: usize = 12;

/// Independent images of a technique.
fn series(gpu: &Gpu, scene: &Scene, settings: &Settings, technique: &str, spp: u32) -> Series {
    let settings = settings.for_technique(lumbre::render::Technique::parse(technique).unwrap());
    let mut renderer = Renderer::new(gpu, scene, &settings).unwrap();
    let mut series = Series::new(settings.width, settings.height, IMAGES, false);
    for image in 0..IMAGES {
        renderer.restart(1000 + image as u32 + technique.len() as u32 * 100).unwrap();
        while renderer.advance(spp).unwrap() {}
        series.add(image, &renderer.film().unwrap().mean(), f64::from(spp));
    }
    series
}

/// What a witness says of an image of known noise.
fn looked_at(truth: &Truth, witness: &Series, kinds: Kinds) -> Witness {
    let own = |tile: Tile, channel: usize| TileMean::of_truth(truth, tile, channel);
    hold_against((truth.image.width, truth.image.height), &own, witness, "witness", kinds)
}

fn changed(truth: &Truth, change: impl Fn(u32, u32, &mut [f32; 3])) -> Truth {
    let mut image = truth.image.clone();
    for (index, pixel) in image.pixels.iter_mut().enumerate() {
        change(index as u32 % image.width, index as u32 / image.width, pixel);
    }
    Truth::new(image, truth.variance.clone())
}

/// One twentieth of the image, 1 % too bright or too dark, is found, and named where it is; the image as it is, is not.
#[test]
fn a_wrong_scale_in_a_twentieth_is_found() {
    let scene = canon("cornell.xml", &[("size", SIDE)]);
    with_gpu(|gpu| {
        let settings = settings(&scene, "path", Backend::Bvh);
        let maker = series(gpu, &scene, &settings, "path", 288);
        let witness = series(gpu, &scene, &settings, "bdpt", 144);
        let truth = Truth::new(maker.mean(), Some(maker.variance()));
        let sound = looked_at(&truth, &witness, Kinds::default());
        assert!(sound.differences.is_empty(), "{:?}", sound.differences);
        println!("half of the tiles of 16x16 show {:.2} %", 100.0 * sound.detectable);
        for factor in [1.01, 0.99] {
            // 16 x 13 of 64 x 64 pixels: a twentieth, of the floor before the blocks.
            let inside = |x: u32, y: u32| (8..24).contains(&x) && (51..64).contains(&y);
            let faulty = changed(&truth, |x, y, pixel| {
                if inside(x, y) {
                    pixel.iter_mut().for_each(|value| *value *= factor);
                }
            });
            let found = looked_at(&faulty, &witness, Kinds::default());
            let first = found.differences.first().expect("1 % in a twentieth");
            println!("{factor}: {}", first.describe());
            assert!((first.deviations > 0.0) == (factor < 1.0));
            let area = Tile { x: 8, y: 51, width: 16, height: 13 };
            assert!(area.overlaps(Tile { x: first.x, y: first.y, width: first.width, height: first.height }));
        }
    });
}

/// A caustic that is removed and a glint that is missing are found; a witness that meets the caustic by chance blames no reference that
/// has it.
#[test]
fn missing_light_is_found() {
    let scene = canon("caustic_small_light.xml", &[("width", SIDE), ("height", SIDE)]);
    with_gpu(|gpu| {
        let settings = settings(&scene, "path", Backend::Bvh);
        let witness = series(gpu, &scene, &settings, "photon", 16);
        // What path shows in a moment: the shadows of glass are black, and its variance knows nothing of it.
        let without = series(gpu, &scene, &settings, "path", 8);
        let mut without = Truth::new(without.mean(), Some(without.variance()));
        for (pixel, noise) in without.image.pixels.iter_mut().zip(&mut without.variance.as_mut().unwrap().pixels) {
            // Should one of its rare samples be there, it is taken away.
            if noise.iter().any(|value| *value > 1.0) {
                (*pixel, *noise) = ([0.0; 3], [0.0; 3]);
            }
        }
        let found = looked_at(&without, &witness, Kinds { of_reference: Some("caustics"), of_witness: None });
        let first = found.differences.first().expect("the caustic");
        println!("{}", first.describe());
        assert!(first.deviations > 0.0 && first.likely == "caustics" && first.witness > 2.0 * first.reference);
        // The other way round nobody is blamed, but it is known that the witness lacks light.
        let truth = Truth::new(witness.mean(), Some(witness.variance()));
        let blind = series(gpu, &scene, &settings, "path", 8);
        let kinds = Kinds { of_reference: None, of_witness: Some("caustics") };
        let other = looked_at(&truth, &blind, kinds);
        assert!(other.differences.iter().all(|difference| difference.deviations > 0.0), "{:?}", other.differences);
        assert!(other.unseen > 0);

        // The pixel on the glass that is surely the brightest is the lamp's reflection: a single bright sample has a variance as large.
        let sum = |pixel: &[f32; 3]| pixel.iter().sum::<f32>();
        let noise = &truth.variance.as_ref().unwrap().pixels;
        let surely = |pixel: usize| sum(&truth.image.pixels[pixel]) - 3.0 * sum(&noise[pixel]).sqrt();
        let glint = (0..noise.len()).max_by(|a, b| surely(*a).total_cmp(&surely(*b))).unwrap();
        let value = truth.image.pixels[glint];
        let (x, y) = (glint as u32 % 64, glint as u32 / 64);
        let neighbour = truth.image.pixels[glint - 3];
        println!("glint at ({x}, {y}): {value:?}, beside it {neighbour:?}");
        let faulty = changed(&truth, |i, j, pixel| {
            if (i, j) == (x, y) {
                *pixel = neighbour;
            }
        });
        let found = looked_at(&faulty, &witness, Kinds::default());
        let first = found.differences.first().expect("the glint");
        println!("{}", first.describe());
        assert!(first.x <= x && x < first.x + first.width && first.y <= y && y < first.y + first.height);
    });
}

/// Techniques that lack light of a scene make no reference of it, and those that find some only by chance are known.
#[test]
fn the_table_says_who_may() {
    let names = |scene: &str, solves: Solves| -> Vec<(String, bool)> {
        let scene = canon(scene, &[]);
        let settings = settings(&scene, "path", Backend::Bvh);
        let all = candidates(&scene, solves, &settings);
        all.iter().map(|candidate| (candidate.technique.describe(), candidate.by_chance.is_some())).collect()
    };
    let of =
        |list: &[(&str, bool)]| list.iter().map(|(name, chance)| ((*name).to_owned(), *chance)).collect::<Vec<_>>();
    // Nothing smooth: whatever is unbiased will do.
    let all = of(&[("path", false), ("light", false), ("bdpt", false), ("vcm", false), ("photon", false)]);
    assert_eq!(names("cornell.xml", Solves::Everything), all);
    assert_eq!(names("cornell.xml", Solves::Diffuse), all, "all is diffuse there");
    let hard = of(&[("path", true), ("bdpt", true), ("vcm", false), ("photon", false)]);
    assert_eq!(names("caustic_small_light.xml", Solves::Everything), hard);
    // Glass that is not quite smooth, and a sky with a sun.
    let harder = of(&[("path", true), ("bdpt", true), ("vcm", false), ("photon", true)]);
    assert_eq!(names("gltf_room/room.gltf", Solves::Everything), harder);
    // Points of light behind smooth glass: next-event estimation cannot find these at all.
    assert_eq!(names("small_vcm.xml", Solves::Mirrored), of(&[("whitted", false), ("whitted:branches=one", false)]));
    let direct = names("cornell.xml", Solves::Direct);
    assert!(direct.contains(&("direct".into(), false)) && direct.contains(&("bdpt".into(), false)), "{direct:?}");
}

/// A reference of a second has all of its certificate, which comes back from the file.
#[test]
fn a_reference_knows_what_it_is() {
    let scene = canon("cornell.xml", &[("size", "24")]);
    let folder = tempfile::tempdir().unwrap();
    with_gpu(|gpu| {
        let settings = settings(&scene, "path", Backend::Bvh);
        let mut shares = Vec::new();
        let request = Request {
            gpu,
            scene: &scene,
            settings: &settings,
            solves: Solves::Everything,
            budget: Budget::Seconds(1.5),
            seed: 0,
            parts: None,
        };
        let truth = make(&request, &mut |step| {
            if let lumbre::reference::Step::Share(share) = step {
                shares.push(share);
            }
            Ok(())
        })
        .unwrap();
        let certificate: &Certificate = truth.certificate.as_ref().unwrap();
        assert!(certificate.doubt().is_none(), "{:?}", certificate.doubt());
        assert_eq!(certificate.pilots.len(), 3);
        assert!(certificate.makers.iter().map(|maker| maker.share).sum::<f64>() - 1.0 < 1e-6);
        let own = truth.relmse().unwrap();
        assert!(certificate.error.relmse.contains(own) && own > 0.0, "{own} in {:?}", certificate.error.relmse);
        assert!(shares.windows(2).all(|pair| pair[0] <= pair[1]) && !shares.is_empty());
        let path = folder.path().join("reference.exr");
        write(&path, &truth).unwrap();
        let back = read(&path, 24, 24).unwrap();
        assert_eq!(back.certificate, truth.certificate);
        assert_eq!(back.image, truth.image);
        assert!(back.difference_map.is_some());
        // Two of other seeds are as far apart as they say.
        let other = make(&Request { seed: 1, ..request }, &mut |_| Ok(())).unwrap();
        let apart = lumbre::image::metrics::compare(&other.image, &truth.image).unwrap().relmse;
        let expected = own + other.relmse().unwrap();
        assert!((0.6..1.6).contains(&(apart / expected)), "{apart} against {expected}");
    });
}

/// The command makes one, checks one, goes on with an interrupted one, and `compare` and `bench` read it.
#[test]
fn references_on_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let cornell = scene_path("cornell.xml").display().to_string();
    let command = |args: &[&str]| {
        let mut command = lumbre();
        command.current_dir(here).args(["reference", &cornell, "--size", "24x24"]).args(args);
        command
    };
    let json =
        |name: &str| -> serde_json::Value { serde_json::from_slice(&std::fs::read(here.join(name)).unwrap()).unwrap() };
    let shown = |mut command: std::process::Command| {
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", errors(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    let said = shown(command(&["-o", "a.exr", "-t", "1", "--json", "a.json"]));
    assert!(said.contains("made by    ") && said.contains("verdict    confirmed"), "{said}");
    let known = json("a.json");
    assert_eq!(known["schema"], "lumbre-reference-1");
    assert!(!here.join("a.exr.parts").exists());

    let mut compared = lumbre();
    compared.current_dir(here).args(["compare", "a.exr", "a.exr"]);
    let said = shown(compared);
    assert!(said.contains("without the reference's own noise") && said.contains("reference     by "), "{said}");
    let mut bench = lumbre();
    bench.current_dir(here).args(["bench", &cornell, "--size", "24x24", "-n", "2", "--seeds", "2", "-o", "out"]);
    bench.args(["--reference", "a.exr"]);
    works(bench);
    let results = lumbre::bench::results::Results::read(&here.join("out/results.json")).unwrap();
    let reference = &results.scenes[0].reference;
    assert!(reference.doubt.is_none() && reference.certificate.is_some() && reference.difference_map.is_some());
    assert!(reference.seconds < 0.5, "it was checked already: {} s", reference.seconds);

    // What somebody darkened is found, and says where.
    let mut image: Image = lumbre::image::read_image(&here.join("a.exr")).unwrap();
    image.pixels[..24 * 12].iter_mut().flatten().for_each(|value| *value *= 0.5);
    let picture = lumbre::image::Picture { image, layers: Vec::new(), header: Vec::new() };
    lumbre::image::write_picture(&here.join("dark.exr"), &picture).unwrap();
    let said = fails(command(&["--check", "dark.exr", "-t", "1"]), 1);
    assert!(said.contains("dark.exr and ") && said.contains("tile ("), "{said}");

    let said = fails(command(&["-o", "a.png"]), 2);
    assert!(said.contains("a.png: a reference is an .exr"), "{said}");
    let said = fails(command(&["-t", "1"]), 2);
    assert!(said.contains("--output"), "{said}");
    let said = fails(command(&["-o", "a.exr", "-t", "0"]), 2);
    assert!(said.contains("above 0"), "{said}");
    let said = fails(command(&["-o", "a.exr", "--seed", "64"]), 2);
    assert!(said.contains("0..=63"), "{said}");

    let sensor = "<film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='8'/></film>";
    let dark = "<emitter type='point'><rgb name='intensity' value='0'/></emitter><shape type='sphere'/>";
    let text = format!("<scene version='3.0.0'><sensor type='perspective'>{sensor}</sensor>{dark}</scene>");
    std::fs::write(here.join("dark.xml"), text).unwrap();
    let mut of_nothing = lumbre();
    of_nothing.current_dir(here).args(["reference", "dark.xml", "-o", "c.exr", "-t", "1"]);
    let said = fails(of_nothing, 2);
    assert!(said.contains("dark.xml is black") && !here.join("c.exr").exists(), "{said}");

    // The pilot takes a share of the time, so an interrupt during it finds nothing to keep; once the making has begun, it does.
    let mut child = start(command(&["-o", "b.exr", "-t", "40"]));
    let mut told = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(told.any(|line| line.starts_with("reference by ")));
    std::thread::sleep(std::time::Duration::from_secs(3));
    signal(&child, "INT");
    let last = told.last().unwrap();
    assert!(last.contains("b.exr.parts; the same command goes on"), "{last}");
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert!(here.join("b.exr.parts").exists() && !here.join("b.exr").exists());
    // What was spent counts, so that a shorter time is nearly over; how long that is depends on the machine.
    let output = command(&["-o", "b.exr", "-t", "8", "--json", "b.json"]).output().unwrap();
    assert!(output.status.success() && !errors(&output).contains("trying"), "{}", errors(&output));
    let [seconds, pilots] = ["seconds", "pilot_seconds"].map(|name| json("b.json")[name].as_f64().unwrap());
    assert!(seconds > pilots + 3.0, "{seconds} of which {pilots}");
    assert!(here.join("b.exr").exists() && !here.join("b.exr.parts").exists());
}
