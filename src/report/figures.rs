//! Which figure of error a comparison goes by, and the efficiencies and ratios of that figure.

use super::reference::Own;
use crate::bench::results::{Figure, HEAVY_TAIL, Pair, Ratio, SceneResults, VariantResults};
use crate::statistics::Interval;

/// The share of the least error from which on the reference's own error is worth a word.
const WORTH_WHILE: f64 = 0.1;

impl Figure {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Relmse => "relMSE",
            Self::Trimmed => "trimmed relMSE",
            Self::Parts => "relMSE of parts",
            Self::Median => "median",
        }
    }

    /// What it is, in words that need no explanation.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Relmse => "the relMSE",
            Self::Trimmed => "the relMSE without the worst thousandth of pixels",
            Self::Parts => "the relMSE of eight parts of the image, their median",
            Self::Median => "the median of the pixels' squared relative errors",
        }
    }
}

impl Pair {
    /// The ratio of efficiencies by a figure of error, with its test.
    pub fn by(&self, figure: Figure) -> &Ratio {
        match figure {
            Figure::Relmse => &self.efficiency,
            Figure::Trimmed => &self.trimmed,
            Figure::Parts => &self.parts,
            Figure::Median => &self.median,
        }
    }

    /// The ratio by the figure that decides.
    pub fn decisive(&self) -> &Interval {
        &self.by(self.decided_by).ratio
    }
}

impl VariantResults {
    /// The efficiency by a figure of error.
    pub fn efficiency_by(&self, figure: Figure) -> &Interval {
        match figure {
            Figure::Relmse => &self.efficiency,
            Figure::Trimmed => &self.trimmed_efficiency,
            Figure::Parts => &self.parts_efficiency,
            Figure::Median => &self.median_efficiency,
        }
    }

    /// Whether few pixels decide its relMSE.
    pub fn is_heavy(&self) -> bool {
        self.worst_share > HEAVY_TAIL
    }
}

impl SceneResults {
    /// The figure of error that its variants are ordered by: relMSE, or that of parts where it decides between any of them and the first.
    pub fn ordered_by(&self) -> Figure {
        if self.pairs.iter().any(|pair| pair.decided_by == Figure::Parts) { Figure::Parts } else { Figure::Relmse }
    }

    /// The variants with their numbers, the most efficient first.
    pub fn by_efficiency(&self) -> Vec<(usize, &VariantResults)> {
        let figure = self.ordered_by();
        let rank = |variant: &VariantResults| {
            let mean = variant.efficiency_by(figure).mean;
            if mean.is_nan() { f64::NEG_INFINITY } else { mean }
        };
        let mut sorted: Vec<_> = self.variants.iter().enumerate().collect();
        sorted.sort_by(|(_, a), (_, b)| rank(b).total_cmp(&rank(a)));
        sorted
    }

    /// The reference's own error over the least relMSE of a variant, where that is more than a tenth: a better reference is worth while.
    pub fn reference_share(&self) -> Option<f64> {
        let own = Own::of(&self.reference)?.relmse;
        let errors = self.variants.iter().filter_map(|variant| Some(variant.last()?.relmse.mean));
        let least = errors.filter(|error| error.is_finite()).fold(f64::INFINITY, f64::min);
        let share = if least > 0.0 { own / least } else { f64::INFINITY };
        (share > WORTH_WHILE).then_some(share)
    }

    /// How a variant compares with the scene's first one.
    pub fn pair_of(&self, variant: &str) -> Option<&Pair> {
        self.pairs.iter().find(|pair| pair.variant == variant && pair.against != variant)
    }
}
