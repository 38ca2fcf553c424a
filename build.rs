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
#[path = "src/modules/mod.rs"]
mod modules;
#[allow(dead_code)]
#[path = "src/spirv/mod.rs"]
mod spirv;
#[allow(dead_code, unused_imports)]
#[path = "src/techniques/table.rs"]
mod table;

use modules::compile::Compiler;
use modules::source::Sources;
use modules::variants::{Variant, files_in, variants};

/// A text without comments, blank lines and the space around lines: what decides whether something must be compiled again.
fn without_comments(text: &str) -> String {
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty()).fold(String::new(), |all, line| all + line + "\n")
}

/// A variant's text with all that it includes, as a hash.
fn fingerprint(variant: &Variant, sources: &Sources) -> Result<u64, String> {
    let mut seen = BTreeSet::new();
    let mut queue = vec![variant.file.clone()];
    let mut hasher = DefaultHasher::new();
    let recipe = without_comments(&fs::read_to_string("src/modules/compile.rs").unwrap_or_default());
    (variant.backend.name, &variant.define, recipe).hash(&mut hasher);
    while let Some(name) = queue.pop() {
        if !seen.insert(name.clone()) {
            continue;
        }
        let (_, text) = sources.resolve(&name, variant)?;
        without_comments(&text).hash(&mut hasher);
        for line in text.lines() {
            if let Some(included) = line.trim().strip_prefix("#include \"").and_then(|rest| rest.strip_suffix('"')) {
                queue.push(included.to_owned());
            }
        }
    }
    Ok(hasher.finish())
}

/// A module as it was compiled, with its names, and as the program holds it: without them, deflated.
struct Made {
    named: PathBuf,
    words: usize,
    deflated: Vec<u8>,
}

/// A variant's module, compiled unless it is there already.
fn make(compiler: &Compiler, variant: &Variant, sources: &Sources, modules: &Path) -> Result<Made, String> {
    let stem = variant.name.replace('/', "-");
    let named = modules.join(format!("{stem}-{:016x}.spv", fingerprint(variant, sources)?));
    let failed = |error: std::io::Error| format!("cannot write {}: {error}", named.display());
    if !named.exists() {
        // Another build may be at the same module: it appears whole or not at all.
        let part = named.with_extension(format!("{}.part", std::process::id()));
        write_if_changed(&part, &compiler.compile(variant, sources)?)?;
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
    // Modules are the same in every profile: in a folder beside the profiles', what `make demo` has compiled is there for `make test`.
    let modules = out.ancestors().nth(4).unwrap_or(&out).join("spirv");
    fs::create_dir_all(&modules).map_err(|error| format!("cannot make {}: {error}", modules.display()))?;
    watch(Path::new("shaders"));
    for source in ["build.rs", "src/layout", "src/modules", "src/spirv", "src/techniques/table.rs"] {
        println!("cargo:rerun-if-changed={source}");
    }
    for family in files_in(Path::new("src/techniques")) {
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
    let sources = Sources::new(Path::new("shaders"));
    let all = variants(Path::new("shaders"))?;
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<(usize, Result<Made, String>)>> = Mutex::default();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                let compiler = Compiler::new();
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(variant) = all.get(index) else { break };
                    let made = compiler
                        .as_ref()
                        .map_err(Clone::clone)
                        .and_then(|compiler| make(compiler, variant, &sources, &modules));
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
