//! Attributes of PLY files that textures show, by the names that Mitsuba 3 gives them (its documentation of the shape `ply`): properties `red`, `green`,
//! `blue` (or `r`, `g`, `b`) are `vertex_color` or `face_color`; `NAME_x`, `NAME_y`, `NAME_z` (or `0`, `1`, `2`, or `1`, `2`, `3`) are `vertex_NAME`
//! or `face_NAME`, and so is the first of them alone; `NAME_r`, `NAME_g`, `NAME_b` are `vertex_NAME_color`.

use glam::Vec4;
use ply_rs_bw::ply::ElementDef;

use crate::scene::Attribute;

/// What may stand behind a name.
const ENDINGS: [[&str; 3]; 3] = [["x", "y", "z"], ["0", "1", "2"], ["1", "2", "3"]];

/// The properties that make an attribute, and its values so far.
pub(super) struct Column {
    properties: Vec<String>,
    attribute: Attribute,
}

/// The columns of an element, `vertex` or `face`, for those attributes of it that are wanted and that it has.
pub(super) fn columns(element: &ElementDef, wanted: &[String]) -> Vec<Column> {
    let of = |name: &String| {
        let properties = properties(element, name.strip_prefix(element.name.as_str())?.strip_prefix('_')?)?;
        Some(Column { properties, attribute: Attribute { name: name.clone(), values: Vec::new() } })
    };
    wanted.iter().filter_map(of).collect()
}

fn properties(element: &ElementDef, name: &str) -> Option<Vec<String>> {
    let has = |names: &Vec<String>| names.iter().all(|name| element.properties.contains_key(name));
    let plain = |names: [&str; 3]| names.map(str::to_owned).to_vec();
    let with = |name: &str, endings: &[&str]| -> Vec<String> {
        endings.iter().map(|ending| format!("{name}_{ending}")).collect()
    };
    let mut candidates: Vec<Vec<String>> = Vec::new();
    if name == "color" {
        candidates.extend([plain(["r", "g", "b"]), plain(["red", "green", "blue"])]);
    }
    if let Some(stem) = name.strip_suffix("_color") {
        candidates.extend([with(stem, &["r", "g", "b"]), with(stem, &["r"])]);
    }
    candidates.extend(ENDINGS.iter().map(|endings| with(name, endings)));
    candidates.extend(ENDINGS.iter().map(|endings| with(name, &endings[..1])));
    candidates.into_iter().find(has)
}

impl Column {
    /// Takes the values of one vertex or face out of all numbers that it has.
    pub fn take(&mut self, all: &[(String, f32)]) {
        let value = |property: &String| all.iter().find(|(name, _)| name == property).map_or(0.0, |(_, value)| *value);
        let value = match &self.properties[..] {
            [x, y, z] => Vec4::new(value(x), value(y), value(z), 1.0),
            one => Vec4::splat(one.first().map_or(0.0, value)).with_w(1.0),
        };
        self.attribute.values.push(value);
    }

    pub fn into_attribute(self) -> Attribute {
        self.attribute
    }
}
