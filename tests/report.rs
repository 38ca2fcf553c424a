//! The report of a bench: a page that parses, that says what the results say, and that works in a browser.

use std::collections::HashSet;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use lumbre::bench::results::{
    Cell, CurvePoint, Device, Figure, Floor, Pair, Point, Ratio, Reference, Results, Row, Run, SCHEMA, SceneResults,
    Setup, VariantResults,
};
use lumbre::reference::{self, Certificate, Difference, Maker, OwnError, Pilot, Witness};
use lumbre::report::{CSV_COLUMNS, write};
use lumbre::statistics::Interval;

/// Names that break a page or a table which does not escape them.
const VARIANTS: [&str; 3] = [
    "path <on> \"bvh\" & co",
    "</script><!-- it's, \n<b>two lines</b>",
    "a_name_without_any_place_to_break_it_that_is_longer_than_a_phone_is_wide",
];

trait Scaled {
    fn scaled(self, factor: f64) -> Self;
}

impl Scaled for Interval {
    fn scaled(self, factor: f64) -> Self {
        Self { mean: factor * self.mean, low: factor * self.low, high: factor * self.high }
    }
}

fn exact(mean: f64) -> Interval {
    Interval { mean, low: mean, high: mean }
}

fn around(mean: f64) -> Interval {
    Interval { mean, low: mean * 0.9, high: mean * 1.1 }
}

fn point(spp: f64, seconds: f64, relmse: Interval, has_clock: bool) -> CurvePoint {
    CurvePoint {
        spp,
        seconds: around(seconds),
        device_seconds: has_clock.then(|| around(0.9 * seconds)),
        relmse,
        parts_relmse: relmse.scaled(0.9),
        trimmed_relmse: relmse.scaled(0.8),
        median_relmse: relmse.scaled(0.3),
        mse: Interval { mean: 0.5 * relmse.mean, low: -1e-3, high: relmse.high },
        mape: exact(relmse.mean.abs().sqrt()),
        flip: exact(0.0),
    }
}

fn variant(scene: usize, index: usize) -> VariantResults {
    // The first has a plain curve; the second is a single point without an interval or a clock; the third has all that
    // has no place on a logarithmic axis.
    let curve = match index {
        0 => (0..6)
            .map(|k| point(f64::from(1 << k), 0.01 * f64::from(1 << k), around(0.3 / f64::from(1 << k)), true))
            .collect(),
        1 => vec![point(16.5, 0.25, exact(0.02), false)],
        _ => [0.4, 0.0, -0.01, f64::NAN, f64::INFINITY, 0.1]
            .iter()
            .enumerate()
            .map(|(k, relmse)| {
                let (low, high) = if k == 0 { (1e-12, 1e9) } else { (f64::NEG_INFINITY, f64::NAN) };
                let ends = Interval { mean: *relmse, low, high };
                point(4.0 * (k + 1) as f64, 0.1 * (k + 1) as f64, ends, true)
            })
            .collect(),
    };
    VariantResults {
        name: VARIANTS[index].into(),
        renderer: "lumbre <0.1.0>".into(),
        technique: "path".into(),
        backend: "bvh".into(),
        options: if index == 0 { vec![] } else { vec!["lights=power".into(), "no-specialise".into()] },
        bias: if index == 2 { "clamps <everything> & more".into() } else { String::new() },
        notes: if index == 1 { vec!["its clock <differs> & so on".into()] } else { vec![] },
        setup: Setup { load: 0.0, build: 0.25, compile: f64::NAN },
        device_bytes: (index != 1).then_some(3 << 20),
        curve,
        efficiency: [around(1234.5), exact(f64::INFINITY), exact(f64::NAN)][index],
        parts_efficiency: [around(2345.6), exact(f64::INFINITY), exact(f64::NAN)][index],
        trimmed_efficiency: [around(2345.6), exact(f64::INFINITY), exact(f64::NAN)][index],
        median_efficiency: [around(3456.7), exact(f64::INFINITY), exact(f64::NAN)][index],
        worst_share: [0.01, 0.02, 0.875][index],
        slope: [around(-1.0), exact(f64::NAN), around(-0.4)][index],
        slope_of: if index == 2 { Figure::Median } else { Figure::Relmse },
        floor: Floor {
            relmse: [-1e-5, 0.0, 0.09][index],
            deviation: 1e-4,
            flagged: index == 2 || (index == 0 && scene == 1),
        },
        energy_ratio: exact(1.0),
        estimate_ratio: (index == 0).then(|| around(0.97)),
        samples_per_s: around(1.5e6),
        rays_per_s: (index != 1).then(|| around(7.5e6)),
        runs: [1.1, 0.8]
            .map(|estimate| Run {
                seed: 0,
                points: vec![end_of_run(0.01, (index == 0).then_some(0.01 * estimate))],
                rays: None,
                nonfinite: index as u64,
                image: "a.exr".into(),
            })
            .to_vec(),
    }
}

fn end_of_run(relmse: f64, estimated_relmse: Option<f64>) -> Point {
    Point {
        spp: 32,
        seconds: 0.25,
        device_seconds: None,
        mse: relmse,
        relmse,
        parts_relmse: relmse,
        trimmed_relmse: relmse,
        median_relmse: relmse,
        worst_share: 0.02,
        mape: 0.1,
        flip: 0.1,
        energy_ratio: 1.0,
        estimated_relmse,
    }
}

fn pair(index: usize, significant: bool) -> Pair {
    // The third variant's relMSE is decided by few pixels, so that of parts decides, and says otherwise.
    let (decided_by, ratio) =
        if index == 1 { (Figure::Relmse, exact(f64::INFINITY)) } else { (Figure::Parts, around(0.5)) };
    Pair {
        variant: VARIANTS[index].into(),
        against: VARIANTS[0].into(),
        efficiency: Ratio { ratio, significant: index == 1 && significant },
        parts: Ratio { ratio: around(35.5), significant },
        trimmed: Ratio { ratio: around(34.5), significant },
        median: Ratio { ratio: around(44.4), significant: false },
        speed_ratio: exact(0.0),
        decided_by,
        tested_by: if index == 1 { Figure::Relmse } else { Figure::Trimmed },
        significant,
    }
}

/// A reference that another technique confirmed.
fn certificate() -> Certificate {
    Certificate {
        schema: reference::SCHEMA.into(),
        scene: "scenes/a \"b\".xml".into(),
        budget: 5.0,
        seconds: 4.5,
        pilot_seconds: 0.75,
        pilots: [("bdpt <1>", 1e-4, 0.0, None), ("path", 2e-4, 3e-5, Some("caustics & <co>"))]
            .map(|(technique, noise, lacking, by_chance)| Pilot {
                technique: technique.into(),
                seconds: 0.25,
                noise,
                lacking,
                by_chance: by_chance.map(String::from),
            })
            .to_vec(),
        makers: [("bdpt <1>", 0.75, None), ("path", 0.25, Some("caustics & <co>"))]
            .map(|(technique, share, by_chance)| Maker {
                technique: technique.into(),
                spp: 65_536.0 * share,
                seconds: 3.5 * share,
                share,
                by_chance: by_chance.map(String::from),
            })
            .to_vec(),
        error: OwnError {
            relmse: Interval { mean: 1.25e-3, low: 1.0e-3, high: 1.5e-3 },
            bias: 2.5e-4,
            largest_share: 0.02,
            tail_index: Some(4.5),
            at_least: false,
        },
        witness: Some(witness()),
        others: vec![],
    }
}

fn witness() -> Witness {
    Witness {
        technique: "vcm <2>".into(),
        spp: 1234.0,
        seconds: 1.25,
        by_chance: None,
        unseen: 0,
        tests: 9876,
        detectable: 0.0123,
        differences: vec![],
    }
}

/// One that is doubted: its witness differs, others differ too, and few bright samples decide its own error.
fn doubted() -> Certificate {
    let difference = |x: u32, likely: &str| Difference {
        x,
        y: 32,
        width: 16,
        height: 4,
        reference: 0.5234,
        witness: 0.6145,
        deviations: 7.25,
        likely: likely.into(),
    };
    let confirmed = certificate();
    Certificate {
        error: OwnError { bias: 0.0, at_least: true, largest_share: 0.75, tail_index: Some(1.4), ..confirmed.error },
        witness: Some(Witness {
            by_chance: Some("hidden <caustics>".into()),
            unseen: 17,
            differences: vec![difference(16, "glints & <co>"), difference(64, "caustics of small lights")],
            ..witness()
        }),
        others: vec![Witness {
            technique: "photon <3>".into(),
            differences: vec![difference(48, "an edge")],
            ..witness()
        }],
        ..confirmed
    }
}

/// A row whose cells share one heat map: it must be in the page once.
fn row(at: f64, picture: &str) -> Row {
    let cell = |name: &&str| Cell {
        variant: (*name).into(),
        spp: 16.0,
        seconds: 0.5,
        relmse: 0.01,
        picture: picture.into(),
        crop: "pictures/crop & part.png".into(),
        heat_map: "heat.png".into(),
        heat_scale: 0.5,
    };
    Row { at, cells: VARIANTS.iter().map(cell).collect() }
}

const PICTURES: [&str; 6] =
    ["reference.png", "time.png", "spp.png", "pictures/crop & part.png", "heat.png", "difference.png"];

/// The first scene's is confirmed and was made; the second one's was given, and is doubted.
fn reference(index: usize) -> Reference {
    let certificate = [certificate(), doubted()][index].clone();
    Reference {
        image: "reference.exr".into(),
        picture: "reference.png".into(),
        origin: ["made", "given: a <file>.exr"][index].into(),
        technique: Some(certificate.makers()),
        spp: Some(65_536),
        relmse: (index == 0).then_some(1e-6),
        seconds: 4.5,
        doubt: certificate.doubt(),
        certificate: Some(certificate),
        difference_map: (index == 1).then(|| "difference.png".into()),
    }
}

fn scene(index: usize) -> SceneResults {
    SceneResults {
        name: ["box <1> & 'co'", "b"][index].into(),
        file: "scenes/a \"b\".xml".into(),
        width: 3,
        height: 2,
        max_depth: -1,
        triangles: 1_234_567,
        lights: 1,
        reference: reference(index),
        variants: (0..3).map(|number| variant(index, number)).collect(),
        pairs: vec![pair(1, true), pair(2, false)],
        equal_time: Some(row(0.5, "time.png")),
        equal_spp: (index == 0).then(|| row(16.0, "spp.png")),
    }
}

fn results() -> Results {
    Results {
        schema: SCHEMA.into(),
        version: "0.1.0".into(),
        command: "lumbre bench 'a <b>.xml' && true".into(),
        started: "2026-01-02T03:04:05Z".into(),
        device: Device {
            name: "Some <GPU>".into(),
            driver: "driver & 1".into(),
            processors: 2,
            host: "linux x86_64".into(),
        },
        seeds: 5,
        seconds: Some(0.5),
        spp: None,
        confidence: 0.95,
        scenes: (0..2).map(scene).collect(),
    }
}

/// Names and figures as they are in earnest: five variants with options, figures of all sizes.
fn in_earnest() -> Results {
    const NAMES: [&str; 5] = [
        "path on bvh",
        "path on bvh, lights=tree",
        "path on ray-query, sampler=independent",
        "bdpt on bvh, no-specialise",
        "photon radius=0.0125 on ray-query, lights=power",
    ];
    let of = |mean: f64| Interval { mean, low: 0.0763 * mean, high: 12.9 * mean };
    let variants = NAMES.iter().zip(0..).map(|(name, index)| {
        let scale = 10f64.powi(index - 3) * 1.2345;
        let error = Interval { mean: -1.25e-5 * scale, low: -3.5e-3 * scale, high: 2.75e-3 * scale };
        let mut found = variant(0, 0);
        let mut last = point(123_456.0, 12.345, error, true);
        last.parts_relmse = of(2.34e-4 * scale);
        (last.trimmed_relmse, last.median_relmse) = (of(1.23e-4 * scale), of(4.56e-5 * scale));
        found.curve.push(last);
        VariantResults {
            name: (*name).into(),
            renderer: "lumbre 0.1.0".into(),
            technique: name.split(" on ").next().unwrap().into(),
            backend: "ray-query".into(),
            options: vec!["lights=power".into(), "no-specialise".into()],
            bias: "blurs within a radius that becomes smaller as there are more samples".into(),
            setup: Setup { load: 0.0123, build: 12.34, compile: 123.4 },
            efficiency: of(12_345.0 / scale),
            parts_efficiency: of(23_456.0 / scale),
            trimmed_efficiency: of(23_456.0 / scale),
            median_efficiency: of(34_567.0 / scale),
            worst_share: [0.0123, 0.456, 0.9876][index as usize % 3],
            slope_of: [Figure::Relmse, Figure::Median, Figure::Median][index as usize % 3],
            slope: Interval { mean: -0.98, low: -1.23, high: -0.71 },
            floor: Floor { relmse: -1.23e-5, deviation: 4.56e-6, flagged: index % 2 == 1 },
            energy_ratio: Interval { mean: 1.0123, low: 0.9876, high: 1.0345 },
            samples_per_s: of(1.234e7),
            rays_per_s: Some(of(1.234e8)),
            device_bytes: Some(1_234_567_890),
            ..found
        }
    });
    let pair = |(index, name): (usize, &&str)| {
        let ratio = |mean: f64| Ratio { ratio: of(mean), significant: index % 2 == 0 };
        let scale = 10f64.powi(index as i32 - 3);
        Pair {
            variant: (*name).into(),
            against: NAMES[0].into(),
            efficiency: ratio(1.234 * scale),
            parts: ratio(2.345 * scale),
            trimmed: ratio(2.345 * scale),
            median: ratio(3.456 * scale),
            speed_ratio: of(1.234),
            decided_by: [Figure::Relmse, Figure::Parts][index % 2],
            tested_by: [Figure::Relmse, Figure::Trimmed][index % 2],
            significant: index % 2 == 0,
        }
    };
    let pairs: Vec<Pair> = NAMES.iter().enumerate().skip(1).map(pair).collect();
    let scenes = [0, 1].map(|index| SceneResults {
        name: ["cornell", "caustic_small_light"][index].into(),
        variants: variants.clone().collect(),
        pairs: pairs.clone(),
        equal_time: None,
        equal_spp: None,
        ..scene(index)
    });
    Results { scenes: scenes.into(), ..results() }
}

/// A folder with the pictures, each of its own colour.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("pictures")).unwrap();
    for (index, name) in PICTURES.iter().enumerate() {
        let picture = image::RgbImage::from_pixel(3, 2, image::Rgb([50 * index as u8, 100, 0]));
        picture.save(folder.path().join(name)).unwrap();
    }
    folder
}

fn page(folder: &Path) -> String {
    page_of(folder, &results())
}

fn page_of(folder: &Path, results: &Results) -> String {
    write(folder, results).unwrap();
    std::fs::read_to_string(folder.join("index.html")).unwrap()
}

/// The bodies of the scripts in a page, and the page without them.
fn scripts(page: &str) -> (Vec<&str>, String) {
    let (mut bodies, mut rest, mut without) = (Vec::new(), page, String::new());
    while let Some(at) = rest.find("<script") {
        let begin = at + rest[at..].find('>').unwrap() + 1;
        let end = begin + rest[begin..].find("</script>").expect("an end of every script");
        bodies.push(&rest[begin..end]);
        without += &rest[..begin];
        rest = &rest[end..];
    }
    (bodies, without + rest)
}

#[test]
fn the_page_is_well_formed_and_needs_nothing_else() {
    let folder = folder();
    let page = page(folder.path());
    let (bodies, markup) = scripts(&page);
    assert_eq!(bodies.len(), 3, "no name may open or close a script");
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&markup, options).unwrap();

    let mut ids = HashSet::new();
    for id in document.descendants().filter_map(|node| node.attribute("id")) {
        assert!(ids.insert(id), "the id {id} occurs twice");
    }
    for node in document.descendants().filter(|node| node.is_element()) {
        for name in ["aria-labelledby", "href", "value"] {
            let Some(target) = node.attribute(name) else { continue };
            match (name, target.strip_prefix('#'), target.strip_prefix("data:image/png;base64,")) {
                ("aria-labelledby", ..) => assert!(ids.contains(target), "no element {target}"),
                ("href", Some(id), _) => assert!(ids.contains(id), "no element {id}"),
                ("href", None, data) => assert!(data.is_some(), "the page refers to {target}"),
                _ if node.tag_name().name() == "option" => assert!(ids.contains(target), "no picture {target}"),
                _ => {}
            }
        }
        assert!(node.attribute("src").is_none(), "everything is in the page");
        if node.attribute("role") == Some("img") {
            assert!(!node.attribute("aria-label").unwrap().is_empty());
        }
    }
    assert!(!page.contains("http://") && !page.contains("https://") && !page.contains("url("));

    // Each picture once, though the reference, the crop and the heat map are shown several times.
    assert_eq!(page.matches("data:image/png;base64,").count(), PICTURES.len());
    let uses = document.descendants().filter(|node| node.tag_name().name() == "use").count();
    // Two references, a difference map, three rows of three variants with three views each.
    assert_eq!(uses, 2 + 1 + 3 * 3 * 3);

    // What the results say is there as text, not as markup.
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    let says = |text: &str| texts.iter().any(|found| found.contains(text));
    for text in VARIANTS {
        assert!(says(text), "{text} is not in the page");
    }
    for text in [
        "its clock <differs> & so on",
        "Biased: clamps <everything> & more",
        "unexpected bias",
        "of the true one; within 15 % in 1 of 2 runs",
        "A thousandth of the pixels makes 88 % of the relMSE",
        "bdpt <1>, 49\u{202f}152 spp, 2.62 s, 75 % of the image",
        "relMSE 1.3e-3 (1.0e-3 to 1.5e-3), and blur of at most 2.5e-4",
        "relMSE at least 1.0e-3",
        "so its variance may be infinite",
        "no difference beyond noise in 9\u{202f}876 tests",
        "differs beyond noise in 2 places",
        "In 17 of them it lacks light",
        "finds hidden <caustics> only with rare, bright samples",
        "photon <3>, ",
        "(48, 32) of 16 × 4",
        "glints & <co>",
        "Where the witness differs",
        "Techniques that were tried for it",
        "lumbre bench 'a <b>.xml' && true",
    ] {
        assert!(says(text), "{text} is not in the page");
    }
    assert!(
        says("Some <GPU>")
            && says("2026-01-02 03:04:05 UTC")
            && says("95 % confidence")
            && says("1\u{202f}234\u{202f}567")
    );
    assert!(says("4 samples were not finite"));
}

#[test]
fn the_most_efficient_variant_comes_first() {
    let folder = folder();
    let page = page(folder.path());
    let table = &page[page.find("<table class=\"summary\"").unwrap()..];
    let table = &table[..table.find("</table>").unwrap()];
    // Infinite, finite, not a number.
    let places = ["&lt;b&gt;two lines&lt;/b&gt;</div></th>", "&amp; co</div></th>", "is_wide</div></th>"]
        .map(|name| table.find(name).unwrap());
    assert!(places.is_sorted(), "{places:?}");
}

/// What is not to be believed says so beside the figures: in the table, not only at the reference.
#[test]
fn the_summary_says_what_to_doubt() {
    let folder = folder();
    let page = page(folder.path());
    let table = &page[page.find("<table class=\"summary\"").unwrap()..];
    let table = &table[..table.find("</table>").unwrap()];
    let (first, second) = table.split_at(table.find("href=\"#scene-1\"").unwrap());
    for (scene, is_doubted) in [(first, false), (second, true)] {
        assert_eq!(scene.contains("Reference not confirmed: vcm &lt;2&gt; differs: tile (16, 32)"), is_doubted);
        // In the cell of each ratio.
        assert_eq!(scene.matches(" reference</small>").count(), if is_doubted { 2 } else { 0 });
        // Few pixels decide the third variant: its efficiency and all that it is compared with go by the other figure.
        assert_eq!(scene.matches("few pixels decide").count(), 1);
        assert_eq!(scene.matches("by relMSE of parts").count(), 3 + 1, "{scene}");
        assert_eq!(scene.matches("of the median").count(), 1);
    }
    let by_figure = &page[page.find("Error that few pixels do not decide").unwrap()..];
    let by_figure = &by_figure[..by_figure.find("</table>").unwrap()];
    assert_eq!(by_figure.matches(">decides</small>").count(), 2 * 2);
    let heading = &page[page.find("<h2 id=\"scene-1\"").unwrap()..];
    assert!(heading[..heading.find("<dl").unwrap()].contains("Reference not confirmed"));
}

/// The reference's own error is a line in the charts of relMSE and, where few samples do not decide it, of its sisters; where it has
/// no place there, the caption says so.
#[test]
fn charts_show_the_own_error_of_the_reference() {
    let folder = folder();
    let page = page(folder.path());
    let lines = |page: &str| page.matches("<g class=\"level\">").count();
    assert_eq!((lines(&page), page.matches("own error, at least").count()), (3 * 2 * 2 + 2 * 2, 2 * 2));
    let mut results = results();
    for scene in &mut results.scenes {
        let error = &mut scene.reference.certificate.as_mut().unwrap().error;
        (error.relmse, error.bias, error.at_least) = (exact(1e-9), 0.0, false);
    }
    let page = page_of(folder.path(), &results);
    assert_eq!((lines(&page), page.matches("own error, 1.00·10⁻⁹, is far below this axis.").count()), (0, 2 * 3 * 2));
}

#[test]
fn charts_hold_only_numbers_within_their_frame() {
    let folder = folder();
    let page = page(folder.path());
    let markup = scripts(&page).1;
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&markup, options).unwrap();
    let charts: Vec<_> = document
        .descendants()
        .filter(|node| node.attribute("class").is_some_and(|class| class.starts_with("chart ")))
        .collect();
    // Two scenes, two widths: six errors over two axes (FLIP is 0 throughout), and the kernels.
    assert_eq!(charts.len(), 2 * 2 * (6 * 2 + 1));
    let mut markers = 0;
    for chart in charts {
        let view: Vec<f64> = chart.attribute("viewBox").unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
        for node in chart.descendants().filter(|node| node.is_element()) {
            for attribute in node.attributes().filter(|attribute| !attribute.name().starts_with("aria-")) {
                let value = attribute.value();
                assert!(!value.contains("NaN") && !value.contains("inf"), "{}=\"{value}\"", attribute.name());
            }
            if let Some(path) = node.attribute("d") {
                let numbers = path.split(|c: char| c.is_alphabetic() || c == ' ').filter(|text| !text.is_empty());
                for number in numbers.map(|text| text.parse::<f64>().unwrap()) {
                    assert!((-9.0..=view[2].max(view[3])).contains(&number), "{number} in {path}");
                }
            }
            markers += usize::from(node.attribute("class") == Some("marker"));
        }
    }
    // 6 points of the first variant, 1 of the second, of the third those that are positive and finite: 2 of 6 as relMSE,
    // of parts, trimmed, median and RMSE, 3 as MAPE, whose mean is here the root of a magnitude; over time in kernels 6 and 6.
    assert_eq!(markers, 2 * 2 * (2 * (5 * 9 + 10) + 12));
    assert_eq!(page.matches("there is no positive figure to draw").count(), 4);
}

/// The records of a table after RFC 4180.
fn records(text: &str) -> Vec<Vec<String>> {
    let (mut records, mut record, mut field) = (Vec::new(), Vec::new(), String::new());
    let mut quoted = false;
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match (character, quoted) {
            ('"', true) if characters.peek() == Some(&'"') => field.push(characters.next().unwrap()),
            ('"', _) => quoted = !quoted,
            (',', false) => record.push(std::mem::take(&mut field)),
            ('\n', false) => {
                record.push(std::mem::take(&mut field));
                records.push(std::mem::take(&mut record));
            }
            (other, _) => field.push(other),
        }
    }
    assert!(!quoted && field.is_empty() && record.is_empty(), "the table ends with a line feed");
    records
}

#[test]
fn the_table_reads_back() {
    let folder = folder();
    let page = page(folder.path());
    let table = std::fs::read_to_string(folder.path().join("results.csv")).unwrap();
    let records = records(&table);
    assert_eq!(records[0], CSV_COLUMNS);
    let column = |name: &str| CSV_COLUMNS.iter().position(|column| *column == name).unwrap();
    let results = results();
    let mut lines = records[1..].iter();
    for scene in &results.scenes {
        for variant in &scene.variants {
            for (index, point) in variant.curve.iter().enumerate() {
                let line = lines.next().unwrap();
                assert_eq!(line.len(), CSV_COLUMNS.len());
                let text = |name: &str| line[column(name)].as_str();
                assert_eq!(
                    (text("scene"), text("variant"), text("file")),
                    (&*scene.name, &*variant.name, &*scene.file)
                );
                assert_eq!((text("options"), text("point")), (&*variant.options.join(" "), &*index.to_string()));
                for (name, interval) in [
                    ("seconds", Some(point.seconds)),
                    ("device_seconds", point.device_seconds),
                    ("relmse", Some(point.relmse)),
                    ("parts_relmse", Some(point.parts_relmse)),
                    ("trimmed_relmse", Some(point.trimmed_relmse)),
                    ("median_relmse", Some(point.median_relmse)),
                    ("mse", Some(point.mse)),
                    ("mape", Some(point.mape)),
                    ("flip", Some(point.flip)),
                ] {
                    for (end, value) in [("", 0), ("_low", 1), ("_high", 2)] {
                        let text = text(&format!("{name}{end}"));
                        let value = interval.map(|interval| [interval.mean, interval.low, interval.high][value]);
                        match value {
                            None => assert_eq!(text, ""),
                            Some(value) if value.is_nan() => assert!(text.parse::<f64>().unwrap().is_nan()),
                            Some(value) => assert_eq!(text.parse::<f64>().unwrap(), value),
                        }
                    }
                }
            }
        }
    }
    assert!(lines.next().is_none());

    // The page holds the same table, and all of the results.
    let bodies = scripts(&page).0;
    let value = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    assert!(value(bodies[0]) == value(&serde_json::to_string(&results).unwrap()), "the page holds other results");
    assert_eq!(serde_json::from_str::<String>(bodies[1]).unwrap(), table);
}

#[test]
fn a_picture_that_is_missing_or_none_is_named() {
    for name in PICTURES {
        let folder = folder();
        std::fs::remove_file(folder.path().join(name)).unwrap();
        let error = write(folder.path(), &results()).unwrap_err().to_string();
        assert!(error.contains(name) && error.lines().count() == 1, "{error}");
        std::fs::write(folder.path().join(name), "P6 no PNG").unwrap();
        let error = write(folder.path(), &results()).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("PNG") && error.lines().count() == 1, "{error}");
        assert!(!folder.path().join("index.html").exists());
    }
}

#[test]
fn a_bench_without_anything_has_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let results = Results { scenes: vec![], seeds: 1, seconds: None, spp: Some(4), ..results() };
    write(folder.path(), &results).unwrap();
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    roxmltree::Document::parse_with_options(&scripts(&page).1, options).unwrap();
    assert!(page.contains("Every variant ran once"));
}

/// Uses what there is to use in the page, and posts what it found to `/found`.
const PROBE: &str = include_str!("report/probe.js");

/// How long Chromium may take to start and to use the page, on a machine that does something else as well.
const PATIENCE: Duration = Duration::from_secs(120);

/// Chromium, ended with the test whatever its outcome.
struct Browser(Child);

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Answers one request: `page` to whoever asks for `/`, and what was posted to `/found`, which it returns.
fn answer(mut stream: TcpStream, page: &str) -> Option<String> {
    let mut lines = BufReader::new(stream.try_clone().unwrap());
    let (mut request, mut length) = (String::new(), 0);
    lines.read_line(&mut request).ok()?;
    loop {
        let mut header = String::new();
        lines.read_line(&mut header).ok()?;
        match header.trim().split_once(':') {
            None => break,
            Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                length = value.trim().parse().unwrap()
            }
            Some(_) => {}
        }
    }
    let mut posted = vec![0; length];
    lines.read_exact(&mut posted).ok()?;
    let (status, body) = if request.starts_with("GET / ") { ("200 OK", page) } else { ("404 Not Found", "") };
    let kind = "text/html; charset=utf-8";
    let head = format!("HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
    // A browser that hangs up asks again.
    let _ = stream.write_all(format!("{head}Connection: close\r\n\r\n{body}").as_bytes());
    request.starts_with("POST /found ").then(|| String::from_utf8(posted).unwrap())
}

/// What `page` posts to `/found` once it is opened in headless Chromium. The page is served and tells when it is done:
/// Chromium's own ways to wait for a page (a virtual clock, the event `load`) end before a busy machine has run it.
fn found_in_chromium(chromium: &str, page: &str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let (sender, found) = mpsc::channel();
    let page: Arc<str> = page.into();
    // A thread for each connection: browsers open some that they never use. All end with the process.
    std::thread::spawn(move || {
        for stream in listener.incoming().map_while(Result::ok) {
            let (sender, page) = (sender.clone(), page.clone());
            std::thread::spawn(move || answer(stream, &page).map(|found| sender.send(found)));
        }
    });
    let profile = tempfile::tempdir().unwrap();
    let flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                 --disable-component-update --disable-sync --no-proxy-server --remote-debugging-port=0";
    let mut browser = Browser(
        Command::new(chromium)
            .args(flags.split_whitespace())
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("http://{address}/"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap(),
    );
    let began = Instant::now();
    while began.elapsed() < PATIENCE {
        if let Ok(found) = found.recv_timeout(Duration::from_millis(100)) {
            return found;
        }
        if let Some(status) = browser.0.try_wait().unwrap() {
            panic!("Chromium ended before the page was used: {status}");
        }
    }
    panic!("the page was not used within {} s", PATIENCE.as_secs());
}

/// Where Chromium is. Where there is none this says so, unless `LUMBRE_TEST_CHROMIUM=required`: then the test fails.
fn chromium() -> Option<&'static str> {
    const CHROMIUM: &str = "/usr/bin/chromium";
    if Path::new(CHROMIUM).exists() {
        return Some(CHROMIUM);
    }
    let required = std::env::var("LUMBRE_TEST_CHROMIUM").as_deref() == Ok("required");
    assert!(!required, "there is no {CHROMIUM}, and LUMBRE_TEST_CHROMIUM=required asks for it");
    eprintln!("skipped: there is no {CHROMIUM}");
    None
}

/// A page that holds others as the value `name` of a script, which goes on with `script`.
fn holding(name: &str, value: &impl serde::Serialize, script: &str) -> String {
    let value = serde_json::to_string(value).unwrap().replace('<', "\\u003c");
    format!("<!DOCTYPE html><meta charset=\"utf-8\"><body><script>const {name} = {value};{script}</script>")
}

/// Measures the pages of `texts` and posts what does not fit.
const FIT: &str = include_str!("report/fit.js");

/// No table is wider than its page, be it a small window or a phone: nothing is to be scrolled sideways.
#[test]
fn every_table_fits_its_page() {
    let Some(chromium) = chromium() else { return };
    let folder = folder();
    let texts = [results(), in_earnest()].map(|results| page_of(folder.path(), &results));
    let found = found_in_chromium(chromium, &holding("texts", &texts, FIT));
    assert_eq!(found.lines().count(), 4, "{found}");
    for line in found.lines() {
        assert!(line.ends_with(" tables: fits"), "{found}");
    }
}

/// What the page does in headless Chromium.
#[test]
fn the_page_works_in_a_browser() {
    let Some(chromium) = chromium() else { return };
    let folder = folder();
    let used = found_in_chromium(chromium, &holding("text", &page(folder.path()), PROBE));
    let (wide, narrow) = used.split_once('|').unwrap_or_else(|| panic!("the page in a browser: {used}"));
    for (found, width, kind) in [(wide, 1280, "wide"), (narrow, 390, "narrow")] {
        let figure = |name: &str| {
            let pairs = found.split(' ').filter_map(|pair| pair.split_once('='));
            pairs.into_iter().find(|(key, _)| *key == name).unwrap_or_else(|| panic!("no {name}: {found}")).1
        };
        let number = |name: &str| figure(name).parse::<i32>().unwrap();
        assert_eq!((figure("ready"), figure("error")), ("yes", "none"), "{found}");
        assert!((width - 20..=width).contains(&number("window")), "{found}");
        assert!(number("content") <= number("window"), "wider than its window of {width}: {found}");
        let charts = vec![format!("{kind}:parts"); 4].join("+");
        assert_eq!(figure("charts"), charts, "{found}");
        assert!(number("letters") >= 120, "letters of a chart are at least 12 px: {found}");
        assert_eq!((figure("panel"), figure("off")), ("mape", "true"), "{found}");
        assert_eq!(
            (figure("size"), figure("range"), figure("clip")),
            ("3x2", "52", "inset(0px_48%_0px_0px)"),
            "{found}"
        );
        assert_eq!(figure("dragged"), "25+80+100", "{found}");
        assert_eq!((figure("flips"), figure("chosen")), ("left+right+left", "true"), "{found}");
        assert_eq!(
            (figure("json"), figure("csv"), figure("names")),
            (SCHEMA, "scene", "results.jsonresults.csv"),
            "{found}"
        );
    }
}
