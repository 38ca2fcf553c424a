//! Instances: turned over, stretched, and standing in each other.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use super::Run;
use super::figure::Figure;
use super::geometry::{closed_cube, glowing, icosphere, inside_out, lamp, look};
use crate::error::Result;
use crate::image::metrics::compare;
use crate::render::Settings;
use crate::scene::{Mesh, Scene, SceneBuilder};

/// A ball's mesh; smooth, with its normals.
fn ball(smooth: bool) -> Mesh {
    let ball = icosphere(3);
    if !smooth {
        return ball;
    }
    Mesh { normals: ball.positions.iter().map(|position| position.as_vec3()).collect(), ..ball }
}

/// A ball under a lamp, placed by a map as an instance, whose group has it at an offset, or with its vertices mapped. It is smooth where the
/// map leaves its shape: normals that are interpolated and then mapped are others than those that are mapped first, once it does not.
fn under_a_lamp(place: DAffine3, as_instance: bool, smooth: bool, offset: DVec3) -> Result<Scene> {
    let mut builder = SceneBuilder::new("instance");
    // The front only: an instance that is turned inside out is black.
    let skin = glowing(&mut builder, [0.8, 0.6, 0.4], [0.0; 3]);
    if as_instance {
        let group = builder.group("ball");
        builder.mesh(group, "ball", ball(smooth), DAffine3::from_translation(offset), skin);
        builder.instance(group, place * DAffine3::from_translation(-offset));
    } else {
        // Without normals a mesh has its front by its winding, which vertices that are mirrored turn round; an instance keeps it.
        let turned = !smooth && place.matrix3.determinant() < 0.0;
        builder.mesh(0, "ball", ball(smooth).turned(turned), place, skin);
    }
    let floor = builder.matte([0.5; 3]);
    builder.parallelogram(DVec3::new(-4.0, -1.5, -4.0), DVec3::Z * 8.0, DVec3::X * 8.0, floor);
    let light = lamp(&mut builder, [6.0; 3]);
    builder.parallelogram(DVec3::new(-1.0, 4.0, -1.0), DVec3::X * 2.0, DVec3::Z * 2.0, light);
    look(&mut builder, 32, DVec3::new(0.0, 1.0, 6.0), DVec3::ZERO, 40.0)?;
    builder.finish()
}

/// Mirrored, flattened and sheared instances against the same mesh with its vertices moved.
pub(super) fn instances(run: &mut Run) -> Result<()> {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let of = |scale: DVec3| DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(0.1, 0.0, 0.2));
    let shear = DMat3::from_cols(DVec3::new(1.0, 0.4, 0.0), DVec3::new(0.0, 0.5, 0.3), DVec3::new(0.2, 0.0, 1.2));
    for (name, map, smooth) in [
        ("mirrored", of(DVec3::new(-1.0, 1.0, 1.0)), true),
        ("mirrored thrice", of(DVec3::splat(-1.0)), true),
        ("a thousand times wider than thick", of(DVec3::new(1.5, 0.0015, 1.5)), false),
        ("mirrored and flattened", of(DVec3::new(-1.5, 0.1, 1.0)), false),
        ("sheared", DAffine3::from_mat3(shear), false),
        ("a group far from its origin", of(DVec3::ONE), true),
    ] {
        let offset = DVec3::splat(if name.starts_with("a group") { 1e3 } else { 0.0 });
        let (one, other) = (under_a_lamp(map, true, smooth, offset)?, under_a_lamp(map, false, smooth, offset)?);
        let settings = run.settings(&one, "path")?;
        let spp = run.pick(64, 32);
        let (a, b) = (run.render(&one, &settings, spp)?, run.render(&other, &settings, spp)?);
        let noise = compare(&run.render(&other, &Settings { seed: 1, ..settings }, spp)?.mean(), &b.mean())?.relmse;
        let difference = compare(&a.mean(), &b.mean())?.relmse;
        run.note(Figure::at_most("path", format!("{name}: relMSE as a share of the noise's"), difference / noise, 0.1));
    }
    Ok(())
}

/// Balls and cubes that stand in each other and in the walls of a furnace, all of its albedo and, as instances cannot emit, in a room of
/// no emission but the walls': they are seen only if they lose or gain light.
pub(super) fn interpenetrating(run: &mut Run) -> Result<()> {
    let mut builder = SceneBuilder::new("interpenetrating");
    let wall = glowing(&mut builder, [0.0; 3], [1.0; 3]);
    builder.mesh(0, "walls", inside_out(closed_cube()), DAffine3::from_scale(DVec3::splat(4.0)), wall);
    // White: under radiance 1 from everywhere, a white convex thing has radiance 1, and so has what stands in another.
    let white = glowing(&mut builder, [1.0; 3], [0.0; 3]);
    let (ball, cube) = (builder.group("ball"), builder.group("cube"));
    builder.mesh(ball, "ball", icosphere(2), DAffine3::IDENTITY, white);
    builder.mesh(cube, "cube", closed_cube(), DAffine3::IDENTITY, white);
    for index in 0..12 {
        let angle = f64::from(index);
        let turn = DQuat::from_rotation_y(angle) * DQuat::from_rotation_x(0.3 * angle);
        let at = DVec3::new((1.3 * angle).cos(), (0.7 * angle).sin(), (2.1 * angle).cos());
        let scale = DVec3::new(if index % 3 == 0 { -0.8 } else { 0.8 }, 0.5 + 0.05 * angle, 0.7);
        builder.instance(
            if index % 2 == 0 { ball } else { cube },
            DAffine3::from_scale_rotation_translation(scale, turn, at),
        );
    }
    builder.instance(cube, DAffine3::from_translation(DVec3::new(0.0, -3.9, 0.0)));
    look(&mut builder, 32, DVec3::new(0.0, 0.5, 3.9), DVec3::ZERO, 50.0)?;
    let scene = builder.finish()?;
    for technique in run.thorough(&scene) {
        let film = run.render(&scene, &run.settings(&scene, technique)?, run.pick(128, 64))?;
        run.mean(technique, "white things under radiance 1", &film, 0, 1.0);
    }
    Ok(())
}
