//! What the worker and the window share: what is wanted, and what there is to tell.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use crate::error::Error;
use crate::view::news::{Doing, News, Picture};
use crate::view::wanted::Wanted;

struct Inside {
    wanted: Wanted,
    /// Something else is wanted than what the worker was given last.
    is_new: bool,
    quits: bool,
    /// Counts changes of the shaders' files.
    shader_changes: u64,
    news: News,
    /// What went wrong before there was any picture.
    fatal: Option<Error>,
}

/// Behind a lock that is held for moments only.
pub(super) struct Shared {
    inside: Mutex<Inside>,
    changed: Condvar,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Shared {
    pub fn new(wanted: Wanted, wake: Box<dyn Fn() + Send + Sync>) -> Self {
        let news = News {
            doing: Doing::Loading,
            trouble: None,
            facts: None,
            picture: None,
            traced: None,
            shader_error: None,
            losses: 0,
            failed_scene: None,
        };
        let inside = Mutex::new(Inside { wanted, is_new: true, quits: false, shader_changes: 0, news, fatal: None });
        Self { inside, changed: Condvar::new(), wake }
    }

    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.inside.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn want(&self, wanted: Wanted) {
        let mut inside = self.lock();
        inside.wanted = wanted;
        inside.is_new = true;
        self.changed.notify_all();
    }

    /// Takes note that files of shaders have changed.
    pub fn shaders_changed(&self) {
        let mut inside = self.lock();
        inside.shader_changes += 1;
        inside.is_new = true;
        self.changed.notify_all();
    }

    /// How often they have.
    pub fn shader_changes(&self) -> u64 {
        self.lock().shader_changes
    }

    pub fn quit(&self) {
        self.lock().quits = true;
        self.changed.notify_all();
    }

    pub fn news(&self) -> News {
        self.lock().news.clone()
    }

    /// What is wanted now; waits for something new where the worker may rest. Nothing once it is to end. `failed` is cleared where
    /// something else is wanted than what failed.
    pub fn next(&self, may_rest: bool, failed: &mut bool) -> Option<Wanted> {
        let mut inside = self.lock();
        while may_rest && !inside.is_new && !inside.quits {
            inside = self.changed.wait(inside).unwrap_or_else(PoisonError::into_inner);
        }
        if inside.quits {
            return None;
        }
        if std::mem::take(&mut inside.is_new) && *failed {
            *failed = false;
            inside.news.trouble = None;
        }
        Some(inside.wanted.clone())
    }

    /// Changes the news.
    pub fn tell(&self, change: impl FnOnce(&mut News)) {
        change(&mut self.lock().news);
        (self.wake)();
    }

    /// Says what the worker is at, where that is something else than before.
    pub fn tell_doing(&self, doing: Doing) {
        if self.lock().news.doing != doing {
            self.tell(|news| news.doing = doing);
        }
    }

    /// Says what cannot be had. Before there is any picture that is the end of it.
    pub fn fail(&self, error: Error, scene_number: u64) {
        let message = error.to_string();
        {
            let mut inside = self.lock();
            if inside.news.picture.is_none() {
                inside.fatal = Some(error);
            }
        }
        self.tell(|news| {
            news.doing = Doing::Failed(message.clone());
            news.failed_scene = Some(scene_number);
            news.trouble = Some(message);
        });
    }

    /// What went wrong before there was any picture; once.
    pub fn take_fatal(&self) -> Option<Error> {
        self.lock().fatal.take()
    }

    /// Shows a picture, and says what the worker is at: both at once, as a picture is the last one where it rests.
    pub fn show(&self, picture: Picture, doing: Doing) {
        self.tell(|news| {
            news.doing = doing;
            news.picture = Some(Arc::new(picture));
            news.trouble = None;
        });
    }
}
