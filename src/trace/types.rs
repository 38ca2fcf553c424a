//! What there is to tell of a sample.

use serde::Serialize;

/// One sample of one pixel, with the paths that made it.
#[derive(Clone, Debug, Serialize)]
pub struct Trace {
    /// The scene's file.
    pub scene: String,
    /// The technique with its parameters.
    pub integrator: String,
    /// The ray backend.
    pub backend: String,
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Index of the sample within the pixel.
    pub sample: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Weight that the pixel filter gives the sample.
    pub filter_weight: f64,
    /// What the film takes: radiance in W/(m² sr) times that weight.
    pub value: [f64; 3],
    /// What the contributions of the camera's paths, times the filter's weight, and the splats add up to: the same but for rounding.
    pub sum: [f64; 3],
    /// The subpaths that were followed, the camera's first.
    pub subpaths: Vec<Subpath>,
    /// Of bidirectional techniques: the strategies (s, t) of the pixel's own subpaths. Of Metropolis light transport that mutates one strategy at a time: those of
    /// `proposal`.
    pub strategies: Vec<StrategyContribution>,
    /// What the camera's paths add, before the filter's weight.
    pub contributions: Vec<Contribution>,
    /// What light subpaths and chains add to the pixel from elsewhere, weighted, the filter included.
    pub splats: Vec<Splat>,
    /// Of Metropolis light transport: the visits of chains to the pixel.
    pub visits: Vec<Visit>,
    /// Of Metropolis light transport, where there are visits: the proposal that made the path of the visit which adds most. The subpaths are that path's.
    pub proposal: Option<Proposal>,
}

/// A subpath, from the camera or from a light.
#[derive(Clone, Debug, Serialize)]
pub struct Subpath {
    /// Whether it comes from a light.
    pub from_light: bool,
    /// The light subpath's number.
    pub index: u32,
    /// Where it begins.
    pub beginning: Beginning,
    /// Its vertices.
    pub vertices: Vec<Vertex>,
    /// The background that it has left the scene to, where that emits.
    pub background: Option<Emission>,
}

impl Subpath {
    /// Its last vertex, in world coordinates.
    pub fn end(&self) -> [f64; 3] {
        self.vertices.last().map_or(self.beginning.position, |vertex| vertex.position)
    }

    /// Whether its last ray meets nothing.
    pub fn leaves_the_scene(&self) -> bool {
        let goes_on =
            |vertex: &Vertex| !vertex.scatterings.is_empty() && !vertex.roulette.is_some_and(|roulette| roulette.ends);
        self.background.is_some() || self.vertices.last().is_some_and(goes_on)
    }
}

/// Where a subpath begins.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Beginning {
    /// The point, in world coordinates.
    pub position: [f64; 3],
    /// The direction in which it leaves.
    pub direction: [f64; 3],
    /// Of a light subpath: emitted radiance and cosine over the density of the choice, W.
    pub power: Option<[f64; 3]>,
    /// Of a light subpath: density of the point per area, of parallel light of the ray per area across.
    pub pdf_a: Option<f64>,
}

/// A vertex of a subpath.
#[derive(Clone, Debug, Serialize)]
pub struct Vertex {
    /// Its place on the subpath, 1 is the first after the beginning.
    pub index: u32,
    /// The point, in world coordinates.
    pub position: [f64; 3],
    /// The geometric normal there, unit; nothing but zeros at a light without extent.
    pub normal: [f64; 3],
    /// The direction that the path came from, unit.
    pub towards_previous: [f64; 3],
    /// The shape's name.
    pub shape: Option<String>,
    /// The material's name and kind; nothing where it reflects nothing.
    pub material: Option<String>,
    /// Product of f |cos| / pdf, roulette and absorption up to here.
    pub throughput: [f64; 3],
    /// What the path has run into here.
    pub emission: Option<Emission>,
    /// Lights that were sampled from here.
    pub light_samples: Vec<LightSample>,
    /// The directions in which the path goes on: one, but where a technique follows all branches.
    pub scatterings: Vec<Scattering>,
    /// Russian roulette after that.
    pub roulette: Option<Roulette>,
}

/// Emission that a path has run into.
#[derive(Clone, Debug, Serialize)]
pub struct Emission {
    /// Emitted radiance, W/(m² sr); of a delta light its intensity, W/sr, or irradiance, W/m².
    pub radiance: [f64; 3],
    /// Throughput that multiplies it.
    pub throughput: [f64; 3],
    /// Density with which the BSDF chooses the direction, per solid angle; nothing where a delta lobe or the camera does, or the light is a delta.
    pub pdf_w: Option<f64>,
    /// Density with which next-event estimation picks it, per solid angle; of a chain that mutates paths, a light subpath's beginning. 0 of a delta light.
    pub light_pdf_w: f64,
    /// Whether no direction hits the light by chance.
    pub is_delta: bool,
    /// MIS weight; 1 of a chain that mutates paths, where all ways to make a path are in [`Proposal::share`].
    pub mis_weight: f64,
}

/// Next-event estimation: one light sample.
#[derive(Clone, Debug, Serialize)]
pub struct LightSample {
    /// The point on the light, in world coordinates; nothing where the light is infinitely far away.
    pub position: Option<[f64; 3]>,
    /// The direction to it.
    pub direction: [f64; 3],
    /// f |cos| of the BSDF.
    pub f_cos: [f64; 3],
    /// Radiance over density, of a delta light irradiance over probability, times what comes through.
    pub radiance_over_pdf: [f64; 3],
    /// Density of the sample per solid angle, of a delta light the probability of choosing it.
    pub pdf: f64,
    /// Whether no direction hits the light by chance.
    pub is_delta: bool,
    /// Density with which the BSDF picks the direction, per solid angle.
    pub bsdf_pdf_w: f64,
    /// MIS weight.
    pub mis_weight: f64,
    /// Share of light that comes through; 0 is shadow.
    pub transmittance: f64,
    /// Throughput times all of that: what it adds.
    pub contribution: [f64; 3],
}

/// The direction in which a path goes on.
#[derive(Clone, Debug, Serialize)]
pub struct Scattering {
    /// The direction, unit.
    pub direction: [f64; 3],
    /// f |cos| / pdf.
    pub weight: [f64; 3],
    /// Density per solid angle, of a delta lobe the probability of choosing it; 1 where a chain that mutates paths aims at a delta light.
    pub pdf: f64,
    /// `delta`, `narrow` or `broad`.
    pub lobe: &'static str,
    /// Whether it goes to the other side of the surface.
    pub transmits: bool,
    /// Throughput after it.
    pub throughput: [f64; 3],
}

/// Russian roulette.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Roulette {
    /// Probability of going on.
    pub survival: f64,
    /// Whether the path ends.
    pub ends: bool,
}

/// A strategy of bidirectional techniques.
#[derive(Clone, Debug, Serialize)]
pub struct StrategyContribution {
    /// Vertices from the light.
    pub s: u32,
    /// Vertices from the camera.
    pub t: u32,
    /// `connected`, `merged` or `candidate`: one of those that one ray is traced for, whose visibility is not known.
    pub how: &'static str,
    /// The contribution by itself.
    pub contribution: [f64; 3],
    /// MIS weight; of a connection that stands for several candidates, times what it stands for.
    pub mis_weight: f64,
}

/// What paths of one length add.
#[derive(Clone, Debug, Serialize)]
pub struct Contribution {
    /// Segments; 1 also where photons of several lengths were merged at once.
    pub segments: u32,
    /// The contribution.
    pub value: [f64; 3],
}

/// What comes to the pixel from elsewhere.
#[derive(Clone, Debug, Serialize)]
pub struct Splat {
    /// Number of the light subpath, or of the chain.
    pub source: u32,
    /// Vertices from the light; of a chain nothing.
    pub s: Option<u32>,
    /// Vertices from the camera; of a chain nothing.
    pub t: Option<u32>,
    /// What is added, weighted.
    pub value: [f64; 3],
    /// MIS weight, or of a chain the probability of the visit.
    pub weight: f64,
}

/// A chain at the pixel.
#[derive(Clone, Debug, Serialize)]
pub struct Visit {
    /// Its number.
    pub chain: u32,
    /// Its mutation.
    pub mutation: u32,
    /// The mutation that proposed the path: the same of a proposal, an earlier one of the path that the chain was at, 0 of the bootstrap sample that the
    /// chain began at.
    pub proposed_by: u32,
    /// Whether this is the proposal, rather than the path that the chain was at.
    pub is_proposal: bool,
    /// Probability with which the proposal was accepted.
    pub acceptance: f64,
    /// Probability of this visit: that, or one less it.
    pub probability: f64,
    /// The path's contribution.
    pub contribution: [f64; 3],
    /// What the visit adds.
    pub value: [f64; 3],
}

/// What a chain has proposed: a path.
#[derive(Clone, Debug, Serialize)]
pub struct Proposal {
    /// The chain's number.
    pub chain: u32,
    /// The mutation, as [`Visit::proposed_by`] has it.
    pub mutation: u32,
    /// The sort of mutation: `bootstrap sample`, `large step`, `large step until a light is met`, `small step`, `bidirectional mutation`, `lens
    /// perturbation`, `multi-chain perturbation` or `caustic perturbation`.
    pub sort: &'static str,
    /// What the value of the path's subpaths and strategies is multiplied by to be the visit's contribution, which is over the density of
    /// large steps: one over their density, over that with which the value is weighted.
    pub share: f64,
}
