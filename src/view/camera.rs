//! Where the user stands and looks: orbiting, panning, dollying and flying.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::scene::Camera;
use crate::scene::camera::Projection;

/// The nearest that the viewing direction comes to straight up or down, in radians.
const POLE: f64 = 0.02;

/// A camera that moves. It keeps the shape of the scene's camera: its field of view, lens, scale and handedness.
#[derive(Clone, Debug)]
pub struct Viewpoint {
    /// The scene's camera.
    start: Camera,
    /// What it turns around, at the start.
    start_target: DVec3,
    /// The axis that stays upright.
    up: DVec3,
    /// How it is turned against the start.
    turned: DQuat,
    eye: DVec3,
    target: DVec3,
    /// Width of what parallel rays see, over that of the scene's camera; 1 where rays begin at a point.
    width: f64,
    /// Length of a step, in scene units.
    unit: f64,
}

impl Viewpoint {
    /// Stands where a camera does that looks at a scene with this centre and radius.
    pub fn new(camera: &Camera, (centre, radius): (DVec3, f64)) -> Self {
        let eye = camera.to_world.translation;
        let forward = camera.to_world.matrix3.z_axis.normalize_or(DVec3::Z);
        let along = (centre - eye).dot(forward);
        let target = eye + forward * if along > 0.1 * radius { along } else { radius };
        Self {
            start: camera.clone(),
            start_target: target,
            up: nearest_axis(camera.to_world.matrix3.y_axis),
            turned: DQuat::IDENTITY,
            eye,
            target,
            width: 1.0,
            unit: radius,
        }
    }

    /// The camera as it stands.
    pub fn camera(&self) -> Camera {
        let across = DMat3::from_diagonal(DVec3::new(self.width, self.width, 1.0));
        let matrix3 = DMat3::from_quat(self.turned) * self.start.to_world.matrix3 * across;
        Camera { to_world: DAffine3 { matrix3, translation: self.eye }, ..self.start.clone() }
    }

    /// Goes back to where the scene's camera is.
    pub fn reset(&mut self) {
        self.turned = DQuat::IDENTITY;
        self.eye = self.start.to_world.translation;
        self.target = self.start_target;
        self.width = 1.0;
    }

    fn axis(&self, of: impl Fn(&DMat3) -> DVec3) -> DVec3 {
        (self.turned * of(&self.start.to_world.matrix3)).normalize_or(DVec3::X)
    }

    fn forward(&self) -> DVec3 {
        self.axis(|matrix| matrix.z_axis)
    }

    /// To the right of the image, which is -x of the camera's space.
    fn right(&self) -> DVec3 {
        -self.axis(|matrix| matrix.x_axis)
    }

    /// The turn by two angles, around the upright axis and around the image's horizontal; the second one ends at the poles.
    fn turn(&self, yaw: f64, pitch: f64) -> DQuat {
        let angle = self.forward().angle_between(self.up);
        let upwards = self.forward().cross(self.up).normalize_or(self.right());
        let pitch =
            pitch.clamp(angle - std::f64::consts::PI + POLE, (angle - POLE).max(angle - std::f64::consts::PI + POLE));
        DQuat::from_axis_angle(self.up, yaw) * DQuat::from_axis_angle(upwards, pitch)
    }

    /// Turns around what it looks at: by angles to the right and down of what is seen, in radians.
    pub fn orbit(&mut self, right: f64, down: f64) {
        let turn = self.turn(-right, -down);
        self.eye = self.target + turn * (self.eye - self.target);
        self.turned = (turn * self.turned).normalize();
    }

    /// Turns the eye where it stands: by angles to the right and down, in radians.
    pub fn look(&mut self, right: f64, down: f64) {
        let turn = self.turn(-right, -down);
        self.target = self.eye + turn * (self.target - self.eye);
        self.turned = (turn * self.turned).normalize();
    }

    /// Moves what is seen by pixels of an image of this size, to the right and down.
    pub fn pan(&mut self, [right, down]: [f64; 2], [width, height]: [u32; 2]) {
        let plane = self.camera().image_plane(width, height);
        let scale = self.start.to_world.matrix3.z_axis.length();
        let distance = (self.target - self.eye).dot(self.forward()) / scale;
        // Across the image: of parallel rays the change of their origin, else that of their direction times the distance.
        let (across, downwards) = if plane.dx == DVec3::ZERO {
            (plane.lens_x, plane.lens_y)
        } else {
            (plane.dx * distance, plane.dy * distance)
        };
        let by = -(across * right + downwards * down);
        self.eye += by;
        self.target += by;
    }

    /// Comes nearer to what it looks at: by a factor on the distance, which stays above a thousandth of the scene. Parallel rays show the same
    /// from any distance: of them it is a factor on the width of what they see.
    pub fn dolly(&mut self, factor: f64) {
        if self.start.projection == Projection::Orthographic {
            self.width = (self.width * factor).clamp(1e-3, 1e3);
            return;
        }
        let away = self.eye - self.target;
        let least = 1e-3 * self.unit / away.length().max(f64::MIN_POSITIVE);
        self.eye = self.target + away * factor.max(least);
    }

    /// Flies by so many radii of the scene to the right, up and ahead.
    pub fn fly(&mut self, [right, up, ahead]: [f64; 3]) {
        let by = (self.right() * right + self.up * up + self.forward() * ahead) * self.unit;
        self.eye += by;
        self.target += by;
    }
}

/// The axis of the world, with its sign, that a direction is nearest to.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let size = direction.abs();
    let axis = match size.max_element() {
        largest if largest == size.y => DVec3::Y,
        largest if largest == size.z => DVec3::Z,
        _ => DVec3::X,
    };
    axis * direction.dot(axis).signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewpoint() -> Viewpoint {
        let camera = Camera::look_at(DVec3::new(0.0, 1.0, 8.0), DVec3::new(0.0, 1.0, 0.0), DVec3::Y, 40.0).unwrap();
        Viewpoint::new(&camera, (DVec3::new(0.0, 1.0, 0.0), 2.0))
    }

    fn is_near(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-9
    }

    #[test]
    fn it_stands_where_the_scene_s_camera_does() {
        let mut view = viewpoint();
        let start = view.camera().to_world;
        assert!(is_near(view.target, DVec3::new(0.0, 1.0, 0.0)));
        view.orbit(0.3, -0.2);
        view.pan([10.0, 20.0], [100, 50]);
        view.fly([0.1, 0.2, 0.3]);
        assert!(!is_near(view.camera().to_world.translation, start.translation));
        view.reset();
        assert_eq!(view.camera().to_world, start);
    }

    /// Dragging to the right turns what is seen to the right: the eye goes to the left, at the same distance, and looks at the target still.
    #[test]
    fn orbiting_keeps_distance_and_target() {
        let mut view = viewpoint();
        view.orbit(std::f64::consts::FRAC_PI_2, 0.0);
        assert!(is_near(view.eye, DVec3::new(-8.0, 1.0, 0.0)), "{}", view.eye);
        assert!(is_near(view.forward(), DVec3::X));
        // Down: the eye goes up, and no further than the pole.
        view.orbit(0.0, 9.0);
        assert!(view.eye.y > 8.9 && view.eye.distance(view.target) - 8.0 < 1e-9, "{}", view.eye);
        assert!(view.right().dot(DVec3::Y).abs() < 1e-9, "the horizon is level");
        view.orbit(0.0, -9.0);
        assert!(view.eye.y < -6.9);
    }

    /// A point in the target's plane moves by what the pointer does.
    #[test]
    fn panning_follows_the_pointer() {
        let mut view = viewpoint();
        view.pan([50.0, 0.0], [100, 50]);
        let half_width = 8.0 * 20f64.to_radians().tan();
        assert!(is_near(view.eye, DVec3::new(-half_width, 1.0, 8.0)), "{}", view.eye);
    }

    #[test]
    fn flying_and_coming_nearer() {
        let mut view = viewpoint();
        view.fly([1.0, 1.0, 2.0]);
        assert!(is_near(view.eye, DVec3::new(2.0, 3.0, 4.0)), "{}", view.eye);
        view.reset();
        view.dolly(0.5);
        assert!(is_near(view.eye, DVec3::new(0.0, 1.0, 4.0)));
        view.dolly(0.0);
        assert!(view.eye.z > 1e-3);
        view.reset();
        view.start.projection = Projection::Orthographic;
        let start = view.camera().to_world;
        view.dolly(0.5);
        let nearer = view.camera().to_world;
        let half = DVec3::new(0.5, 0.5, 1.0);
        assert!(
            is_near(nearer.translation, start.translation)
                && is_near(nearer.matrix3 * DVec3::ONE, start.matrix3 * half)
        );
        view.reset();
        view.look(std::f64::consts::FRAC_PI_2, 0.0);
        assert!(
            is_near(view.eye, DVec3::new(0.0, 1.0, 8.0)) && is_near(view.forward(), DVec3::X),
            "{}",
            view.forward()
        );
    }
}
