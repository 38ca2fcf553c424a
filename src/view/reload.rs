//! Shaders from their files while the program runs: what has changed is compiled, and stands for what was compiled into the program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::{Error, Result};

/// Watches a folder of shaders.
#[derive(Clone)]
pub struct Reloader {
    folder: PathBuf,
    seen: BTreeMap<PathBuf, SystemTime>,
}

/// When each file below a folder was written last.
fn times(folder: &Path, into: &mut BTreeMap<PathBuf, SystemTime>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            times(&path, into);
        } else if let Ok(time) = entry.metadata().and_then(|data| data.modified()) {
            into.insert(path, time);
        }
    }
}

impl Reloader {
    /// For the shaders in this folder, as they are now. Fails where there are none.
    pub fn new(folder: &Path) -> Result<Self> {
        if !cfg!(feature = "hot-reload") {
            let message = "this lumbre was built without a compiler of shaders; with it: cargo build --release --features hot-reload";
            return Err(Error::Usage(String::from(message)));
        }
        if !folder.join("core/prelude.glsl").is_file() {
            return Err(Error::Usage(format!(
                "{} holds no shaders of lumbre: valid is the folder with core/prelude.glsl",
                folder.display()
            )));
        }
        let mut reloader = Self { folder: folder.to_owned(), seen: BTreeMap::new() };
        reloader.has_changed();
        Ok(reloader)
    }

    /// Whether any file has been written, made or removed since the last call.
    pub fn has_changed(&mut self) -> bool {
        let mut now = BTreeMap::new();
        times(&self.folder, &mut now);
        let changed = now != self.seen;
        self.seen = now;
        changed
    }

    /// Compiles the modules of a technique for a backend, and of AOVs, from their files; pipelines that are made from now on are made of them. Fails with the compiler's
    /// messages, and then leaves all modules as they were.
    #[cfg(feature = "hot-reload")]
    pub fn reload(&self, technique: &str, backend: &str) -> Result<(), String> {
        use crate::gpu::replace_modules;
        use crate::modules::compile::Compiler;
        use crate::modules::source::Sources;
        use crate::modules::variants::variants;
        use crate::spirv;

        let sources = Sources::new(&self.folder);
        let compiler = Compiler::new()?;
        let taken = |name: &str| {
            name.ends_with(&format!(".{backend}"))
                && (name.starts_with(&format!("{technique}.")) || name.starts_with("film/"))
        };
        let mut made = Vec::new();
        for variant in variants(&self.folder)?.iter().filter(|variant| taken(&variant.name)) {
            let bytes = compiler.compile(variant, &sources)?;
            let words: Vec<u32> =
                bytes.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect();
            made.push((variant.name.clone(), spirv::strip(&words)?));
        }
        replace_modules(made);
        Ok(())
    }

    /// There is no compiler in this program.
    #[cfg(not(feature = "hot-reload"))]
    pub fn reload(&self, _: &str, _: &str) -> Result<(), String> {
        Err(format!("{}: there is no compiler of shaders in this program", self.folder.display()))
    }
}
