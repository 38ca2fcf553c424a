//! Steps left out on demand, for `docs/tour/`: what the validation layer says then is what a page of it quotes, and `tests/tour.rs` holds them together.
//! The variable is no option of the program: what a driver does with a step missing is undefined.

use std::sync::OnceLock;

use crate::error::{Error, Result, one_of};

/// The variable that names a step.
const VARIABLE: &str = "LUMBRE_OMIT";

macro_rules! steps {
    ($( $(#[doc = $doc:literal])* $step:ident $name:literal; )*) => {
        /// A step that can be left out.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Step { $( $(#[doc = $doc])* $step, )* }

        /// Every step by its name.
        const STEPS: &[(&str, Step)] = &[$( ($name, Step::$step), )*];
    };
}

steps! {
    /// The Vulkan version that the instance is for.
    ApiVersion "api-version";
    /// The features that are enabled with the device, without which no buffer has an address.
    Features "features";
    /// Memory is bound to buffers.
    BindMemory "bind-memory";
    /// Buffers say that their addresses will be asked for.
    AddressUsage "address-usage";
    /// Memory says that the addresses of what lies in it will be asked for.
    AddressMemory "address-memory";
    /// The pipeline layout has room for push constants.
    PushConstantRange "push-constant-range";
    /// The descriptor set is bound.
    DescriptorSet "descriptor-set";
    /// Push constants are written.
    PushConstants "push-constants";
    /// The barriers between commands.
    Barrier "barrier";
    /// Queries are reset before they are written again.
    QueryReset "query-reset";
    /// The command buffer is ended before it is submitted.
    EndCommands "end-commands";
    /// The fence is reset before it is given to the queue again.
    FenceReset "fence-reset";
    /// Buffers that acceleration structures are built from say so.
    StructureInput "structure-input";
    /// Objects are destroyed before their device.
    Destroy "destroy";
}

static ASKED: OnceLock<Option<Step>> = OnceLock::new();

/// Reads which step the environment asks to leave out; fails where there is none of that name.
pub(super) fn read() -> Result<()> {
    let asked = match std::env::var(VARIABLE) {
        Err(_) => None,
        Ok(text) => match STEPS.iter().find(|(name, _)| *name == text) {
            Some((_, step)) => Some(*step),
            None => {
                let valid = one_of(STEPS.iter().map(|(name, _)| *name));
                return Err(Error::Usage(format!("{VARIABLE}={text}: valid are {valid}")));
            }
        },
    };
    ASKED.get_or_init(|| asked);
    Ok(())
}

/// Whether any step is left out.
pub(super) fn omits_any() -> bool {
    ASKED.get().copied().flatten().is_some()
}

/// Whether this step is left out.
pub(super) fn omits(step: Step) -> bool {
    ASKED.get().copied().flatten() == Some(step)
}
