//! What the viewer says of what happens, line by line.

use std::time::Instant;

use crate::view::inspect::Inspection;
use crate::view::news::Doing;
use crate::view::state::State;

/// What has been told already.
#[derive(Default)]
struct Told {
    /// The scene of the last picture, what made it, and with which shaders.
    picture_of: Option<(u64, String, u64)>,
    losses: u32,
    trouble: Option<String>,
    /// What the compiler said last of the shaders.
    shader_error: Option<String>,
    /// The scene, the camera and the shaders of the last picture that had enough samples.
    done: Option<(u64, u64, u64)>,
    notice: Option<String>,
    pixel: Option<Inspection>,
}

/// Says each thing once.
pub(super) struct Telling {
    tell: Box<dyn Fn(&str)>,
    began: Instant,
    told: Told,
}

impl Telling {
    pub fn new(tell: Box<dyn Fn(&str)>, began: Instant) -> Self {
        Self { tell, began, told: Told::default() }
    }

    /// Says a line.
    pub fn tell(&self, line: &str) {
        (self.tell)(line);
    }

    /// Says what came of what the user did since the last time; whether there is a new notice.
    pub fn tell_actions(&mut self, state: &State) -> bool {
        if let Some(found) = state.inspection.as_ref().filter(|found| self.told.pixel.as_ref() != Some(*found)) {
            let ([x, y], [r, g, b]) = (found.pixel, found.value);
            self.tell(&format!("pixel {x},{y}: {r} {g} {b}"));
            self.told.pixel = Some(found.clone());
        }
        let is_new = state.notice.is_some() && state.notice != self.told.notice;
        if is_new {
            self.told.notice.clone_from(&state.notice);
            state.notice.iter().for_each(|notice| self.tell(notice));
        }
        is_new
    }

    /// Says what the worker has told since the last time.
    pub fn tell_news(&mut self, state: &State) {
        let (news, told, tell) = (&state.news, &mut self.told, &self.tell);
        if news.losses > told.losses {
            told.losses = news.losses;
            tell(&format!("losses of the device so far: {}", news.losses));
        }
        if news.trouble != told.trouble {
            told.trouble.clone_from(&news.trouble);
            news.trouble.iter().for_each(|trouble| tell(trouble));
        }
        if news.shader_error != told.shader_error {
            told.shader_error.clone_from(&news.shader_error);
            // A line for each of its messages.
            news.shader_error.iter().flat_map(|error| error.lines()).for_each(|line| tell(&format!("shaders: {line}")));
        }
        let (Some(picture), Some(facts)) = (&news.picture, &news.facts) else { return };
        let of = (picture.scene_number, picture.made_by.clone(), picture.shaders);
        if facts.scene_number == picture.scene_number && told.picture_of.as_ref() != Some(&of) {
            tell(&format!(
                "picture of {} after {:.2} s: {}x{} by {}{}, {:.1} spp",
                facts.scene.display(),
                self.began.elapsed().as_secs_f64(),
                picture.image.width,
                picture.image.height,
                of.1,
                if picture.shaders > 0 { " with changed shaders" } else { "" },
                picture.spp
            ));
            told.picture_of = Some(of);
        }
        let done = Some((picture.scene_number, picture.camera_number, picture.shaders))
            .filter(|_| news.doing == Doing::Resting);
        if !state.wanted.is_paused && done.is_some() && told.done != done {
            let place = if state.wanted.camera.is_none() { "the scene's camera" } else { "elsewhere" };
            tell(&format!("done: {:.0} spp from {place}", picture.spp));
            told.done = done;
        }
    }
}
