//! What a driver compiles for a scene and a technique: per kernel the instructions that specialisation leaves, and how often each heavy
//! function stands in it once all calls are inlined.
//!
//!     cargo run --release --example kernels -- scenes/cornell.xml path,bdpt
//!     cargo run --release --example kernels -- scenes/cornell.xml bdpt --all
//!
//! Without `--all` a table in Markdown with the functions of docs/building.md, else every function of each kernel.

use std::path::Path;

use lumbre::gpu::DeviceKind;
use lumbre::layout::backend::Backend;
use lumbre::render::{Settings, Technique, modules_of};
use lumbre::scene::{self, LoadOptions};
use lumbre::spirv::Arithmetic;
use lumbre::spirv::copies::{Copies, copies};

/// What is heavy, and the functions that stand for it.
const HEAVY: [(&str, &[&str]); 7] = [
    ("traversal", &["traverse", "proceed"]),
    ("`bsdf_eval`", &["bsdf_eval"]),
    ("`bsdf_pdf`", &["bsdf_pdf"]),
    ("`bsdf_choose`", &["bsdf_choose"]),
    ("`light_sample`", &["light_sample"]),
    ("texels", &["load_texel"]),
    ("vertex", &["interaction_at"]),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--all").collect();
    let all = std::env::args().any(|arg| arg == "--all");
    let [path, techniques] = &args[..] else {
        return Err("usage: kernels SCENE TECHNIQUE[,TECHNIQUE...] [--all]".into());
    };
    let scene = scene::load(Path::new(path), &LoadOptions::default())?;
    if !all {
        let names: Vec<&str> = HEAVY.iter().map(|(name, _)| *name).collect();
        println!("| kernel | instructions | of | inlined | {} |", names.join(" | "));
        println!("|{}", "---|".repeat(4 + HEAVY.len()));
    }
    for technique in techniques.split(',') {
        let settings = Settings::new(&scene, Technique::parse(technique)?, Backend::Bvh);
        let (modules, constants) = modules_of(&scene, &settings, DeviceKind::Cpu)?;
        for module in modules {
            let specialised = lumbre::spirv::specialise(&lumbre::gpu::module(&module)?, &constants, Arithmetic::Free)?;
            let functions = copies(&named(&module)?, &constants)?;
            let inlined: usize = functions.iter().map(|function| function.instructions * function.copies).sum();
            let sizes = format!("{} | {} | {inlined}", specialised.after, specialised.before);
            if all {
                println!("{module}: {sizes}");
                for Copies { name, instructions, copies } in &functions {
                    println!("{:8} {copies:4} x {instructions:5} {name}", copies * instructions);
                }
            } else {
                let count = |names: &[&str]| -> usize {
                    functions
                        .iter()
                        .filter(|function| names.contains(&function.name.as_str()))
                        .map(|function| function.copies)
                        .sum()
                };
                let counts: Vec<String> = HEAVY.iter().map(|(_, names)| count(names).to_string()).collect();
                println!("| `{module}` | {sizes} | {} |", counts.join(" | "));
            }
        }
    }
    Ok(())
}

/// The module as it was compiled, with its names.
fn named(module: &str) -> Result<Vec<u32>, Box<dyn std::error::Error>> {
    let list = std::fs::read_to_string(concat!(env!("OUT_DIR"), "/modules.txt"))?;
    let found = list.lines().find_map(|line| line.strip_prefix(module)?.strip_prefix(' '));
    let bytes = std::fs::read(found.ok_or_else(|| format!("no module {module}"))?)?;
    Ok(bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect())
}
