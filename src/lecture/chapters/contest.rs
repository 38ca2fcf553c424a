//! The same room by several techniques at equal time: every command gets the same `-t`.

use std::rc::Rc;

use super::scenes::Room;
use crate::error::Result;
use crate::image::Image;
use crate::image::metrics::RELATIVE_FLOOR;
use crate::lecture::lab::Lab;
use crate::lecture::run::{Compared, Run};
use crate::techniques;

/// Seconds of rendering that each technique gets.
pub const EQUAL_TIME: f64 = 3.0;

/// Techniques that compete, as far as the table has them.
const TECHNIQUES: [&str; 6] = ["path", "light", "bdpt", "vcm", "photon", "mlt"];

/// What a technique made of a room.
pub struct Entry {
    pub technique: &'static str,
    pub run: Rc<Run>,
    pub found: Compared,
    /// Its relMSE over all pixels but the worst hundredth, which rare bright samples decide.
    pub typical: f64,
}

/// The techniques that compete.
pub fn techniques() -> impl Iterator<Item = &'static str> {
    TECHNIQUES.into_iter().filter(|name| techniques::find(name).is_some())
}

/// One technique.
pub fn equal_time(lab: &mut Lab, room: &Room, technique: &'static str) -> Result<Entry> {
    let reference = room.reference(lab)?;
    let run = lab.render(&format!("{}-{technique}", room.name), room.shot(technique).seconds(EQUAL_TIME))?;
    let found = lab.compare(&run, &reference)?;
    let typical = without_worst(&run.image, &reference.image);
    Ok(Entry { technique, run, found, typical })
}

/// All of them.
pub fn all(lab: &mut Lab, room: &Room) -> Result<Vec<Entry>> {
    techniques().map(|technique| equal_time(lab, room, technique)).collect()
}

/// The relMSE over the ninety-nine hundredths of the pixels that have the least of it.
fn without_worst(image: &Image, reference: &Image) -> f64 {
    let of_pixel = |(a, b): (&[f32; 3], &[f32; 3])| {
        let channels = a.iter().zip(b).map(|(a, b)| (f64::from(*a), f64::from(*b)));
        channels.map(|(a, b)| (a - b).powi(2) / (b * b + RELATIVE_FLOOR)).sum::<f64>() / 3.0
    };
    let mut errors: Vec<f64> = image.pixels.iter().zip(&reference.pixels).map(of_pixel).collect();
    errors.sort_by(f64::total_cmp);
    let kept = errors.len() - errors.len() / 100;
    errors[..kept].iter().sum::<f64>() / kept.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_hundredth_is_left_out() {
        let image = |value: &dyn Fn(u32) -> f32| Image {
            width: 200,
            height: 1,
            pixels: (0..200).map(|x| [value(x); 3]).collect(),
        };
        let reference = image(&|_| 1.0);
        let noisy = image(&|x| if x < 2 { 1e3 } else { 2.0 });
        assert!((without_worst(&noisy, &reference) - 1.0 / 1.01).abs() < 1e-6);
    }
}
