//! The header of merged images: what is true of the whole, of what is said of each shard.

use serde_json::Value;

use crate::image::Image;

/// What an attribute of lumbre begins with.
const PREFIX: &str = "lumbre.";

/// What becomes of an attribute that is not the same in all shards by intent.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    /// The sum: of numbers, of each number of an object, of lists one after the other.
    Sum,
    /// The greatest of the numbers.
    Greatest,
    /// Each different text once.
    Names,
    /// It is made anew of the merged image, or is of one shard alone.
    LeftOut,
}

/// Attributes with a rule of their own. All others are kept where all shards have the same, and left out where they do not.
const RULES: [(&str, Rule); 18] = [
    ("device", Rule::Names),
    ("driver", Rule::Names),
    ("spp", Rule::Sum),
    ("aov_samples", Rule::Sum),
    ("rays", Rule::Sum),
    ("seconds", Rule::Sum),
    ("nonfinite", Rule::Sum),
    ("nonfinite_at", Rule::Sum),
    ("peak_device_bytes", Rule::Greatest),
    ("mean", Rule::LeftOut),
    ("mrays_per_s", Rule::LeftOut),
    ("samples_per_s", Rule::LeftOut),
    ("identity", Rule::LeftOut),
    ("share", Rule::LeftOut),
    ("shard", Rule::LeftOut),
    // Estimates from a shard's own samples, of which that of the whole does not follow.
    ("estimated_relmse", Rule::LeftOut),
    ("estimate_doubt", Rule::LeftOut),
    ("brightness", Rule::LeftOut),
];

/// Different names of what shards were made on, as one text: each once, in the order of the shards.
pub fn names<'a>(all: impl IntoIterator<Item = &'a str>) -> String {
    let mut seen: Vec<&str> = Vec::new();
    for name in all {
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen.join("; ")
}

/// The header of the image that is made of these, from theirs.
pub(super) fn merged(headers: &[&[(String, String)]], image: &Image) -> Vec<(String, String)> {
    let Some((first, _)) = headers.split_first() else { return Vec::new() };
    let of = |name: &str| -> Option<Vec<&str>> {
        let find = |header: &&'_ [(String, String)]| header.iter().position(|(own, _)| own == name);
        headers.iter().map(|header| find(header).map(|at| header[at].1.as_str())).collect()
    };
    let mut merged: Vec<(String, String)> =
        first.iter().filter_map(|(name, _)| Some((name.clone(), value(rule(name), &of(name)?)?))).collect();
    let mut add = |name: &str, value: String| merged.push((format!("{PREFIX}{name}"), value));
    add("shards", headers.len().to_string());
    add("mean", Value::from(image.average().to_vec()).to_string());
    let total = |name: &str| sum(&of(&format!("{PREFIX}{name}"))?);
    let render = total("seconds").and_then(|seconds| seconds.get("render")?.as_f64()).filter(|seconds| *seconds > 0.0);
    let number = |name: &str| total(name)?.as_f64();
    if let (Some(render), Some(rays), Some(spp)) = (render, number("rays"), number("spp")) {
        let samples = spp * f64::from(image.width) * f64::from(image.height);
        add("mrays_per_s", (rays / render / 1e6).to_string());
        add("samples_per_s", (samples / render).to_string());
    }
    merged
}

fn rule(name: &str) -> Option<Rule> {
    let own = name.strip_prefix(PREFIX)?;
    RULES.iter().find(|(name, _)| *name == own).map(|(_, rule)| *rule)
}

/// The attribute of the whole, from those of all shards; nothing where it has none.
fn value(rule: Option<Rule>, all: &[&str]) -> Option<String> {
    match rule {
        None => all.iter().all(|value| value == &all[0]).then(|| all[0].to_owned()),
        Some(Rule::Names) => Some(names(all.iter().copied())),
        Some(Rule::Sum) => sum(all).map(|sum| sum.to_string()),
        Some(Rule::Greatest) => {
            let numbers: Option<Vec<u64>> = all.iter().map(|text| text.parse().ok()).collect();
            numbers?.into_iter().max().map(|most| most.to_string())
        }
        Some(Rule::LeftOut) => None,
    }
}

/// The sum of values that are written as JSON; nothing where they do not add up.
fn sum(all: &[&str]) -> Option<Value> {
    let values = all.iter().map(|text| serde_json::from_str::<Value>(text).ok()).collect::<Option<Vec<_>>>()?;
    let mut values = values.into_iter();
    let first = values.next()?;
    values.try_fold(first, plus)
}

fn plus(a: Value, b: Value) -> Option<Value> {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => Some(match (a.as_u64(), b.as_u64()) {
            (Some(a), Some(b)) => Value::from(a.checked_add(b)?),
            _ => Value::from(a.as_f64()? + b.as_f64()?),
        }),
        (Value::Array(a), Value::Array(b)) => Some(Value::from([a, b].concat())),
        (Value::Object(a), Value::Object(mut b)) if a.len() == b.len() => {
            let entries = a.into_iter().map(|(key, own)| Some((key.clone(), plus(own, b.remove(&key)?)?)));
            entries.collect::<Option<serde_json::Map<_, _>>>().map(Value::Object)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(entries: &[(&str, &str)]) -> Vec<(String, String)> {
        entries.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn what_is_of_one_shard_is_not_said_of_the_whole() {
        let one = header(&[
            ("lumbre.device", "A"),
            ("lumbre.rays", "5"),
            ("lumbre.seconds", r#"{"render":2.0,"load":1.5}"#),
            ("lumbre.spp", "64"),
            ("lumbre.nonfinite_at", r#"[{"x":1}]"#),
            ("lumbre.peak_device_bytes", "100"),
            ("lumbre.mean", "[0,0,0]"),
            ("lumbre.estimated_relmse", "0.5"),
            ("lumbre.kernels", "[1]"),
            ("lumbre.seed", "3"),
            ("owner", "me"),
            ("host", "a"),
        ]);
        let other = header(&[
            ("lumbre.device", "B"),
            ("lumbre.rays", "7"),
            ("lumbre.seconds", r#"{"render":4.0,"load":0.5}"#),
            ("lumbre.spp", "64"),
            ("lumbre.nonfinite_at", r#"[{"x":2}]"#),
            ("lumbre.peak_device_bytes", "300"),
            ("lumbre.mean", "[2,2,2]"),
            ("lumbre.estimated_relmse", "0.5"),
            ("lumbre.kernels", "[2]"),
            ("lumbre.seed", "3"),
            ("owner", "me"),
            ("host", "b"),
        ]);
        let image = Image { width: 2, height: 1, pixels: vec![[1.0; 3], [3.0; 3]] };
        let mut merged = merged(&[&one, &other, &one], &image);
        merged.sort();
        let expected = header(&[
            ("lumbre.device", "A; B"),
            ("lumbre.mean", "[2.0,2.0,2.0]"),
            ("lumbre.mrays_per_s", &(17.0 / 8.0 / 1e6).to_string()),
            ("lumbre.nonfinite_at", r#"[{"x":1},{"x":2},{"x":1}]"#),
            ("lumbre.peak_device_bytes", "300"),
            ("lumbre.rays", "17"),
            ("lumbre.samples_per_s", "48"),
            ("lumbre.seconds", r#"{"render":8.0,"load":3.5}"#),
            ("lumbre.seed", "3"),
            ("lumbre.shards", "3"),
            ("lumbre.spp", "192"),
            ("owner", "me"),
        ]);
        assert_eq!(merged, expected);
    }
}
