//! The patches of `radiosity` on the device, and the rounds in which they pass light on to each other.
//!
//! Before the first sample of the image, rounds prepare: each takes the light of the last one a segment further, until there is next to
//! none left or paths have to end. Then one round goes before each sample, in frames of its own, so that no submission is long.

use std::collections::HashSet;
use std::time::Duration;

use super::super::pace::Pace;
use super::super::settings::Settings;
use super::super::state::{
    Context, FrameLimits, Job, NextState, StateBytes, StateKind, StateReport, TechniqueState, Trial,
};
use super::super::stream::StateStream;
use super::super::table::Pass;
use super::super::table::radiosity as row;
use super::patches::{PatchMesh, Quartered};
use super::report::PatchReport;
use crate::error::Result;
use crate::gpu::{Buffer, Gpu};
use crate::layout::{FIXED_RGB_BYTES, NONE, PREPARING_BIT, VEC3_BYTES, WORKGROUP, address};
use crate::scene::Scene;
use crate::scene::compile::light::area;
use crate::techniques::table::radiosity::structs::PatchTable;

/// The most rays of a patch in a round, where their number follows that of pixels.
const MOST_RAYS: u64 = 64;
/// Rounds that prepare have so many times fewer rays: what they leave is soon passed on.
const FEWER: u32 = 8;
/// Rays by which a patch learns its albedo.
const ALBEDO_RAYS: u32 = 256;
/// Share of the light, of each colour, that may be left on its way when the image begins.
const RESIDUAL: f64 = 1e-6;
/// Rounds after which that is given up: where nothing is absorbed, light goes on for ever.
const MOST_ROUNDS: u32 = 4096;
/// How often patches are quartered where that is asked for.
const LEVELS: u32 = 3;
/// Rays of a patch by which it is decided.
const TRIAL_RAYS: u32 = 256;
/// Share of the light that may be left on its way then.
const TRIAL_RESIDUAL: f64 = 0.02;
/// Share of all area from which on emission is left to rays alone: they find it oftener than one sample of the lights does.
const FOUND_FROM: f64 = 0.25;

/// How many layers of irradiance there are, by path length, and whether the last one takes all longer paths.
fn layers(settings: &Settings) -> (u32, bool) {
    match settings.max_depth {
        Some(depth) => (depth.saturating_sub(1).max(1), false),
        None => (settings.lengths.saturating_sub(1).max(1), true),
    }
}

/// Patches of the size that these settings ask for; larger where they need not be quartered.
fn mesh(scene: &Scene, settings: &Settings, quartered: &Quartered) -> Result<PatchMesh> {
    let levels = if threshold(settings) > 0.0 { LEVELS } else { 0 };
    PatchMesh::new(scene, settings.technique.number(&row::PATCHES), levels, quartered)
}

/// Differences above which patches are quartered; 0 where all are.
fn threshold(settings: &Settings) -> f64 {
    settings.technique.number(&row::ADAPTIVE)
}

/// What radiosity keeps.
pub(in super::super) struct Patches;

impl StateKind for Patches {
    fn check(&self, gpu: &Gpu, settings: &Settings) -> Result<()> {
        if shoots(settings) {
            gpu.require_int64_atomics("radiosity:solver=shoot", "solver=gather does without")?;
        }
        Ok(())
    }

    /// Where patches are quartered as need be, it is the most that they can be.
    fn bytes(&self, scene: &Scene, settings: &Settings) -> Result<Vec<StateBytes>> {
        let exact = threshold(settings) == 0.0;
        let sizes = sizes(&mesh(scene, settings, &Quartered::All)?, scene, settings);
        Ok(sizes.map(|(name, bytes)| StateBytes { name, bytes, exact }).into())
    }

    fn make(&self, context: &Context) -> Result<Box<dyn TechniqueState>> {
        let trials = if threshold(context.settings) > 0.0 { LEVELS } else { 0 };
        Ok(Box::new(Radiosity::new(context, Quartered::These(HashSet::new()), trials)?))
    }
}

/// What the patches take on the device, by kind.
fn sizes(mesh: &PatchMesh, scene: &Scene, settings: &Settings) -> [(&'static str, u64); 4] {
    let (patches, vertices) = (mesh.patches.len() as u64, mesh.vertices() as u64);
    let layers = u64::from(layers(settings).0);
    let bytes = |list: &[u32]| size_of_val(list) as u64;
    let bases = scene.instances.len() as u64 * 4; // `instance_order` may be longer: that is counted with what it places
    let lists = [
        size_of_val(mesh.faces.as_slice()) as u64,
        size_of_val(mesh.patches.as_slice()) as u64,
        bytes(&mesh.face_of),
        bases,
        bytes(&mesh.cells),
        size_of_val(mesh.corners.as_slice()) as u64,
        bytes(&mesh.term_first),
        size_of_val(mesh.terms.as_slice()) as u64,
        size_of::<PatchTable>() as u64,
    ];
    [
        ("patches", lists.into_iter().map(|bytes| bytes.max(4)).sum()),
        (
            "light of patches",
            light_bytes(patches * (1 + 2 * layers + 2)).max(light_bytes(1)) + light_bytes(vertices * layers).max(4),
        ),
        ("arriving at patches", arriving_bytes(settings, patches).max(4)),
        ("counts of patches", (patches * 4 * u64::from(mesh.columns())).max(4)),
    ]
}

/// Bytes of so many values of irradiance.
fn light_bytes(count: u64) -> u64 {
    count * u64::from(VEC3_BYTES)
}

/// Bytes of the power that arrives: three sums, and three integers for each patch and layer.
fn arriving_bytes(settings: &Settings, patches: u64) -> u64 {
    if shoots(settings) { u64::from(FIXED_RGB_BYTES) * (1 + patches * u64::from(layers(settings).0)) } else { 0 }
}

/// What the next frame of the patches does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    Albedo,
    Gather,
    Shoot,
    Collect,
    Vertices,
}

impl Task {
    const ALL: [Self; 5] = [Self::Albedo, Self::Gather, Self::Shoot, Self::Collect, Self::Vertices];

    /// The pass that does it.
    pub fn pass(self) -> Pass {
        match self {
            Self::Albedo => row::ALBEDO,
            Self::Gather => row::GATHER,
            Self::Shoot => row::SHOOT,
            Self::Collect => row::COLLECT,
            Self::Vertices => row::VERTICES,
        }
    }
}

/// Whether the settings ask for patches that shoot.
fn shoots(settings: &Settings) -> bool {
    settings.technique.has_pass(&row::SHOOT)
}

/// The patches of a rendering, and how far the light is on its way between them.
pub struct Radiosity {
    mesh: PatchMesh,
    surfaces: usize,
    table: Buffer,
    newest: Buffer,
    received: Buffer,
    albedo: Buffer,
    met: Buffer,
    arriving: Buffer,
    at_vertices: Buffer,
    /// What else the table points to.
    _kept: Vec<Buffer>,
    layers: u32,
    open_ended: bool,
    shoots: bool,
    rays: u32,
    /// What comes next, from which patch on.
    task: Task,
    cursor: u32,
    /// Rounds that are done, and those of them that prepared; nothing while that goes on.
    rounds: u32,
    prepared: Option<u32>,
    albedos: Vec<[f32; 3]>,
    /// Power that patches send out: after the first round, and after the last one that prepared.
    first_power: [f64; 3],
    power: [f64; 3],
    /// The residual at which preparing ends.
    may_be_left: f64,
    /// Rays that fit into a job.
    pace: Pace,
    /// Which patches are quartered, above which differences, and the trials by which that is found out, this one included.
    quartered: Quartered,
    threshold: f64,
    trials: u32,
}

impl Radiosity {
    /// Divides the scene that is on the device. With trials left, it only finds out which patches are to be quartered.
    fn new(context: &Context, quartered: Quartered, trials: u32) -> Result<Self> {
        let Context { gpu, scene, settings, order, instance_order } = *context;
        let mut mesh = mesh(scene, settings, &quartered)?;
        mesh.reorder(scene, order, instance_order);
        let bases = mesh.bases(scene, instance_order);
        let (layers, open_ended) = layers(settings);
        let (patches, vertices) = (mesh.patches.len() as u64, mesh.vertices() as u64);
        let mut kept = Vec::new();
        let mut keep = |bytes: &[u8]| -> Result<[u32; 2]> {
            let buffer = Buffer::with_data(gpu, "patches", bytes)?;
            let place = address(buffer.address());
            kept.push(buffer);
            Ok(place)
        };
        let light = |count: u64| Buffer::zeroed(gpu, "light of patches", light_bytes(count));
        let (albedo, received) = (light(patches)?, light(2 * patches * u64::from(layers))?);
        let (newest, at_vertices) = (light(2 * patches)?, light(vertices * u64::from(layers))?);
        let columns = mesh.columns();
        let met = Buffer::zeroed(gpu, "counts of patches", patches * 4 * u64::from(columns))?;
        let arriving = Buffer::zeroed(gpu, "arriving at patches", arriving_bytes(settings, patches))?;
        let table = PatchTable {
            faces: keep(bytemuck::cast_slice(&mesh.faces))?,
            patches: keep(bytemuck::cast_slice(&mesh.patches))?,
            face_of: keep(bytemuck::cast_slice(&mesh.face_of))?,
            face_base: keep(bytemuck::cast_slice(&bases))?,
            cells: keep(bytemuck::cast_slice(&mesh.cells))?,
            corners: keep(bytemuck::cast_slice(&mesh.corners))?,
            term_first: keep(bytemuck::cast_slice(&mesh.term_first))?,
            terms: keep(bytemuck::cast_slice(&mesh.terms))?,
            albedo: address(albedo.address()),
            received: address(received.address()),
            newest: address(newest.address()),
            vertices: address(at_vertices.address()),
            arriving: address(arriving.address()),
            met: address(met.address()),
            patch_count: patches as u32,
            vertex_count: vertices as u32,
            layers,
            open_ended: u32::from(open_ended),
            found: u32::from(is_found(scene, &mesh)),
            columns,
        };
        Ok(Self {
            table: Buffer::with_data(gpu, "patches", &[table])?,
            rays: if trials > 0 { TRIAL_RAYS } else { rays(settings, patches) },
            surfaces: scene.surfaces.len(),
            mesh,
            newest,
            received,
            albedo,
            met,
            arriving,
            at_vertices,
            _kept: kept,
            layers,
            open_ended,
            shoots: shoots(settings),
            task: Task::Albedo,
            cursor: 0,
            rounds: 0,
            prepared: (settings.max_depth.is_some_and(|depth| depth < 2) || patches == 0).then_some(0),
            albedos: Vec::new(),
            first_power: [0.0; 3],
            power: [0.0; 3],
            may_be_left: if trials > 0 { TRIAL_RESIDUAL } else { RESIDUAL },
            pace: Pace::new(),
            quartered,
            threshold: threshold(settings),
            trials,
        })
    }

    /// Patches to be quartered besides those that were; nothing where there are none.
    fn uneven(&self) -> Result<Option<Quartered>> {
        let (count, layers) = (self.mesh.patches.len(), self.layers as usize);
        let all: Vec<[f32; 3]> = self.received.read(2 * count * layers)?;
        let shown = &all[((self.rounds & 1) as usize) * count * layers..][..count * layers];
        let strength = |rgb: [f32; 3]| rgb.iter().sum::<f32>();
        let light: Vec<f32> =
            (0..count).map(|patch| (0..layers).map(|layer| strength(shown[layer * count + patch])).sum()).collect();
        Ok(self.mesh.uneven(&light, self.threshold, &self.quartered))
    }

    /// What a round begins with.
    fn first_task(&self) -> Task {
        if self.shoots { Task::Shoot } else { Task::Gather }
    }

    /// What the task at hand runs over.
    fn extent(&self) -> u32 {
        let patches = self.mesh.patches.len() as u32;
        match self.task {
            Task::Albedo | Task::Gather | Task::Collect => patches,
            Task::Shoot => 2 * patches, // as many again for the lights
            Task::Vertices => self.mesh.vertices() as u32,
        }
    }

    /// Measures what the round has passed on: the light that goes on from there.
    fn end_preparing_round(&mut self) -> Result<()> {
        let count = self.mesh.patches.len();
        let both: Vec<[f32; 3]> = self.newest.read(2 * count)?;
        let newest = if self.rounds & 1 == 0 { &both[count..] } else { &both[..count] };
        let mut power = [0.0; 3];
        for ((patch, albedo), light) in self.mesh.patches.iter().zip(&self.albedos).zip(newest) {
            for channel in 0..3 {
                power[channel] += f64::from(patch.area) * f64::from(albedo[channel]) * f64::from(light[channel]);
            }
        }
        if self.rounds == 0 {
            self.first_power = power;
        }
        self.power = power;
        self.rounds += 1;
        self.task = self.first_task();
        let ends = !self.open_ended && self.rounds >= self.layers;
        if ends || self.residual() <= self.may_be_left || self.rounds >= MOST_ROUNDS {
            self.prepared = Some(self.rounds);
            self.rounds = 0;
        }
        Ok(())
    }

    /// The largest share of a colour's light that was still on its way when the image began; 0 where paths end before.
    fn residual(&self) -> f64 {
        let shares = self.power.iter().zip(self.first_power).filter(|(_, first)| *first > 0.0);
        shares.map(|(power, first)| power / first).fold(0.0, f64::max)
    }

    /// Figures of the patches and their form factors.
    pub fn figures(&self) -> Result<PatchReport> {
        let columns = self.mesh.columns() as usize;
        let counts: Vec<u32> = self.met.read(self.mesh.patches.len() * columns)?;
        let mut report = PatchReport::new(&self.mesh, &counts, self.surfaces);
        report.rays = self.rays;
        report.rounds = self.prepared.unwrap_or(self.rounds) + if self.prepared.is_some() { self.rounds } else { 0 };
        report.residual = if self.open_ended { self.residual() } else { 0.0 };
        Ok(report)
    }
}

impl TechniqueState for Radiosity {
    fn table(&self) -> u64 {
        self.table.address()
    }

    /// The round that the image shows.
    fn word(&self, _: u32) -> u32 {
        self.rounds.saturating_sub(1)
    }

    /// Each sample shows patches in a state of their own.
    fn limits(&self) -> FrameLimits {
        FrameLimits { samples: 1, ..FrameLimits::NONE }
    }

    fn next_job(&self, sample: u32, most: u64) -> Option<Job> {
        let is_ready = self.prepared.is_some() && self.rounds > sample;
        if self.prepared == Some(0) || is_ready {
            return None;
        }
        let preparing = self.prepared.is_none();
        let samples = match self.task {
            Task::Albedo => ALBEDO_RAYS,
            Task::Gather | Task::Shoot if preparing => (self.rays / FEWER).max(1),
            Task::Gather | Task::Shoot => self.rays,
            Task::Collect | Task::Vertices => 1,
        };
        let fit = (self.pace.fits().min(most) / u64::from(samples)).next_multiple_of(u64::from(WORKGROUP));
        let (first, left) = (self.cursor, self.extent() - self.cursor);
        let count = u32::try_from(fit).unwrap_or(u32::MAX).max(WORKGROUP).min(left);
        let word = self.rounds | if preparing { PREPARING_BIT } else { 0 };
        let about = format!("{count} patches from {first}, round {word}");
        Some(Job { pass: self.task.pass(), first, count, samples, word, about })
    }

    fn job_done(&mut self, job: &Job, took: Duration) -> Result<()> {
        self.pace.took(u64::from(job.count) * u64::from(job.samples), took);
        self.cursor += job.count;
        if self.cursor < self.extent() {
            return Ok(());
        }
        self.cursor = 0;
        match (self.task, self.prepared) {
            (Task::Albedo, _) => {
                self.albedos = self.albedo.read(self.mesh.patches.len())?;
                self.task = self.first_task();
            }
            (Task::Shoot, _) => self.task = Task::Collect,
            (Task::Gather | Task::Collect, None) => self.end_preparing_round()?,
            // The round counts once the vertices have it.
            (Task::Gather | Task::Collect, Some(_)) => self.task = Task::Vertices,
            (Task::Vertices, _) => {
                self.rounds += 1;
                self.task = self.first_task();
            }
        }
        Ok(())
    }

    /// Forgets all light; albedos stay.
    fn restart(&mut self, _: u32) -> Result<()> {
        self.received.clear()?;
        self.met.clear()?;
        self.arriving.clear()?;
        (self.cursor, self.rounds) = (0, 0);
        if self.prepared != Some(0) {
            self.prepared = None;
        }
        self.task = if self.albedos.is_empty() { Task::Albedo } else { self.first_task() };
        Ok(())
    }

    /// All light, and how far the round at hand is.
    fn exchange(&mut self, stream: &mut StateStream, _: bool) -> Result<()> {
        let mut task = self.task as u32;
        let (mut prepared, mut has_albedos) = (self.prepared.unwrap_or(NONE), u32::from(!self.albedos.is_empty()));
        stream.numbers([&mut task, &mut self.cursor, &mut self.rounds, &mut prepared, &mut has_albedos])?;
        stream.reals(self.first_power.iter_mut().chain(&mut self.power))?;
        for buffer in [&self.newest, &self.received, &self.albedo, &self.met, &self.arriving, &self.at_vertices] {
            stream.buffer(buffer)?;
        }
        if stream.restores() {
            let found = Task::ALL.into_iter().find(|known| *known as u32 == task);
            stream.check(found.is_some(), || {
                format!("task {task} of the patches: valid are 0 to {}", Task::ALL.len() - 1)
            })?;
            self.task = found.unwrap_or(Task::Albedo);
            self.prepared = (prepared != NONE).then_some(prepared);
            if has_albedos > 0 {
                self.albedos = self.albedo.read(self.mesh.patches.len())?;
            }
            let (cursor, extent) = (self.cursor, self.extent());
            stream.check(cursor <= extent, || format!("place {cursor} among the patches: valid are 0 to {extent}"))?;
        }
        Ok(())
    }

    fn report(&self) -> Result<Option<StateReport>> {
        self.figures()?.report().map(Some)
    }

    fn trial(&self) -> Option<&dyn Trial> {
        (self.trials > 0).then_some(self)
    }
}

impl Trial for Radiosity {
    fn doing(&self) -> &'static str {
        "quartering patches"
    }

    /// Quarters patches where irradiance differs from one to the next, and tries again, until it differs nowhere or they are small enough.
    fn next(&self) -> Result<NextState> {
        let uneven = self.uneven()?;
        let trials = if uneven.is_some() { self.trials - 1 } else { 0 };
        let quartered = uneven.unwrap_or_else(|| self.quartered.clone());
        Ok(Box::new(move |context| Ok(Box::new(Self::new(context, quartered, trials)?))))
    }
}

/// Rays of a patch in a round.
fn rays(settings: &Settings, patches: u64) -> u32 {
    let asked = settings.technique.number(&row::RAYS);
    if asked >= 1.0 {
        return asked as u32;
    }
    (settings.pixels() / patches.max(1)).clamp(1, MOST_RAYS).next_power_of_two() as u32
}

/// Whether the patches' rays find all emission by themselves: there is much of it, and nothing else shines.
fn is_found(scene: &Scene, mesh: &PatchMesh) -> bool {
    let Some(emitting) = scene.lights.iter().map(area).sum::<Option<f64>>() else { return false };
    let front = mesh.patches.iter().filter(|patch| patch.back == 0 && patch.face != NONE);
    let all: f64 = front.map(|patch| f64::from(patch.area)).sum();
    scene.background.is_none() && emitting >= FOUND_FROM * all
}
