//! The bench's statistics against renderers whose noise and bias are known, and its files.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;

use lumbre::bench::results::{Figure, HEAVY_TAIL, Setup, VariantResults};
use lumbre::bench::{Bench, Limits, Snapshot, Stop, Subject, Truth, Variant};
use lumbre::error::{Error, Result};
use lumbre::image::Image;
use lumbre::image::metrics::squared_bias;

const SIDE: u32 = 24;
/// The contribution of a firefly to its pixel.
const FIREFLY: f64 = 3000.0;

/// Uniform numbers (splitmix64: Steele, Lea and Flood 2014) and normal ones (Box and Muller 1958).
struct Stream(u64);

impl Stream {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((mixed ^ mixed >> 31) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The true image: from dark to bright.
fn truth(pixel: usize, channel: usize) -> f64 {
    0.02 + ((pixel * 3 + channel) as f64 * 0.37).sin().powi(2) * 1.5
}

fn image(value: impl Fn(usize, usize) -> f64) -> Image {
    let pixels =
        (0..(SIDE * SIDE) as usize).map(|pixel| [0, 1, 2].map(|channel| value(pixel, channel) as f32)).collect();
    Image { width: SIDE, height: SIDE, pixels }
}

/// A renderer of known noise: each sample of a value t has the standard deviation `noise` sqrt(t), its expectation is
/// t (1 + `bias`); a sample of the image takes `cost` seconds, with some jitter.
struct Synthetic {
    noise: f64,
    bias: f64,
    cost: f64,
    /// Probability that a sample of the image holds a firefly, in its first pixel: a thousandth of so few pixels is one.
    fireflies: f64,
    trial: u64,
    stream: Stream,
    sums: Vec<f64>,
    spp: u32,
    seconds: f64,
    begun: Rc<RefCell<u32>>,
}

impl Synthetic {
    fn new(noise: f64, bias: f64, cost: f64, trial: u64) -> Self {
        let sums = Vec::new();
        Self {
            noise,
            bias,
            cost,
            fireflies: 0.0,
            trial,
            stream: Stream(0),
            sums,
            spp: 0,
            seconds: 0.0,
            begun: Rc::default(),
        }
    }

    /// relMSE of one sample per pixel.
    fn relmse(&self) -> f64 {
        let values = (0..(SIDE * SIDE) as usize).flat_map(|pixel| (0..3).map(move |channel| truth(pixel, channel)));
        values.map(|t| self.noise * self.noise * t / (t * t + 1e-2)).sum::<f64>() / f64::from(3 * SIDE * SIDE)
    }
}

impl Subject for Synthetic {
    fn renderer(&self) -> String {
        String::from("synthetic")
    }
    fn setup(&self) -> Setup {
        Setup::default()
    }
    fn device_bytes(&self) -> Option<u64> {
        None
    }
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
    fn begin(&mut self, seed: u32) -> Result<()> {
        *self.begun.borrow_mut() += 1;
        self.stream = Stream((self.trial << 32 | u64::from(seed)).wrapping_mul(0xd134_2543_de82_ef95));
        self.sums = vec![0.0; (3 * SIDE * SIDE) as usize];
        (self.spp, self.seconds) = (0, 0.0);
        Ok(())
    }
    fn advance(&mut self, stop: Stop) -> Result<Snapshot> {
        let in_time =
            stop.seconds.map_or(u32::MAX, |limit| ((limit - self.seconds) / self.cost).ceil().max(0.0) as u32);
        let more = (stop.spp - self.spp).min(in_time);
        for (index, sum) in self.sums.iter_mut().enumerate() {
            let t = truth(index / 3, index % 3);
            let k = f64::from(more);
            *sum += k * t * (1.0 + self.bias) + (k * t).sqrt() * self.noise * self.stream.normal();
        }
        for _ in 0..more {
            if self.stream.uniform() < self.fireflies {
                self.sums[..3].iter_mut().for_each(|sum| *sum += FIREFLY);
            }
        }
        self.spp += more;
        self.seconds += f64::from(more) * self.cost * (1.0 + 0.05 * self.stream.normal()).max(0.5);
        let spp = f64::from(self.spp);
        Ok(Snapshot {
            image: image(|pixel, channel| self.sums[3 * pixel + channel] / spp),
            spp,
            seconds: self.seconds,
            device_seconds: None,
            rays: None,
            nonfinite: 0,
            estimated_relmse: None,
        })
    }
}

fn variant(name: &str, subject: Synthetic) -> Variant {
    Variant {
        name: name.to_owned(),
        technique: String::from("synthetic"),
        backend: String::from("none"),
        options: Vec::new(),
        bias: String::new(),
        subject: Box::new(subject),
    }
}

fn bench<'a>(folder: &'a Path, truth: &'a Truth, seeds: u32, spp: u32) -> Bench<'a> {
    std::fs::create_dir_all(folder.join("runs")).unwrap();
    std::fs::create_dir_all(folder.join("images")).unwrap();
    Bench {
        folder,
        scene: "s",
        limits: Limits { seeds, seconds: None, spp: Some(spp), first_seed: 0 },
        fingerprint: 1,
        truth,
    }
}

/// One bench of these subjects in a folder of its own.
fn measure(truth: &Truth, seeds: u32, spp: u32, subjects: Vec<Synthetic>) -> lumbre::bench::Summary {
    let folder = tempfile::tempdir().unwrap();
    let mut variants: Vec<Variant> =
        subjects.into_iter().enumerate().map(|(index, subject)| variant(&format!("v{index}"), subject)).collect();
    bench(folder.path(), truth, seeds, spp).results(&mut variants, |_| Ok(())).unwrap()
}

fn exact() -> Truth {
    Truth::new(image(truth), Some(image(|_, _| 0.0)))
}

/// A reference of known variance per value, `noise`^2 t / `spp`.
fn noisy(noise: f64, spp: f64, seed: u64) -> Truth {
    let stream = RefCell::new(Stream(seed));
    let values = image(|pixel, channel| {
        let t = truth(pixel, channel);
        t + (t / spp).sqrt() * noise * stream.borrow_mut().normal()
    });
    Truth::new(values, Some(image(|pixel, channel| noise * noise * truth(pixel, channel) / spp)))
}

fn share(count: usize, of: usize) -> f64 {
    count as f64 / of as f64
}

/// A known relMSE lies in its interval at the nominal rate, also against a reference that is noisy itself.
#[test]
fn intervals_cover_at_their_rate() {
    const TRIALS: u64 = 200;
    let mut covered = [0, 0];
    for trial in 0..TRIALS {
        for (which, reference) in [exact(), noisy(0.5, 192.0, 7 + trial)].iter().enumerate() {
            let subject = Synthetic::new(0.5, 0.0, 0.01, trial);
            let expected = subject.relmse() / 16.0;
            let found = measure(reference, 5, 16, vec![subject]);
            covered[which] += usize::from(found.variants[0].curve.last().unwrap().relmse.contains(expected));
        }
    }
    let rates = covered.map(|count| share(count, TRIALS as usize));
    println!("95 % intervals contain the true relMSE in {rates:?} of {TRIALS} trials");
    // Three standard deviations of a count of 200 at 0.95.
    assert!((rates[0] - 0.95).abs() < 0.047, "{rates:?}");
    assert!((rates[1] - 0.95).abs() < 0.047, "{rates:?}");
}

/// A bias of 1 % is found below noise that hides it in any one image; without one none is found.
#[test]
fn a_planted_bias_is_found() {
    let (mut found, mut false_alarms, mut floors) = (0, 0, Vec::new());
    const TRIALS: u64 = 40;
    for trial in 0..TRIALS {
        let reference = noisy(0.5, 65536.0, 1000 + trial);
        let flagged = |bias: f64| {
            let summary = measure(&reference, 5, 4096, vec![Synthetic::new(0.5, bias, 0.01, trial)]);
            let VariantResults { floor, .. } = summary.variants[0].clone();
            floor
        };
        let biased = flagged(0.01);
        found += usize::from(biased.flagged);
        floors.push(biased.relmse);
        false_alarms += usize::from(flagged(0.0).flagged);
    }
    let values = (0..(SIDE * SIDE) as usize).flat_map(|pixel| (0..3).map(move |channel| truth(pixel, channel)));
    let expected = values.map(|t| 1e-4 * t * t / (t * t + 1e-2)).sum::<f64>() / f64::from(3 * SIDE * SIDE);
    let mean = floors.iter().sum::<f64>() / floors.len() as f64;
    println!(
        "1 % of bias: found in {found} of {TRIALS}, floor {mean:.3e} against {expected:.3e}; {false_alarms} false alarms"
    );
    assert!(found as u64 >= TRIALS - 1 && false_alarms <= 1);
    assert!((mean / expected - 1.0).abs() < 0.1);
}

/// The deviation that is stated for the squared bias is the one that it has.
#[test]
fn the_floors_deviation_is_right() {
    let mut scores = Vec::new();
    for trial in 0..200 {
        let reference = noisy(0.5, 256.0, 5000 + trial);
        let images: Vec<Image> = (0..4)
            .map(|seed| {
                let mut subject = Synthetic::new(0.5, 0.0, 0.01, trial);
                subject.begin(seed).unwrap();
                subject.advance(Stop { spp: 64, seconds: None }).unwrap().image
            })
            .collect();
        let found = squared_bias(&images, &reference.image, reference.variance.as_ref());
        scores.push(found.relative / found.deviation);
    }
    let mean = scores.iter().sum::<f64>() / scores.len() as f64;
    let spread = (scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64).sqrt();
    println!("squared bias over its deviation: mean {mean:.3}, spread {spread:.3}");
    // Channels are taken as correlated and here they are not: the deviation is up to sqrt(3) too large, never too small.
    assert!(mean.abs() < 0.25 && (0.4..1.1).contains(&spread));
}

/// A technique against itself: no difference, in at least 95 % of 40 trials; against one of a quarter of the noise, always one.
#[test]
fn a_against_a() {
    let (mut different, mut better) = (0, 0);
    for trial in 0..40 {
        let subjects = [1, 2].map(|part| Synthetic::new(0.5, 0.0, 0.01, 2 * trial + part)).into();
        different += usize::from(measure(&exact(), 5, 16, subjects).pairs[0].significant);
        let subjects = vec![Synthetic::new(0.5, 0.0, 0.01, trial), Synthetic::new(0.25, 0.0, 0.01, 100 + trial)];
        let pair = &measure(&exact(), 5, 16, subjects).pairs[0];
        better += usize::from(pair.significant && pair.efficiency.ratio.contains(4.0));
    }
    println!("A/A: {different} of 40 differ; a quarter of the variance: {better} of 40 found with 4 in the interval");
    assert!(different <= 2);
    assert!(better >= 34);
}

/// Where a rare firefly decides the relMSE, it decides nothing else: against itself a technique with fireflies hardly ever differs, and four
/// times the efficiency is found by the figure without the worst pixels; the slope is that of Monte Carlo.
#[test]
fn fireflies_do_not_decide() {
    let (mut different, mut better, mut heavy) = (0, 0, 0);
    let struck = |noise: f64, trial: u64| Synthetic { fireflies: 0.01, ..Synthetic::new(noise, 0.0, 0.01, trial) };
    const TRIALS: u64 = 40;
    for trial in 0..TRIALS {
        let subjects = [1, 2].map(|part| struck(0.5, 2 * trial + part)).into();
        different += usize::from(measure(&exact(), 5, 64, subjects).pairs[0].significant);
        let found = measure(&exact(), 5, 64, vec![struck(0.5, trial), struck(0.25, 100 + trial)]);
        let pair = &found.pairs[0];
        heavy += usize::from(found.variants.iter().any(|variant| variant.worst_share > HEAVY_TAIL));
        better +=
            usize::from(pair.significant && pair.decided_by == Figure::Parts && pair.tested_by == Figure::Trimmed);
        assert!((2.5..6.0).contains(&pair.median.ratio.mean), "{:?}", pair.median);
    }
    println!(
        "A/A with fireflies: {different} of {TRIALS} differ; a quarter of the variance: {better} of {heavy} with some found"
    );
    assert!(different <= 2);
    assert!(better as u64 >= 34 && heavy as u64 >= 34);
    let slope = &measure(&exact(), 5, 4096, vec![struck(0.5, 7)]).variants[0];
    println!("slope {:?} of the {:?}", slope.slope, slope.slope_of);
    assert!(slope.slope_of == Figure::Median && (slope.slope.mean + 1.0).abs() < 0.15);
}

/// Error falls with the slope of Monte Carlo; a bias flattens it.
#[test]
fn slopes() {
    let plain = measure(&exact(), 5, 4096, vec![Synthetic::new(0.5, 0.0, 0.01, 2)]);
    let biased = measure(&exact(), 5, 4096, vec![Synthetic::new(0.5, 0.05, 0.01, 2)]);
    let (a, b) = (plain.variants[0].slope, biased.variants[0].slope);
    println!("slope {a:?}; with 5 % of bias {b:?}");
    assert!(a.contains(-1.0) && a.high - a.low < 0.1);
    assert!(b.low > -0.8 && biased.variants[0].floor.flagged);
}

/// Equal time and equal samples, whichever was the limit.
#[test]
fn rows_have_in_common_what_they_say() {
    let reference = exact();
    for (seconds, spp) in [(None, Some(64)), (Some(0.5), None)] {
        let folder = tempfile::tempdir().unwrap();
        let limits = Limits { seeds: 2, seconds, spp, first_seed: 0 };
        let bench = Bench { limits, ..bench(folder.path(), &reference, 2, 64) };
        let mut variants =
            vec![variant("a", Synthetic::new(0.5, 0.0, 0.01, 1)), variant("b", Synthetic::new(0.5, 0.0, 0.02, 2))];
        let found = bench.results(&mut variants, |_| Ok(())).unwrap();
        let (time, samples) = (found.equal_time.unwrap(), found.equal_spp.unwrap());
        assert!(time.cells.iter().all(|cell| (cell.seconds / time.at - 1.0).abs() < 0.2), "{time:?}");
        assert!((time.cells[0].spp / time.cells[1].spp / 2.0 - 1.0).abs() < 0.3, "{time:?}");
        assert!(samples.cells.iter().all(|cell| cell.spp == samples.at), "{samples:?}");
        for cell in time.cells.iter().chain(&samples.cells) {
            for file in [&cell.picture, &cell.crop, &cell.heat_map] {
                assert!(folder.path().join(file).exists(), "{file}");
            }
        }
    }
}

/// A bench that is interrupted goes on where it stopped, and a run of other settings does not count.
#[test]
fn an_interrupted_bench_goes_on() {
    let reference = exact();
    let folder = tempfile::tempdir().unwrap();
    let begun = Rc::new(RefCell::new(0));
    let run = |fingerprint: u64, stop_at: usize| {
        let subjects = [1, 2].map(|trial| Synthetic { begun: begun.clone(), ..Synthetic::new(0.5, 0.0, 0.01, trial) });
        let mut variants: Vec<Variant> = subjects.into_iter().map(|subject| variant("same", subject)).collect();
        variants[1].name = String::from("other");
        *begun.borrow_mut() = 0;
        let mut heard = 0;
        let bench = Bench { fingerprint, ..bench(folder.path(), &reference, 3, 8) };
        let found = bench.run(&mut variants, |_| {
            heard += 1;
            if heard > stop_at { Err(Error::Usage(String::from("stopped"))) } else { Ok(()) }
        });
        (found, *begun.borrow())
    };
    let (stopped, begun_first) = run(1, 3);
    assert!(stopped.is_err() && begun_first == 3 + 2, "{begun_first}"); // two warm up
    let (whole, begun_then) = run(1, 100);
    let whole = whole.unwrap();
    assert_eq!(begun_then, 3 + 2);
    let (again, begun_last) = run(1, 100);
    assert_eq!(begun_last, 0);
    let errors = |runs: &[Vec<lumbre::bench::results::Run>]| -> Vec<f64> {
        runs.iter().flatten().flat_map(|run| run.points.iter().map(|point| point.relmse)).collect()
    };
    assert_eq!(errors(&whole), errors(&again.unwrap()));
    let (_, begun_other) = run(2, 100);
    assert_eq!(begun_other, 6 + 2);
}
