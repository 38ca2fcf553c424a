//! What is rendered with: the technique with its parameters, and the settings.

use std::ops::RangeInclusive;

use egui::{ComboBox, DragValue, Grid, RichText, Ui};

use super::WIDTH;
use crate::layout::backend::BACKENDS;
use crate::techniques::{TECHNIQUES, Technique, Values};
use crate::view::layer::Layer;
use crate::view::news::Facts;
use crate::view::state::State;
use crate::view::wanted::Layers;

/// The largest limit that is offered.
const MOST_DEPTH: f32 = 1024.0;
/// Depth that a limit begins with.
const FIRST_DEPTH: u32 = 8;

pub(super) fn technique(ui: &mut Ui, state: &mut State, facts: &Facts) {
    let mut wanted = facts.settings.technique.clone();
    ComboBox::from_id_salt("technique").width(WIDTH - 60.0).selected_text(facts.settings.technique.row.name).show_ui(
        ui,
        |ui| {
            for row in TECHNIQUES {
                let is_own = row.name == facts.settings.technique.row.name;
                let chosen = ui.selectable_label(is_own, row.name).on_hover_text(row.title).clicked();
                if let (true, false, Ok(technique)) = (chosen, is_own, Technique::parse(row.name)) {
                    wanted = technique;
                }
            }
        },
    );
    ui.label(RichText::new(facts.settings.technique.row.title).small().weak());
    Grid::new("parameters").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        for parameter in wanted.row.parameters {
            let value = wanted.value(parameter.name).unwrap_or_default().to_owned();
            ui.label(parameter.name).on_hover_text(parameter.about);
            if let Some(changed) = value_of(ui, parameter.name, &parameter.values, &value) {
                // It is one of those that are offered.
                let _ = wanted.set(parameter.name, &changed);
            }
            ui.end_row();
        }
    });
    if wanted.full() != facts.settings.technique.full() {
        let overrides = &mut state.wanted.choice.overrides;
        (overrides.technique, overrides.rr_q) = (Some(wanted.full()), None); // which it tells as well
        if !wanted.row.tells_strategies && matches!(state.wanted.choice.layers, Layers::Strategies(_)) {
            state.wanted.choice.layers = Layers::Nothing;
            state.wanted.layer = Layer::Image;
        }
        state.is_changed = true;
    }
}

/// Asks for the value of a parameter; another one, once the user is done with it.
fn value_of(ui: &mut Ui, name: &str, values: &Values, value: &str) -> Option<String> {
    match values {
        Values::Choice(words) => {
            let mut chosen = None;
            ComboBox::from_id_salt(("parameter", name)).selected_text(value).show_ui(ui, |ui| {
                for word in *words {
                    if ui.selectable_label(*word == value, *word).clicked() {
                        chosen = Some((*word).to_owned());
                    }
                }
            });
            chosen
        }
        Values::Number(least, most, _) => {
            let known: f32 = value.parse().unwrap_or(*least);
            number(ui, name, *least..=*most, None, known).map(|changed| changed.to_string())
        }
    }
}

/// Asks for a number with at most so many decimals; another one, once the user is done with it.
fn number(ui: &mut Ui, name: &str, range: RangeInclusive<f32>, decimals: Option<usize>, known: f32) -> Option<f32> {
    let id = ui.id().with(("draft", name));
    let mut draft = ui.data(|data| data.get_temp(id)).unwrap_or(known);
    let whole = (range.end() - range.start()).abs().min(1.0);
    let speed = (draft.abs() * 0.02).max(whole * 0.005);
    let response = ui.add(
        DragValue::new(&mut draft).range(range).clamp_existing_to_range(false).speed(speed).max_decimals_opt(decimals),
    );
    if response.dragged() || response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, draft));
        return None;
    }
    ui.data_mut(|data| data.remove_temp::<f32>(id));
    (draft != known).then_some(draft)
}

pub(super) fn settings(ui: &mut Ui, state: &mut State, facts: &Facts) {
    let before = (state.wanted.choice.clone(), state.wanted.device.clone());
    Grid::new("settings").num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
        let choice = &mut state.wanted.choice.overrides;
        ui.label("backend");
        ComboBox::from_id_salt("backend").selected_text(facts.settings.backend.name()).show_ui(ui, |ui| {
            for row in BACKENDS {
                if ui.selectable_label(row.backend == facts.settings.backend, row.name).clicked() {
                    choice.backend = Some(row.name.to_owned());
                }
            }
        });
        ui.end_row();
        ui.label("device");
        let name = |index: usize| facts.devices.get(index).map_or("?", String::as_str);
        ComboBox::from_id_salt("device").width(170.0).truncate().selected_text(name(facts.device)).show_ui(ui, |ui| {
            for index in 0..facts.devices.len() {
                if ui.selectable_label(index == facts.device, name(index)).clicked() && index != facts.device {
                    state.wanted.device = Some(index.to_string());
                }
            }
        });
        ui.end_row();
        ui.label("sampler");
        ComboBox::from_id_salt("sampler").selected_text(facts.settings.sampler.name()).show_ui(ui, |ui| {
            for row in facts.settings.technique.row.samplers() {
                let is_own = row.sampler == facts.settings.sampler;
                if ui.selectable_label(is_own, row.name).on_hover_text(row.about).clicked() && !is_own {
                    choice.sampler = Some(row.sampler);
                }
            }
        });
        ui.end_row();
        ui.label("depth").on_hover_text("Longest path in segments: 1 is emission only, 2 adds direct light");
        ui.horizontal(|ui| {
            let mut depth = facts.settings.max_depth;
            let mut is_limited = depth.is_some();
            ui.checkbox(&mut is_limited, "");
            match (is_limited, depth) {
                (false, _) => {
                    ui.label("no limit");
                    depth = None;
                }
                (true, None) => depth = Some(FIRST_DEPTH),
                (true, Some(known)) => {
                    if let Some(changed) = number(ui, "depth", 0.0..=MOST_DEPTH, Some(0), known as f32) {
                        depth = Some(changed.round() as u32);
                    }
                }
            }
            if depth != facts.settings.max_depth {
                choice.max_depth = Some(depth);
            }
        });
        ui.end_row();
        if facts.cameras.len() > 1 {
            ui.label("camera");
            let current = choice.camera.clone().unwrap_or_else(|| String::from("0"));
            let shown = facts.cameras.get(current.parse::<usize>().unwrap_or(usize::MAX)).unwrap_or(&current);
            ComboBox::from_id_salt("camera").width(170.0).truncate().selected_text(shown).show_ui(ui, |ui| {
                for (index, name) in facts.cameras.iter().enumerate() {
                    if ui.selectable_label(name == shown, name).clicked() {
                        choice.camera = Some(index.to_string());
                    }
                }
            });
            ui.end_row();
        }
    });
    let camera_changed = before.0.overrides.camera != state.wanted.choice.overrides.camera;
    if camera_changed {
        state.stay();
    }
    state.is_changed |= before != (state.wanted.choice.clone(), state.wanted.device.clone());
}
