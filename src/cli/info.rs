//! `lumbre info`: what a scene holds and needs.

use clap::Args;

use lumbre::error::Result;
use lumbre::scene::Needs;

use super::{SceneArgs, print, print_warnings};

#[derive(Args)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    scene: SceneArgs,
}

pub(super) fn run(args: &InfoArgs) -> Result<()> {
    let scene = args.scene.load()?;
    print_warnings(&scene);
    let needs = Needs::of(&scene);
    let triangles: u32 = scene.groups.iter().map(|group| group.triangles.len() as u32).sum();
    let spheres: u32 = scene.groups.iter().map(|group| group.spheres.len() as u32).sum();
    print(&format!("scene      {}", scene.source.display()));
    print(&format!("image      {}x{}, {:?}", scene.film.width, scene.film.height, scene.film.filter));
    let cameras: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    print(&format!("cameras    {}", cameras.join(", ")));
    print(&format!(
        "geometry   {triangles} triangles, {spheres} spheres, {} groups, {} instances",
        scene.groups.len(),
        scene.instances.len()
    ));
    let (min, max) = (scene.origin + scene.bounds.min.as_dvec3(), scene.origin + scene.bounds.max.as_dvec3());
    print(&format!("bounds     {min} to {max}"));
    print(&format!("surfaces   {}, of {} materials", scene.surfaces.len(), scene.materials.len()));
    print(&format!(
        "lights     {} entries, background {}",
        scene.lights.len(),
        if needs.background { "yes" } else { "no" }
    ));
    let (used, left_out) = needs.describe();
    print(&format!("needs      {}", used.join(", ")));
    print(&format!("left out   {}", left_out.join(", ")));
    Ok(())
}
