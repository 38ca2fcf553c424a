//! GLSL to SPIR-V, by shaderc. Nothing is optimised: `src/spirv` makes of each module what a scene needs before a driver sees it.

use super::source::Sources;
use super::variants::Variant;

/// The compiler; one for each thread.
pub struct Compiler(shaderc::Compiler);

impl Compiler {
    /// Makes one.
    pub fn new() -> Result<Self, String> {
        shaderc::Compiler::new().map(Self).map_err(|error| error.to_string())
    }

    /// A module's bytes; fails with the compiler's messages, each with file and line.
    pub fn compile(&self, variant: &Variant, sources: &Sources) -> Result<Vec<u8>, String> {
        let text = sources.read(&variant.file)?;
        let mut options = shaderc::CompileOptions::new().map_err(|error| error.to_string())?;
        options.set_target_env(shaderc::TargetEnv::Vulkan, shaderc::EnvVersion::Vulkan1_3 as u32);
        options.set_target_spirv(shaderc::SpirvVersion::V1_5);
        options.set_optimization_level(shaderc::OptimizationLevel::Zero);
        options.set_warnings_as_errors();
        if let Some(define) = &variant.define {
            options.add_macro_definition(define, Some("1"));
        }
        options.set_include_callback(|name, _, _, _| {
            let (resolved_name, content) = sources.resolve(name, variant)?;
            Ok(shaderc::ResolvedInclude { resolved_name, content })
        });
        let file = format!("shaders/{}", variant.file);
        let artifact = self
            .0
            .compile_into_spirv(&text, shaderc::ShaderKind::Compute, &file, "main", Some(&options))
            .map_err(|error| format!("{} for backend {}:\n{error}", variant.name, variant.backend.name))?;
        Ok(artifact.as_binary_u8().to_vec())
    }
}
