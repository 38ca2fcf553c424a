//! Compiles every shader: technique x pass x backend from the table in `src/techniques/table.rs`, and the kernels in
//! `shaders/kernels`. None is optimised: `src/spirv` makes of each what a scene needs before a driver sees it. A shader
//! is compiled again only when its text, or that of a file it includes, has changed, comments aside.

use std::collections::{BTreeSet, HashMap};
use std::fmt::Write as _;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

#[allow(dead_code, unused_imports)]
#[path = "src/layout/mod.rs"]
mod layout;
#[allow(dead_code)]
#[path = "src/spirv/mod.rs"]
mod spirv;
#[allow(dead_code, unused_imports)]
#[path = "src/techniques/table.rs"]
mod table;

/// One SPIR-V module to make.
struct Variant {
    /// Its name in the generated table: `path.pixels.bvh`.
    name: String,
    /// Path below `shaders/`.
    file: String,
    /// What `#include "trace/backend.glsl"` stands for.
    backend: &'static layout::backend::BackendRow,
    /// Whose parameters `#include "generated/parameters.glsl"` stands for.
    technique: Option<&'static table::TechniqueRow>,
    /// A macro that is defined as 1.
    define: Option<String>,
}

/// The names of the files in a folder, in order.
fn files_in(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The technique whose parameters a kernel that belongs to none has: it says so in a line `// Parameters of technique: NAME`.
fn technique_of_kernel(file: &str) -> Result<Option<&'static table::TechniqueRow>, String> {
    let text = fs::read_to_string(file).map_err(|error| format!("cannot read {file}: {error}"))?;
    let Some(name) = text.lines().find_map(|line| line.strip_prefix("// Parameters of technique: ")) else {
        return Ok(None);
    };
    table::find(name.trim()).map(Some).ok_or_else(|| format!("{file}: there is no technique '{}'", name.trim()))
}

fn variants() -> Result<Vec<Variant>, String> {
    let mut all = Vec::new();
    for backend in layout::backend::BACKENDS {
        for row in table::TECHNIQUES {
            for pass in row.passes {
                all.push(Variant {
                    name: row.module(pass, backend.name),
                    file: row.file.to_owned(),
                    backend,
                    technique: Some(row),
                    define: Some(pass.define()),
                });
            }
        }
        for folder in ["film", "rays", "test"] {
            for kernel in files_in(&format!("shaders/kernels/{folder}")) {
                // What a driver traverses on its own cannot be counted.
                if kernel == "count.glsl" && !backend.counts {
                    continue;
                }
                let technique = technique_of_kernel(&format!("shaders/kernels/{folder}/{kernel}"))?;
                all.push(Variant {
                    name: format!("{folder}/{}.{}", kernel.trim_end_matches(".glsl"), backend.name),
                    file: format!("kernels/{folder}/{kernel}"),
                    backend,
                    technique,
                    define: None,
                });
            }
        }
    }
    Ok(all)
}

/// The text that `#include "name"` stands for.
fn resolve(name: &str, generated: &Path, variant: &Variant) -> Result<(String, String), String> {
    let (shown, path) = match name.strip_prefix("generated/") {
        Some(file) => (name.to_owned(), generated.join(file)),
        None if name == "trace/backend.glsl" => {
            let file = format!("trace/{}", variant.backend.file);
            (format!("shaders/{file}"), Path::new("shaders").join(file))
        }
        None => (format!("shaders/{name}"), Path::new("shaders").join(name)),
    };
    let text = if name == "generated/parameters.glsl" {
        variant.technique.map_or_else(String::new, table::TechniqueRow::parameters_glsl)
    } else {
        fs::read_to_string(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))?
    };
    // Each file takes part once, as if it had an include guard.
    let guard: String =
        shown.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' }).collect();
    Ok((shown, format!("#ifndef INCLUDED_{guard}\n#define INCLUDED_{guard}\n#line 1\n{text}\n#endif\n")))
}

/// A text without comments, blank lines and the space around lines: what decides whether something must be compiled again.
fn without_comments(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty()).fold(String::new(), |all, line| all + line + "\n")
}

/// A variant's text with all that it includes, as a hash.
fn fingerprint(variant: &Variant, generated: &Path) -> Result<u64, String> {
    let mut seen = BTreeSet::new();
    let mut queue = vec![variant.file.clone()];
    let mut hasher = DefaultHasher::new();
    let recipe = without_comments(&fs::read_to_string("build.rs").unwrap_or_default());
    (variant.backend.name, &variant.define, recipe).hash(&mut hasher);
    while let Some(name) = queue.pop() {
        if !seen.insert(name.clone()) {
            continue;
        }
        let (_, text) = resolve(&name, generated, variant)?;
        without_comments(&text).hash(&mut hasher);
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
    options.set_optimization_level(shaderc::OptimizationLevel::Zero);
    options.set_warnings_as_errors();
    if let Some(define) = &variant.define {
        options.add_macro_definition(define, Some("1"));
    }
    options.set_include_callback(|name, _, _, _| {
        let (resolved_name, content) = resolve(name, generated, variant)?;
        Ok(shaderc::ResolvedInclude { resolved_name, content })
    });
    let artifact = compiler
        .compile_into_spirv(&text, shaderc::ShaderKind::Compute, &source, "main", Some(&options))
        .map_err(|error| format!("{} for backend {}:\n{error}", variant.name, variant.backend.name))?;
    Ok(artifact.as_binary_u8().to_vec())
}

/// A module as it was compiled, with its names, and as the program holds it: without them, deflated.
struct Made {
    named: PathBuf,
    words: usize,
    deflated: Vec<u8>,
}

/// A variant's module, compiled unless it is there already.
fn make(compiler: &shaderc::Compiler, variant: &Variant, generated: &Path, modules: &Path) -> Result<Made, String> {
    let stem = variant.name.replace('/', "-");
    let named = modules.join(format!("{stem}-{:016x}.spv", fingerprint(variant, generated)?));
    let failed = |error: std::io::Error| format!("cannot write {}: {error}", named.display());
    if !named.exists() {
        // Another build may be at the same module: it appears whole or not at all.
        let part = named.with_extension(format!("{}.part", std::process::id()));
        write_if_changed(&part, &compile(compiler, variant, generated)?)?;
        fs::rename(&part, &named).map_err(failed)?;
    }
    let bytes = fs::read(&named).map_err(|error| format!("cannot read {}: {error}", named.display()))?;
    let words: Vec<u32> =
        bytes.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect();
    let stripped = spirv::strip(&words).map_err(|error| format!("{}: {error}", variant.name))?;
    let mut deflated = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    let deflated = deflated
        .write_all(&stripped.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>())
        .and_then(|()| deflated.finish())
        .map_err(failed)?;
    Ok(Made { named, words: stripped.len(), deflated })
}

/// Compiles what draws the window of `lumbre view`: a vertex and a fragment shader, which no scene specialises.
fn make_interface(out: &Path) -> Result<(), String> {
    let compiler = shaderc::Compiler::new().map_err(|error| error.to_string())?;
    let mut options = shaderc::CompileOptions::new().map_err(|error| error.to_string())?;
    options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
    options.set_warnings_as_errors();
    for (stage, kind) in [("vert", shaderc::ShaderKind::Vertex), ("frag", shaderc::ShaderKind::Fragment)] {
        let source = format!("shaders/interface/interface.{stage}");
        let text = fs::read_to_string(&source).map_err(|error| format!("cannot read {source}: {error}"))?;
        let module = compiler
            .compile_into_spirv(&text, kind, &source, "main", Some(&options))
            .map_err(|error| error.to_string())?;
        write_if_changed(&out.join(format!("interface.{stage}.spv")), module.as_binary_u8())?;
    }
    Ok(())
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
    let of_techniques: Vec<&layout::SharedStruct> = table::structs().collect();
    write_if_changed(&generated.join("layout.glsl"), layout::glsl(&of_techniques).as_bytes())?;
    write_if_changed(&generated.join("inline.glsl"), layout::inline_glsl().as_bytes())?;
    write_if_changed(&generated.join("materials.glsl"), layout::materials_glsl().as_bytes())?;
    write_if_changed(&generated.join("properties.glsl"), layout::properties_glsl().as_bytes())?;
    write_if_changed(&generated.join("lights.glsl"), layout::lights_glsl().as_bytes())?;

    watch(Path::new("shaders"));
    for source in ["build.rs", "src/layout", "src/spirv", "src/techniques/table.rs"] {
        println!("cargo:rerun-if-changed={source}");
    }
    for family in files_in("src/techniques") {
        for file in ["row.rs", "structs.rs"] {
            let file = format!("src/techniques/{family}/{file}");
            if Path::new(&file).exists() {
                println!("cargo:rerun-if-changed={file}");
            }
        }
    }

    if std::env::var_os("CARGO_FEATURE_VIEW").is_some() {
        make_interface(&out)?;
    }

    // Compiling takes a tenth of a second each: every core takes the next one until none is left.
    let all = variants()?;
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, Result<Made, String>)>> = Mutex::default();
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
    // The program holds each module once, also where two variants come to the same; tests read the names of modules from files.
    let mut errors = Vec::new();
    let mut table = String::from("pub(crate) static MODULES: &[(&str, usize, &[u8])] = &[\n");
    let mut files = String::new();
    let mut held: HashMap<Vec<u8>, PathBuf> = HashMap::new();
    for (index, made) in results {
        let made = match made {
            Ok(made) => made,
            Err(error) => {
                errors.push(error);
                continue;
            }
        };
        let name = &all[index].name;
        let _ = writeln!(files, "{name} {}", made.named.display());
        let path = match held.get(&made.deflated) {
            Some(path) => path.clone(),
            None => {
                let path = out.join(format!("{}.deflated", name.replace('/', "-")));
                write_if_changed(&path, &made.deflated)?;
                held.insert(made.deflated, path.clone());
                path
            }
        };
        let _ = writeln!(table, "    ({name:?}, {}, include_bytes!({:?})),", made.words, path.display().to_string());
    }
    table.push_str("];\n");
    if !errors.is_empty() {
        return Err(errors.join("\n"));
    }
    write_if_changed(&out.join("modules.txt"), files.as_bytes())?;
    write_if_changed(&out.join("modules.rs"), table.as_bytes())
}

fn main() {
    if let Err(error) = run() {
        // Cargo shows what a failed build script wrote to stderr.
        eprintln!("\n{error}");
        std::process::exit(1);
    }
}
