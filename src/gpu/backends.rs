//! Which ray backend a device traces with.

use super::device::Gpu;
use super::survey::DeviceKind;
use crate::error::{Error, Result, one_of};
use crate::layout::backend::{BACKENDS, Backend};

/// The name that leaves the choice to the device.
const AUTO: &str = "auto";

impl Backend {
    /// The backend of that name on the command line; nothing for `auto`, which leaves it to the device.
    pub fn parse(name: &str) -> Result<Option<Self>> {
        if name == AUTO {
            return Ok(None);
        }
        let found = BACKENDS.iter().find(|row| row.name == name).map(|row| row.backend);
        found.map(Some).ok_or_else(|| {
            let valid = std::iter::once(AUTO).chain(BACKENDS.iter().map(|row| row.name));
            Error::Usage(format!("no backend '{name}': valid are {}", one_of(valid)))
        })
    }
}

impl Gpu {
    /// The backend of that name on the command line, which fails where the device refuses it. Without one, or with `auto`, ray queries on GPUs
    /// that have them, and on processors the one that was measured to be faster there (docs/lavapipe.md).
    pub fn backend(&self, name: Option<&str>) -> Result<Backend> {
        if let Some(backend) = name.map(Backend::parse).transpose()?.flatten() {
            self.require(backend)?;
            return Ok(backend);
        }
        let survey = self.survey();
        let ray_query = survey.kind != DeviceKind::Cpu && survey.refusal(Backend::RayQuery).is_none();
        Ok(if ray_query { Backend::RayQuery } else { Backend::Bvh })
    }

    /// Fails, saying why and what works instead, where `backend` is refused on this device.
    pub fn require(&self, backend: Backend) -> Result<()> {
        let survey = self.survey();
        match survey.refusal(backend) {
            None => Ok(()),
            Some(why) => {
                let valid =
                    survey.backends.iter().filter(|support| support.refused.is_none()).map(|support| support.name);
                Err(Error::Usage(format!(
                    "backend {} is refused on {}: {why}. Valid there: {}",
                    backend.name(),
                    survey.name,
                    one_of(valid)
                )))
            }
        }
    }
}
