//! The same room by several techniques at equal time: every command gets the same `-t`.

use std::rc::Rc;

use super::scenes::Room;
use crate::error::Result;
use crate::integrator;
use crate::lecture::lab::Lab;
use crate::lecture::run::{Compared, Run};

/// Seconds of rendering that each technique gets.
pub const EQUAL_TIME: f64 = 3.0;

/// Techniques that compete, as far as the table has them.
const TECHNIQUES: [&str; 6] = ["path", "light", "bdpt", "vcm", "photon", "mlt"];

/// What a technique made of a room.
pub struct Entry {
    pub technique: &'static str,
    pub run: Rc<Run>,
    pub found: Compared,
}

/// The techniques that compete.
pub fn techniques() -> impl Iterator<Item = &'static str> {
    TECHNIQUES.into_iter().filter(|name| integrator::find(name).is_some())
}

/// One technique.
pub fn equal_time(lab: &mut Lab, room: &Room, technique: &'static str) -> Result<Entry> {
    let reference = room.reference(lab)?;
    let run = lab.render(&format!("{}-{technique}", room.name), room.shot(technique).seconds(EQUAL_TIME))?;
    let found = lab.compare(&run, &reference)?;
    Ok(Entry { technique, run, found })
}

/// All of them.
pub fn all(lab: &mut Lab, room: &Room) -> Result<Vec<Entry>> {
    techniques().map(|technique| equal_time(lab, room, technique)).collect()
}
