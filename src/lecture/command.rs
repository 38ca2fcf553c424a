//! A `lumbre render` that a chapter asks for.

/// When a rendering ends.
#[derive(Clone, Copy, Debug)]
enum Budget {
    Samples(u32),
    Seconds(f64),
}

/// What is rendered and how: the arguments of `lumbre render` but for its outputs.
#[derive(Clone, Debug)]
pub struct Shot {
    scene: &'static str,
    technique: String,
    budget: Budget,
    /// Whether the budget follows from a measurement, and so must not be made smaller with the lecture.
    measured: bool,
    size: (u32, u32),
    options: Vec<String>,
}

/// Sizes of pictures: all have about as many pixels.
const SQUARE: (u32, u32) = (160, 160);
const WIDE: (u32, u32) = (192, 128);

/// The seed of references: no other picture has it.
const REFERENCE_SEED: &str = "4000";

/// How much smaller a lecture is than the full one.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Sides of pictures times this.
    pub side: f64,
    /// Samples and seconds times this.
    pub work: f64,
}

impl Shot {
    /// A scene of the canon by a technique.
    pub fn new(scene: &'static str, technique: impl Into<String>) -> Self {
        let square = scene.starts_with("cornell") || scene.starts_with("furnace");
        let size = if square { SQUARE } else { WIDE };
        Self {
            scene,
            technique: technique.into(),
            budget: Budget::Samples(64),
            measured: false,
            size,
            options: Vec::new(),
        }
    }

    /// So many samples of each pixel.
    pub fn samples(mut self, spp: u32) -> Self {
        self.budget = Budget::Samples(spp);
        self
    }

    /// So many seconds of rendering.
    pub fn seconds(mut self, seconds: f64) -> Self {
        self.budget = Budget::Seconds(seconds);
        self
    }

    /// The budget follows from what other pictures took.
    pub fn that_was_measured(mut self) -> Self {
        self.measured = true;
        self
    }

    /// Another size than the scene's usual one.
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.size = (width, height);
        self
    }

    /// Further options.
    pub fn with(mut self, options: &str) -> Self {
        self.options.extend(options.split_whitespace().map(String::from));
        self
    }

    /// With the variance of every pixel, for standard errors.
    pub fn with_errors(self) -> Self {
        self.with("--aov variance")
    }

    /// With random numbers that no other picture has: errors of the two are independent.
    pub fn with_own_seed(self) -> Self {
        self.with("--seed").with(REFERENCE_SEED).with_errors()
    }

    /// Its scene's file.
    pub fn file(&self, scenes: &str) -> String {
        format!("{scenes}/{}.xml", self.scene)
    }

    /// The command line after the program's name.
    pub fn arguments(&self, scenes: &str, scale: Scale) -> Vec<String> {
        let side = |side: u32| ((f64::from(side) * scale.side).round() as u32).max(1);
        let work = if self.measured { 1.0 } else { scale.work };
        let budget = match self.budget {
            Budget::Samples(spp) if work == 1.0 => ["-n".into(), spp.to_string()],
            Budget::Samples(spp) => ["-n".into(), ((f64::from(spp) * work).round() as u32).max(2).to_string()],
            Budget::Seconds(seconds) => ["-t".into(), short(seconds * work)],
        };
        let size = format!("{}x{}", side(self.size.0), side(self.size.1));
        let fixed = ["render".into(), self.file(scenes), "-i".into(), self.technique.clone()];
        fixed.into_iter().chain(budget).chain(["--size".into(), size]).chain(self.options.iter().cloned()).collect()
    }
}

/// Seconds with no more digits than mean something.
fn short(seconds: f64) -> String {
    format!("{}", (seconds.max(0.001) * 1000.0).round() / 1000.0)
}

/// A command as one types it: arguments that a shell would change in quotes.
pub fn typed(arguments: &[String]) -> String {
    let quoted = |argument: &String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
        let is_plain = !argument.is_empty() && argument.chars().all(plain);
        if is_plain { argument.clone() } else { format!("'{}'", argument.replace('\'', "'\\''")) }
    };
    std::iter::once(String::from("lumbre")).chain(arguments.iter().map(quoted)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shot_as_a_command() {
        let shot = Shot::new("cornell", "path").samples(512).with("--max-depth 4").with_own_seed();
        let line = |scale| typed(&shot.arguments("my scenes", scale));
        let full = Scale { side: 1.0, work: 1.0 };
        assert_eq!(
            line(full),
            "lumbre render 'my scenes/cornell.xml' -i path -n 512 --size 160x160 --max-depth 4 --seed 4000 --aov variance"
        );
        assert!(line(Scale { side: 0.1, work: 0.001 }).contains("-n 2 --size 16x16"));
        let timed = Shot::new("door_ajar", "bdpt").seconds(2.0 / 3.0).arguments("scenes", full);
        assert_eq!(typed(&timed), "lumbre render scenes/door_ajar.xml -i bdpt -t 0.667 --size 192x128");
    }
}
