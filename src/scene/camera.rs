//! Cameras: where they stand, what they see, and the rays that they send through the image.

use glam::{DAffine3, DVec3};

use crate::error::{Error, Result};

/// Which side of the image the field of view spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FovAxis {
    /// Its width.
    X,
    /// Its height.
    Y,
    /// Its diagonal.
    Diagonal,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
}

/// A pinhole camera. It looks along +z of its own space, with +x to the left and +y up, as in Mitsuba.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Its name, for `--camera`.
    pub name: String,
    /// World from camera.
    pub to_world: DAffine3,
    /// Field of view along `axis`, in degrees.
    pub fov: f64,
    /// What the field of view spans.
    pub axis: FovAxis,
    /// Shift of the image's centre, in image widths and heights.
    pub principal_point: [f64; 2],
}

/// The rays of an image: pixel position (x, y) looks along `corner + x dx + y dy`.
#[derive(Clone, Copy, Debug)]
pub struct ImagePlane {
    /// The camera's position.
    pub origin: DVec3,
    /// Direction through the upper left corner.
    pub corner: DVec3,
    /// Its change per pixel to the right.
    pub dx: DVec3,
    /// Its change per pixel down.
    pub dy: DVec3,
}

impl Camera {
    /// Looks from `origin` at `target`.
    pub fn look_at(origin: DVec3, target: DVec3, up: DVec3, fov: f64) -> Result<Self> {
        let to_world = look_at(origin, target, up).ok_or_else(|| {
            Error::Usage(format!("a camera at {origin} cannot look at {target} with {up} as its up: the directions must differ and be finite"))
        })?;
        Ok(Self { name: String::from("camera"), to_world, fov, axis: FovAxis::X, principal_point: [0.0; 2] })
    }

    /// Tangent of half the angle that the image's width spans.
    fn tan_half_width(&self, width: f64, height: f64) -> f64 {
        let tan = (self.fov.to_radians() / 2.0).tan();
        let of_height = tan * width / height;
        match self.axis {
            FovAxis::X => tan,
            FovAxis::Y => of_height,
            FovAxis::Diagonal => tan * width / width.hypot(height),
            FovAxis::Smaller => {
                if width <= height {
                    tan
                } else {
                    of_height
                }
            }
            FovAxis::Larger => {
                if width >= height {
                    tan
                } else {
                    of_height
                }
            }
        }
    }

    /// The rays of an image of `width` by `height` pixels.
    pub fn image_plane(&self, width: u32, height: u32) -> ImagePlane {
        let (width, height) = (f64::from(width), f64::from(height));
        let half_width = self.tan_half_width(width, height);
        let half_height = half_width * height / width;
        let [shift_x, shift_y] = self.principal_point;
        let left = half_width * (1.0 + 2.0 * shift_x);
        let top = half_height * (1.0 + 2.0 * shift_y);
        ImagePlane {
            origin: self.to_world.translation,
            corner: self.to_world.transform_vector3(DVec3::new(left, top, 1.0)),
            dx: self.to_world.transform_vector3(DVec3::new(-2.0 * half_width / width, 0.0, 0.0)),
            dy: self.to_world.transform_vector3(DVec3::new(0.0, -2.0 * half_height / height, 0.0)),
        }
    }
}

/// World from a space that stands at `origin`, looks along +z at `target`, and has +x to the left. Nothing where the
/// arguments leave it undetermined.
pub fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<DAffine3> {
    let forward = (target - origin).try_normalize()?;
    let left = up.cross(forward).try_normalize()?;
    let up = forward.cross(left);
    Some(DAffine3 { matrix3: glam::DMat3::from_cols(left, up, forward), translation: origin })
}
