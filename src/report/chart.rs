//! Curves on two logarithmic axes, as SVG.
//!
//! Each chart is drawn twice, wide and narrow, with letters of the same size; the style sheet shows the one that fits.

use super::html::escape;
use super::number;
use super::scale::{LogScale, Tick, drawable};
use crate::statistics::Interval;

/// Colours and marker shapes that the style sheet and [`marker`] have; further series repeat them with dashes.
pub const STYLES: usize = 8;

/// A chart.
pub struct Chart<'a> {
    /// What it shows, for those who do not see it.
    pub text: String,
    /// Title of the horizontal axis.
    pub x: &'a str,
    /// Title of the vertical axis.
    pub y: &'a str,
    /// The curves.
    pub series: Vec<Series<'a>>,
    /// A straight line to compare them with.
    pub guide: Option<Guide<'a>>,
    /// Values that all curves are read against. One that is less than a decade beyond the vertical axis extends it; of one that is
    /// farther away the caption says where it is.
    pub levels: Vec<Level<'a>>,
}

/// A value that has a horizontal line of its own.
pub struct Level<'a> {
    /// The value.
    pub value: f64,
    /// What stands at the line.
    pub label: &'a str,
}

/// A curve.
pub struct Series<'a> {
    /// What it belongs to.
    pub name: &'a str,
    /// Its number among the scene's variants: colour, shape and dashes follow from it.
    pub index: usize,
    /// Its points.
    pub points: Vec<Spot>,
    /// A level that it cannot fall below, if one is known.
    pub floor: Option<f64>,
}

/// A point of a curve.
pub struct Spot {
    /// Where it is horizontally.
    pub x: Interval,
    /// And vertically.
    pub y: Interval,
    /// What it stands for.
    pub text: String,
}

/// A dashed line of one slope.
pub struct Guide<'a> {
    /// Its slope in the logarithmic plane.
    pub slope: f64,
    /// Where it goes.
    pub through: Through,
    /// What stands beside it.
    pub label: &'a str,
}

/// Where a guide line goes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Through {
    /// Through the end of a curve, so that the ends of all others lie on or above it.
    BestEnd,
    /// Through (1, 1).
    Unity,
}

/// Measures of a drawing in px.
#[derive(Clone, Copy)]
struct Frame {
    class: &'static str,
    width: f64,
    height: f64,
}

const FRAMES: [Frame; 2] =
    [Frame { class: "wide", width: 600.0, height: 400.0 }, Frame { class: "narrow", width: 350.0, height: 380.0 }];
/// Room for labels and titles around the curves.
const LEFT: f64 = 68.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 50.0;

/// Distance that labels keep from each other, horizontally and vertically.
const LABEL_WIDTH: f64 = 42.0;
const LABEL_HEIGHT: f64 = 20.0;
/// How far a level may extend the vertical axis, in decades.
const LEVEL_ROOM: f64 = 1.0;
/// Room that a level's label needs above its line.
const LEVEL_LABEL: f64 = 18.0;
/// A guide line shorter than this has no room for its label.
const LEAST_GUIDE: f64 = 200.0;

/// The two axes of a drawing.
struct Plane {
    frame: Frame,
    x: LogScale,
    y: LogScale,
}

impl Chart<'_> {
    /// The chart in both widths, or a sentence where nothing can be drawn; and how many points were left out.
    pub fn draw(&self) -> String {
        let drawings: Option<String> = FRAMES.iter().map(|frame| self.drawing(*frame)).collect();
        let Some(drawings) = drawings else {
            return format!("<p class=\"empty\">{}: there is no positive figure to draw.</p>\n", escape(self.y));
        };
        let lost = self.series.iter().flat_map(|series| &series.points).filter(|spot| !spot.drawable()).count();
        let mut sentences: Vec<String> = self.levels_out_of_reach();
        match lost {
            0 => {}
            1 => sentences.push(String::from("One point is not positive and finite, and is not drawn.")),
            _ => sentences.push(format!("{lost} points are not positive and finite, and are not drawn.")),
        }
        let caption = match sentences.is_empty() {
            true => String::new(),
            false => format!("<figcaption>{}</figcaption>\n", escape(&sentences.join(" "))),
        };
        format!("<figure class=\"plot\">\n{drawings}{caption}</figure>\n")
    }

    fn spots(&self) -> impl Iterator<Item = &Spot> + Clone {
        self.series.iter().flat_map(|series| &series.points).filter(|spot| spot.drawable())
    }

    /// The vertical axis between two places, extended to the levels that are near enough.
    fn vertical(&self, from: f64, to: f64) -> Option<LogScale> {
        let axis = LogScale::around(self.spots().map(|spot| &spot.y), from, to)?;
        Some(self.levels.iter().fold(axis, |extended, level| {
            // Near enough is what is near the curves, not near another level.
            if axis.reaches(level.value, LEVEL_ROOM) { extended.extended(level.value) } else { extended }
        }))
    }

    /// A sentence for each level that has no line.
    fn levels_out_of_reach(&self) -> Vec<String> {
        let Some(axis) = self.vertical(0.0, 1.0) else { return Vec::new() };
        let beyond = self.levels.iter().filter(|level| !axis.reaches(level.value, 0.0));
        let sentence = |level: &Level| {
            let value = number::figure(level.value);
            match level.value {
                value_at if !drawable(value_at) => {
                    format!("{}: {value}, which has no place on this axis.", capital(level.label))
                }
                value_at if value_at < axis.ends().0 => {
                    format!("{}, {value}, is far below this axis.", capital(level.label))
                }
                _ => format!("{}, {value}, is far above this axis.", capital(level.label)),
            }
        };
        beyond.map(sentence).collect()
    }

    fn drawing(&self, frame: Frame) -> Option<String> {
        let plane = Plane {
            frame,
            x: LogScale::around(self.spots().map(|spot| &spot.x), LEFT, frame.width - RIGHT)?,
            y: self.vertical(frame.height - BOTTOM, TOP)?,
        };
        let mut svg = format!(
            "<svg class=\"chart {}\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
            frame.class,
            frame.width,
            frame.height,
            escape(&self.text)
        );
        svg += &plane.axes(self.x, self.y);
        if let Some(guide) = &self.guide {
            let ends = self.series.iter().filter_map(|series| series.points.iter().rfind(|spot| spot.drawable()));
            svg += &plane.guide(guide, ends);
        }
        for series in &self.series {
            svg += &plane.series(series);
        }
        for level in self.levels.iter().filter(|level| plane.y.reaches(level.value, 0.0)) {
            svg += &plane.level(level);
        }
        svg += "</svg>\n";
        Some(svg)
    }
}

impl Spot {
    fn drawable(&self) -> bool {
        drawable(self.x.mean) && drawable(self.y.mean)
    }
}

impl Plane {
    /// The ends of both axes: left, right, top, bottom.
    fn sides(&self) -> (f64, f64, f64, f64) {
        (LEFT, self.frame.width - RIGHT, TOP, self.frame.height - BOTTOM)
    }

    fn axes(&self, x_title: &str, y_title: &str) -> String {
        let (left, right, top, bottom) = self.sides();
        let mut lines = String::new();
        let mut labels = String::new();
        let class = |label: &Option<String>| if label.is_some() { "major" } else { "minor" };
        for Tick { at, label } in self.x.ticks(LABEL_WIDTH) {
            lines += &format!("<path class=\"{}\" d=\"M{at:.1} {top}V{bottom}\"/>\n", class(&label));
            if let Some(label) = label {
                labels +=
                    &format!("<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>\n", bottom + 18.0);
            }
        }
        for Tick { at, label } in self.y.ticks(LABEL_HEIGHT) {
            lines += &format!("<path class=\"{}\" d=\"M{left} {at:.1}H{right}\"/>\n", class(&label));
            if let Some(label) = label {
                labels += &format!(
                    "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n",
                    left - 7.0,
                    at + 4.5
                );
            }
        }
        let (middle_x, middle_y) = (0.5 * (left + right), 0.5 * (top + bottom));
        format!(
            "<g class=\"grid\">\n{lines}<path class=\"frame\" d=\"M{left} {top}V{bottom}H{right}\"/>\n</g>\n\
             <g class=\"labels\">\n{labels}\
             <text class=\"title\" x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text class=\"title\" transform=\"translate(14 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</g>\n",
            self.frame.height - 8.0,
            escape(x_title),
            escape(y_title)
        )
    }

    fn guide<'a>(&self, guide: &Guide, ends: impl Iterator<Item = &'a Spot>) -> String {
        let heights = ends.map(|spot| spot.y.mean.log10() - guide.slope * spot.x.mean.log10());
        let height = match guide.through {
            Through::BestEnd => heights.fold(f64::INFINITY, f64::min),
            Through::Unity => 0.0,
        };
        // The part of the line within both axes, in logarithms of x.
        let (low, high) = (self.x.ends().0.log10(), self.x.ends().1.log10());
        let ends = [self.y.ends().0, self.y.ends().1].map(|y| (y.log10() - height) / guide.slope);
        let (from, to) = (low.max(ends[0].min(ends[1])), high.min(ends[0].max(ends[1])));
        if from >= to || !height.is_finite() {
            return String::new();
        }
        let place = |log: f64| (self.x.at(10f64.powf(log)), self.y.at(10f64.powf(height + guide.slope * log)));
        let ((x0, y0), (x1, y1)) = (place(from), place(to));
        // Curves end on or above the line, so the label has most room below its right end.
        let (x, y) = place(from + 0.75 * (to - from));
        let angle = (y1 - y0).atan2(x1 - x0).to_degrees();
        let label = if (x1 - x0).hypot(y1 - y0) < LEAST_GUIDE {
            String::new()
        } else {
            format!(
                "<text transform=\"translate({x:.1} {y:.1}) rotate({angle:.1})\" dy=\"16\" text-anchor=\"middle\">{}</text>",
                escape(guide.label)
            )
        };
        format!("<g class=\"guide\"><path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/>{label}</g>\n")
    }

    fn level(&self, level: &Level) -> String {
        let (left, right, top, _) = self.sides();
        let at = self.y.at(level.value);
        // Curves fall to the right, so the label has most room at the left.
        let label = if at - top < LEVEL_LABEL { at + 14.0 } else { at - 5.0 };
        format!(
            "<g class=\"level\"><path d=\"M{left} {at:.1}H{right}\"/><text x=\"{:.1}\" y=\"{label:.1}\">{}</text></g>\n",
            left + 6.0,
            escape(level.label)
        )
    }

    fn series(&self, series: &Series) -> String {
        let spots: Vec<&Spot> = series.points.iter().filter(|spot| spot.drawable()).collect();
        let place = |spot: &Spot| (self.x.at(spot.x.mean), self.y.at(spot.y.mean));
        let line = |points: &mut dyn Iterator<Item = (f64, f64)>| {
            points.map(|(x, y)| format!("{x:.1} {y:.1}")).collect::<Vec<String>>().join("L")
        };
        let mut shapes = String::new();
        if spots.len() > 1 {
            let upper = spots.iter().map(|spot| (self.x.at(spot.x.mean), self.end(spot.y.high, spot)));
            let lower = spots.iter().rev().map(|spot| (self.x.at(spot.x.mean), self.end(spot.y.low, spot)));
            shapes += &format!("<path class=\"band\" d=\"M{}Z\"/>\n", line(&mut upper.chain(lower)));
        }
        if let Some(floor) = series.floor.filter(|floor| (self.y.ends().0..self.y.ends().1).contains(floor)) {
            let (left, right, ..) = self.sides();
            shapes += &format!("<path class=\"floor\" d=\"M{left} {:.1}H{right}\"/>\n", self.y.at(floor));
        }
        if spots.len() > 1 {
            shapes += &format!("<path class=\"line\" d=\"M{}\"/>\n", line(&mut spots.iter().map(|spot| place(spot))));
        }
        for spot in spots {
            let (x, y) = place(spot);
            let (low, high) = (self.end(spot.y.low, spot), self.end(spot.y.high, spot));
            let [left, right] = [spot.x.low, spot.x.high].map(|end| if end.is_nan() { x } else { self.x.at(end) });
            let mut whiskers = String::new();
            if low - high > 0.5 {
                let (cap0, cap1) = (x - 3.0, x + 3.0);
                whiskers +=
                    &format!("M{x:.1} {low:.1}V{high:.1}M{cap0:.1} {low:.1}H{cap1:.1}M{cap0:.1} {high:.1}H{cap1:.1}");
            }
            if right - left > 0.5 {
                whiskers += &format!("M{left:.1} {y:.1}H{right:.1}");
            }
            if !whiskers.is_empty() {
                shapes += &format!("<path class=\"whisker\" d=\"{whiskers}\"/>\n");
            }
            shapes += &format!(
                "<path class=\"marker\" d=\"{}\"><title>{}</title></path>\n",
                marker(series.index, x, y),
                escape(&spot.text)
            );
        }
        format!(
            "<g class=\"series {}\" data-series=\"{}\">\n<title>{}</title>\n{shapes}</g>\n",
            style(series.index),
            series.index,
            escape(series.name)
        )
    }

    /// Where the end of an interval is drawn; what is not a number, at its mean.
    fn end(&self, value: f64, spot: &Spot) -> f64 {
        self.y.at(if value.is_nan() { spot.y.mean } else { value })
    }
}

/// A text that begins a sentence.
fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

/// The classes of a series: its colour, and dashes from the ninth on.
pub fn style(index: usize) -> String {
    format!("s{} d{}", index % STYLES, index / STYLES % 3)
}

/// What stands before a series' name in a legend.
pub fn key(index: usize) -> String {
    format!(
        "<svg class=\"swatch series {}\" viewBox=\"0 0 34 14\" width=\"34\" height=\"14\" aria-hidden=\"true\">\
         <path class=\"line\" d=\"M1 7H33\"/><path class=\"marker\" d=\"{}\"/></svg>",
        style(index),
        marker(index, 17.0, 7.0)
    )
}

/// The outline of a marker around a point, all of about the same area.
fn marker(index: usize, x: f64, y: f64) -> String {
    let polygon = |corners: &[(f64, f64)]| {
        let places: Vec<String> = corners.iter().map(|(dx, dy)| format!("{:.1} {:.1}", x + dx, y + dy)).collect();
        format!("M{}Z", places.join("L"))
    };
    match index % STYLES {
        0 => format!("M{:.1} {y:.1}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0Z", x - 4.5),
        1 => polygon(&[(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)]),
        2 => polygon(&[(0.0, -5.5), (5.3, 4.0), (-5.3, 4.0)]),
        3 => polygon(&[(0.0, -6.0), (5.0, 0.0), (0.0, 6.0), (-5.0, 0.0)]),
        4 => polygon(&[(0.0, 5.5), (5.3, -4.0), (-5.3, -4.0)]),
        5 => {
            let (a, b) = (1.8, 5.2);
            let corners = [
                (-a, -b),
                (a, -b),
                (a, -a),
                (b, -a),
                (b, a),
                (a, a),
                (a, b),
                (-a, b),
                (-a, a),
                (-b, a),
                (-b, -a),
                (-a, -a),
            ];
            polygon(&corners)
        }
        6 => polygon(&[(-2.6, -4.6), (2.6, -4.6), (5.2, 0.0), (2.6, 4.6), (-2.6, 4.6), (-5.2, 0.0)]),
        _ => {
            let corner = |k: u32| {
                let radius = if k.is_multiple_of(2) { 6.2 } else { 2.8 };
                let angle = f64::from(k) * std::f64::consts::PI / 5.0;
                (radius * angle.sin(), -radius * angle.cos())
            };
            polygon(&(0..10).map(corner).collect::<Vec<_>>())
        }
    }
}

/// What a point of a curve stands for, in words.
pub fn describe(name: &str, x: &str, y: &str, value: &Interval) -> String {
    format!("{name}: {x}, {y} {}", number::interval_line(value))
}
