//! Markov chains on the device: how many there are, what they begin with, and the mean that their visits are scaled by.
//!
//! A chain visits paths in proportion to their contribution, so its visits say what the image looks like and not how bright it is. That is
//! the mean contribution of bootstrap samples and of large steps: both are independent paths. Chains begin with bootstrap samples that are
//! chosen in proportion to their contribution, which leaves no start-up bias (Veach 1997, section 11.3.1). Light that few paths find is met
//! by as many chains as it deserves if bootstrap samples have met it, and by next to none otherwise: there should be many, however few
//! chains there are.
//!
//! Where the contribution f of a path is much more than the mean, chains visit it less often than that, and each visit counts for more: their
//! target is compressed to f / (1 + f / K) (see `shaders/techniques/metropolis/chains.glsl`), so that no path holds a chain for longer than the image takes, and
//! the mean has few surprises.

use std::time::Duration;

use super::super::pace::Pace;
use super::super::sampler::Sampler;
use super::super::settings::Settings;
use super::super::splat_planes::SplatPlanes;
use super::super::state::{Context, FilmScale, FrameLimits, Job, StateBytes, StateKind, TechniqueState};
use super::super::stream::StateStream;
use super::super::table::Pass;
use super::super::table::metropolis::{BOOTSTRAP_SAMPLES, BOUND, CHAINS, MULTIPLEXED, PATHS, PRIMARY};
use super::super::technique::Technique;
use crate::error::{Error, Result};
use crate::gpu::{Buffer, Gpu};
use crate::layout::{BIDIRECTIONAL_LENGTH, LightSubpathTable, NONE, VEC3_BYTES, VEC4_BYTES, WORKGROUP, address};
use crate::scene::Scene;
use crate::statistics::Estimate;
use crate::techniques::table::metropolis::structs::{BootstrapSample, Chain, ChainTable, PathVertex};

/// Bytes that the chains of a rendering may take where their number is not asked for.
const CHAIN_BYTES: u64 = 256 << 20;
/// Blocks of numbers that a path draws before its first vertex, and at each, as far as they are worth keeping.
const FIRST_BLOCKS: u64 = 2;
const VERTEX_BLOCKS: u64 = 2;
/// The most vertices of a part of a path whose numbers are kept: those of later ones are drawn anew by each proposal.
const MOST_VERTICES: u64 = 24;
/// The longest paths of chains that keep vertices, in segments. Chains keep two paths: the current one and the proposal.
const MOST_SEGMENTS: u64 = 32;
/// Paths that a job of bootstrap samples has room for at least, where it needs any: few chains are no reason to keep a device idle.
const LEAST_ROOM: u64 = 1024;
/// Of large steps, the share that goes to kinds whatever their contribution; bootstrap samples have no other.
const FIXED: f64 = 0.2;
/// Of the share [`FIXED`] of large steps, the part of the kind that samples no light: where that kind is what finds an image's light, few of
/// its paths find any.
const IMPLICIT: f64 = 0.25;

/// The pass of the technique's form, which mutates paths.
fn form(technique: &Technique) -> Pass {
    [MULTIPLEXED, PATHS].into_iter().find(|pass| technique.has_pass(pass)).unwrap_or(PRIMARY)
}

/// How much there is of each, before anything is allocated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct ChainSize {
    /// Chains.
    pub chains: u64,
    /// Those that take part in one sample.
    pub of_sample: u64,
    /// Mutations of each of these.
    pub mutations: u64,
    /// Bootstrap samples: paths that chains may begin with.
    pub bootstrap: u64,
    /// Blocks of numbers that a chain has room for, of the camera's and of the lights' paths.
    pub camera_blocks: u64,
    pub light_blocks: u64,
    /// Vertices of paths that a chain has room for, where it keeps those instead.
    pub vertices: u64,
    /// Paths that there is room for: one for each chain, or more, since bootstrap samples are made in the same room.
    room: u64,
    /// Layers of its path's contribution.
    layers: u64,
    /// Kinds of paths: by their length, or besides that what the camera's paths find, of whatever length.
    pub kinds: u64,
    /// The kind whose camera subpaths hit lights without next-event estimation.
    implicit: u64,
}

impl ChainSize {
    pub fn of(settings: &Settings) -> Self {
        let technique = &settings.technique;
        let depth = u64::from(settings.max_depth.unwrap_or(u32::MAX));
        let blocks = |vertices: u64| FIRST_BLOCKS + VERTEX_BLOCKS * depth.min(vertices);
        let longest = u64::from(BIDIRECTIONAL_LENGTH);
        let mut size = match form(technique) {
            MULTIPLEXED => Self {
                camera_blocks: blocks(MOST_VERTICES),
                light_blocks: blocks(longest),
                kinds: 1 + depth.clamp(1, longest),
                ..Self::default()
            },
            PATHS => {
                let segments = depth.clamp(1, MOST_SEGMENTS);
                Self { kinds: segments + 1, implicit: segments, vertices: 2 * (segments + 1), ..Self::default() }
            }
            _ => Self { camera_blocks: blocks(MOST_VERTICES), kinds: 1, ..Self::default() },
        };
        size.layers = u64::from(settings.layers().max(1));
        let pixels = settings.pixels();
        let workgroup = u64::from(WORKGROUP);
        let asked = technique.number(&CHAINS) as u64;
        let most = if asked > 0 {
            asked
        } else {
            (CHAIN_BYTES / size.bytes_of_chain() / workgroup * workgroup).clamp(workgroup, pixels.max(workgroup))
        };
        [size.chains, size.of_sample, size.mutations] = divided(pixels, most);
        size.bootstrap = (technique.number(&BOOTSTRAP_SAMPLES) as u64).max(size.chains);
        size.room = if size.vertices > 0 { size.chains.max(LEAST_ROOM) } else { size.chains };
        size
    }

    /// The probability that a bootstrap sample is of each kind.
    fn shares(&self) -> Vec<f64> {
        let others = (1.0 - IMPLICIT) / (self.kinds - 1).max(1) as f64;
        let share = |kind| match kind == self.implicit {
            true if self.kinds == 1 => 1.0,
            true => IMPLICIT,
            false => others,
        };
        (0..self.kinds).map(share).collect()
    }

    fn bytes_of_chain(&self) -> u64 {
        self.number_bytes_of_chain() + self.value_bytes_of_chain() + size_of::<Chain>() as u64
    }

    fn number_bytes_of_chain(&self) -> u64 {
        let blocks = self.camera_blocks + self.light_blocks;
        u64::from(VEC4_BYTES) * blocks + size_of::<PathVertex>() as u64 * self.vertices
    }

    fn value_bytes_of_chain(&self) -> u64 {
        u64::from(VEC3_BYTES) * self.layers
    }

    /// Bytes of the chains with the contributions of their paths, of their numbers, and of bootstrap samples.
    pub fn bytes(&self) -> [StateBytes; 3] {
        let states = self.chains * (size_of::<Chain>() as u64 + self.value_bytes_of_chain());
        let table = size_of::<ChainTable>() as u64 + 4 * self.kinds;
        [
            StateBytes::exact("chains", states + table),
            StateBytes::exact("paths of chains", self.room * self.number_bytes_of_chain()),
            StateBytes::exact("candidates", self.bootstrap * size_of::<BootstrapSample>() as u64),
        ]
    }
}

/// Pixels of the image with the border from which wide filters reach into it: the light subpaths that a sample stands for.
fn paths_of_sample(settings: &Settings) -> u64 {
    let border = (settings.filter.radius() - 0.5).max(0.0).ceil() as u64;
    (u64::from(settings.width) + 2 * border) * (u64::from(settings.height) + 2 * border)
}

/// What Metropolis light transport keeps.
pub(in super::super) struct MarkovChains;

impl StateKind for MarkovChains {
    fn check(&self, _: &Gpu, settings: &Settings) -> Result<()> {
        if settings.technique.row.samplers().iter().any(|row| row.sampler == settings.sampler) {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "random numbers of {} are its chains' own: valid is --sampler {}",
            settings.technique.row.name,
            Sampler::Independent.name()
        )))
    }

    fn bytes(&self, _: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let splats = SplatPlanes::bytes(settings, SplatPlanes::several(settings));
        Ok([splats].into_iter().chain(ChainSize::of(settings).bytes()).collect())
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        Ok(Box::new(Chains::new(context.gpu, context.settings)?))
    }
}

/// The Markov chains of a rendering, and where they splat.
pub struct Chains {
    size: ChainSize,
    splats: SplatPlanes,
    paths_of_sample: u32,
    /// The pass that mutates paths, and makes bootstrap samples where it is given no samples.
    pass: Pass,
    table: Buffer,
    kinds_shares: Buffer,
    states: Buffer,
    values: Buffer,
    numbers: Buffer,
    bootstrap: Buffer,
    /// Bootstrap samples that there are already, those that chains choose among, and how many fit into a job.
    made: u64,
    wanted: u64,
    pace: Pace,
    /// What making them took, and may take.
    took: Duration,
    budget: Duration,
    /// The probability that a large step is of each kind.
    shares: Vec<f64>,
    /// The bound K of the target, in means of it over all paths that contribute anything, and as a value once all bootstrap samples are there.
    bound_in_means: f64,
    bound: f64,
    /// Sum of the target at bootstrap samples, once they are all there.
    sum: Option<f64>,
    /// Sum of the squared differences of those from their mean.
    squares: f64,
    /// Where along the sum of the target the first chain begins, in 0..1 of what there is for each.
    offset: f64,
}

impl TechniqueState for Chains {
    fn table(&self) -> u64 {
        self.table.address()
    }

    fn limits(&self) -> FrameLimits {
        self.splats.limits()
    }

    /// The next bootstrap samples to make. They are made in the room of the chains, and no bound on frames cuts them.
    fn next_job(&self, _: u32, _: u64) -> Option<Job> {
        let left = self.wanted - self.made;
        let room = if self.size.vertices > 0 { self.size.room } else { left };
        let (first, count) = (self.made as u32, self.pace.fits().min(left).min(room) as u32);
        let about = format!("{count} bootstrap samples from {first}");
        (left > 0).then_some(Job { pass: self.pass, first, count, samples: 0, word: 0, about })
    }

    /// Chooses among bootstrap samples once all are there, or as many as there is time for.
    fn job_done(&mut self, job: &Job, took: Duration) -> Result<()> {
        self.made += u64::from(job.count);
        self.took += took;
        self.pace.took(u64::from(job.count), took);
        let is_late = self.took >= self.budget;
        if self.made < self.wanted && !is_late {
            return Ok(());
        }
        let bootstrap: Vec<BootstrapSample> = self.bootstrap.read(self.made as usize)?;
        if bootstrap.iter().any(|sample| sample.contribution > 0.0) {
            self.wanted = self.made;
            return self.begin(&bootstrap);
        }
        if self.made < self.wanted {
            return Ok(()); // time or not, there is nothing to begin with
        }
        Err(Error::NothingFound(format!(
            "no light in {} paths: there is nothing to mutate; more :candidates of mlt may find some, or another technique",
            bootstrap.len()
        )))
    }

    /// The share of bootstrap samples that are there; 1 once chains have begun.
    fn start(&self) -> f64 {
        self.made as f64 / self.wanted as f64
    }

    /// Chains begin with the bootstrap samples that are there by then, as long as any of them contributes.
    fn set_time_budget(&mut self, budget: Duration) {
        self.budget = budget;
    }

    /// Forgets where chains are, and how fast bootstrap samples were made: where a time budget ends them, each start is that of a new
    /// renderer.
    fn restart(&mut self, seed: u32) -> Result<()> {
        self.splats.restart()?;
        self.offset = uniform(seed);
        (self.made, self.wanted, self.took) = (0, self.size.bootstrap, Duration::ZERO);
        self.pace = Pace::new();
        (self.sum, self.bound) = (None, f64::INFINITY);
        self.shares = self.size.shares();
        self.describe_chains(0.0)
    }

    /// The bootstrap samples, and where each chain is. The table follows from them: it holds addresses, which are this process's own.
    fn exchange(&mut self, stream: &mut StateStream, under_way: bool) -> Result<()> {
        self.splats.exchange(stream, under_way)?;
        stream.long(&mut self.made)?;
        stream.long(&mut self.wanted)?;
        let (made, wanted, most) = (self.made, self.wanted, self.size.bootstrap);
        stream.check(made <= wanted && wanted <= most, || {
            format!("{made} of {wanted} bootstrap samples: valid are at most so many, and {most} in all")
        })?;
        for buffer in [&self.bootstrap, &self.states, &self.values, &self.numbers] {
            stream.buffer(buffer)?;
        }
        if stream.restores() && self.made == self.wanted {
            self.estimate_normalisation(&self.bootstrap.read(self.made as usize)?)?;
        }
        Ok(())
    }

    /// The mean over all independent paths over the one by which chains scaled their visits, which was of bootstrap samples alone.
    fn film_scale(&self) -> Result<Option<FilmScale>> {
        let (Some(brightness), Some(sum)) = (self.brightness()?, self.sum) else { return Ok(None) };
        let scaled_by = f64::from((sum / self.made as f64) as f32);
        Ok(Some(FilmScale { factor: brightness.mean / scaled_by, brightness }))
    }
}

impl Chains {
    fn new(gpu: &Gpu, settings: &Settings) -> Result<Self> {
        let size = ChainSize::of(settings);
        let [_, paths, bootstrap] = size.bytes();
        let mut chains = Self {
            splats: SplatPlanes::new(gpu, settings, SplatPlanes::several(settings))?,
            paths_of_sample: paths_of_sample(settings) as u32,
            pass: form(&settings.technique),
            table: Buffer::zeroed(gpu, "chains", size_of::<ChainTable>() as u64)?,
            kinds_shares: Buffer::zeroed(gpu, "chains", 4 * size.kinds)?,
            states: Buffer::zeroed(gpu, "chains", size.chains * size_of::<Chain>() as u64)?,
            values: Buffer::zeroed(gpu, "chains", size.chains * size.value_bytes_of_chain())?,
            numbers: Buffer::new(gpu, paths.name, paths.bytes)?,
            bootstrap: Buffer::new(gpu, bootstrap.name, bootstrap.bytes)?,
            made: 0,
            wanted: size.bootstrap,
            pace: Pace::new(),
            took: Duration::ZERO,
            budget: Duration::MAX,
            shares: Vec::new(),
            bound_in_means: settings.technique.number(&BOUND),
            bound: f64::INFINITY,
            sum: None,
            squares: 0.0,
            offset: 0.0,
            size,
        };
        chains.restart(settings.random_seed())?;
        Ok(chains)
    }

    fn begin(&mut self, bootstrap: &[BootstrapSample]) -> Result<()> {
        let targets = self.estimate_normalisation(bootstrap)?;
        let starts: Vec<u32> = chosen(&targets, self.size.chains as usize, self.offset).collect();
        // Chains that take part in one sample begin with bootstrap samples from all over the list, however many samples there will be.
        let (of_sample, turns) = (self.size.of_sample as usize, (self.size.chains / self.size.of_sample) as usize);
        let states: Vec<Chain> = (0..starts.len())
            .map(|chain| starts[chain % of_sample * turns + chain / of_sample])
            .map(|begins_at| Chain {
                begins_at,
                kind: Source::of(bootstrap[begins_at as usize]).made_by as u32,
                known: NONE,
                ..Chain::default()
            })
            .collect();
        self.states.upload(bytemuck::cast_slice(&states))
    }

    /// Estimates the normalisation of the target from bootstrap samples, its mean over the density of large steps, together with its bound
    /// and the probabilities of kinds. Returns the target of chains at each sample, over the density of bootstrap samples.
    fn estimate_normalisation(&mut self, bootstrap: &[BootstrapSample]) -> Result<Vec<f64>> {
        // Large steps have those kinds that contribute more, more often.
        let contributions = bootstrap.iter().map(|sample| (f64::from(sample.contribution), 1.0));
        let first = bound(contributions, self.bound_in_means);
        let mut shares = vec![0.0; self.size.kinds as usize];
        let last = shares.len() - 1;
        for sample in bootstrap {
            let (source, target) = (Source::of(*sample), compressed(f64::from(sample.contribution), first));
            shares[source.kind.min(last)] += (1.0 - source.by_last) * target;
            shares[last] += source.by_last * target;
        }
        let (fixed, sum) = (self.size.shares(), shares.iter().sum::<f64>());
        shares.iter_mut().zip(&fixed).for_each(|(share, fixed)| *share = FIXED * fixed + (1.0 - FIXED) * *share / sum);
        self.shares = shares;
        // How much likelier a large step makes this path than a bootstrap sample was to be it.
        let of_kind: Vec<f64> = self.shares.iter().zip(&fixed).map(|(share, fixed)| share / fixed).collect();
        let likelier = |sample: &BootstrapSample| {
            let Source { kind, by_last, .. } = Source::of(*sample);
            (1.0 - by_last) * of_kind[kind.min(last)] + by_last * of_kind[last]
        };
        let weighed =
            || bootstrap.iter().map(|sample| (f64::from(sample.contribution) / likelier(sample), likelier(sample)));
        let bound = bound(weighed(), self.bound_in_means);
        let targets: Vec<f64> =
            weighed().map(|(contribution, likelier)| likelier * compressed(contribution, bound)).collect();
        let sum: f64 = targets.iter().sum();
        let mean = sum / bootstrap.len() as f64;
        (self.bound, self.sum) = (bound, Some(sum));
        self.squares = targets.iter().map(|target| (target - mean).powi(2)).sum();
        self.describe_chains(mean)?;
        Ok(targets)
    }

    /// Writes the table, with the probability of each kind.
    fn describe_chains(&self, mean: f64) -> Result<()> {
        let mut sum = 0.0;
        let mut cumulative: Vec<f32> = self
            .shares
            .iter()
            .map(|share| {
                sum += share;
                sum as f32
            })
            .collect();
        if let Some(last) = cumulative.last_mut() {
            *last = 1.0;
        }
        self.kinds_shares.upload(bytemuck::cast_slice(&cumulative))?;
        let size = &self.size;
        let mut light = LightSubpathTable { light_path_count: self.paths_of_sample, ..LightSubpathTable::default() };
        self.splats.describe(&mut light);
        let table = ChainTable {
            light,
            bootstrap: address(self.bootstrap.address()),
            states: address(self.states.address()),
            values: address(self.values.address()),
            numbers: address(self.numbers.address()),
            kinds_shares: address(self.kinds_shares.address()),
            kind_count: size.kinds as u32,
            chains: size.chains as u32,
            chains_of_sample: size.of_sample as u32,
            mutations: size.mutations as u32,
            camera_blocks: size.camera_blocks as u32,
            light_blocks: size.light_blocks as u32,
            normalisation: mean as f32,
            bound: self.bound as f32,
        };
        self.table.upload(bytemuck::bytes_of(&table))
    }

    /// Where each chain is.
    pub fn states(&self) -> Result<Vec<Chain>> {
        self.states.read(self.size.chains as usize)
    }

    /// The probability that a large step is of each kind.
    pub fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// The bound K of the target of chains, in the unit of a chain's contribution; infinite before there are any chains.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// The mean of the target over all independent paths so far, bootstrap samples and large steps: the image's brightness, under the bound.
    /// Its variance is that of bootstrap samples, and of the sums of chains, whose large steps are the same number in the mean. Nothing
    /// before there are any.
    fn brightness(&self) -> Result<Option<Estimate>> {
        let Some(by_bootstrap) = self.sum else { return Ok(None) };
        let bootstrap = self.made as f64;
        let steps: Vec<(f64, f64)> = self
            .states()?
            .iter()
            .map(|chain| (f64::from(chain.sum) + f64::from(chain.sum_low), f64::from(chain.large_steps)))
            .collect();
        let sum = by_bootstrap + steps.iter().map(|(sum, _)| sum).sum::<f64>();
        let count = bootstrap + steps.iter().map(|(_, count)| count).sum::<f64>();
        let mean = sum / count;
        // A ratio of two sums over what is independent (Cochran 1977, "Sampling techniques", section 2.11).
        let squares = self.squares + steps.iter().map(|(sum, count)| (sum - mean * count).powi(2)).sum::<f64>();
        Ok(Some(Estimate { mean, variance: squares / (count * count) }))
    }
}

/// Where a bootstrap sample is from, as `bootstrap_source` of `shaders/techniques/metropolis/chains.glsl` packs it.
struct Source {
    kind: usize,
    /// The kind of large steps that made it.
    made_by: usize,
    /// Of the density of large steps there, what is not its kind's but the last one's.
    by_last: f64,
}

impl Source {
    fn of(sample: BootstrapSample) -> Self {
        let word = sample.kind;
        let [kind, made_by] = [word & 0xff, word >> 8 & 0xff].map(|byte| byte as usize);
        Self { kind, made_by, by_last: f64::from(word >> 16) / 65535.0 }
    }
}

/// How many chains there are of so many at most, how many of them take part in one sample, and how many mutations each has there:
/// together as many as there are pixels. Chains beyond that take turns.
fn divided(pixels: u64, most: u64) -> [u64; 3] {
    let mutations = pixels.div_ceil(most);
    let of_sample = pixels.div_ceil(mutations);
    [(most / of_sample).max(1) * of_sample, of_sample, mutations]
}

/// The compressed target of chains at a path of this contribution: about as much where that is far below the bound, and never more than it.
fn compressed(contribution: f64, bound: f64) -> f64 {
    contribution / (1.0 + contribution / bound)
}

/// The bound that is so many times the mean of the target under it, over the paths that contribute anything; `paths` is the contribution of
/// each, and how much it counts. The mean is the target's so that the brightest paths do not raise the bound that is to hold them.
fn bound(paths: impl Iterator<Item = (f64, f64)>, means: f64) -> f64 {
    let (values, weights): (Vec<f64>, Vec<f64>) = paths.filter(|(contribution, _)| *contribution > 0.0).unzip();
    let all: f64 = weights.iter().sum();
    // The mean of the target, and its derivative by the bound.
    let mean = |bound: f64| {
        values.iter().zip(&weights).fold([0.0; 2], |[mean, slope], (contribution, weight)| {
            let target = compressed(*contribution, bound);
            [mean + weight / all * target, slope + weight / all * (target / bound).powi(2)]
        })
    };
    // means * mean(x) - x is concave and 0 at 0, so there is one solution beyond that. It lies below so many plain means, and Newton's method
    // comes down to it from there without passing it.
    let mut at = means * mean(f64::INFINITY)[0];
    for _ in 0..60 {
        let [mean, slope] = mean(at);
        let step = (at - means * mean) / (1.0 - means * slope);
        at -= step;
        if step <= 1e-12 * at {
            break;
        }
    }
    at
}

/// As many bootstrap samples as there are chains, each in proportion to the target: at equal distances along the sum of that, from `offset` of
/// one on, which is uniform in 0..1 (systematic resampling, Kitagawa 1996).
fn chosen(targets: &[f64], chains: usize, offset: f64) -> impl Iterator<Item = u32> {
    let total: f64 = targets.iter().sum();
    let (mut index, mut passed) = (0, targets[0]);
    (0..chains).map(move |chain| {
        let at = (chain as f64 + offset) / chains as f64 * total;
        while passed <= at && index + 1 < targets.len() {
            index += 1;
            passed += targets[index];
        }
        index as u32
    })
}

/// A number in 0..1 of a seed (the finaliser of MurmurHash3, Appleby 2011).
fn uniform(seed: u32) -> f64 {
    let mut bits = u64::from(seed) + 1;
    for factor in [0xff51_afd7_ed55_8ccd_u64, 0xc4ce_b9fe_1a85_ec53] {
        bits ^= bits >> 33;
        bits = bits.wrapping_mul(factor);
    }
    ((bits ^ bits >> 33) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each bootstrap sample is chosen as often as its share of the sum asks for, to within one, and over many seeds exactly; what contributes nothing
    /// never.
    #[test]
    fn chains_begin_in_proportion() {
        let targets = [0.0, 3.0, 0.5, 0.0, 0.0, 6.5, 0.0];
        for chains in [1, 7, 100, 1001] {
            let mut all = [0.0; 7];
            for seed in 0..2000 {
                let mut counts = [0; 7];
                chosen(&targets, chains, uniform(seed)).for_each(|index| counts[index as usize] += 1);
                for ((count, target), all) in counts.iter().zip(targets).zip(&mut all) {
                    assert!((f64::from(*count) - target / 10.0 * chains as f64).abs() < 1.0, "{counts:?}");
                    assert!(target > 0.0 || *count == 0, "{counts:?}");
                    *all += f64::from(*count) / 2000.0;
                }
            }
            for (mean, target) in all.iter().zip(targets) {
                // What is off is less than one each time: half of it is the most that it can vary by.
                assert!(
                    (mean - target / 10.0 * chains as f64).abs() < 4.0 * 0.5 / 2000_f64.sqrt(),
                    "{chains}: {all:?}"
                );
            }
        }
    }

    /// `-n` counts mutations per pixel, whatever number of chains there is room for: too many by less than one of each chain's.
    #[test]
    fn a_sample_is_a_mutation_of_each_pixel() {
        for pixels in [1, 100, 1024, 65_536, 393_216] {
            for most in [1, 7, 100, 600, 1024, 52_992, 192_960, 1 << 20] {
                let [chains, of_sample, mutations] = divided(pixels, most);
                assert!(
                    chains <= most && chains % of_sample == 0 && chains + of_sample > most.min(pixels),
                    "{chains} of {most}"
                );
                let done = of_sample * mutations;
                assert!(done >= pixels && done - pixels < mutations, "{of_sample} x {mutations} for {pixels}");
            }
        }
        assert_eq!(divided(393_216, 52_992), [49_152, 49_152, 8]);
    }

    /// The bound is so many times the mean of what it leaves, and one path of 10^9 does not raise it by more than its share.
    #[test]
    fn few_paths_do_not_raise_the_bound() {
        let values: Vec<f64> = (0..1000).map(|i| f64::from(i % 10)).collect();
        let plain = bound(values.iter().map(|x| (*x, 1.0)), 100.0);
        let mean = values.iter().filter(|x| **x > 0.0).map(|x| compressed(*x, plain)).sum::<f64>() / 900.0;
        assert!((plain / mean - 100.0).abs() < 1e-6, "{plain} over {mean}");
        let with_one = bound(values.iter().copied().chain([1e9]).map(|x| (x, 1.0)), 100.0);
        assert!(with_one > plain && with_one < 1.2 * plain, "{with_one} against {plain}");
        let by_weight = bound((0..10).map(|i| (f64::from(i), 5.0)), 100.0);
        assert!((by_weight / plain - 1.0).abs() < 1e-9, "{by_weight} against {plain}");
    }
}
