//! What the window keeps: what is wanted, what there was to tell, how it is shown, and what keys and pointer do to it.

use std::path::PathBuf;
use std::sync::Arc;

use egui::{Align2, Color32, Context, FontId, Key, PointerButton, Pos2, Rect, Response, Sense, Ui, Vec2};

use super::camera::Viewpoint;
use super::display::Display;
use super::inspect::{Inspection, inspect};
use super::interface::PICTURE;
use super::news::{Doing, Facts, News, Picture, Traced};
use super::wanted::{Asked, Wanted};

/// Radians of a turn for each point that the pointer moves.
const TURN: f32 = 0.008;
/// Radii of the scene that one flies in a second.
const SPEED: f32 = 0.6;
/// Factor on speed while shift is held.
const FAST: f32 = 4.0;
/// Factor on the distance for one point of scrolling.
const DOLLY: f32 = 0.004;
/// Steps of exposure, in powers of two.
const EXPOSURE_STEP: f32 = 0.5;

/// What each key does, for the panel and the manual.
pub(super) const KEYS: [(&str, &str); 11] = [
    ("left drag", "orbit; with Ctrl look around"),
    ("right, middle drag", "pan"),
    ("wheel", "nearer, farther"),
    ("W A S D, E C", "fly; E up, C down; Shift faster"),
    ("R", "back to the scene's camera"),
    ("Space", "rest, go on"),
    ("+ -", "exposure; 0 resets it"),
    ("F", "false colour"),
    ("P, F12", "screenshot: PNG and EXR"),
    ("click", "trace a pixel's brightest sample"),
    ("Esc, Q", "quit"),
];

/// What the window keeps.
pub(super) struct State {
    pub wanted: Wanted,
    /// What was wanted last of the scene that is there: another one may be of no use.
    last_good: Option<Wanted>,
    pub news: News,
    pub display: Display,
    /// Where the user stands; nothing until there is a scene.
    pub viewpoint: Option<Viewpoint>,
    pub inspection: Option<Inspection>,
    /// What came of what the user did last.
    pub notice: Option<String>,
    /// Whether the worker is to be told what is wanted.
    pub is_changed: bool,
    /// Whether a screenshot is asked for.
    pub shoots: bool,
    pub quits: bool,
    /// Scenes that were opened so far, each of which has a number of its own.
    scenes: u64,
    /// What the viewpoint was made for.
    stands_in: Option<(u64, Option<String>)>,
    /// How the picture lies in the window.
    pub place: Rect,
}

impl State {
    pub fn new(wanted: Wanted, news: News) -> Self {
        Self {
            wanted,
            last_good: None,
            news,
            display: Display::default(),
            viewpoint: None,
            inspection: None,
            notice: None,
            is_changed: false,
            shoots: false,
            quits: false,
            scenes: 0,
            stands_in: None,
            place: Rect::NOTHING,
        }
    }

    pub fn facts(&self) -> Option<Arc<Facts>> {
        self.news.facts.clone()
    }

    /// Takes in what the worker has told.
    pub fn hear(&mut self, news: News) {
        self.news = news;
        let Some(facts) = self.facts() else { return };
        if facts.scene_number == self.wanted.scene_number {
            self.last_good = Some(self.wanted.clone());
            let here = Some((facts.scene_number, self.wanted.choice.overrides.camera.clone()));
            if self.stands_in != here {
                self.viewpoint = Some(Viewpoint::new(&facts.camera, facts.core));
                self.stands_in = here;
                self.inspection = None;
            }
        } else if self.news.failed_scene == Some(self.wanted.scene_number) {
            // The scene that was opened last is of no use: back to the one before.
            self.notice.clone_from(&self.news.trouble);
            if let Some(good) = self.last_good.clone() {
                let now = &self.wanted;
                // But for what has been counted or looked at since.
                self.wanted = Wanted {
                    camera: now.camera.clone(),
                    camera_number: now.camera_number,
                    asked: now.asked,
                    is_paused: now.is_paused,
                    ..good
                };
            }
            self.is_changed = true;
        }
    }

    /// Opens another scene, by its technique and its camera.
    pub fn open(&mut self, scene: PathBuf) {
        self.notice = Some(format!("opening {}", scene.display()));
        let own = &mut self.wanted;
        own.options.format = None;
        if own.scene != scene {
            own.options.defines.clear();
        }
        own.scene = scene;
        self.scenes += 1;
        own.scene_number = self.scenes;
        own.choice.overrides.camera = None;
        (own.choice.overrides.technique, own.choice.overrides.rr_q) = (None, None);
        own.reference = None;
        self.stay();
    }

    /// Reads the scene's file again.
    pub fn reload(&mut self) {
        self.scenes += 1;
        self.wanted.scene_number = self.scenes;
        self.stay();
    }

    /// Looks through the scene's camera, where that is another one than before.
    pub fn stay(&mut self) {
        self.wanted.camera = None;
        self.wanted.camera_number += 1;
        self.is_changed = true;
    }

    /// Looks from where the viewpoint is now.
    fn move_camera(&mut self) {
        let Some(viewpoint) = &self.viewpoint else { return };
        self.wanted.camera = Some(viewpoint.camera());
        self.wanted.camera_number += 1;
        self.is_changed = true;
    }

    /// What keys do that are pressed or held now.
    pub fn keys(&mut self, context: &Context) {
        if context.wants_keyboard_input() {
            return;
        }
        context.input(|input| {
            self.quits |= input.key_pressed(Key::Escape) || input.key_pressed(Key::Q);
            self.shoots |= input.key_pressed(Key::P) || input.key_pressed(Key::F12);
            if input.key_pressed(Key::Space) {
                self.wanted.is_paused = !self.wanted.is_paused;
                self.is_changed = true;
            }
            if input.key_pressed(Key::F) {
                self.display.false_colour = !self.display.false_colour;
            }
            if input.key_pressed(Key::Plus) || input.key_pressed(Key::Equals) {
                self.display.exposure += EXPOSURE_STEP;
            }
            if input.key_pressed(Key::Minus) {
                self.display.exposure -= EXPOSURE_STEP;
            }
            if input.key_pressed(Key::Num0) {
                self.display.exposure = 0.0;
            }
            if input.key_pressed(Key::R) {
                if let Some(viewpoint) = &mut self.viewpoint {
                    viewpoint.reset();
                }
                self.stay();
            }
        });
        self.fly(context);
    }

    fn fly(&mut self, context: &Context) {
        let by = context.input(|input| {
            let axis = |more, less| f32::from(i8::from(input.key_down(more)) - i8::from(input.key_down(less)));
            let step = SPEED * input.stable_dt.min(0.1) * if input.modifiers.shift { FAST } else { 1.0 };
            [axis(Key::D, Key::A), axis(Key::E, Key::C), axis(Key::W, Key::S)].map(|way| way * step)
        });
        if by == [0.0; 3] {
            return;
        }
        if let Some(viewpoint) = &mut self.viewpoint {
            viewpoint.fly(by.map(f64::from));
            self.move_camera();
        }
        context.request_repaint(); // for as long as the key is held
    }

    /// The picture in the room that there is, and what the pointer does there.
    pub fn show_picture(&mut self, ui: &mut Ui) {
        let room = ui.available_rect_before_wrap();
        let Some(picture) = self.news.picture.clone() else {
            ui.centered_and_justified(|ui| ui.label(egui::RichText::new(self.doing()).size(18.0)));
            return;
        };
        let size = Vec2::new(picture.image.width as f32, picture.image.height as f32);
        let scale = (room.width() / size.x).min(room.height() / size.y).max(f32::MIN_POSITIVE);
        self.place = Rect::from_center_size(room.center(), size * scale);
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        ui.painter().image(PICTURE, self.place, whole, Color32::WHITE);
        if let Some(found) = &self.inspection {
            let at =
                self.place.min + (Vec2::new(found.pixel[0] as f32, found.pixel[1] as f32) + Vec2::splat(0.5)) * scale;
            ui.painter().circle_stroke(at, 5.0, (1.5, Color32::WHITE));
            ui.painter().circle_stroke(at, 6.5, (1.0, Color32::BLACK));
        }
        if let Some(traced) = self.traced().filter(|traced| traced.camera_number == picture.camera_number) {
            overlay(ui, &traced, self.place.min, scale);
        }
        if let Some(error) = &self.news.shader_error {
            shader_error(ui, error, room);
        }
        let response = ui.allocate_rect(room, Sense::click_and_drag());
        self.pointer(&response, scale, &picture, ui.ctx());
    }

    fn pointer(&mut self, response: &Response, scale: f32, picture: &Picture, context: &Context) {
        let by = response.drag_delta();
        let scrolled = if response.hovered() { context.input(|input| input.smooth_scroll_delta.y) } else { 0.0 };
        let size = [picture.image.width, picture.image.height];
        let Some(viewpoint) = &mut self.viewpoint else { return };
        let mut is_moved = true;
        let turns = response.dragged_by(PointerButton::Primary);
        if turns && context.input(|input| input.modifiers.ctrl) {
            viewpoint.look(f64::from(-by.x * TURN), f64::from(-by.y * TURN));
        } else if turns && by != Vec2::ZERO {
            viewpoint.orbit(f64::from(by.x * TURN), f64::from(by.y * TURN));
        } else if (response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle))
            && by != Vec2::ZERO
        {
            viewpoint.pan([by.x, by.y].map(|points| f64::from(points / scale)), size);
        } else if scrolled != 0.0 {
            viewpoint.dolly(f64::from((-scrolled * DOLLY).exp()));
        } else {
            is_moved = false;
        }
        if is_moved {
            self.move_camera();
        }
        if let (true, Some(at), Some(facts)) = (response.clicked(), response.interact_pointer_pos(), self.facts()) {
            let place = (at - self.place.min) / scale;
            let is_inside = self.place.contains(at);
            let pixel = [place.x as u32, place.y as u32];
            self.inspection = is_inside.then(|| inspect(pixel, picture, &facts, &self.wanted)).flatten();
            if self.inspection.is_some() {
                let number = self.wanted.asked.map_or(1, |asked| asked.number + 1);
                self.wanted.asked = Some(Asked { number, pixel });
                self.is_changed = true;
            }
        }
    }

    /// What happened in the pixel that was clicked on, once that is known.
    pub fn traced(&self) -> Option<Arc<Traced>> {
        self.inspection.as_ref()?;
        let asked = self.wanted.asked?;
        self.news.traced.clone().filter(|traced| traced.number == asked.number)
    }

    /// What the worker is at, in words.
    pub fn doing(&self) -> String {
        match &self.news.doing {
            Doing::Loading => String::from("reading the scene"),
            Doing::Building(what, share) => {
                share.map_or_else(|| (*what).to_owned(), |share| format!("{what}, {:.0} %", 100.0 * share))
            }
            Doing::Rendering => String::from("rendering"),
            Doing::Resting if self.wanted.is_paused => String::from("resting: Space goes on"),
            Doing::Resting => String::from("done"),
            Doing::Failed(why) => why.clone(),
        }
    }
}

/// Draws subpaths over the picture: the camera's blue, lights' orange, a dot and a number at each vertex.
fn overlay(ui: &Ui, traced: &Traced, corner: Pos2, scale: f32) {
    let Ok(trace) = &traced.trace else { return };
    let painter = ui.painter();
    for (subpath, places) in trace.subpaths.iter().zip(&traced.places) {
        let colour = if subpath.from_light { Color32::from_rgb(255, 150, 40) } else { Color32::from_rgb(90, 170, 255) };
        let at = |place: [f32; 2]| corner + Vec2::new(place[0], place[1]) * scale;
        for pair in places.windows(2) {
            if let [Some(from), Some(to)] = pair {
                painter.line_segment([at(*from), at(*to)], (3.0, Color32::from_black_alpha(160)));
                painter.line_segment([at(*from), at(*to)], (1.5, colour));
            }
        }
        for (index, place) in places.iter().enumerate() {
            let Some(place) = place else { continue };
            painter.circle_filled(at(*place), 4.0, Color32::BLACK);
            painter.circle_filled(at(*place), 3.0, colour);
            let beside = at(*place) + Vec2::new(6.0, -6.0);
            painter.text(beside, Align2::LEFT_BOTTOM, index, FontId::monospace(12.0), colour);
        }
    }
}

/// Shows what the compiler says of shaders, over the last good picture.
fn shader_error(ui: &Ui, error: &str, room: Rect) {
    let text =
        ui.painter().layout(error.trim_end().to_owned(), FontId::monospace(12.0), Color32::WHITE, room.width() - 40.0);
    let place = Rect::from_min_size(room.min + Vec2::splat(12.0), text.size() + Vec2::splat(16.0));
    ui.painter().rect_filled(place, 4.0, Color32::from_rgba_unmultiplied(120, 0, 0, 220));
    ui.painter().galley(place.min + Vec2::splat(8.0), text, Color32::WHITE);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::backend::Backend;
    use crate::scene::{LoadOptions, load};
    use crate::techniques::{Overrides, Settings, Technique};
    use crate::view::layer::Layer;
    use crate::view::wanted::Choice;

    /// However many of them: what the scene that is there was opened with is wanted again. A scene that opens has its own.
    #[test]
    fn scenes_that_fail_leave_what_was_asked_of_the_one_before() {
        let file = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/furnace_sphere.xml"));
        let options = LoadOptions { defines: vec![(String::from("spp"), String::from("4"))], ..LoadOptions::default() };
        let scene = load(&file, &options).unwrap();
        let news = |scene_number: u64, failed_scene: Option<u64>| News {
            doing: Doing::Rendering,
            trouble: None,
            facts: Some(Arc::new(Facts {
                scene_number,
                scene: file.clone(),
                cameras: Vec::new(),
                camera: scene.cameras[0].clone(),
                core: (glam::DVec3::ZERO, 1.0),
                warnings: Vec::new(),
                settings: Settings::new(&scene, Technique::parse("path").unwrap(), Backend::Bvh),
                device: 0,
                devices: Vec::new(),
            })),
            picture: None,
            traced: None,
            shader_error: None,
            losses: 0,
            failed_scene,
        };
        let overrides = Overrides { technique: Some(String::from("bdpt")), ..Overrides::default() };
        let wanted = Wanted {
            scene: file.clone(),
            options: options.clone(),
            scene_number: 0,
            device: None,
            choice: Choice { overrides: overrides.clone(), ..Choice::default() },
            camera: None,
            camera_number: 0,
            layer: Layer::Image,
            reference: Some(PathBuf::from("truth.exr")),
            is_paused: false,
            asked: None,
            shaders: None,
            spp: None,
        };
        let mut state = State::new(wanted, news(0, None));
        state.hear(news(0, None));
        state.open(PathBuf::from("broken.obj"));
        state.open(PathBuf::from("broken.ply"));
        assert!(state.wanted.options.defines.is_empty() && state.wanted.choice.overrides.technique.is_none());
        state.hear(news(0, Some(2)));
        let asked = |state: &State| {
            let own = &state.wanted;
            (
                own.scene.clone(),
                own.scene_number,
                own.options.defines.clone(),
                own.choice.overrides.clone(),
                own.reference.clone(),
            )
        };
        assert_eq!(asked(&state), (file.clone(), 0, options.defines, overrides, Some(PathBuf::from("truth.exr"))));
        // Another one that opens, and is broken when it is read again, keeps its own.
        state.open(file.clone());
        state.hear(news(3, None));
        let opened = asked(&state);
        state.reload();
        state.hear(news(3, Some(4)));
        assert_eq!(asked(&state), opened);
        assert_eq!(opened.3.technique, None);
    }
}
