//! The picture on the window's device, made anew where what it shows has changed.

use std::sync::Arc;

use crate::error::Result;
use crate::gpu::window::Presenter;
use crate::view::display::{Display, srgb_pixels};
use crate::view::interface;
use crate::view::news::Picture;

/// The largest side of a picture on the device: every Vulkan device has textures of that size.
pub(super) const MOST_SIDE: u32 = 4096;

/// What it was made of.
struct MadeOf {
    picture: Arc<Picture>,
    display: Display,
    is_smooth: bool,
}

/// The texture that is the picture.
#[derive(Default)]
pub(super) struct PictureTexture(Option<MadeOf>);

impl PictureTexture {
    /// Brings the texture up to date. `is_smooth`: between pixels, where it is shown larger.
    pub fn bring(
        &mut self,
        presenter: &mut Presenter,
        picture: &Arc<Picture>,
        display: Display,
        is_smooth: bool,
    ) -> Result<()> {
        let is_there = self.0.as_ref().is_some_and(|own| {
            Arc::ptr_eq(&own.picture, picture) && own.display == display && own.is_smooth == is_smooth
        });
        if !is_there {
            let (size, pixels) = pixels(picture, &display);
            interface::set_picture(presenter, size, &pixels, is_smooth)?;
            self.0 = Some(MadeOf { picture: picture.clone(), display, is_smooth });
        }
        Ok(())
    }

    /// The device is gone, and the texture with it.
    pub fn forget(&mut self) {
        self.0 = None;
    }
}

/// The pixels of the picture as the screen is to show them: all of them, or of a picture that is larger than textures are every second, third, ...
fn pixels(picture: &Picture, display: &Display) -> ([u32; 2], Vec<[u8; 4]>) {
    let image = display.tone(&picture.image, picture.layer.scale());
    let all = srgb_pixels(&image);
    let step = image.width.max(image.height).div_ceil(MOST_SIDE).max(1);
    if step == 1 {
        return ([image.width, image.height], all);
    }
    let some = |side: u32| (0..side).step_by(step as usize);
    let at = |x: u32, y: u32| all[y as usize * image.width as usize + x as usize];
    let pixels = some(image.height).flat_map(|y| some(image.width).map(move |x| at(x, y))).collect();
    ([image.width.div_ceil(step), image.height.div_ceil(step)], pixels)
}
