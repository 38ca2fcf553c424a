//! Cameras: where they stand, what they see, and the rays that they send through the image.

use glam::{DAffine3, DMat3, DVec3};

use super::request::FilmSettings;
use crate::error::{Error, Result};
use crate::layout::{CAMERA_ORTHOGRAPHIC, CAMERA_PINHOLE, CAMERA_THIN_LENS};

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

/// How a camera makes its image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Projection {
    /// All rays meet in one point.
    #[default]
    Pinhole,
    /// Rays begin on a lens.
    ThinLens {
        /// Radius of the lens, in scene units.
        radius: f64,
        /// Distance of the plane that is sharp, along the viewing direction.
        focus: f64,
    },
    /// All rays are parallel; the image is twice the length of the camera's axes across and down.
    Orthographic,
}

/// A camera. It looks along +z of its own space, with +x to the left and +y up, as in Mitsuba.
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
    /// How it makes its image.
    pub projection: Projection,
    /// The part of the whole image that is rendered, in shares of it: left, top, width, height.
    pub window: [f64; 4],
    /// The image that the file asks for through it, where that is not the scene's.
    pub film: Option<FilmSettings>,
    /// Samples per pixel that the file asks for through it, where it has a film of its own.
    pub spp: Option<u32>,
}

/// The window that is the whole image.
pub const WHOLE: [f64; 4] = [0.0, 0.0, 1.0, 1.0];

/// The rays of an image: from a pinhole or a lens around `origin`, pixel position (x, y) looks along `corner + x dx + y dy`,
/// whose length along the viewing direction is one. An orthographic camera's rays all go along `corner` and begin at
/// `origin + x lens_x + y lens_y`.
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
    /// Change of the origin per unit of lens (or per pixel) to the right.
    pub lens_x: DVec3,
    /// Change of it down.
    pub lens_y: DVec3,
    /// Lengths of the viewing direction after which all is sharp.
    pub focus: f64,
    /// One of the `CAMERA_*` constants.
    pub kind: u32,
}

impl ImagePlane {
    /// Where the middle of the lens sees a point, in pixels from the upper left corner; nothing where that is behind it. The point is in the camera's
    /// coordinates: relative to the scene's origin.
    pub fn project(&self, point: DVec3) -> Option<[f64; 2]> {
        let to = point - self.origin;
        let [x, y, depth] = if self.kind == CAMERA_ORTHOGRAPHIC {
            (DMat3::from_cols(self.lens_x, self.lens_y, self.corner).inverse() * to).to_array()
        } else {
            // to = depth (corner + x dx + y dy)
            let [x, y, depth] = (DMat3::from_cols(self.dx, self.dy, self.corner).inverse() * to).to_array();
            [x / depth, y / depth, depth]
        };
        (depth > 0.0 && x.is_finite() && y.is_finite()).then_some([x, y])
    }
}

impl Camera {
    /// A pinhole camera.
    pub fn new(name: &str, to_world: DAffine3, fov: f64, axis: FovAxis) -> Self {
        Self {
            name: name.to_owned(),
            to_world,
            fov,
            axis,
            principal_point: [0.0; 2],
            projection: Projection::Pinhole,
            window: WHOLE,
            film: None,
            spp: None,
        }
    }

    /// Looks from `origin` at `target`.
    pub fn look_at(origin: DVec3, target: DVec3, up: DVec3, fov: f64) -> Result<Self> {
        let to_world = look_at(origin, target, up).ok_or_else(|| {
            Error::Usage(format!("a camera at {origin} cannot look at {target} with {up} as its up: the directions must differ and be finite"))
        })?;
        Ok(Self::new("camera", to_world, fov, FovAxis::X))
    }

    /// Tangent of half the angle that the image's width spans.
    pub(in crate::scene) fn tan_half_width(&self, width: f64, height: f64) -> f64 {
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

    /// Whether paths from the lights can run into it: it has a lens with an area.
    pub fn has_lens(&self) -> bool {
        matches!(self.projection, Projection::ThinLens { radius, .. } if radius > 0.0)
    }

    /// The rays of an image of `width` by `height` pixels.
    pub fn image_plane(&self, width: u32, height: u32) -> ImagePlane {
        let (width, height) = (f64::from(width), f64::from(height));
        let [left, top, across, down] = self.window;
        let (whole_width, whole_height) = (width / across, height / down);
        let map = |x: f64, y: f64, z: f64| self.to_world.transform_vector3(DVec3::new(x, y, z));
        let plane = ImagePlane {
            origin: self.to_world.translation,
            corner: DVec3::ZERO,
            dx: DVec3::ZERO,
            dy: DVec3::ZERO,
            lens_x: DVec3::ZERO,
            lens_y: DVec3::ZERO,
            focus: 1.0,
            kind: CAMERA_PINHOLE,
        };
        if self.projection == Projection::Orthographic {
            // Two units of the camera's space across, as many down as the image's shape says.
            let pixel = 2.0 / whole_width;
            let first = DVec3::new(1.0 - left * 2.0, (whole_height / 2.0 - top * whole_height) * pixel, 0.0);
            return ImagePlane {
                origin: self.to_world.transform_point3(first),
                corner: map(0.0, 0.0, 1.0).normalize(),
                lens_x: map(-pixel, 0.0, 0.0),
                lens_y: map(0.0, -pixel, 0.0),
                kind: CAMERA_ORTHOGRAPHIC,
                ..plane
            };
        }
        let half_width = self.tan_half_width(whole_width, whole_height);
        let half_height = half_width * whole_height / whole_width;
        let [shift_x, shift_y] = self.principal_point;
        let x = half_width * (1.0 - 2.0 * shift_x - 2.0 * left);
        let y = half_height * (1.0 - 2.0 * shift_y - 2.0 * top);
        let plane = ImagePlane {
            corner: map(x, y, 1.0),
            dx: map(-2.0 * half_width / whole_width, 0.0, 0.0),
            dy: map(0.0, -2.0 * half_height / whole_height, 0.0),
            ..plane
        };
        match self.projection {
            Projection::ThinLens { radius, focus } if radius > 0.0 => ImagePlane {
                lens_x: map(radius, 0.0, 0.0),
                lens_y: map(0.0, radius, 0.0),
                focus,
                kind: CAMERA_THIN_LENS,
                ..plane
            },
            _ => plane,
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
