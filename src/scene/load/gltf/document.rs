//! The file as a whole: its container, its JSON and its extensions.

use std::f64::consts::FRAC_PI_4;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use gltf::json::{self, Value};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Map;

use super::range;
use crate::error::{Error, Result, one_of};
use crate::files::{FILE_BYTES, read_bytes};
use crate::scene::load::limits::JSON_BYTES;
use crate::scene::single;

/// The first chunk of a .glb.
const JSON: [u8; 4] = *b"JSON";

/// What is read of the extensions; a file that requires any other is refused.
pub(super) const EXTENSIONS: [&str; 19] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// What to do about some that are not read.
const HINTS: [(&str, &str); 2] = [
    ("KHR_draco_mesh_compression", "its meshes are compressed by Draco, and must be decompressed before; "),
    ("KHR_texture_basisu", "its images are KTX2, and must be PNG, JPEG or WebP; "),
];

/// A node, in double precision.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    pub camera: Option<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub weights: Option<Vec<f64>>,
    pub extensions: Map<String, Value>,
}

/// A skin.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub joints: Vec<usize>,
    pub inverse_bind_matrices: Option<usize>,
}

/// A scene of the file.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneEntry {
    /// Where it stands in the file, for messages.
    #[serde(skip)]
    pub element: String,
    pub nodes: Vec<usize>,
    pub extras: Value,
}

/// A light of KHR_lights_punctual, in double precision.
#[derive(Debug, Deserialize)]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default = "white")]
    pub color: [f64; 3],
    #[serde(default = "one")]
    pub intensity: f64,
    pub range: Option<f64>,
    #[serde(default)]
    pub spot: Cones,
}

fn white() -> [f64; 3] {
    [1.0; 3]
}

fn one() -> f64 {
    1.0
}

/// The angles of a spot from its axis, radians.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct Cones {
    #[serde(rename = "innerConeAngle")]
    pub inner: f64,
    #[serde(rename = "outerConeAngle")]
    pub outer: f64,
}

impl Default for Cones {
    fn default() -> Self {
        Self { inner: 0.0, outer: FRAC_PI_4 }
    }
}

/// The elements of a file; none refers to another yet.
#[derive(Debug)]
pub(super) struct Document {
    pub path: PathBuf,
    /// What a .glb carries behind its JSON.
    pub binary: Option<Vec<u8>>,
    pub accessors: Vec<json::Accessor>,
    pub buffers: Vec<json::Buffer>,
    pub buffer_views: Vec<json::buffer::View>,
    pub cameras: Vec<json::Camera>,
    pub images: Vec<json::Image>,
    pub lights: Vec<Light>,
    pub materials: Vec<json::Material>,
    pub meshes: Vec<json::Mesh>,
    pub nodes: Vec<Node>,
    pub samplers: Vec<json::texture::Sampler>,
    pub scenes: Vec<SceneEntry>,
    pub skins: Vec<Skin>,
    pub textures: Vec<json::Texture>,
    scene: Option<usize>,
    extensions_used: Vec<String>,
    has_animations: bool,
}

impl Document {
    /// Reads the file and takes its JSON apart.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = read_bytes(path, FILE_BYTES)?;
        let (text, binary) = if bytes.starts_with(b"glTF") { split_binary(path, &bytes)? } else { (&bytes[..], None) };
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        if text.len() > JSON_BYTES {
            let message = format!("its JSON has {} bytes, and {JSON_BYTES} is the most that is read", text.len());
            return Err(Error::scene(path, message));
        }
        let mut value: Value = serde_json::from_slice(text)
            .map_err(|error| Error::scene(path, format!("not a glTF file: its JSON is wrong: {error}")))?;
        make_whole(&mut value);
        let Value::Object(mut root) = value else {
            return Err(Error::scene(path, "not a glTF file: its JSON is not an object"));
        };
        check_version(path, &root)?;
        range::check(path, &root)?;
        let required: Vec<String> = elements(path, &mut root, "extensionsRequired")?;
        if let Some(unknown) = required.iter().find(|name| !EXTENSIONS.contains(&name.as_str())) {
            let hint = HINTS.iter().find(|(name, _)| name == unknown).map_or("", |(_, hint)| hint);
            return Err(Error::scene(
                path,
                format!("the file requires the extension '{}'; {hint}read are {}", shown(unknown), one_of(EXTENSIONS)),
            ));
        }
        let scene = match root.remove("scene") {
            None => None,
            Some(value) => {
                Some(serde_json::from_value(value).map_err(|error| Error::scene(path, format!("scene: {error}")))?)
            }
        };
        let mut extensions = object(path, &mut root, "extensions", "extensions")?;
        let punctual = "extensions.KHR_lights_punctual";
        let mut lights = object(path, &mut extensions, "KHR_lights_punctual", punctual)?;
        Ok(Self {
            path: path.to_owned(),
            binary: binary.map(<[u8]>::to_vec),
            accessors: elements(path, &mut root, "accessors")?,
            buffers: elements(path, &mut root, "buffers")?,
            buffer_views: elements(path, &mut root, "bufferViews")?,
            cameras: elements(path, &mut root, "cameras")?,
            images: elements(path, &mut root, "images")?,
            lights: elements(path, &mut lights, "lights")?,
            materials: elements(path, &mut root, "materials")?,
            meshes: elements(path, &mut root, "meshes")?,
            nodes: elements(path, &mut root, "nodes")?,
            samplers: elements(path, &mut root, "samplers")?,
            scenes: elements(path, &mut root, "scenes")?,
            skins: elements(path, &mut root, "skins")?,
            textures: elements(path, &mut root, "textures")?,
            extensions_used: elements(path, &mut root, "extensionsUsed")?,
            has_animations: root.get("animations").and_then(Value::as_array).is_some_and(|all| !all.is_empty()),
            scene,
        })
    }

    /// Says what the file uses and is not read.
    pub fn warn(&self, warnings: &mut Vec<String>) {
        for name in &self.extensions_used {
            if !EXTENSIONS.contains(&name.as_str()) {
                warnings.push(format!("the extension '{}' is not read", shown(name)));
            }
        }
        if self.has_animations {
            warnings.push(String::from("animations are not read: nodes stand as the file places them"));
        }
    }

    /// The default scene, or the first one; of a file without scenes, all nodes that are no other node's children.
    pub fn scene(&self) -> Result<SceneEntry> {
        let index = self.scene.unwrap_or(0);
        if self.scenes.is_empty() && self.scene.is_none() {
            let mut is_child = vec![false; self.nodes.len()];
            for child in self.nodes.iter().flat_map(|node| &node.children) {
                if let Some(is_child) = is_child.get_mut(*child) {
                    *is_child = true;
                }
            }
            let nodes = (0..self.nodes.len()).filter(|node| !is_child[*node]).collect();
            return Ok(SceneEntry { element: String::from("the file"), nodes, extras: Value::Null });
        }
        let scene = self.get(&self.scenes, "scenes", index, "scene")?;
        Ok(SceneEntry { element: format!("scenes[{index}]"), ..scene.clone() })
    }

    /// An error about one element.
    pub fn wrong(&self, element: &str, message: impl Display) -> Error {
        Error::scene(&self.path, format!("{element}: {message}"))
    }

    /// The element of that index in the list of that name, for the element that refers to it.
    pub fn get<'a, T>(&self, list: &'a [T], name: &str, index: usize, element: &str) -> Result<&'a T> {
        list.get(index).ok_or_else(|| {
            self.wrong(element, format!("refers to {name}[{index}], and the file has {} {name}", list.len()))
        })
    }

    /// An extension that the JSON types do not know.
    pub fn extension<T: DeserializeOwned>(
        &self,
        extensions: &Map<String, Value>,
        name: &str,
        element: &str,
    ) -> Result<Option<T>> {
        let Some(value) = extensions.get(name) else { return Ok(None) };
        let read = serde_json::from_value(value.clone());
        read.map(Some).map_err(|error| self.wrong(element, format!("extensions.{name}: {error}")))
    }

    /// A number that must be 0 or more, and finite.
    pub fn amount(&self, element: &str, name: &str, value: f32) -> Result<f32> {
        if value.is_finite() && value >= 0.0 {
            return Ok(value);
        }
        Err(self.wrong(element, format!("{name} is {value}, and must be finite and 0 or more")))
    }

    /// Numbers that were computed from those of the file, all of which must fit single precision.
    pub fn computed<const N: usize>(&self, element: &str, what: &str, values: [f64; N]) -> Result<[f64; N]> {
        single::check(values).map_err(|message| self.wrong(element, format!("{what}: {message}")))?;
        Ok(values)
    }

    /// A number that must be in 0 to 1.
    pub fn share(&self, element: &str, name: &str, value: f32) -> Result<f32> {
        if (0.0..=1.0).contains(&value) {
            return Ok(value);
        }
        Err(self.wrong(element, format!("{name} is {value}, and must be in 0 to 1")))
    }

    /// Numbers each of which must be in 0 to 1.
    pub fn shares<const N: usize>(&self, element: &str, name: &str, values: [f32; N]) -> Result<[f32; N]> {
        values.iter().try_for_each(|value| self.share(element, name, *value).map(drop))?;
        Ok(values)
    }
}

/// Makes numbers that are whole integers, however they are written: `1.0` and `1e2` are valid indices.
fn make_whole(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(make_whole),
        Value::Object(members) => members.iter_mut().for_each(|(_, value)| make_whole(value)),
        Value::Number(number) if number.is_f64() => {
            let float = number.as_f64().unwrap_or(f64::NAN);
            // Whole numbers beyond this have neighbours that are not.
            if float.fract() == 0.0 && (0.0..9e15).contains(&float) {
                *number = (float as u64).into();
            }
        }
        _ => {}
    }
}

/// Text of the file as messages show it: short, and on one line.
pub(super) fn shown(text: &str) -> String {
    let short: String = text.chars().take(80).flat_map(char::escape_debug).collect();
    if text.chars().nth(80).is_some() { short + "..." } else { short }
}

fn check_version(path: &Path, root: &Map<String, Value>) -> Result<()> {
    let asset = root.get("asset");
    let text = |name: &str| asset.and_then(|asset| asset.get(name)).and_then(Value::as_str);
    let Some(version) = text("version") else {
        return Err(Error::scene(path, "not a glTF file: it has no asset.version"));
    };
    let is_2 = |version: &str| version.split('.').next() == Some("2");
    if !is_2(version) || text("minVersion").is_some_and(|version| !is_2(version)) {
        return Err(Error::scene(path, format!("asset.version is '{}', and 2.0 is read", shown(version))));
    }
    Ok(())
}

/// A list of the JSON's root, element by element, so that a message can say which one is wrong.
fn elements<T: DeserializeOwned>(path: &Path, root: &mut Map<String, Value>, name: &str) -> Result<Vec<T>> {
    let Some(value) = root.remove(name) else { return Ok(Vec::new()) };
    let Value::Array(values) = value else { return Err(Error::scene(path, format!("{name} is not a list"))) };
    let read = |(index, value)| {
        serde_json::from_value(value).map_err(|error| Error::scene(path, format!("{name}[{index}]: {error}")))
    };
    values.into_iter().enumerate().map(read).collect()
}

fn object(path: &Path, root: &mut Map<String, Value>, name: &str, element: &str) -> Result<Map<String, Value>> {
    match root.remove(name) {
        None => Ok(Map::new()),
        Some(Value::Object(object)) => Ok(object),
        Some(_) => Err(Error::scene(path, format!("{element} is not an object"))),
    }
}

/// The JSON and the binary data of a .glb file (glTF 2.0 specification, section 4.4).
fn split_binary<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let wrong = |message: String| Error::scene(path, format!("not a valid .glb file: {message}"));
    let word = |at: usize| {
        let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
        bytes.map(u32::from_le_bytes).ok_or_else(|| wrong(String::from("it ends in its header")))
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(wrong(format!("its version is {version}, and 2 is read")));
    }
    if length < 12 || length > bytes.len() {
        return Err(wrong(format!("its header claims {length} bytes, and it has {}", bytes.len())));
    }
    let mut chunks = Vec::new();
    let mut at = 12;
    while at < length {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let data = at + 8;
        if data > length || size > length - data {
            return Err(wrong(format!(
                "the chunk at byte {at} claims {size} bytes, and {} are left",
                length.saturating_sub(data)
            )));
        }
        chunks.push((kind.to_le_bytes(), &bytes[data..data + size]));
        at = data + size;
    }
    match chunks.split_first() {
        Some(((JSON, text), rest)) => {
            let binary = rest.first().filter(|(kind, _)| kind == b"BIN\0").map(|(_, data)| *data);
            Ok((text.trim_ascii_end(), binary))
        }
        _ => Err(wrong(String::from("its first chunk is not JSON"))),
    }
}
