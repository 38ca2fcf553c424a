//! Compiles every shader: technique x pass x backend from the table in `src/integrator.rs`, and the kernels in
//! `shaders/test` and `shaders/rays`. A shader is compiled again only when its text, or that of a file it includes, has changed.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

#[allow(dead_code)]
#[path = "src/backend.rs"]
mod backend;
#[allow(dead_code)]
#[path = "src/integrator.rs"]
mod integrator;
#[allow(dead_code, unused_imports)]
#[path = "src/layout/mod.rs"]
mod layout;

/// One SPIR-V module to make.
struct Variant {
    /// Its name in the generated table: `path.pixels.bvh`.
    name: String,
    /// Path below `shaders/`.
    file: String,
    /// What `#include "trace/backend.glsl"` stands for.
    backend: &'static backend::BackendRow,
    /// Macros, each defined as 1.
    defines: Vec<String>,
    /// Drivers read an optimised module in a fraction of the time; one that is not keeps its names.
    optimised: bool,
}

/// The names of the files in a folder, in order.
fn files_in(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn variants() -> Vec<Variant> {
    let mut all = Vec::new();
    for backend in backend::BACKENDS {
        for row in integrator::INTEGRATORS {
            for pass in row.passes {
                all.push(Variant {
                    name: format!("{}.{}.{}", row.name, pass.name, backend.name),
                    file: format!("integrators/{}", row.file),
                    backend,
                    defines: vec![format!("PASS_{}", pass.name.to_uppercase().replace('-', "_"))],
                    optimised: true,
                });
            }
        }
        for folder in ["test", "rays"] {
            for kernel in files_in(&format!("shaders/{folder}")) {
                // What a driver traverses on its own cannot be counted.
                if kernel == "count.glsl" && !backend.counts {
                    continue;
                }
                all.push(Variant {
                    name: format!("{folder}/{}.{}", kernel.trim_end_matches(".glsl"), backend.name),
                    file: format!("{folder}/{kernel}"),
                    backend,
                    defines: Vec::new(),
                    // The kernel that counts is not one whose speed matters, and tests/layout.rs reads its names.
                    optimised: folder != "test" && kernel != "count.glsl",
                });
            }
        }
    }
    // Each again without what many scenes do without.
    let lean: Vec<Variant> = all
        .iter()
        .map(|full| Variant {
            name: format!("{}.lean", full.name),
            file: full.file.clone(),
            backend: full.backend,
            defines: full.defines.iter().cloned().chain([String::from("LEAN")]).collect(),
            optimised: full.optimised,
        })
        .collect();
    // With everything that there is this one takes more identifiers than the optimiser has.
    all.iter_mut().filter(|full| full.name.starts_with("mlt.multiplexed.")).for_each(|full| full.optimised = false);
    all.extend(lean);
    // Techniques with their names, for tests/layout.rs.
    for (name, defines) in [
        ("path", None),
        ("bdpt", Some("PASS_LIGHT")),
        ("photon", Some("PASS_CAMERA")),
        ("radiosity", Some("PASS_GATHER")),
        ("mlt", Some("PASS_PRIMARY")),
    ] {
        all.extend(backend::BACKENDS.iter().map(|backend| Variant {
            name: format!("test/{name}.{}", backend.name),
            file: format!("integrators/{name}.glsl"),
            backend,
            defines: defines.iter().map(|define| String::from(*define)).collect(),
            optimised: false,
        }));
    }
    all
}

/// The text that `#include "name"` stands for.
fn resolve(name: &str, generated: &Path, backend: &backend::BackendRow) -> Result<(String, String), String> {
    let (shown, path) = match name.strip_prefix("generated/") {
        Some(file) => (name.to_owned(), generated.join(file)),
        None if name == "trace/backend.glsl" => {
            let file = format!("trace/{}", backend.file);
            (format!("shaders/{file}"), Path::new("shaders").join(file))
        }
        None => (format!("shaders/{name}"), Path::new("shaders").join(name)),
    };
    let text = fs::read_to_string(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    // Each file takes part once, as if it had an include guard.
    let guard: String =
        shown.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
    Ok((shown, format!("#ifndef INCLUDED_{guard}\n#define INCLUDED_{guard}\n#line 1\n{text}\n#endif\n")))
}

/// A variant's text with all that it includes, as a hash: what decides whether it must be compiled again.
fn fingerprint(variant: &Variant, generated: &Path) -> Result<u64, String> {
    let mut seen = BTreeSet::new();
    let mut queue = vec![variant.file.clone()];
    let mut hasher = DefaultHasher::new();
    (variant.backend.name, &variant.defines, variant.optimised, fs::read_to_string("build.rs").unwrap_or_default())
        .hash(&mut hasher);
    while let Some(name) = queue.pop() {
        if !seen.insert(name.clone()) {
            continue;
        }
        let (_, text) = resolve(&name, generated, variant.backend)?;
        text.hash(&mut hasher);
        for line in text.lines() {
            if let Some(included) = line.trim().strip_prefix("#include \"").and_then(|rest| rest.strip_suffix('"')) {
                queue.push(included.to_owned());
            }
        }
    }
    Ok(hasher.finish())
}

fn compile(compiler: &shaderc::Compiler, variant: &Variant, generated: &Path) -> Result<Vec<u8>, String> {
    let source = format!("shaders/{}", variant.file);
    let text = fs::read_to_string(&source).map_err(|error| format!("cannot read {source}: {error}"))?;
    let mut options = shaderc::CompileOptions::new().map_err(|error| error.to_string())?;
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
    options.set_target_spirv(shaderc::SpirvVersion::V1_5);
    options.set_optimization_level(if variant.optimised {
        shaderc::OptimizationLevel::Performance
    } else {
        shaderc::OptimizationLevel::Zero
    });
    options.set_warnings_as_errors();
    for define in &variant.defines {
        options.add_macro_definition(define, Some("1"));
    }
    options.set_include_callback(|name, _, _, _| {
        let (resolved_name, content) = resolve(name, generated, variant.backend)?;
        Ok(shaderc::ResolvedInclude { resolved_name, content })
    });
    let artifact = compiler
        .compile_into_spirv(&text, shaderc::ShaderKind::Compute, &source, "main", Some(&options))
        .map_err(|error| format!("{} for backend {}:\n{error}", variant.name, variant.backend.name))?;
    Ok(artifact.as_binary_u8().to_vec())
}

/// The file that holds a variant's SPIR-V, compiled unless it is there already.
fn make(compiler: &shaderc::Compiler, variant: &Variant, generated: &Path, modules: &Path) -> Result<PathBuf, String> {
    let path =
        modules.join(format!("{}-{:016x}.spv", variant.name.replace('/', "-"), fingerprint(variant, generated)?));
    if !path.exists() {
        // Another profile's build may be at the same module: it appears whole or not at all.
        let part = path.with_extension(format!("{}.part", std::process::id()));
        write_if_changed(&part, &compile(compiler, variant, generated)?)?;
        fs::rename(&part, &path).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    Ok(path)
}

fn write_if_changed(path: &Path, text: &[u8]) -> Result<(), String> {
    if fs::read(path).is_ok_and(|old| old == text) {
        return Ok(());
    }
    fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
}

fn watch(folder: &Path) {
    println!("cargo:rerun-if-changed={}", folder.display());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.path().is_dir() {
            watch(&entry.path());
        } else {
            println!("cargo:rerun-if-changed={}", entry.path().display());
        }
    }
}

fn run() -> Result<(), String> {
    let out = PathBuf::from(std::env::var("OUT_DIR").map_err(|error| error.to_string())?);
    let generated = out.join("generated");
    // Modules are the same in every profile: in a folder beside the profiles', what `make demo` has compiled is there for `make test`.
    let modules = out.ancestors().nth(4).unwrap_or(&out).join("spirv");
    for folder in [&generated, &modules] {
        fs::create_dir_all(folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
    }
    write_if_changed(&generated.join("layout.glsl"), layout::glsl().as_bytes())?;
    write_if_changed(&generated.join("inline.glsl"), layout::inline_glsl().as_bytes())?;

    watch(Path::new("shaders"));
    for source in ["build.rs", "src/backend.rs", "src/integrator.rs", "src/layout"] {
        println!("cargo:rerun-if-changed={source}");
    }

    // Compiling takes a second or so each: every core takes the next one until none is left.
    let all = variants();
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, Result<PathBuf, String>)>> = Mutex::default();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                let compiler = shaderc::Compiler::new().map_err(|error| error.to_string());
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(variant) = all.get(index) else { break };
                    let made = compiler
                        .as_ref()
                        .map_err(Clone::clone)
                        .and_then(|compiler| make(compiler, variant, &generated, &modules));
                    results.lock().unwrap_or_else(PoisonError::into_inner).push((index, made));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_by_key(|(index, _)| *index);
    let mut errors = Vec::new();
    let mut table = String::from("pub(crate) static MODULES: &[(&str, &[u8])] = &[\n");
    for (index, made) in results {
        match made {
            Ok(path) => {
                let _ =
                    writeln!(table, "    ({:?}, include_bytes!({:?})),", all[index].name, path.display().to_string());
            }
            Err(error) => errors.push(error),
        }
    }
    table.push_str("];\n");
    if !errors.is_empty() {
        return Err(errors.join("\n"));
    }
    write_if_changed(&out.join("modules.rs"), table.as_bytes())
}

fn main() {
    if let Err(error) = run() {
        // Cargo shows what a failed build script wrote to stderr.
        eprintln!("\n{error}");
        std::process::exit(1);
    }
}
