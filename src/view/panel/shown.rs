//! What is shown: exposure and colours, layers, and what is known of a pixel.

use egui::{Color32, ComboBox, RichText, Slider, Ui};

use super::WIDTH;
use crate::image::srgb_byte;
use crate::render::aovs::AOVS;
use crate::techniques::LONGEST;
use crate::view::display::{Curve, FALSE_COLOUR_RANGE, false_colour};
use crate::view::layer::Layer;
use crate::view::news::{Facts, Traced};
use crate::view::state::State;
use crate::view::wanted::Layers;

/// Segments up to which layers by path length are offered.
const MOST_LENGTHS: u32 = 16;

pub(super) fn display(ui: &mut Ui, state: &mut State) {
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

pub(super) fn layers(ui: &mut Ui, state: &mut State, facts: &Facts) {
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

pub(super) fn pixel(ui: &mut Ui, state: &State) {
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
