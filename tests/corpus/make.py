#!/usr/bin/env python3
"""Writes the files of tests/corpus: small ones that are broken, one reason each, and sound ones that mutations begin with.

    python3 tests/corpus/make.py tests/corpus

Python's standard library only. The JPEG and EXR files of sound/image are not made here: libjpeg-turbo and the exr crate wrote
them, and fuzzing found image/b44_wraps.exr. The other broken ones are made of them.
"""

import base64
import json
import struct
import sys
import zlib
from pathlib import Path

ROOT = Path(sys.argv[1])


def put(name, data):
    path = ROOT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data.encode() if isinstance(data, str) else data)


def scene(body):
    return f'<scene version="3.0.0">\n{body}\n</scene>\n'


# --- Mitsuba XML -------------------------------------------------------------------------------------------------------------

put("sound/mitsuba/shapes.xml", scene("""
<default name="r" value="0.5"/>
<include filename="part.xml"/>
<shape type="rectangle"><ref id="part"/><transform name="to_world"><rotate x="1" angle="90"/><scale value="2"/></transform></shape>
<shape type="disk"><boolean name="flip_normals" value="true"/></shape>
<shape type="cube"><transform name="to_world"><scale x="1" y="2" z="3"/><translate x="1"/></transform></shape>
<shape type="cylinder"><point name="p0" value="0, 0, 0"/><point name="p1" x="1" y="2" z="3"/><float name="radius" value="$r"/></shape>
<shape type="sphere"><point name="center" x="1" y="0" z="0"/><float name="radius" value="$r"/></shape>
<shape type="obj"><string name="filename" value="mesh.obj"/><boolean name="face_normals" value="true"/></shape>
<shape type="ply"><string name="filename" value="mesh.ply"/><boolean name="flip_tex_coords" value="true"/></shape>
<shape type="serialized"><string name="filename" value="mesh.serialized"/><integer name="shape_index" value="0"/></shape>
<shape type="shapegroup" id="g"><shape type="sphere"/><shape type="cube"/></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 5 0 0 0 1"/></transform></shape>"""))

put("sound/mitsuba/materials.xml", scene("""
<texture type="bitmap" id="t"><string name="filename" value="image.png"/><string name="wrap_mode" value="clamp"/></texture>
<bsdf type="twosided" id="a"><bsdf type="diffuse"><rgb name="reflectance" value="0.1, 0.2, 0.3"/></bsdf></bsdf>
<bsdf type="conductor" id="b"><string name="material" value="Au"/></bsdf>
<bsdf type="roughconductor" id="c"><rgb name="eta" value="0.2, 0.9, 1"/><rgb name="k" value="4"/><float name="alpha" value="0.2"/></bsdf>
<bsdf type="roughdielectric" id="d"><string name="distribution" value="ggx"/><float name="int_ior" value="1.5"/></bsdf>
<bsdf type="plastic" id="e"><boolean name="nonlinear" value="true"/></bsdf>
<bsdf type="roughplastic" id="f"><srgb name="diffuse_reflectance" value="#a0b1c2"/></bsdf>
<bsdf type="thindielectric" id="h"/>
<bsdf type="principled" id="i"><float name="metallic" value="0.5"/><float name="clearcoat" value="1"/></bsdf>
<bsdf type="blendbsdf" id="j"><float name="weight" value="0.3"/><ref id="b"/><ref id="c"/></bsdf>
<bsdf type="bumpmap" id="k"><ref id="j"/><texture type="checkerboard"/><float name="scale" value="2"/></bsdf>
<bsdf type="normalmap" id="l"><ref id="e"/><texture name="normalmap" type="bitmap"><boolean name="raw" value="true"/><string name="filename" value="image.png"/></texture></bsdf>
<bsdf type="mask" id="m"><ref id="a"/><texture name="opacity" type="bitmap"><string name="filename" value="image.png"/></texture></bsdf>
<bsdf type="diffuse" id="n"><spectrum name="reflectance" value="400:0.1, 700:0.5"/></bsdf>
<bsdf type="diffuse" id="o"><spectrum name="reflectance" filename="x.spd"/></bsdf>
<shape type="sphere"><ref id="k"/></shape><shape type="cube"><ref id="m"/></shape>"""))

put("sound/mitsuba/lights.xml", scene("""
<integrator type="path"><integer name="max_depth" value="8"/><integer name="rr_depth" value="5"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/><string name="fov_axis" value="diagonal"/>
<transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="32"/><integer name="crop_width" value="8"/><rfilter type="mitchell"/></film>
<sampler type="independent"><integer name="sample_count" value="16"/></sampler></sensor>
<sensor type="thinlens"><float name="aperture_radius" value="0.1"/><float name="focus_distance" value="2"/></sensor>
<emitter type="point"><rgb name="intensity" value="1, 2, 3"/><point name="position" x="0" y="1" z="2"/></emitter>
<emitter type="spot"><float name="cutoff_angle" value="20"/><float name="beam_width" value="10"/></emitter>
<emitter type="directional"><vector name="direction" x="0" y="-1" z="0"/></emitter>
<emitter type="projector"><texture name="irradiance" type="bitmap"><string name="filename" value="image.png"/></texture></emitter>
<emitter type="envmap"><string name="filename" value="image.png"/><float name="scale" value="0.5"/></emitter>
<shape type="sphere"><emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>
<shape type="rectangle"><emitter type="area"><texture name="radiance" type="checkerboard"/></emitter></shape>"""))

# Each blend holds the one before twice: there are 2^40 ways down, and 41 materials.
blends = "\n".join(f'<bsdf type="blendbsdf" id="b{i}"><ref id="b{i - 1}"/><ref id="b{i - 1}"/></bsdf>' for i in range(1, 41))
put("sound/mitsuba/blends_of_blends.xml", scene(
    f'<bsdf type="diffuse" id="b0"/>\n{blends}\n'
    '<shape type="sphere"><bsdf type="bumpmap"><ref id="b40"/><texture type="checkerboard"/></bsdf></shape>'))

put("mitsuba/empty.xml", "")
put("mitsuba/truncated.xml", scene('<shape type="sphere">\n<float name="radius" value="1"/></shape>')[:60])
put("mitsuba/latin1.xml", scene('<bsdf type="diffuse"\nid="gr\u00fcn"/>').encode("latin-1"))
put("mitsuba/utf16.xml", scene("").encode("utf-16"))
put("mitsuba/zero_byte.xml", scene('<bsdf type="dif\0fuse"/>'))
put("mitsuba/deep.xml", scene("<a>" * 20000 + "</a>" * 20000))
chain = "\n".join(f'<bsdf type="twosided" id="b{i}"><ref id="b{i - 1}"/></bsdf>' for i in range(1, 1000))
put("mitsuba/deep_references.xml", scene(f'<bsdf type="diffuse" id="b0"/>\n{chain}'))
laughs = "\n".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 10))
put("mitsuba/entity_bomb.xml", f'<!DOCTYPE scene [<!ENTITY e0 "ha">\n{laughs}]>\n<scene version="3.0.0">&e9;</scene>\n')
put("mitsuba/external_entity.xml",
    '<!DOCTYPE scene [<!ENTITY e SYSTEM "file:///etc/passwd">]>\n<scene version="3.0.0">&e;</scene>\n')
laughs = "\n".join(f'<default name="e{i}" value="{f"$e{i - 1} " * 10}"/>' for i in range(1, 10))
put("mitsuba/parameter_bomb.xml", scene(f'<default name="e0" value="ha"/>\n{laughs}'))
put("mitsuba/include_cycle.xml", scene('<include filename="parts/include_cycle.xml"/>'))
put("mitsuba/parts/include_cycle.xml", scene('<include filename="../include_cycle.xml"/>'))
put("mitsuba/include_bomb.xml", scene('<include filename="parts/bomb1.xml"/>\n' * 40))
put("mitsuba/parts/bomb1.xml", scene('<include filename="bomb2.xml"/>\n' * 40))
put("mitsuba/parts/bomb2.xml", scene("<a/>\n" * 1000))
put("mitsuba/include_folder.xml", scene('<include filename="."/>'))
put("mitsuba/reference_to_itself.xml", scene('<shape type="shapegroup" id="g">\n<ref id="g"/></shape>'))
put("mitsuba/instance_of_its_own.xml", scene(
    '<shape type="sphere" id="s"/>\n<shape type="shapegroup" id="g"><shape type="instance"><ref id="s"/></shape></shape>\n'
    '<shape type="instance"><ref id="g"/></shape>'))
put("mitsuba/integrators.xml", scene(
    '<integrator type="aov"><string name="aovs" value="a:depth"/>\n<integrator type="path"/><integrator type="path"/></integrator>'))
put("mitsuba/lines_in_a_name.xml", scene('<bsdf type="velvet&#10;error: \x7f&#27;[31mred"/>'.replace("&#27;", "&#9;")))
put("mitsuba/long_name.xml", scene(f'<bsdf type="{"velvet" * 4000}"/>'))
put("mitsuba/huge_film.xml", scene(
    '<sensor type="perspective"><film type="hdrfilm">\n<integer name="width" value="70000"/></film></sensor>'))
put("mitsuba/huge_integer.xml", scene(
    '<integrator type="path">\n<integer name="max_depth" value="99999999999999999999"/></integrator>'))
put("mitsuba/infinite_matrix.xml", scene(
    '<shape type="cube"><transform name="to_world">\n'
    '<matrix value="1e200 0 0 0 0 1e200 0 0 0 0 1e200 0 0 0 0 1"/></transform></shape>'))

# --- OBJ and MTL -------------------------------------------------------------------------------------------------------------

put("sound/obj/plain.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
    "f 1/1/1 2/2/1 3/3/1\nf -4/-3/-1 -3/-2/-1 -2/-1/-1 -1/-1/-1\n")
put("sound/obj/materials.obj", "mtllib scene.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng one\nusemtl red\nf 1 2 3\n"
    "g two\nusemtl lamp\nf 1 3 4\nusemtl glass\nf 1 2 3 4\n\n#####\nnewmtl red\nKd 1 0 0\nKa 0 0 0\nillum 2\n"
    "newmtl lamp\nKe 5 5 5\nnewmtl glass\nNi 1.5\nillum 4\nTf 1 0.9 0.9\nKs 1 1 1\nNs 10\nd 0.5\nmap_Kd x.png\nbump y.png\n")
square = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
put("obj/empty.obj", "")
put("obj/truncated.obj", square + "f 1 2 3\nv 0 0 1\nv 1 0")
put("obj/index_too_large.obj", square + "f 1 2 3\nf 1 2 4\n")
put("obj/index_zero.obj", square + "f 0 1 2\n")
put("obj/index_far_back.obj", square + "f -1 -2 -4000000000\n")
# An index that tobj 4.0.5 multiplies beyond 64 bits.
put("obj/index_far_back_texture.obj", "vt 0 0\nvn 0 0 1\n" + square + "f 1/-6148914691236517206/1 2/1/1 3/1/1\n")
put("obj/index_far_back_normal.obj", "vt 0 0\nvn 0 0 1\n" + square + "f 1/1/-6148914691236517206 2/1/1 3/1/1\n")
put("obj/absurd_index.obj", square + "f 1 2 340282366920938463463374607431768211456\n")
put("obj/not_finite.obj", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n")
put("obj/latin1.obj", b"v 0 0 0\no gr\xfcn\n" + square.encode() + b"f 1 2 3\n")
put("obj/zero_bytes.obj", b"v 0 0 0\0\0\0\n")
put("obj/one_endless_line.obj", square + "f" + " 1 2 3" * 4000 + " x\n")
for name, mtl in [("short_colour", b"newmtl a\nKd 1 0\n"), ("mtl_latin1", b"newmtl gr\xfcn\n"),
                  ("mtl_no_number", b"newmtl a\n\nNi glass\n"), ("negative_light", b"newmtl a\nKe 1 -1 1\n")]:
    put(f"obj/{name}.obj", f"mtllib {name}.mtl\n{square}usemtl a\nf 1 2 3\n")
    put(f"obj/{name}.mtl", mtl)
put("obj/mtl_folder.obj", f"mtllib ..\n{square}f 1 2 x\n")

# --- PLY ---------------------------------------------------------------------------------------------------------------------


def ply(vertices, faces, form="ascii", index="uchar", more=""):
    return (f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {faces}\nproperty list {index} int vertex_indices\n{more}end_header\n")


corners = "0 0 0\n1 0 0\n0 1 0\n"
floats = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
binary = "binary_little_endian"
put("sound/ply/ascii.ply", ply(3, 1) + corners + "3 0 1 2\n")
put("sound/ply/little.ply", ply(3, 1, binary).encode() + floats + struct.pack("<B3i", 3, 0, 1, 2))
put("sound/ply/big.ply", ply(3, 1, "binary_big_endian").encode() + struct.pack(">9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    + struct.pack(">B3i", 3, 0, 1, 2))
put("sound/ply/full.ply", "ply\nformat ascii 1.0\nobj_info x\nelement vertex 4\n"
    + "".join(f"property double {name}\n" for name in ["x", "y", "z", "nx", "ny", "nz", "s", "t"])
    + "element face 1\nproperty list uint ushort vertex_index\nproperty uchar red\nelement edge 1\nproperty int a\nend_header\n"
    + "0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 1 1 1\n0 1 0 0 0 1 0 1\n4 0 1 2 3 255\n7\n")
put("ply/empty.ply", "")
put("ply/truncated_header.ply", ply(3, 1)[:70])
put("ply/truncated.ply", ply(3, 1) + corners[:8])
put("ply/truncated_binary.ply", ply(3, 1, binary).encode() + floats[:30])
put("ply/vertices_4e9.ply", ply(4294967295, 1, binary).encode() + floats)
put("ply/vertices_2e64.ply", ply(18446744073709551615, 1, binary).encode() + floats)
put("ply/vertices_2e70.ply", ply(1 << 70, 1) + corners)
put("ply/faces_4e9.ply", ply(3, 4294967295) + corners + "3 0 1 2\n")
put("ply/list_4e9.ply", ply(3, 1, binary, "uint").encode() + floats + struct.pack("<I3i", 0xffffffff, 0, 1, 2))
put("ply/list_negative.ply", ply(3, 1, binary, "int").encode() + floats + struct.pack("<i3i", -1, 0, 1, 2))
put("ply/list_of_fractions.ply", ply(3, 1).replace("uchar int", "uchar float") + corners + "3 0 0.5 2\n")
put("ply/without_bytes.ply", ply(3, 1, binary, more="element nothing 18446744073709551615\n").encode() + floats
    + struct.pack("<B3i", 3, 0, 1, 2))
put("ply/without_indices.ply", ply(3, 1).replace("vertex_indices", "corners") + corners + "3 0 1 2\n")
put("ply/index_too_large.ply", ply(3, 1, binary).encode() + floats + struct.pack("<B3i", 3, 0, 1, 3))
put("ply/infinite.ply", ply(3, 1, binary).encode() + struct.pack("<9f", 0, 0, float("inf"), 1, 0, 0, 0, 1, 0)
    + struct.pack("<B3i", 3, 0, 1, 2))
put("ply/latin1.ply", b"ply\nformat ascii 1.0\nelement gr\xfcn 1\n")
put("ply/one_endless_line.ply", "ply\nformat ascii 1.0\ncomment " + "x" * 20000)

# --- Serialized --------------------------------------------------------------------------------------------------------------


def serialized(stream):
    return struct.pack("<HH", 0x041c, 4) + zlib.compress(stream, 9)


def mesh(vertices=3, triangles=1, flags=0x1000, name=b"t\0", last=2):
    return (struct.pack("<I", flags) + name + struct.pack("<QQ", vertices, triangles) + floats
            + struct.pack("<3I", 0, 1, last))


put("sound/serialized/single.serialized", serialized(mesh()))
put("sound/serialized/stream.serialized", b"raw" + mesh())
put("sound/serialized/stream_full.serialized", b"raw" + struct.pack("<I", 0x200b) + b"full\0" + struct.pack("<QQ", 3, 1)
    + struct.pack("<33d", *[0.25] * 33) + struct.pack("<3I", 0, 1, 2))
put("serialized/empty.serialized", "")
put("serialized/wrong_magic.serialized", "PK\3\4 a zip file")
put("serialized/truncated.serialized", serialized(mesh())[:20])
put("serialized/checksum.serialized", serialized(mesh())[:-1] + b"\0")
put("serialized/vertices_4e9.serialized", serialized(mesh(vertices=0xffffffff)))
put("serialized/vertices_2e64.serialized", serialized(mesh(vertices=2**64 - 1)))
put("serialized/triangles_2e64.serialized", serialized(mesh(triangles=2**64 - 1)))
put("serialized/index_too_large.serialized", serialized(mesh(last=3)))
put("serialized/endless_name.serialized", serialized(mesh(name=b"x" * (1 << 20))))
# 24 MB of zeros: vertices that are there, and no triangles.
put("serialized/bomb.serialized", serialized(struct.pack("<I", 0x1000) + b"\0" + struct.pack("<QQ", 2_000_000, 1)
    + b"\0" * 24_000_000))

# --- Images ------------------------------------------------------------------------------------------------------------------


def png(width, height, rows, depth=8, colour=2, crc=True):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data) if crc else 1)

    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    palette = chunk(b"PLTE", bytes(range(12))) if colour == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + palette + chunk(b"IDAT", zlib.compress(rows, 9))
            + chunk(b"IEND", b""))


def hdr(width, height, body):
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + body


def with_box(data, corner):
    """An EXR image whose windows end at that corner."""
    for name in [b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"]:
        at = data.index(name) + len(name) + 4
        data = data[:at] + struct.pack("<4i", 0, 0, *corner) + data[at + 16:]
    return data


for name, depth, colour, size in [("grey1", 1, 0, 1), ("palette2", 2, 3, 1), ("grey_alpha", 8, 4, 4), ("rgb", 8, 2, 6),
                                  ("rgba16", 16, 6, 16)]:
    put(f"sound/image/{name}.png", png(2, 2, (b"\0" + bytes(range(size))) * 2, depth, colour))
flat = bytes([128, 128, 128, 129])
put("sound/image/flat.hdr", hdr(2, 2, flat * 4))
put("sound/image/runs.hdr", hdr(8, 2, (b"\2\2\0\x08" + b"\x88\x80" * 4) * 2))
put("sound/image/old_runs.hdr", hdr(8, 2, (flat + bytes([1, 1, 1, 7])) * 2))
jpeg = (ROOT / "sound/image/baseline.jpg").read_bytes()
exr = (ROOT / "sound/image/zip.exr").read_bytes()
put("image/empty.png", "")
put("image/text.png", "this is no image\n")
put("image/truncated.png", png(2, 2, (b"\0" + bytes(6)) * 2)[:45])
put("image/checksum.png", png(2, 2, (b"\0" + bytes(6)) * 2, crc=False))
put("image/short_data.png", png(64, 64, b"\0" * 20))
put("image/nothing.png", png(0, 2, b""))
put("image/60000x60000.png", png(60000, 60000, b"\0" * 100))
put("image/16384x16384.png", png(16384, 16384, b"\0" * 100))
put("image/side_2e31.png", png(0x7fffffff, 1, b"\0" * 100))
# An honest bomb: all of its texels are there.
put("image/bomb.png", png(20000, 20000, b"\0" * (2501 * 20000), 1, 0))
put("image/truncated.hdr", hdr(8, 2, b"\2\2\0\x08\x88\x80"))
put("image/60000x60000.hdr", hdr(60000, 60000, flat * 4))
put("image/16384x16384.hdr", hdr(16384, 16384, flat * 4))
put("image/no_size.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y two +X 2\n")
put("image/truncated.jpg", jpeg[:len(jpeg) // 2])
frame = jpeg.index(b"\xff\xc0") + 5
put("image/65500x65500.jpg", jpeg[:frame] + struct.pack(">HH", 65500, 65500) + jpeg[frame + 4:])
put("image/16384x16384.jpg", jpeg[:frame] + struct.pack(">HH", 16384, 16384) + jpeg[frame + 4:])
put("image/truncated.exr", exr[:len(exr) // 2])
put("image/65535x65535.exr", with_box(exr, (65534, 65534)))
put("image/16384x16384.exr", with_box(exr, (16383, 16383)))
put("image/box_2e31.exr", with_box(exr, (0x7fffffff, 0x7fffffff)))
put("image/box_inside_out.exr", with_box(exr, (-5, -5)))
put("image/not_a_number.exr", (ROOT / "sound/image/none.exr").read_bytes()[:-4] + struct.pack("<f", float("nan")))

# --- glTF --------------------------------------------------------------------------------------------------------------------

SQUARE = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)


def gltf(**changes):
    image = png(2, 2, (b"\0" + bytes(range(6))) * 2)
    data = SQUARE + image
    root = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"children": [2]},
                  {"translation": [0, 0, 5], "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {"outerConeAngle": 0.5}}]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.5},
                       "emissiveFactor": [0.1, 0, 0], "alphaMode": "MASK"}],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "magFilter": 9728}],
        "images": [{"bufferView": 2, "mimeType": "image/png"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
                      {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
                        {"buffer": 0, "byteOffset": 60, "byteLength": len(image)}],
        "buffers": [{"byteLength": len(data)}],
    }
    root.update(changes)
    return root, data


def uri(data):
    return "data:application/octet-stream;base64," + base64.b64encode(data).decode()


def text(**changes):
    """The file as text; everything binary is in it."""
    root, data = gltf(**changes)
    if "buffers" not in changes:
        root["buffers"][0]["uri"] = uri(data)
    return json.dumps(root, indent=1)


def glb(root, data):
    body = json.dumps(root).encode()
    body += b" " * (-len(body) % 4)
    data += b"\0" * (-len(data) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(body) + len(data)) + struct.pack("<I4s", len(body), b"JSON") + body
            + struct.pack("<I4s", len(data), b"BIN\0") + data)


def change(part, index, **values):
    """The file with one element changed."""
    root, _ = gltf()
    root[part][index].update(values)
    return text(**{part: root[part]})


put("sound/gltf/square.gltf", text())
put("sound/gltf/square.glb", glb(*gltf()))
root, data = gltf()
put("sound/gltf/parts.gltf", json.dumps(root).encode() + b"\n#####\n" + data)
sparse = {"count": 1, "indices": {"bufferView": 3, "componentType": 5121}, "values": {"bufferView": 0}}
root["accessors"][0]["sparse"] = sparse
root["bufferViews"].append({"buffer": 0, "byteLength": 1})
root["materials"].append({"normalTexture": {"index": 0}, "doubleSided": True, "alphaMode": "BLEND", "extensions": {
    "KHR_materials_transmission": {"transmissionFactor": 0.5}, "KHR_materials_ior": {"ior": 1.4},
    "KHR_materials_clearcoat": {"clearcoatFactor": 1}, "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1]},
    "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2}, "KHR_materials_specular": {"specularFactor": 0.5},
    "KHR_materials_emissive_strength": {"emissiveStrength": 3}}})
root["meshes"].append({"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "mode": 5, "material": 1}]})
root["nodes"] += [{"mesh": 1, "scale": [1, -1, 1]}, {"mesh": 1, "rotation": [0, 0, 1, 0]}]
root["scenes"] = [{"nodes": [0, 1, 3, 4], "extras": {"lumbre": {"environment": {"uri": "image.png", "intensity": 2}}}}]
put("sound/gltf/full.gltf", json.dumps(root).encode() + b"\n#####\n" + data)

# Poses, instances, vertex alpha, light on both sides, compressed normals (six unit vectors that meshoptimizer 0.22 wrote, of which four
# are used) and the optics of later extensions. Accessors without a buffer view are zeros.
root, data = gltf()
normals = base64.b64decode("oAEP8AAA/bu4TgE/8AAAbCbvXsUAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAH9/")
root["accessors"] += [{"componentType": 5121, "type": "VEC4", "count": 4}, {"componentType": 5126, "type": "VEC4", "count": 4},
                      {"componentType": 5126, "type": "VEC3", "count": 2}, {"componentType": 5126, "type": "MAT4", "count": 1},
                      {"bufferView": 3, "componentType": 5120, "normalized": True, "type": "VEC3", "count": 4}]
root["bufferViews"].append({"buffer": 1, "byteLength": 24, "byteStride": 4, "extensions": {"EXT_meshopt_compression": {
    "buffer": 0, "byteOffset": len(data), "byteLength": len(normals), "byteStride": 4, "count": 6, "mode": "ATTRIBUTES",
    "filter": "OCTAHEDRAL"}}})
data += normals
root["buffers"] = [{"byteLength": len(data)}, {"byteLength": 24}]
root["meshes"] = [{"weights": [0.5], "primitives": [{"indices": 1, "material": 0, "targets": [{"POSITION": 0, "NORMAL": 0}], "attributes": {
    "POSITION": 0, "NORMAL": 6, "JOINTS_0": 2, "WEIGHTS_0": 3, "COLOR_0": 3}}]}]
root["materials"] = [{"alphaMode": "BLEND", "doubleSided": True, "emissiveFactor": [1, 1, 1], "extensions": {
    "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1},
    "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceIor": 1.4, "iridescenceThicknessMaximum": 300},
    "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionColorFactor": [1, 0.5, 0]},
    "KHR_materials_dispersion": {"dispersion": 1}}}]
root["skins"] = [{"joints": [1], "inverseBindMatrices": 5}]
root["nodes"][0] = {"mesh": 0, "skin": 0}
root["nodes"] += [{"mesh": 0, "weights": [1]},
                  {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 4}}}}]
root["scenes"] = [{"nodes": [0, 1, 3, 4]}]
put("sound/gltf/posed.gltf", json.dumps(root).encode() + b"\n#####\n" + data)

put("gltf/empty.gltf", "")
put("gltf/empty.glb", "")
put("gltf/truncated.gltf", text()[:300])
put("gltf/truncated.glb", glb(*gltf())[:400])
whole = glb(*gltf())
put("gltf/chunk_too_long.glb", whole[:12] + struct.pack("<I", 0xfffffff0) + whole[16:])
put("gltf/total_too_long.glb", whole[:8] + struct.pack("<I", 0xffffffff) + whole[12:])
put("gltf/latin1.gltf", text(nodes=[{"name": "gr\u00fcn", "mesh": 0}] * 3).replace("\\u00fc", "\u00fc").encode("latin-1"))
put("gltf/utf16.gltf", text().encode("utf-16"))
put("gltf/deep.gltf", "[" * 100000)
put("gltf/deep_extras.gltf", text(extras={}).replace('"extras": {}', '"extras": ' + '{"a": ' * 5000 + "1" + "}" * 5000))
put("gltf/cycle.gltf", change("nodes", 2, children=[1]))
put("gltf/own_child.gltf", change("nodes", 1, children=[1]))
put("gltf/two_parents.gltf", text(scenes=[{"nodes": [0, 1, 2]}]))
put("gltf/node_missing.gltf", text(scenes=[{"nodes": [0, 4294967295]}]))
put("gltf/accessor_out_of_range.gltf", change("accessors", 0, byteOffset=4))
put("gltf/accessor_4e9.gltf", change("accessors", 0, count=4000000000))
put("gltf/accessor_2e64.gltf", change("accessors", 1, count=2**64 - 1, byteOffset=2**64 - 1))
put("gltf/accessor_without_bytes.gltf", text(accessors=[
    {"componentType": 5126, "type": "VEC3", "count": 10**12}, {"componentType": 5123, "type": "SCALAR", "count": 6}]))
put("gltf/view_out_of_range.gltf", change("bufferViews", 1, byteOffset=2**63))
put("gltf/buffer_too_short.gltf", text(buffers=[{"byteLength": 4000000000, "uri": uri(SQUARE)}]))
put("gltf/index_out_of_range.gltf", change("accessors", 1, bufferView=0, componentType=5123, count=12))
put("gltf/sparse_out_of_range.gltf", change("accessors", 1, sparse={
    "count": 1, "indices": {"bufferView": 0, "byteOffset": 3, "componentType": 5121}, "values": {"bufferView": 1}}))
put("gltf/sparse_more_than_all.gltf", change("accessors", 1, count=3, sparse={
    "count": 4, "indices": {"bufferView": 0, "componentType": 5121}, "values": {"bufferView": 0}}))
for name, path in [("parent", "../../../../../etc/passwd"), ("encoded", "%2e%2e%2fsecret"), ("absolute", "/etc/passwd"),
                   ("backslash", "..\\..\\secret"), ("scheme", "file:///etc/passwd"), ("device", "/dev/zero")]:
    put(f"gltf/escape_{name}.gltf", text(buffers=[{"byteLength": 1, "uri": path}]))
put("gltf/escape_image.gltf", change("images", 0, uri="../../secret.png", bufferView=None).replace('"bufferView": null,', ""))
put("gltf/zero_byte_in_path.gltf", text(buffers=[{"byteLength": 1, "uri": "a%00b"}]))
put("gltf/image_lies.gltf", change("images", 0, uri=uri(png(60000, 60000, b"\0" * 100)), bufferView=None)
    .replace('"bufferView": null,', ""))
