//! Writes a scene of many small triangles: a wrinkled torus in a room with an area light.
//!
//!     cargo run --release --example dense_scene -- 480000 out/dense.xml
//!     cargo run --release --example dense_scene -- 1000000 out/crowd.xml --instances 1000
//!     cargo run --release --example dense_scene -- 2000 out/texture.xml --texture 8192
//!
//! With `--instances` the torus is placed that often, small, on a grid. With `--texture` it shows an image with so many texels
//! on a side. The mesh goes to a binary PLY file beside the scene, the image to a PNG file. Mitsuba 3 reads all of them.

use std::f64::consts::TAU;
use std::io::Write;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut words = Vec::new();
    let (mut instances, mut texture) = (0usize, 0u32);
    let mut args = std::env::args().skip(1);
    while let Some(word) = args.next() {
        match word.as_str() {
            "--instances" => instances = args.next().unwrap_or_default().parse()?,
            "--texture" => texture = args.next().unwrap_or_default().parse()?,
            _ => words.push(word),
        }
    }
    let [count, path] = &words[..] else {
        return Err("usage: dense_scene TRIANGLES FILE.xml [--instances N] [--texture TEXELS]".into());
    };
    let triangles: usize = count.parse()?;
    let path = PathBuf::from(path);
    let mesh = path.with_extension("ply");
    // Around the tube and along the ring, in the proportion of their lengths; two triangles per cell.
    let along = (((triangles as f64 / 2.0) * 2.7).sqrt().round() as usize).max(3);
    let around = (triangles / 2 / along).max(3);
    write_mesh(&mesh, along, around, texture > 0)?;
    let name = mesh.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let image = path.with_extension("png");
    let bsdf = if texture > 0 {
        write_texture(&image, texture)?;
        textured(&image.file_name().unwrap_or_default().to_string_lossy())
    } else {
        String::from(r#"<ref id="grey"/>"#)
    };
    let shape = format!(
        r#"<shape type="ply">
        <string name="filename" value="{name}"/>
        <boolean name="face_normals" value="true"/>
        {bsdf}
    </shape>"#
    );
    std::fs::write(&path, scene(&if instances > 0 { crowd(&shape, instances) } else { shape }))?;
    println!("{} triangles in {}", 2 * along * around, path.display());
    Ok(())
}

/// A torus whose tube is wrinkled, so that neighbouring rays go different ways.
fn write_mesh(path: &Path, along: usize, around: usize, has_uvs: bool) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         {}element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        along * around,
        if has_uvs { "property float u\nproperty float v\n" } else { "" },
        2 * along * around
    )?;
    for i in 0..along {
        for j in 0..around {
            let (u, v) = (TAU * i as f64 / along as f64, TAU * j as f64 / around as f64);
            let wrinkle = 0.12 * (23.0 * u + 3.0 * v.sin()).sin() * (11.0 * v).cos()
                + 0.02 * (157.0 * u).sin() * (89.0 * v).sin();
            let tube = 0.45 + wrinkle;
            let ring = 1.0 + tube * v.cos();
            let values = [ring * u.cos(), tube * v.sin(), ring * u.sin(), u / TAU, v / TAU];
            for value in &values[..if has_uvs { 5 } else { 3 }] {
                file.write_all(&(*value as f32).to_le_bytes())?;
            }
        }
    }
    for i in 0..along {
        for j in 0..around {
            let at = |i: usize, j: usize| ((i % along) * around + j % around) as i32;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            for triangle in [[a, b, c], [a, c, d]] {
                file.write_all(&[3])?;
                for index in triangle {
                    file.write_all(&index.to_le_bytes())?;
                }
            }
        }
    }
    file.flush()
}

/// A picture in which no texel is like its neighbours.
fn write_texture(path: &Path, size: u32) -> image::ImageResult<()> {
    image::RgbImage::from_fn(size, size, |x, y| {
        let hash = (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
        image::Rgb([(hash >> 24) as u8, (x * 255 / size) as u8, (y * 255 / size) as u8])
    })
    .save(path)
}

fn textured(image: &str) -> String {
    format!(
        r#"<bsdf type="twosided">
            <bsdf type="diffuse">
                <texture type="bitmap" name="reflectance">
                    <string name="filename" value="{image}"/>
                </texture>
            </bsdf>
        </bsdf>"#
    )
}

/// A shape placed so often, on a grid of cubes that fills the room's middle, each turned its own way.
fn crowd(shape: &str, instances: usize) -> String {
    let side = (instances as f64).cbrt().ceil().max(1.0) as usize;
    let step = 3.0 / side as f64;
    let mut text = format!(r#"<shape type="shapegroup" id="crowd">{shape}</shape>"#);
    for index in 0..instances {
        let at = |cell: usize| (cell as f64 + 0.5) * step - 1.5;
        let [x, y, z] = [at(index % side), at(index / side % side), at(index / side / side)];
        text += &format!(
            r#"
    <shape type="instance">
        <ref id="crowd"/>
        <transform name="to_world">
            <rotate x="1" y="2" z="3" angle="{}"/>
            <scale value="{}"/>
            <translate x="{x}" y="{y}" z="{z}"/>
        </transform>
    </shape>"#,
            index * 37 % 360,
            0.3 * step
        );
    }
    text
}

fn scene(content: &str) -> String {
    format!(
        r#"<?xml version="1.0" encoding="utf-8"?>
<!-- Generated by benches/dense_scene.rs: many small triangles, for measuring traversal. -->
<scene version="3.0.0">
    <default name="spp" value="64"/>
    <default name="size" value="512"/>
    <default name="max_depth" value="8"/>
    <integrator type="path">
        <integer name="max_depth" value="$max_depth"/>
    </integrator>
    <sensor type="perspective">
        <float name="fov" value="45"/>
        <transform name="to_world">
            <lookat origin="0, 2.6, 3.6" target="0, 0, 0" up="0, 1, 0"/>
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="$spp"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="$size"/>
            <integer name="height" value="$size"/>
            <rfilter type="box"/>
        </film>
    </sensor>
    <bsdf type="twosided" id="grey">
        <bsdf type="diffuse">
            <rgb name="reflectance" value="0.7"/>
        </bsdf>
    </bsdf>
    {content}
    <shape type="cube">
        <transform name="to_world">
            <scale value="4"/>
            <translate y="3"/>
        </transform>
        <ref id="grey"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world">
            <rotate x="1" angle="90"/>
            <translate y="6.9"/>
        </transform>
        <emitter type="area">
            <rgb name="radiance" value="20"/>
        </emitter>
    </shape>
</scene>
"#
    )
}
