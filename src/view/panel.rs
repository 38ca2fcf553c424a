//! The panel at the side of the picture.

mod choices;
mod shown;

use egui::{Color32, Grid, RichText, ScrollArea, Ui};

use super::news::{Doing, Picture};
use super::state::{KEYS, State};

/// Width of the panel in points.
pub(super) const WIDTH: f32 = 300.0;
const TROUBLE: Color32 = Color32::from_rgb(255, 120, 90);
const WARNING: Color32 = Color32::from_rgb(235, 190, 90);

/// All of the panel.
pub(super) fn show(ui: &mut Ui, state: &mut State) {
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        ui.add_space(6.0);
        head(ui, state);
        section(ui, "Rendering", |ui| figures(ui, state));
        if let Some(facts) = state.facts() {
            section(ui, "Technique", |ui| choices::technique(ui, state, &facts));
            section(ui, "Settings", |ui| choices::settings(ui, state, &facts));
            section(ui, "Display", |ui| shown::display(ui, state));
            section(ui, "Layers", |ui| shown::layers(ui, state, &facts));
            section(ui, "Pixel", |ui| shown::pixel(ui, state));
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

/// What is known of the picture; its rows are there before it is, so that what stands below them stays where it is.
fn figures(ui: &mut Ui, state: &State) {
    let picture = state.news.picture.as_deref();
    Grid::new("figures").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: Option<String>| {
            ui.label(name);
            ui.label(RichText::new(value.as_deref().unwrap_or("-")).monospace());
            ui.end_row();
        };
        row("image", picture.map(|own| format!("{} x {}", own.image.width, own.image.height)));
        row("samples per pixel", picture.map(|own| format!("{:.1}", own.spp)));
        row("samples per second", picture.map(|own| short(own.rate)));
        row("seconds", picture.map(|own| format!("{:.1}", own.seconds)));
        row("relMSE, estimated", picture.map(estimate));
        if let Some(error) = picture.and_then(|own| own.error) {
            row("relMSE, to reference", Some(format!("{error:.3e}")));
        }
        if let Some(dropped) = picture.map(|own| own.nonfinite).filter(|dropped| *dropped > 0) {
            row("dropped samples", Some(dropped.to_string()));
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
