//! Images: all variants side by side at equal time and at equal samples, and any two of them over each other.

use super::chart::key;
use super::html::escape;
use super::number;
use super::pictures::Pictures;
use crate::bench::results::{Cell, Row, SceneResults};

/// The rows that the scene has.
pub fn rows(scene: &SceneResults, pictures: &Pictures) -> String {
    let time = scene.equal_time.as_ref().map(|row| row_of(scene, row, &after_time(row), pictures));
    let spp = scene.equal_spp.as_ref().map(|row| row_of(scene, row, &after_samples(row), pictures));
    time.into_iter().chain(spp).collect()
}

fn after_time(row: &Row) -> String {
    format!("{} s", number::figure(row.at))
}

fn after_samples(row: &Row) -> String {
    format!("{} samples per pixel", number::samples(row.at))
}

fn row_of(scene: &SceneResults, row: &Row, at: &str, pictures: &Pictures) -> String {
    let cells: String = row.cells.iter().map(|cell| cell_of(scene, cell, at, pictures)).collect();
    // As many rows as six columns take, all of about the same length.
    let columns = row.cells.len().div_ceil(row.cells.len().div_ceil(6).max(1)).max(2);
    let scale = row.cells.first().map_or(f64::NAN, |cell| cell.heat_scale);
    format!(
        "<div class=\"slide\">\n<h3>All after {at}</h3>\n<div class=\"cells\" style=\"--columns: {columns}\">\n{cells}</div>\n\
         <p class=\"scale\"><span>−{0}</span> <span class=\"ramp\" role=\"img\" aria-label=\"blue where too dark, white where equal, \
         red where too bright\"></span> <span>+{0}</span> <span class=\"quiet\">Heat maps: relative difference from the reference, \
         blue where too dark, red where too bright; full colour is {0} and beyond.</span></p>\n</div>\n",
        number::figure(scale)
    )
}

fn cell_of(scene: &SceneResults, cell: &Cell, at: &str, pictures: &Pictures) -> String {
    let index = scene.variants.iter().position(|variant| variant.name == cell.variant).unwrap_or(0);
    let name = &cell.variant;
    format!(
        "<figure class=\"cell\">\n<h4>{} {}</h4>\n<div class=\"views\">\n{}\n{}\n{}\n</div>\n<figcaption>\
         <span><strong>{}</strong> relMSE</span> <span>{} spp</span> <span>{} s</span></figcaption>\n</figure>\n",
        key(index),
        escape(name),
        pictures.show(&cell.picture, &format!("{} by {name} after {at}", scene.name)),
        pictures.show(&cell.crop, &format!("a part of it, enlarged: {name} after {at}")),
        pictures.show(&cell.heat_map, &format!("where {name} differs from the reference after {at}")),
        number::figure(cell.relmse),
        number::samples(cell.spp),
        number::figure(cell.seconds),
    )
}

/// Any two images of the scene over each other; the script makes the stage work.
pub fn comparison(index: usize, scene: &SceneResults, pictures: &Pictures) -> String {
    let mut choices = vec![(pictures.id(&scene.reference.picture), String::from("reference"))];
    let rows = [
        scene.equal_time.as_ref().map(|row| (row, after_time(row))),
        scene.equal_spp.as_ref().map(|row| (row, after_samples(row))),
    ];
    for (row, at) in rows.into_iter().flatten() {
        for cell in &row.cells {
            choices.push((pictures.id(&cell.picture), format!("{}, {at}", cell.variant)));
        }
    }
    if let Some(map) = &scene.reference.difference_map {
        choices.push((pictures.id(map), String::from("where the witness differs from the reference")));
    }
    if choices.len() < 2 {
        return String::new();
    }
    let select = |name: &str, label: &str, selected: usize| {
        let options: String = choices
            .iter()
            .enumerate()
            .map(|(number, (id, text))| {
                let chosen = if number == selected { " selected=\"selected\"" } else { "" };
                format!("<option value=\"{id}\"{chosen}>{}</option>\n", escape(text))
            })
            .collect();
        format!("<label>{label} <select class=\"{name}\">\n{options}</select></label>\n")
    };
    format!(
        "<div class=\"compare needs-script\">\n<h3>Two images over each other</h3>\n<div class=\"controls\">\n{left}{right}\
         <fieldset class=\"switch\"><legend>As</legend>\n\
         <label><input type=\"radio\" name=\"mode-{index}\" value=\"slide\" checked=\"checked\"/> slider</label>\n\
         <label><input type=\"radio\" name=\"mode-{index}\" value=\"flip\"/> flip</label>\n</fieldset>\n</div>\n\
         <div class=\"stage\" style=\"--shape: {width} / {height}; --natural: {width}px\" tabindex=\"0\" role=\"group\" \
         aria-label=\"Two images over each other: arrow keys move the divider, space flips\"></div>\n\
         <label class=\"divider\">Divider <input type=\"range\" min=\"0\" max=\"100\" step=\"0.5\" value=\"50\"/></label>\n\
         <p class=\"quiet hint\" aria-live=\"polite\"></p>\n</div>\n",
        left = select("left", "Left", 1),
        right = select("right", "Right", 0),
        width = scene.width.max(1),
        height = scene.height.max(1),
    )
}
