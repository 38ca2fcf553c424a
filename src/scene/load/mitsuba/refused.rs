//! What Mitsuba has and this renderer has not, each with the reason.

/// A kind of element and plugins of it; none stands for all of them.
type Plugins = (&'static str, &'static [&'static str]);

/// Reasons, with the plugins that they hold for; a kind of element stands for all of its plugins.
const REFUSED: [(&str, &[Plugins]); 8] = [
    (
        "participating media are not supported",
        &[("medium", &[]), ("phase", &[]), ("volume", &[]), ("texture", &["volume"])],
    ),
    (
        "polarisation is not supported",
        &[
            ("bsdf", &["circular", "measured_polarized", "polarizer", "pplastic", "retarder"]),
            ("integrator", &["stokes"]),
        ],
    ),
    ("hair is not supported", &[("bsdf", &["hair"])]),
    ("measured materials are not supported", &[("bsdf", &["measured"])]),
    ("curves are not supported", &[("shape", &["bsplinecurve", "linearcurve"])]),
    (
        "signed distance fields and ellipsoids are not supported",
        &[("shape", &["sdfgrid", "ellipsoids", "ellipsoidsmesh"])],
    ),
    (
        "a model of the sky is not supported: an image of it can be an envmap",
        &[("emitter", &["sunsky", "timed_sunsky"])],
    ),
    (
        "sensors are perspective, thinlens and orthographic, and films hdrfilm",
        &[("sensor", &["batch", "distant", "irradiancemeter", "radiancemeter"]), ("film", &["specfilm"])],
    ),
];

/// Integrators that compute derivatives.
const OF_DERIVATIVES: [&str; 8] = [
    "prb",
    "prb_basic",
    "prbvolpath",
    "direct_projective",
    "prb_projective",
    "emission_reparam",
    "direct_reparam",
    "volprim_rf_basic",
];

/// Why a plugin is refused, if that is known.
pub(super) fn reason(tag: &str, plugin: &str) -> Option<&'static str> {
    if tag == "integrator" && OF_DERIVATIVES.contains(&plugin) {
        return Some("derivatives are not computed");
    }
    let holds = |kinds: &[Plugins]| {
        kinds.iter().any(|(kind, plugins)| *kind == tag && (plugins.is_empty() || plugins.contains(&plugin)))
    };
    REFUSED.iter().find(|(_, kinds)| holds(kinds)).map(|(reason, _)| *reason)
}
