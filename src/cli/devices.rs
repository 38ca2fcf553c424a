//! `lumbre devices`: every Vulkan device, what it can do, and why a backend is refused on it.

use clap::Args;

use lumbre::error::{Bytes, Error, Result};
use lumbre::gpu::Instance;

use super::output::print;

#[derive(Args)]
pub(super) struct DevicesArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &DevicesArgs) -> Result<()> {
    let devices = Instance::new(false)?.devices()?;
    if args.json {
        let text = serde_json::to_string_pretty(&devices).map_err(|error| Error::Device(error.to_string()))?;
        print(&text);
        return Ok(());
    }
    if devices.is_empty() {
        print("no Vulkan device: install a driver (Debian and Ubuntu: mesa-vulkan-drivers, which brings lavapipe)");
    }
    for device in &devices {
        print(&format!("{}  {}", device.index, device.name));
        print(&format!("   {:?}, {}, Vulkan {}, {}", device.kind, device.driver, device.vulkan, Bytes(device.memory)));
        print(&format!("   uuid {}, subgroups of {}", device.uuid, device.subgroup_size));
        if !device.environment.is_empty() {
            print(&format!("   set for its driver: {}", device.environment.join(" ")));
        }
        for backend in &device.backends {
            let verdict = backend.refused.as_deref().map_or(String::from("yes"), |why| format!("no: {why}"));
            print(&format!("   {:<10} {verdict}", backend.name));
        }
    }
    Ok(())
}
