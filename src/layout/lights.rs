//! The kinds of light, each declared once.
//!
//! A row makes the kind's constant, its specialisation constant, its words in reports, and its branches in `shaders/lights/light.glsl` by
//! way of `generated/lights.glsl`.

/// A kind of light.
#[derive(Clone, Copy, Debug)]
pub struct LightKind {
    /// The name of its constant; the value is its place in [`LIGHTS`].
    pub constant: &'static str,
    /// The name of the specialisation constant: whether the scene has any.
    pub feature: &'static str,
    /// Several of them in reports.
    pub word: &'static str,
    /// One of them in reports, and what the names of its functions in GLSL begin with: `PREFIX_light_sample`, `PREFIX_light_emit` in
    /// `shaders/lights/PREFIX.glsl`.
    pub prefix: &'static str,
    /// Whether no direction hits it by chance: it has no extent, or no spread of directions.
    pub delta: bool,
}

/// Rows are `CONSTANT FEATURE, WORD = PREFIX area|delta;`.
macro_rules! lights {
    ($( $(#[$doc:meta])* $constant:ident $feature:ident, $word:literal = $prefix:ident $form:ident; )*) => {
        enum Index { $( $constant ),* }
        $( $(#[$doc])* pub const $constant: u32 = Index::$constant as u32; )*

        /// The kinds of light, by their constants.
        pub const LIGHTS: &[LightKind] = &[$( LightKind {
            constant: stringify!($constant),
            feature: stringify!($feature),
            word: $word,
            prefix: stringify!($prefix),
            delta: lights!(@is_delta $form),
        } ),*];
    };
    (@is_delta area) => { false };
    (@is_delta delta) => { true };
}

lights! {
    /// A triangle that emits from its front.
    LIGHT_TRIANGLE HAS_TRIANGLE_LIGHTS, "triangle lights" = triangle area;
    /// A sphere that emits outwards.
    LIGHT_SPHERE HAS_SPHERE_LIGHTS, "sphere lights" = sphere area;
    /// An isotropic point.
    LIGHT_POINT HAS_POINT_LIGHTS, "point lights" = point delta;
    /// A point with a cone.
    LIGHT_SPOT HAS_SPOT_LIGHTS, "spot lights" = spot delta;
    /// Parallel light from infinitely far.
    LIGHT_DIRECTIONAL HAS_DIRECTIONAL_LIGHTS, "directional lights" = directional delta;
    /// A point that projects a texture.
    LIGHT_PROJECTOR HAS_PROJECTORS, "projectors" = projector delta;
}

/// How many kinds of light there are.
pub const LIGHT_KINDS: usize = LIGHTS.len();

/// The text of `generated/lights.glsl`: the files of all lights, and macros that branch by the kind of a light.
pub fn lights_glsl() -> String {
    let mut text = String::from("// Generated from src/layout/lights.rs.\n\n");
    for kind in LIGHTS {
        text += &format!("#include \"lights/{}.glsl\"\n", kind.prefix);
    }
    let mut branches = |about: &str, head: &str, result: &str, call: &str, area: &str, delta: &str| {
        text += &format!("\n// {about}\n#define {head}");
        for LightKind { constant, feature, prefix, delta: is_delta, .. } in LIGHTS {
            let rest = if *is_delta { delta } else { area };
            if !rest.is_empty() {
                text += &format!(
                    " \\\n    if ({feature} && light.kind == {constant}) {result} = {prefix}_light_{call}({rest});"
                );
            }
        }
        text.push('\n');
    };
    branches("Samples an area light.", "SAMPLE_AREA_LIGHT(s, light, p, u)", "s", "sample", "light, p, u", "");
    branches("Samples a delta light.", "SAMPLE_DELTA_LIGHT(s, light, p)", "s", "sample", "", "light, p");
    let (area, delta) = ("light, position, direction", "light, direction");
    branches(
        "The beginning of a light subpath.",
        "EMIT_LIGHT(e, light, position, direction)",
        "e",
        "emit",
        area,
        delta,
    );
    let each = |delta: bool| LIGHTS.iter().filter(move |kind| kind.delta == delta);
    let join = |all: Vec<String>, how: &str, none: &str| if all.is_empty() { none.to_owned() } else { all.join(how) };
    text += &format!(
        "\n// Whether a light has no extent or no spread of directions.\n#define IS_DELTA_LIGHT(light) ({})\n",
        join(each(false).map(|kind| format!("light.kind != {}", kind.constant)).collect(), " && ", "true")
    );
    text += &format!(
        "\n// Some light is one of these.\nconst bool HAS_DELTA_LIGHTS = {};\n",
        join(each(true).map(|kind| kind.feature.to_owned()).collect(), " || ", "false")
    );
    text
}
