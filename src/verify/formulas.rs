//! Scenes whose light is known in closed form.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};

use super::Run;
use super::expectations::polygon_irradiance;
use super::geometry::{closed_cube, inside_out, lamp, look, polygon};
use crate::error::Result;
use crate::image::{Texels, TextureImage};
use crate::render::Settings;
use crate::scene::camera::Projection;
use crate::scene::light::Lamp;
use crate::scene::texture::{Pattern, TextureDescription, Wrap};
use crate::scene::{Camera, Scene, SceneBuilder, SurfaceDescription, material};

/// A patch of albedo 0.5 at the origin that faces +y, seen from above, under an emitter of radiance 1.
pub(super) fn patch_under(emitter: impl FnOnce(&mut SceneBuilder, usize)) -> Result<Scene> {
    let mut builder = SceneBuilder::new("patch");
    let floor = builder.matte([0.5; 3]);
    builder.parallelogram(DVec3::new(-1e-3, 0.0, -1e-3), DVec3::Z * 2e-3, DVec3::X * 2e-3, floor);
    let light = lamp(&mut builder, [1.0; 3]);
    emitter(&mut builder, light);
    // One camera for what finds the light by itself, one that sees more of what light's paths find.
    for fov in [0.05, 0.15] {
        look(&mut builder, 16, DVec3::new(0.0, 0.4, 0.3), DVec3::ZERO, fov)?;
    }
    builder.finish()
}

/// Every technique, and every way of direct lighting, gives radiance albedo / pi times the irradiance.
fn irradiance(run: &mut Run, what: &str, scene: &Scene, expected: f64) -> Result<()> {
    let direct = run.pick(vec!["direct", "direct:sampling=emitter", "direct:sampling=bsdf"], Vec::new());
    for technique in run.thorough(scene).into_iter().chain(direct) {
        let settings = Settings { max_depth: Some(2), ..run.settings(scene, technique)? };
        // What only the BSDF's choice of direction finds is seldom found.
        let implicit = technique == "path-implicit" || technique.ends_with("bsdf");
        let film = run.render(scene, &settings, if implicit { 4500 } else { 500 })?;
        run.mean(technique, what, &film, 0, 0.5 / PI * expected);
    }
    // The lamp aims at the patch, which is all that does not emit; radii are shares of its size.
    for technique in run.and_from_lights(scene) {
        let (technique, spp) = match technique {
            "photon" => ("photon:direct=photons:radius=0.1", 3000),
            "vcm" => ("vcm:radius=0.05", 1000),
            "vcm:form=bpm" => ("vcm:form=bpm:radius=0.1", 3000),
            other => (other, 9000),
        };
        let camera = Some(String::from("1"));
        let settings = Settings { max_depth: Some(2), camera, ..run.settings(scene, technique)? };
        let film = run.render(scene, &settings, spp)?;
        run.mean_within(technique, what, &film, 0, 0.5 / PI * expected, 4e-3);
    }
    Ok(())
}

/// A polygon, a disk on the axis and a sphere above a patch.
pub(super) fn emitters(run: &mut Run) -> Result<()> {
    let v = DVec3::new;
    let corners = [v(-1.0, 1.0, 0.5), v(0.5, 1.4, 1.2), v(1.3, 0.9, -0.2), v(0.1, 0.8, -1.0)];
    // The last corner must lie in the plane of the others for the fan to be the polygon.
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
    let last = corners[3] - normal * normal.dot(corners[3] - corners[0]);
    let corners = [corners[0], corners[1], corners[2], last];
    let scene = patch_under(|builder, surface| polygon(builder, &corners, surface))?;
    irradiance(run, "polygon", &scene, polygon_irradiance(&corners, DVec3::ZERO, DVec3::Y))?;
    // E = pi L R^2 / (R^2 + h^2); a polygon of 512 corners has 2.5e-5 less.
    let (radius, height) = (0.7, 1.1);
    let angle = |index: i32| 2.0 * PI * f64::from(index) / 512.0;
    let rim: Vec<_> =
        (0..512).map(|index| v(radius * angle(index).cos(), height, radius * angle(index).sin())).collect();
    let scene = patch_under(|builder, surface| polygon(builder, &rim, surface))?;
    irradiance(run, "disk", &scene, PI * radius * radius / (radius * radius + height * height))?;
    // Wholly above the horizon: E = pi L (R / d)^2 cos of the angle at which the centre stands.
    let (centre, radius) = (v(0.4, 1.2, -0.3), 0.5);
    let scene = patch_under(|builder, surface| builder.sphere(0, "light", centre, radius, surface))?;
    irradiance(run, "sphere", &scene, PI * radius * radius / centre.length_squared() * centre.normalize().y)
}

/// The luminance of a wall of a cube of 10 m with a point light of 50000 cd at its centre and an albedo of 2/3, at six points.
pub(super) fn cube_with_a_point_light(run: &mut Run) -> Result<()> {
    let points = [
        ("centre", [0.0, 0.0], 892.8),
        ("(2.5, 0)", [2.5, 0.0], 768.7),
        ("(2.5, 2.5)", [2.5, 2.5], 686.6),
        ("mid-edge", [4.999_95, 0.0], 565.1),
        ("(5, 2.5)", [4.999_95, 2.5], 522.4),
        ("corner", [4.999_95, 4.999_95], 388.4),
    ];
    let mut builder = SceneBuilder::new("cube");
    let wall = builder.material(material::diffuse([2.0 / 3.0; 3]));
    let wall = builder.surface(SurfaceDescription { front: Some(wall), ..SurfaceDescription::default() });
    builder.mesh(0, "cube", inside_out(closed_cube()), DAffine3::from_scale(DVec3::splat(5.0)), wall);
    builder.lamps.push(Lamp::Point { position: DVec3::ZERO, intensity: [50_000.0; 3] });
    for (_, [x, y], _) in points {
        look(&mut builder, 32, DVec3::new(0.5, 0.3, 0.0), DVec3::new(x, y, 5.0), 0.0005)?;
    }
    // All of the wall.
    look(&mut builder, 32, DVec3::Z * 4.0, DVec3::Z * 5.0, 45.0)?;
    if let Some(camera) = builder.cameras.last_mut() {
        make_parallel(camera, 5.0);
    }
    let scene = builder.finish()?;
    for technique in run.thorough(&scene) {
        for (index, (name, _, expected)) in points.into_iter().enumerate() {
            let settings = Settings { camera: Some(index.to_string()), ..run.settings(&scene, technique)? };
            let film = run.render(&scene, &settings, run.samples(200, 100))?;
            run.mean(technique, name, &film, 0, expected);
        }
    }
    // What all walls absorb is what the light sheds: the mean luminance is r I 4 pi / (pi A (1 - r)).
    let mean = 50_000.0 * 4.0 * (2.0 / 3.0) / (600.0 / 3.0);
    for technique in run.and_from_lights(&scene) {
        // Photons near an edge are missing from beyond it.
        let (technique, share) = match technique {
            "photon" => ("photon:radius=0.01", 4e-3),
            "vcm" => ("vcm:radius=0.001", 2e-3),
            "vcm:form=bpm" => ("vcm:form=bpm:radius=0.01", 4e-3),
            other => (other, 1e-3),
        };
        let settings = Settings { camera: Some(points.len().to_string()), ..run.settings(&scene, technique)? };
        let film = run.render(&scene, &settings, 400)?;
        run.mean_within(technique, "the whole wall", &film, 0, mean, share);
    }
    Ok(())
}

/// Makes a camera's rays parallel, over a square of this half side.
fn make_parallel(camera: &mut Camera, half: f64) {
    camera.projection = Projection::Orthographic;
    camera.to_world.matrix3.x_axis *= half;
    camera.to_world.matrix3.y_axis *= half;
}

/// A slab of glass met head-on: reflections within it sum to R = 2 r / (1 + r) and T = (1 - r) / (1 + r), r = 0.04. Green light comes
/// through it, red light back from it.
pub(super) fn slab(run: &mut Run) -> Result<()> {
    let mut builder = SceneBuilder::new("slab");
    let glass = builder.material(material::dielectric(1.5, [1.0; 3], [1.0; 3], None));
    let glass = builder.surface(SurfaceDescription { front: Some(glass), ..SurfaceDescription::default() });
    let (across, up) = (DVec3::X * 10.0, DVec3::Y * 10.0);
    let corner = |z: f64| DVec3::new(-5.0, -5.0, z);
    // Two faces, each with its front to the outside.
    builder.parallelogram(corner(1.0), across, up, glass);
    builder.parallelogram(corner(0.0), up, across, glass);
    let red = lamp(&mut builder, [1.0, 0.0, 0.0]);
    builder.parallelogram(corner(9.0), up, across, red);
    let green = lamp(&mut builder, [0.0, 1.0, 0.0]);
    builder.parallelogram(corner(-9.0), across, up, green);
    look(&mut builder, 32, DVec3::Z * 5.0, DVec3::ZERO, 0.01)?;
    let scene = builder.finish()?;
    for technique in run.thorough(&scene).into_iter().chain(run.and_from_lights(&scene)) {
        let settings = Settings { rr_depth: 50, ..run.settings(&scene, technique)? };
        let film = run.render(&scene, &settings, run.pick(2000, 1500))?;
        run.mean(technique, "reflected", &film, 0, 1.0 / 13.0);
        run.mean(technique, "transmitted", &film, 1, 12.0 / 13.0);
    }
    Ok(())
}

/// A camera within glass of index 1.5 sees eta^2 times the radiance outside: straight out of a plane, 0.96 eta^2 and what comes back;
/// from the middle of a ball under a white sky, the same, for there is nothing to come back but what entered: all of eta^2.
pub(super) fn inside_glass(run: &mut Run) -> Result<()> {
    let scene = |ball: bool| {
        let mut builder = SceneBuilder::new("inside");
        let glass = builder.material(material::dielectric(1.5, [1.0; 3], [1.0; 3], None));
        let glass = builder.surface(SurfaceDescription { front: Some(glass), ..SurfaceDescription::default() });
        if ball {
            builder.sphere(0, "ball", DVec3::ZERO, 1.0, glass);
        } else {
            builder.parallelogram(DVec3::new(-5.0, -5.0, 1.0), DVec3::X * 10.0, DVec3::Y * 10.0, glass);
        }
        builder.background = Some([1.0; 3]);
        look(&mut builder, 16, DVec3::ZERO, DVec3::Z, if ball { 90.0 } else { 0.01 })?;
        builder.finish()
    };
    for (what, scene, expected) in
        [("out of a plane", scene(false)?, 0.96 * 2.25 + 0.04), ("out of a ball", scene(true)?, 2.25)]
    {
        for technique in run.thorough(&scene) {
            let film = run.render(&scene, &run.settings(&scene, technique)?, 2000)?;
            run.mean(technique, what, &film, 0, expected);
        }
    }
    Ok(())
}

/// A camera of parallel rays that sees the square of this half side around the origin, from `height` above it.
fn from_above(builder: &mut SceneBuilder, half: f64, height: f64) -> Result<()> {
    look(builder, 32, DVec3::Y * height, DVec3::ZERO, 45.0)?;
    if let Some(camera) = builder.cameras.last_mut() {
        make_parallel(camera, half);
    }
    Ok(())
}

/// Form factors, as the mean radiance 0.5 F of what faces a lamp of radiance 1: faces of a unit cube, and equal disks as far apart as
/// their radius.
pub(super) fn form_factors(run: &mut Run) -> Result<()> {
    let face = |corner: DVec3, edge1: DVec3, edge2: DVec3| {
        let mut builder = SceneBuilder::new("form factor");
        let floor = builder.matte([0.5; 3]);
        builder.parallelogram(DVec3::new(-0.5, 0.0, -0.5), DVec3::Z, DVec3::X, floor);
        let light = lamp(&mut builder, [1.0; 3]);
        builder.parallelogram(corner, edge1, edge2, light);
        from_above(&mut builder, 0.5, 0.01)?;
        builder.finish()
    };
    let opposite = face(DVec3::new(-0.5, 1.0, -0.5), DVec3::X, DVec3::Z)?;
    let adjacent = face(DVec3::new(-0.5, 0.0, -0.5), DVec3::X, DVec3::Y)?;
    let disks = {
        let mut builder = SceneBuilder::new("form factor");
        let rim = |height: f64| -> Vec<DVec3> {
            let angle = |index: i32| 2.0 * PI * f64::from(index) / 256.0;
            (0..256).map(|index| DVec3::new(angle(index).cos(), height, angle(index).sin())).collect()
        };
        let floor = builder.matte([0.5; 3]);
        polygon(&mut builder, &rim(0.0), floor);
        let light = lamp(&mut builder, [1.0; 3]);
        polygon(&mut builder, &rim(1.0), light);
        from_above(&mut builder, 1.0, 0.01)?;
        builder.finish()?
    };
    // The image is a square around the disk, a polygon of 256 corners.
    let share = 0.25 * 128.0 * (PI / 128.0).sin();
    for (what, scene, expected, share) in [
        ("opposite faces of a cube", opposite, 0.199_825, 1.0),
        ("adjacent faces of a cube", adjacent, 0.200_044, 1.0),
        ("equal disks", disks, 0.381_966, share),
    ] {
        // All of the face is seen: by light tracing too.
        let light = run.and_from_lights(&scene).into_iter().filter(|technique| *technique == "light");
        for technique in run.thorough(&scene).into_iter().chain(light) {
            if technique == "path-implicit" && what.starts_with("adj") && run.is_short() {
                continue;
            }
            let settings = Settings { max_depth: Some(2), ..run.settings(&scene, technique)? };
            let film = run.render(
                &scene,
                &settings,
                run.samples(if matches!(technique, "path-implicit" | "light") { 800 } else { 200 }, 128),
            )?;
            run.mean(technique, what, &film, 0, 0.5 * share * expected);
        }
    }
    Ok(())
}

/// The inside of a sphere, of which the upper half emits: its kernel is constant, B = B0 + r / (1 - r) mean(B0).
pub(super) fn half_lit_sphere(run: &mut Run) -> Result<()> {
    let mut builder = SceneBuilder::new("sphere");
    let texels = Texels::Float(vec![[1.0; 4], [0.0, 0.0, 0.0, 1.0]]);
    let image = builder.image(TextureImage { source: "halves".into(), width: 1, height: 2, texels });
    let halves =
        TextureDescription { nearest: true, wrap: [Wrap::Clamp; 2], ..TextureDescription::new(Pattern::Image(image)) };
    let halves = builder.texture(halves);
    let front = Some(builder.material(material::diffuse([0.75; 3])));
    let emitting = SurfaceDescription {
        front,
        emission: [1.0; 3],
        emission_texture: Some(halves),
        ..SurfaceDescription::default()
    };
    let surface = builder.surface(emitting);
    builder.sphere(0, "sphere", DVec3::ZERO, -1.0, surface);
    // The first row of the image is around the pole +z.
    for at in [DVec3::Z, DVec3::NEG_Z] {
        // Of the one half only, and as much of it as paths from the light show to many pixels.
        let camera = Camera::look_at(DVec3::new(0.1, 0.2, 0.0), at * 100.0, DVec3::Y, 120.0)?;
        builder.cameras.push(camera);
    }
    (builder.film.width, builder.film.height) = (32, 32);
    let scene = builder.finish()?;
    let indirect = 0.75 / 0.25 * 0.5;
    for technique in run.thorough(&scene).into_iter().chain(run.and_from_lights(&scene)) {
        // Merges: of a sphere, the area within a distance is that of a plane.
        let share = if technique == "photon" || technique.starts_with("vcm") { 2e-3 } else { 1e-3 };
        for (camera, what, expected) in [("0", "the half that emits", 1.0 + indirect), ("1", "the other", indirect)] {
            let settings = Settings { camera: Some(camera.to_owned()), ..run.settings(&scene, technique)? };
            let spp = if technique == "light" { 800 } else { run.pick(200, 128) };
            let film = run.render(&scene, &settings, spp)?;
            run.mean_within(technique, what, &film, 0, expected, share);
        }
    }
    Ok(())
}
