//! glTF files made in memory: elements are added one by one, and refer to each other by the indices that come back.

use std::f64::consts::PI;
use std::path::Path;

use base64::Engine;
use lumbre::scene::{LoadOptions, Scene};
use serde_json::{Map, Value, json};

pub const F32: u32 = 5126;
pub const U8: u32 = 5121;
pub const I8: u32 = 5120;
pub const U16: u32 = 5123;
pub const I16: u32 = 5122;
pub const U32: u32 = 5125;

/// A file in the making; everything binary goes to one buffer.
#[derive(Clone, Debug)]
pub struct Gltf {
    pub json: Value,
    pub bytes: Vec<u8>,
}

/// The little-endian bytes of floats.
pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The little-endian bytes of 16-bit integers.
pub fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// A PNG image of these texels, row by row from the top.
pub fn png(width: u32, height: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let image = image::RgbaImage::from_raw(width, height, texels.concat()).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The corners of the square from (-1, -1, 0) to (1, 1, 0), which faces +z, and its texture coordinates: (0, 0) is the
/// upper left corner.
pub const SQUARE: [f32; 12] = [-1.0, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0, 0.0, -1.0, 1.0, 0.0];
pub const SQUARE_UVS: [f32; 8] = [0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
pub const SQUARE_INDICES: [u16; 6] = [0, 1, 2, 0, 2, 3];

impl Default for Gltf {
    fn default() -> Self {
        Self { json: json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}), bytes: Vec::new() }
    }
}

impl Gltf {
    /// A file with an orthographic camera at (0, 0, 5) that looks along -z and sees -1 to 1 of x and y.
    pub fn new() -> Self {
        let mut file = Self::default();
        let view = json!({"xmag": 1, "ymag": 1, "zfar": 10, "znear": 0.1});
        let camera = file.add("cameras", json!({"type": "orthographic", "orthographic": view}));
        file.node(json!({"camera": camera, "translation": [0, 0, 5]}));
        file
    }

    /// Adds an element to a list of the file.
    pub fn add(&mut self, list: &str, element: Value) -> usize {
        let list = self.json.as_object_mut().unwrap().entry(list).or_insert(json!([])).as_array_mut().unwrap();
        list.push(element);
        list.len() - 1
    }

    /// Adds a node that stands in the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.add("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        index
    }

    /// Adds bytes as a buffer view with more properties.
    pub fn view(&mut self, bytes: &[u8], more: Value) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        merge(&mut view, more);
        self.bytes.extend(bytes);
        self.add("bufferViews", view)
    }

    /// Adds an accessor of these bytes.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, more: Value) -> usize {
        let view = self.view(bytes, json!({}));
        let mut accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        merge(&mut accessor, more);
        self.add("accessors", accessor)
    }

    /// Adds the unit square as a mesh of that material, with more properties of the primitive.
    pub fn square(&mut self, material: Value, more: Value) -> usize {
        let material = self.add("materials", material);
        let positions = self.accessor(&floats(&SQUARE), F32, "VEC3", 4, json!({}));
        let uvs = self.accessor(&floats(&SQUARE_UVS), F32, "VEC2", 4, json!({}));
        let indices = self.accessor(&shorts(&SQUARE_INDICES), U16, "SCALAR", 6, json!({}));
        let mut primitive = json!({
            "attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "indices": indices, "material": material
        });
        merge(&mut primitive, more);
        self.add("meshes", json!({"primitives": [primitive]}))
    }

    /// Adds a texture of this PNG image, by nearest texels.
    pub fn texture(&mut self, png: &[u8]) -> usize {
        let view = self.view(png, json!({}));
        let image = self.add("images", json!({"bufferView": view, "mimeType": "image/png"}));
        let sampler = self.add("samplers", json!({"magFilter": 9728}));
        self.add("textures", json!({"source": image, "sampler": sampler}))
    }

    /// Adds a light and a node that carries it; `node` says where.
    pub fn light(&mut self, light: Value, node: Value) {
        let root = self.json.as_object_mut().unwrap();
        let extensions = root.entry("extensions").or_insert(json!({"KHR_lights_punctual": {"lights": []}}));
        let lights = extensions["KHR_lights_punctual"]["lights"].as_array_mut().unwrap();
        lights.push(light);
        let mut node = node;
        merge(&mut node, json!({"extensions": {"KHR_lights_punctual": {"light": lights.len() - 1}}}));
        self.node(node);
    }

    /// The file as text that holds its buffer.
    pub fn text(&self) -> String {
        let mut json = self.json.clone();
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        let uri = format!("data:application/octet-stream;base64,{data}");
        let buffers = json!([{"byteLength": self.bytes.len(), "uri": uri}]);
        if !self.bytes.is_empty() {
            json.as_object_mut().unwrap().entry("buffers").or_insert(buffers);
        }
        serde_json::to_string_pretty(&json).unwrap()
    }

    /// The file as a .glb.
    pub fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bytes.len()}]);
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut data = self.bytes.clone();
        data.resize(data.len().next_multiple_of(4), 0);
        let word = |value: usize| (value as u32).to_le_bytes();
        let length = 12 + 8 + text.len() + 8 + data.len();
        let head = [b"glTF".to_vec(), word(2).to_vec(), word(length).to_vec()].concat();
        let chunk = |kind: &[u8; 4], data: &[u8]| [&word(data.len())[..], kind, data].concat();
        [head, chunk(b"JSON", &text), chunk(b"BIN\0", &data)].concat()
    }

    /// Writes the file, with others beside it, and loads it.
    pub fn try_load(&self, others: &[(&str, &[u8])]) -> lumbre::Result<Scene> {
        load(self.text().as_bytes(), "scene.gltf", others)
    }

    /// The scene; its film is 16 pixels wide and high.
    pub fn load(&self) -> Scene {
        let mut scene = self.try_load(&[]).unwrap_or_else(|error| panic!("{error}\n{}", self.text()));
        (scene.film.width, scene.film.height) = (16, 16);
        scene
    }
}

/// Writes files to a folder of their own and loads the first one.
pub fn load(bytes: &[u8], name: &str, others: &[(&str, &[u8])]) -> lumbre::Result<Scene> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [(name, bytes)].iter().chain(others) {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    lumbre::scene::load(&Path::new(folder.path()).join(name), &LoadOptions::default())
}

/// Puts the members of one object into another; those of objects in both are merged, null removes one.
pub fn merge(into: &mut Value, from: Value) {
    match (into, from) {
        (Value::Object(into), Value::Object(from)) => {
            for (name, value) in from {
                match value {
                    Value::Null => drop(into.remove(&name)),
                    value => merge(into.entry(name).or_insert(Value::Object(Map::new())), value),
                }
            }
        }
        (into, from) => *into = from,
    }
}

/// A material that is Lambertian: no metal, and the dielectric's reflection switched off.
pub fn matte(base: [f64; 3]) -> Value {
    json!({
        "pbrMetallicRoughness": {"baseColorFactor": [base[0], base[1], base[2], 1], "metallicFactor": 0},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0}}
    })
}

/// With more properties.
pub fn with(mut value: Value, more: Value) -> Value {
    merge(&mut value, more);
    value
}

/// Parallel light along -z of this many lux.
pub fn sun(file: &mut Gltf, lux: f64) {
    file.light(json!({"type": "directional", "intensity": lux}), json!({}));
}

/// Red, green, blue and grey, from the upper left to the lower right; sRGB bytes, one of them not at the end of the range.
pub const FOUR: [[u8; 4]; 4] = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [188, 188, 188, 255]];
/// The same in linear values: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
pub const FOUR_LINEAR: [[f64; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.502_886; 3]];

/// The square with that texture lit so that its radiance is its albedo; `info` adds to the texture's info.
pub fn textured(texels: &[[u8; 4]], info: Value) -> Gltf {
    let mut file = Gltf::new();
    let texture = file.texture(&png(2, 2, texels));
    let base = json!({"pbrMetallicRoughness": {"baseColorTexture": with(json!({"index": texture}), info)}});
    let mesh = file.square(with(matte([1.0; 3]), base), json!({}));
    file.node(json!({"mesh": mesh}));
    sun(&mut file, PI);
    file
}
