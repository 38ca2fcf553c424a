//! The range of the numbers in the JSON of a file, before any is read in single precision and becomes infinite.

use std::fmt::Write;
use std::path::Path;

use gltf::json::Value;
use serde_json::Map;

use super::document::EXTENSIONS;
use crate::error::{Error, Result};
use crate::scene::single;

/// Members that are not read, or whose bounds are: what applications put there is theirs.
const NOT_READ: [&str; 5] = ["accessors", "animations", "asset", "extras", "range"];

/// Fails where a number that is read does not fit single precision.
pub(super) fn check(path: &Path, root: &Map<String, Value>) -> Result<()> {
    members(root, &mut String::new()).map_err(|message| Error::scene(path, message))
}

fn members(object: &Map<String, Value>, place: &mut String) -> Result<(), String> {
    let of_extensions = place == "extensions" || place.ends_with(".extensions");
    let unread = |name: &str| NOT_READ.contains(&name) || of_extensions && !EXTENSIONS.contains(&name);
    let length = place.len();
    for (name, value) in object.iter().filter(|(name, _)| !unread(name)) {
        place.push_str(if length == 0 { "" } else { "." });
        place.push_str(name);
        numbers(value, place)?;
        place.truncate(length);
    }
    Ok(())
}

/// `place` is where the value stands, and stays as it is.
fn numbers(value: &Value, place: &mut String) -> Result<(), String> {
    match value {
        Value::Number(number) => {
            let number = number.as_f64().unwrap_or(f64::NAN);
            single::check([number]).map_err(|message| format!("{place}: {message}"))
        }
        Value::Array(values) => {
            let length = place.len();
            for (index, value) in values.iter().enumerate() {
                let _ = write!(place, "[{index}]"); // to text, which does not fail
                numbers(value, place)?;
                place.truncate(length);
            }
            Ok(())
        }
        Value::Object(object) => members(object, place),
        Value::Null | Value::Bool(_) | Value::String(_) => Ok(()),
    }
}
