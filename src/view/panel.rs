//! The panel at the side of the picture.

use egui::{Color32, ComboBox, DragValue, Grid, RichText, ScrollArea, Slider, Ui};

use super::display::{Curve, FALSE_COLOUR_RANGE, false_colour};
use super::layer::Layer;
use super::news::{Doing, Facts, Picture, Traced};
use super::state::{KEYS, State};
use super::wanted::Layers;
use crate::image::srgb_byte;
use crate::layout::backend::BACKENDS;
use crate::render::aovs::AOVS;
use crate::techniques::{LONGEST, TECHNIQUES, Technique, Values};

/// Width of the panel in points.
pub(super) const WIDTH: f32 = 300.0;
/// Segments up to which layers by path length are offered.
const MOST_LENGTHS: u32 = 16;
/// Depth that a limit begins with.
const FIRST_DEPTH: u32 = 8;

const TROUBLE: Color32 = Color32::from_rgb(255, 120, 90);
const WARNING: Color32 = Color32::from_rgb(235, 190, 90);

/// All of the panel.
pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        ui.add_space(6.0);
        head(ui, state);
        section(ui, "Rendering", |ui| figures(ui, state));
        if let Some(facts) = state.facts() {
            section(ui, "Technique", |ui| technique(ui, state, &facts));
            section(ui, "Settings", |ui| settings(ui, state, &facts));
            section(ui, "Display", |ui| display(ui, state));
            section(ui, "Layers", |ui| layers(ui, state, &facts));
            section(ui, "Pixel", |ui| pixel(ui, state));
        }
        egui::CollapsingHeader::new("Keys").default_open(false).show(ui, |ui| {
            Grid::new("keys").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
                for (key, what) in KEYS {
                    ui.label(RichText::new(key).monospace());
                    ui.label(what);
                    ui.end_row();
                }
            });
        });
        ui.add_space(6.0);
    });
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true).show(ui, content);
}

fn head(ui: &mut Ui, state: &mut State) {
    let name = state.wanted.scene.file_name().unwrap_or_default().to_string_lossy().into_owned();
    ui.heading(name);
    ui.horizontal(|ui| {
        if matches!(state.news.doing, Doing::Loading | Doing::Building(..)) {
            ui.spinner();
        }
        if !matches!(state.news.doing, Doing::Failed(_)) {
            ui.label(state.doing());
        }
    });
    for text in state.news.trouble.iter() {
        ui.label(RichText::new(text).color(TROUBLE));
    }
    if state.news.losses > 0 {
        ui.label(RichText::new(format!("losses of the device so far: {}", state.news.losses)).color(WARNING));
    }
    for text in state.news.facts.iter().flat_map(|facts| &facts.warnings) {
        ui.label(RichText::new(text).color(WARNING).small());
    }
    ui.horizontal(|ui| {
        let rests = state.wanted.is_paused;
        if ui.button(if rests { "Go on" } else { "Rest" }).clicked() {
            state.wanted.is_paused = !rests;
            state.is_changed = true;
        }
        state.shoots |= ui.button("Screenshot").clicked();
        if ui.button("Reload").on_hover_text("Reads the scene's file again").clicked() {
            state.reload();
        }
    });
    if let Some(notice) = &state.notice {
        ui.label(RichText::new(notice).small());
    }
}

/// A number with three digits and a unit of thousands.
fn short(number: f64) -> String {
    match number {
        n if n >= 1e9 => format!("{:.2} G", n / 1e9),
        n if n >= 1e6 => format!("{:.2} M", n / 1e6),
        n if n >= 1e3 => format!("{:.1} k", n / 1e3),
        n => format!("{n:.0}"),
    }
}

fn figures(ui: &mut Ui, state: &State) {
    let Some(picture) = &state.news.picture else {
        ui.label("no picture yet");
        return;
    };
    Grid::new("figures").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(name);
            ui.label(RichText::new(value).monospace());
            ui.end_row();
        };
        row("image", format!("{} x {}", picture.image.width, picture.image.height));
        row("samples per pixel", format!("{:.1}", picture.spp));
        row("samples per second", short(picture.rate));
        row("seconds", format!("{:.1}", picture.seconds));
        row("relMSE, estimated", estimate(picture));
        if let Some(error) = picture.error {
            row("relMSE, to reference", format!("{error:.3e}"));
        }
        if picture.nonfinite > 0 {
            row("dropped samples", picture.nonfinite.to_string());
        }
    });
}

fn estimate(picture: &Picture) -> String {
    match picture.estimate {
        Some(found) if found.is_at_least() => format!("{:.3e} or more", found.relmse),
        Some(found) => format!("{:.3e}", found.relmse),
        None => String::from("unknown"),
    }
}

fn technique(ui: &mut Ui, state: &mut State, facts: &Facts) {
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
            let id = ui.id().with(("draft", name));
            let known: f32 = value.parse().unwrap_or(*least);
            let mut draft = ui.data(|data| data.get_temp(id)).unwrap_or(known);
            let speed = (draft.abs() * 0.02).max((most - least).abs().min(1.0) * 0.005);
            let response = ui.add(DragValue::new(&mut draft).range(*least..=*most).speed(speed));
            if response.dragged() || response.has_focus() {
                ui.data_mut(|data| data.insert_temp(id, draft));
                return None;
            }
            ui.data_mut(|data| data.remove_temp::<f32>(id));
            (draft != known).then(|| draft.to_string())
        }
    }
}

fn settings(ui: &mut Ui, state: &mut State, facts: &Facts) {
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
                    let range = Values::Number(0.0, 1024.0, 0.0);
                    if let Some(changed) = value_of(ui, "depth", &range, &known.to_string()) {
                        depth = changed.parse::<f32>().ok().map(|depth| depth.round() as u32);
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

fn display(ui: &mut Ui, state: &mut State) {
    let display = &mut state.display;
    ui.add(Slider::new(&mut display.exposure, -8.0..=8.0).step_by(0.1).text("exposure"));
    ui.horizontal(|ui| {
        for (name, curve) in Curve::ALL {
            ui.radio_value(&mut display.curve, curve, name);
        }
    });
    ui.checkbox(&mut display.false_colour, "false colour of luminance");
    if display.false_colour {
        legend(ui);
    }
}

/// The false colours with the luminance that they stand for.
fn legend(ui: &mut Ui) {
    const STEPS: usize = 64;
    let (rect, _) = ui.allocate_exact_size(egui::vec2(WIDTH - 50.0, 12.0), egui::Sense::hover());
    for step in 0..STEPS {
        let [r, g, b] = false_colour((step as f32 + 0.5) / STEPS as f32).map(srgb_byte);
        let across = |at: usize| rect.left() + rect.width() * at as f32 / STEPS as f32;
        let part = egui::Rect::from_x_y_ranges(across(step)..=across(step + 1), rect.y_range());
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    let [first, last] = FALSE_COLOUR_RANGE.map(f32::exp2);
    ui.horizontal(|ui| {
        ui.label(RichText::new(format!("{first:.3}")).small());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add_space(14.0);
            ui.label(RichText::new(format!("{last:.1}")).small());
        });
    });
}

fn layers(ui: &mut Ui, state: &mut State, facts: &Facts) {
    let before = (state.wanted.choice.clone(), state.wanted.layer);
    ui.horizontal(|ui| {
        let choice = &mut state.wanted.choice;
        ui.label("keep");
        ui.selectable_value(&mut choice.layers, Layers::Nothing, "none");
        let lengths = facts.settings.max_depth.unwrap_or(MOST_LENGTHS).clamp(1, MOST_LENGTHS);
        if ui.selectable_label(matches!(choice.layers, Layers::Lengths(_)), "lengths").clicked() {
            choice.layers = Layers::Lengths(lengths);
        }
        let tells = facts.settings.technique.row.tells_strategies;
        let is_own = matches!(choice.layers, Layers::Strategies(_));
        let strategies = ui.add_enabled(tells, egui::Button::selectable(is_own, "strategies"));
        if strategies.on_disabled_hover_text("This technique has no strategies to tell apart").clicked() {
            choice.layers = Layers::Strategies(LONGEST);
        }
        ui.checkbox(&mut choice.has_aovs, "AOVs");
    });
    let mut all = vec![Layer::Image, Layer::Deviation];
    if state.wanted.reference.is_some() {
        all.push(Layer::Difference);
    }
    all.extend((1..=facts.settings.lengths).map(Layer::Length));
    for strategy in facts.settings.strategies.iter().flat_map(|own| own.all()) {
        let (s, t) = (strategy.s, strategy.t);
        all.extend([true, false].map(|weighted| Layer::Strategy { s, t, weighted }));
    }
    if state.wanted.choice.has_aovs {
        all.extend(AOVS.iter().map(|row| Layer::Aov(row.name)));
    }
    if !all.contains(&state.wanted.layer) {
        state.wanted.layer = Layer::Image;
    }
    ui.horizontal(|ui| {
        ui.label("show");
        let width = WIDTH - 100.0;
        ComboBox::from_id_salt("layer").width(width).selected_text(state.wanted.layer.name()).show_ui(ui, |ui| {
            for layer in all {
                ui.selectable_value(&mut state.wanted.layer, layer, layer.name());
            }
        });
    });
    state.is_changed |= before != (state.wanted.choice.clone(), state.wanted.layer);
}

fn pixel(ui: &mut Ui, state: &State) {
    let Some(found) = &state.inspection else {
        ui.label(RichText::new("click on the picture").weak());
        return;
    };
    let [x, y] = found.pixel;
    ui.label(RichText::new(format!("{x}, {y}")).monospace());
    for (name, value) in ["R", "G", "B"].iter().zip(found.value) {
        ui.label(RichText::new(format!("{name} {value:.6}")).monospace());
    }
    let mut command = found.command.as_str();
    ui.add(egui::TextEdit::multiline(&mut command).font(egui::TextStyle::Monospace).desired_rows(2));
    if state.wanted.camera.is_some() {
        ui.label(RichText::new("the command looks through the file's camera; this one has been moved").weak());
    }
    match state.traced().as_deref() {
        None => {
            ui.label(RichText::new("tracing its brightest sample").weak());
        }
        Some(Traced { trace: Err(why), .. }) => {
            ui.label(why);
        }
        Some(Traced { trace: Ok(trace), .. }) => {
            let text = crate::trace::text(trace);
            egui::ScrollArea::both().max_height(320.0).id_salt("trace").show(ui, |ui| {
                let lines = RichText::new(text.trim_end()).monospace().size(11.0);
                ui.add(egui::Label::new(lines).wrap_mode(egui::TextWrapMode::Extend).selectable(true));
            });
        }
    }
}
