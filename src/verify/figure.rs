//! What a row measures: a figure beside its bound.

use serde::Serialize;

/// What a figure says, from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It has no bound: it is for the reader.
    Told,
    /// Within its bound.
    Pass,
    /// Beyond its bound by what the driver does on its own, which lumbre cannot mend.
    Driver,
    /// Beyond its bound.
    Fail,
}

impl Verdict {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Told => "told",
            Self::Pass => "pass",
            Self::Driver => "driver",
            Self::Fail => "FAIL",
        }
    }
}

/// One figure.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// The technique, or the kernel that was asked.
    pub technique: String,
    /// What the figure is, with its unit.
    pub what: String,
    /// The figure.
    pub figure: f64,
    /// What it may be at most; nothing where it is only told.
    pub bound: Option<f64>,
    /// The value that was measured, where the figure is how far that is off.
    pub measured: Option<f64>,
    /// The value that is expected of it.
    pub expected: Option<f64>,
    /// Where it is worst: a pixel, a ray, a sample, a direction.
    pub worst: String,
    /// What it says.
    pub verdict: Verdict,
}

impl Figure {
    /// A figure that must not exceed a bound.
    pub fn at_most(technique: &str, what: impl Into<String>, figure: f64, bound: f64) -> Self {
        // What is not a number is within no bound.
        let verdict = if figure <= bound { Verdict::Pass } else { Verdict::Fail };
        let (technique, what) = (technique.to_owned(), what.into());
        let (measured, expected, worst) = (None, None, String::new());
        Self { technique, what, figure, bound: Some(bound), measured, expected, worst, verdict }
    }

    /// A figure that is told only.
    pub fn told(technique: &str, what: impl Into<String>, figure: f64) -> Self {
        Self { bound: None, verdict: Verdict::Told, ..Self::at_most(technique, what, figure, 0.0) }
    }

    /// How far a value is off, relative to what is expected.
    pub fn relative(technique: &str, what: impl Into<String>, measured: f64, expected: f64, bound: f64) -> Self {
        let figure = Self::at_most(technique, what, (measured - expected).abs() / expected.abs(), bound);
        Self { measured: Some(measured), expected: Some(expected), ..figure }
    }

    /// Says where it is worst.
    pub fn worst(mut self, place: impl Into<String>) -> Self {
        self.worst = place.into();
        self
    }

    /// What is beyond its bound here is the driver's doing.
    pub fn by_driver(mut self, driver: &str) -> Self {
        if self.verdict == Verdict::Fail {
            self.verdict = Verdict::Driver;
            self.worst = format!("{driver}: {}", self.worst);
        }
        self
    }
}

/// The largest of some figures and where it was.
#[derive(Clone, Debug, Default)]
pub(super) struct Worst {
    pub value: f64,
    pub place: String,
    seen: bool,
}

impl Worst {
    /// Takes a value in; what is not a number is worse than anything.
    pub fn see(&mut self, value: f64, place: impl FnOnce() -> String) {
        let worse = value > self.value || value.is_nan() && !self.value.is_nan();
        if !self.seen || worse {
            (self.value, self.place, self.seen) = (value, place(), true);
        }
    }

    /// As a figure.
    pub fn figure(self, technique: &str, what: impl Into<String>, bound: f64) -> Figure {
        // Nothing seen is nothing shown.
        let value = if self.seen { self.value } else { f64::NAN };
        Figure::at_most(technique, what, value, bound).worst(self.place)
    }
}
