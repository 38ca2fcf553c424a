//! Which shards belong together, and in which order.

use std::path::PathBuf;

use crate::checkpoint::Identity;
use crate::error::{Error, Result, all_of};
use crate::techniques::Shard;

/// A shard in a file.
#[derive(Clone, Debug)]
pub struct Part {
    /// The file.
    pub path: PathBuf,
    /// What was rendered.
    pub identity: Identity,
    /// Which share of the samples it is.
    pub shard: Shard,
    /// Samples that each pixel has.
    pub spp: u32,
}

/// Puts shards into their order. Fails, with the name of the file, where one is of another rendering, is there twice, is not finished, or is missing.
/// Returns whether they were rendered on different devices.
pub(super) fn put_in_order(parts: &mut [Part]) -> Result<bool> {
    parts.sort_by_key(|part| part.shard.number);
    let refused = |message: String| Err(Error::Usage(message));
    let Some(first) = parts.first() else { return refused(String::from("there is nothing to merge")) };
    let whole = |part: &Part| part.identity.clone().whole();
    let asked = whole(first).anywhere();
    let mut devices_differ = false;
    for part in &*parts {
        let path = part.path.display();
        if let Some(differs) = whole(part).anywhere().differs_from(&asked, ["there", "here"]) {
            return refused(format!(
                "{path} is not of the same rendering as {}; what differs is {differs}",
                first.path.display()
            ));
        }
        devices_differ |= whole(part) != whole(first);
        let [own, others] = [part.shard, first.shard];
        if (own.of, own.samples) != (others.of, others.samples) {
            return refused(format!(
                "{path} is shard {own} of {} samples per pixel, and {} shard {others} of {}: both numbers must be the same",
                own.samples,
                first.path.display(),
                others.samples
            ));
        }
    }
    if let Some((one, other)) = parts.iter().zip(&parts[1..]).find(|(one, other)| one.shard == other.shard) {
        let [one_path, other_path] = [one, other].map(|part| part.path.display());
        return refused(format!("{one_path} and {other_path} are both shard {}: it counts once", one.shard));
    }
    let of = first.shard.of;
    let is_there = |number: &u32| parts.binary_search_by_key(number, |part| part.shard.number).is_ok();
    let missing: Vec<String> =
        (1..=of).filter(|number| !is_there(number)).map(|number| format!("{number}/{of}")).collect();
    if let Some((_, rest)) = missing.split_first() {
        let [shards, are] = if rest.is_empty() { ["shard", "is"] } else { ["shards", "are"] };
        return refused(format!("{shards} {} {are} missing", all_of(missing)));
    }
    if let Some(part) = parts.iter().find(|part| part.spp != part.shard.count()) {
        return refused(format!(
            "{} is not finished: it has {} of the {} samples of shard {}; the same command with --resume goes on",
            part.path.display(),
            part.spp,
            part.shard.count(),
            part.shard
        ));
    }
    Ok(devices_differ)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(number: u32, device: &str, version: &str) -> Part {
        let entries = [("lumbre", version), ("device", device), ("shard", &format!("{number}/2 of 128 samples"))];
        let identity = serde_json::from_value(serde_json::json!(entries)).unwrap();
        let shard = Shard::new(number, 2, 128).unwrap();
        Part { path: PathBuf::from(format!("s{number}")), identity, shard, spp: 64 }
    }

    #[test]
    fn devices_may_differ_and_versions_may_not() {
        assert!(!put_in_order(&mut [part(2, "a", "1"), part(1, "a", "1")]).unwrap());
        assert!(put_in_order(&mut [part(2, "a", "1"), part(1, "b", "1")]).unwrap());
        let said = put_in_order(&mut [part(2, "a", "1"), part(1, "a", "2")]).unwrap_err().to_string();
        assert!(said.contains("what differs is lumbre (1 there, 2 here)"), "{said}");
    }
}
