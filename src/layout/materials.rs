//! The kinds of material, each declared once.
//!
//! A row makes the kind's constant, its specialisation constant, its word in reports, and its branches in `shaders/materials/bsdf.glsl`
//! by way of `generated/materials.glsl`. A material without textures is its GLSL file, a row here, and a loader that fills in a
//! [`super::Material`] of its kind.

use super::arrays;

/// What a kernel must know of a BSDF besides its functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trait {
    /// Every lobe is a delta: there is a function to sample it, and none to evaluate it.
    AllDelta,
    /// Some lobe is a delta, others are not.
    SomeDelta,
    /// Its samples are left open: weight and density are evaluated by whoever samples it.
    OpenSamples,
    /// It has a lobe whose width is the [`super::Material`]'s `alpha_u` and `alpha_v`.
    Rough,
    /// The [`super::Material`]'s `alpha_u` and `alpha_v` hold perceptual roughness, the root of alpha, which may be 0.
    PerceptualRoughness,
    /// It has two lobes, a delta among them, between which the third of a sample's random numbers decides: `whitted` follows both.
    TwoLobes,
    /// Its functions are long to compile: kernels hold each of them once where they can.
    LongToCompile,
}

/// The functions of a BSDF in GLSL.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    /// What their names begin with: `PREFIX_sample`, `PREFIX_eval`, `PREFIX_pdf` in `shaders/materials/PREFIX.glsl`.
    pub prefix: &'static str,
    /// The shared struct that they take beside the [`super::Material`], whose `detail` is its index in the scene's array of these, and the
    /// member of the GLSL struct `Bsdf` that holds it.
    pub detail: Option<(&'static str, &'static str)>,
    /// What else is to be known.
    pub traits: &'static [Trait],
}

/// A kind of material.
#[derive(Clone, Copy, Debug)]
pub struct MaterialKind {
    /// The name of its constant; the value is its place in [`MATERIALS`].
    pub constant: &'static str,
    /// The name of the specialisation constant: whether the scene has any.
    pub feature: &'static str,
    /// Its word in reports.
    pub word: &'static str,
    /// Its functions; none of blends, which are resolved before.
    pub bsdf: Option<Bsdf>,
}

impl MaterialKind {
    /// Whether its BSDF has a trait.
    pub fn has(&self, wanted: Trait) -> bool {
        self.bsdf.is_some_and(|bsdf| bsdf.traits.contains(&wanted))
    }
}

/// Rows are `CONSTANT FEATURE, WORD = PREFIX(DETAIL MEMBER) [TRAITS];`.
macro_rules! materials {
    ($(
        $(#[$doc:meta])*
        $constant:ident $feature:ident, $word:literal
        $(= $prefix:ident( $($detail:ident $member:ident)? ) [$($trait:ident),*])?;
    )*) => {
        enum Index { $( $constant ),* }
        $( $(#[$doc])* pub const $constant: u32 = Index::$constant as u32; )*

        /// The kinds of material, by their constants.
        pub const MATERIALS: &[MaterialKind] = &[$( MaterialKind {
            constant: stringify!($constant),
            feature: stringify!($feature),
            word: $word,
            bsdf: materials!(@bsdf $($prefix [$(stringify!($detail), stringify!($member))?] [$(Trait::$trait),*])?),
        } ),*];
    };
    (@bsdf) => { None };
    (@bsdf $prefix:ident [] $traits:expr) => {
        Some(Bsdf { prefix: stringify!($prefix), detail: None, traits: &$traits })
    };
    (@bsdf $prefix:ident [$($detail:tt)+] $traits:expr) => {
        Some(Bsdf { prefix: stringify!($prefix), detail: Some(($($detail)+)), traits: &$traits })
    };
}

materials! {
    /// Lambertian reflection.
    MATERIAL_DIFFUSE HAS_DIFFUSE, "diffuse" = diffuse() [];
    /// A mirror of metal.
    MATERIAL_CONDUCTOR HAS_CONDUCTOR, "conductor" = conductor() [AllDelta];
    /// A rough metal (GGX).
    MATERIAL_ROUGH_CONDUCTOR HAS_ROUGH_CONDUCTOR, "rough conductor" = rough_conductor() [Rough, LongToCompile];
    /// Smooth glass.
    MATERIAL_DIELECTRIC HAS_DIELECTRIC, "dielectric" = dielectric() [AllDelta, TwoLobes];
    /// Rough glass (GGX).
    MATERIAL_ROUGH_DIELECTRIC HAS_ROUGH_DIELECTRIC, "rough dielectric" = rough_dielectric() [Rough, LongToCompile];
    /// A thin sheet of glass, met once.
    MATERIAL_THIN_DIELECTRIC HAS_THIN_DIELECTRIC, "thin dielectric" = thin_dielectric() [AllDelta, TwoLobes];
    /// A diffuse base under a smooth coating.
    MATERIAL_PLASTIC HAS_PLASTIC, "plastic" = plastic(Plastic plastic) [SomeDelta, TwoLobes];
    /// A diffuse base under a rough coating (GGX).
    MATERIAL_ROUGH_PLASTIC HAS_ROUGH_PLASTIC, "rough plastic" = rough_plastic(Plastic plastic)
        [Rough, OpenSamples, LongToCompile];
    /// Burley's principled BSDF.
    MATERIAL_PRINCIPLED HAS_PRINCIPLED, "principled" = principled(Principled principled)
        [Rough, PerceptualRoughness, OpenSamples, LongToCompile];
    /// Burley's principled BSDF of a thin sheet.
    MATERIAL_PRINCIPLED_THIN HAS_PRINCIPLED_THIN, "principled (thin)" = principled_thin(Principled principled)
        [Rough, PerceptualRoughness, OpenSamples, LongToCompile];
    /// The layered material of glTF.
    MATERIAL_LAYERED HAS_LAYERED, "layered (glTF)" = layered(Layered layered)
        [Rough, PerceptualRoughness, OpenSamples, LongToCompile];
    /// One of two materials, by chance.
    MATERIAL_BLEND HAS_BLENDS, "blends";
}

/// A lobe of microfacets is narrow where the geometric mean of its two alphas is below this. The techniques that can only evaluate a lobe for directions that
/// they are given (photons, virtual point lights, connections to the camera) take narrow ones for what they take mirrors for: `shaders/materials/lobes.glsl`.
pub const NARROW_ALPHA: f32 = 0.03;

/// How many kinds of material there are.
pub const MATERIAL_KINDS: usize = MATERIALS.len();

/// The text of `generated/materials.glsl`: the files of all BSDFs, and macros that branch by the kind of a material. They are macros, and
/// not functions, for a call would copy the whole material.
pub fn materials_glsl() -> String {
    let mut text = String::from("// Generated from src/layout/materials.rs.\n\n");
    let rows: Vec<(&MaterialKind, Bsdf)> =
        MATERIALS.iter().filter_map(|kind| kind.bsdf.map(|bsdf| (kind, bsdf))).collect();
    for (_, bsdf) in &rows {
        text += &format!("#include \"materials/{}.glsl\"\n", bsdf.prefix);
    }
    let is = |kind: &MaterialKind| format!("is_kind(b, {}, {})", kind.feature, kind.constant);
    let either = |all: Vec<String>| if all.is_empty() { String::from("false") } else { all.join(" || ") };
    let with = |wanted: Trait| rows.iter().filter(move |(kind, _)| kind.has(wanted)).map(|(kind, _)| *kind);

    let mut details: Vec<(&str, &str)> = Vec::new();
    for detail in rows.iter().filter_map(|(_, bsdf)| bsdf.detail) {
        if !details.contains(&detail) {
            details.push(detail);
        }
    }
    text += "\n// Members of Bsdf: what materials have besides a Material.\n#define BSDF_DETAILS";
    for (kind, member) in &details {
        text += &format!(" \\\n    {kind} {member};");
    }
    text += "\n\n// Reads those of b.m.\n#define LOAD_BSDF_DETAILS(b)";
    for detail in &details {
        let kinds: Vec<&MaterialKind> =
            rows.iter().filter(|(_, bsdf)| bsdf.detail == Some(*detail)).map(|(kind, _)| *kind).collect();
        let read = {
            let (buffer, array) = arrays::of_element(detail.0).unwrap_or_default();
            format!("b.{} = {buffer}(scene.{array}).at[b.m.detail];", detail.1)
        };
        text += &match &kinds[..] {
            [kind] => format!(" \\\n    if ({}) {read}", is(kind)),
            // Features first: where a scene has none of the kinds, no comparison is left.
            _ => {
                let present = either(kinds.iter().map(|kind| kind.feature.to_owned()).collect());
                let is_one = either(kinds.iter().map(|kind| format!("b.m.kind == {}", kind.constant)).collect());
                format!(" \\\n    if ({present}) {{ if ({is_one}) {read} }}")
            }
        };
    }
    let arguments = |bsdf: &Bsdf| bsdf.detail.map_or(String::from("b.m"), |(_, member)| format!("b.m, b.{member}"));
    let mut branches = |about: &str, head: &str, result: &str, call: &str, rest: &str, with_delta: bool| {
        text += &format!("\n\n// {about}\n#define {head}");
        for (kind, bsdf) in rows.iter().filter(|(kind, _)| with_delta || !kind.has(Trait::AllDelta)) {
            let (is, prefix, arguments) = (is(kind), bsdf.prefix, arguments(bsdf));
            text += &format!(" \\\n    if ({is}) {result} = {prefix}_{call}({arguments}, {rest});");
        }
    };
    branches("Samples b.", "SAMPLE_BSDF(s, b, wo, u)", "s", "sample", "wo, u", true);
    branches("f |cos_i| of the non-delta lobes of b.", "EVALUATE_BSDF(f, b, wo, wi)", "f", "eval", "wo, wi", false);
    branches("Density of the non-delta lobes of b.", "BSDF_DENSITY(pdf, b, wo, wi)", "pdf", "pdf", "wo, wi", false);
    text += "\n\n// Whether b, a mixture, has a lobe that is broad.\n#define MIXTURE_HAS_BROAD(found, b)";
    for (kind, bsdf) in rows.iter().filter(|(kind, _)| kind.has(Trait::OpenSamples)) {
        text += &format!(" \\\n    if ({}) found = {}_has_broad({});", is(kind), bsdf.prefix, arguments(bsdf));
    }
    text.push('\n');
    for (about, name, wanted) in [
        ("Whether every lobe of b is a delta.", "ALL_LOBES_ARE_DELTA", Trait::AllDelta),
        (
            "Whether b's alpha_u and alpha_v are perceptual roughness.",
            "ROUGHNESS_IS_PERCEPTUAL",
            Trait::PerceptualRoughness,
        ),
        ("Whether b has a lobe whose width is its roughness.", "IS_ROUGH", Trait::Rough),
        ("Whether b is a mixture of lobes, which leaves its samples open.", "IS_MIXTURE", Trait::OpenSamples),
        ("Whether u.z decides between two lobes of b, a delta among them.", "HAS_TWO_LOBES", Trait::TwoLobes),
    ] {
        text += &format!("\n// {about}\n#define {name}(b) ({})\n", either(with(wanted).map(is).collect()));
    }
    for (about, name, wanted) in [
        ("Some material is long to compile.", "HAS_LONG_MATERIAL", Trait::LongToCompile),
        ("Some sample is left open.", "HAS_OPEN_SAMPLES", Trait::OpenSamples),
    ] {
        let features = with(wanted).map(|kind| kind.feature.to_owned()).collect();
        text += &format!("\n// {about}\nconst bool {name} = {};\n", either(features));
    }
    text
}
