//! A small room for tests of light transport: a floor, a wall, a block and a ball, of Mitsuba's elements.

use lumbre::scene::{LoadOptions, Scene};

/// A scene of these Mitsuba elements.
pub fn scene(elements: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.xml");
    std::fs::write(&file, format!("<scene version='3.0.0'>{elements}</scene>")).unwrap();
    lumbre::scene::load(&file, &LoadOptions::default()).unwrap()
}

/// A floor, a wall that stands across it, and a block and a ball of these materials.
pub fn room(block: &str, ball: &str) -> String {
    format!(
        "<bsdf type='twosided' id='white'><bsdf type='diffuse'><rgb name='reflectance' value='0.7, 0.6, 0.5'/></bsdf></bsdf>
         <shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/></transform><ref id='white'/></shape>
         <shape type='rectangle'><transform name='to_world'><scale value='3'/><translate z='-1.5'/></transform><ref id='white'/></shape>
         <shape type='cube'><transform name='to_world'><scale value='0.5'/><rotate y='1' angle='30'/><translate x='-0.9' y='0.52'/></transform>{block}</shape>
         <shape type='sphere'><point name='center' x='0.8' y='0.6' z='0.2'/><float name='radius' value='0.6'/>{ball}</shape>"
    )
}

/// A lamp under the ceiling.
pub const LAMP: &str = "<shape type='rectangle'><transform name='to_world'><scale value='0.6'/><rotate x='1' angle='90'/>
    <translate y='2.6'/></transform><bsdf type='diffuse'/><emitter type='area'><rgb name='radiance' value='9, 8, 7'/></emitter></shape>";

/// A name and what it stands for.
pub type Named = (&'static str, &'static str);

/// The materials two by two, the last with the first: each in a room with another.
pub fn material_pairs() -> Vec<(Named, Named)> {
    let pair = |index: usize| (MATERIALS[index], MATERIALS[(index + 1) % MATERIALS.len()]);
    (0..MATERIALS.len()).step_by(2).map(pair).collect()
}

/// Materials that reflect and refract in every way: rough, smooth, coated, mixed, with holes.
pub const MATERIALS: [Named; 9] = [
    ("rough metal", "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf>"),
    ("glass", "<bsdf type='dielectric'/>"),
    ("rough glass", "<bsdf type='roughdielectric'><float name='alpha' value='0.4'/></bsdf>"),
    ("thin glass", "<bsdf type='thindielectric'/>"),
    ("plastic", "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.2, 0.5, 0.3'/></bsdf>"),
    ("rough plastic", "<bsdf type='roughplastic'><float name='alpha' value='0.3'/></bsdf>"),
    (
        "principled",
        "<bsdf type='principled'><rgb name='base_color' value='0.7, 0.4, 0.2'/><float name='roughness' value='0.5'/>
         <float name='clearcoat' value='0.6'/><float name='spec_trans' value='0.5'/></bsdf>",
    ),
    (
        "a blend",
        "<bsdf type='blendbsdf'><float name='weight' value='0.4'/><bsdf type='diffuse'/>
         <bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf></bsdf>",
    ),
    ("a mask", "<bsdf type='mask'><float name='opacity' value='0.4'/><bsdf type='diffuse'/></bsdf>"),
];
