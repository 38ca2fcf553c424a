#!/usr/bin/env python3
"""Makes tests/references: one small scene per kind of material, light and camera, and what Mitsuba 3 makes of it.

    pip install mitsuba numpy
    benches/references.py             every scene that has no reference yet
    benches/references.py NAME...     these, again

Each reference is an EXR of the mean of independent seeds (R, G, B) and the variance of that mean (variance.R, ...), by
`scalar_rgb`. `cargo test --release --test tests references::` renders the same files and compares them pixel by pixel.
"""
import struct
import sys
import zlib
from pathlib import Path

from mitsuba_runs import mean_and_variance

FOLDER = Path(__file__).resolve().parent.parent / "tests" / "references"
SPP, SEEDS = 512, 16

STAGE = """<scene version="3.0.0">
    <!-- The stage of the other files here: a floor, a back wall, a lamp, and a camera. -->
    <default name="camera" value="stage_perspective.xml"/>
    <include filename="$camera"/>
    <shape type="rectangle">
        <transform name="to_world"><scale value="4"/><rotate x="1" angle="-90"/><translate y="-1"/></transform>
        <bsdf type="diffuse"><texture name="reflectance" type="checkerboard">
            <rgb name="color0" value="0.7, 0.5, 0.3"/><rgb name="color1" value="0.2, 0.3, 0.4"/>
            <transform name="to_uv"><scale value="4"/></transform>
        </texture></bsdf>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="4"/><translate y="2" z="-3"/></transform>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.4, 0.5, 0.6"/></bsdf>
    </shape>
</scene>
"""
FILM = """<film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/>CROP<rfilter type="box"/></film>"""
LOOK = """<transform name="to_world"><lookat origin="0, 1.2, 5" target="0, 0, 0" up="0, 1, 0"/></transform>"""
CAMERAS = {
    "perspective": f"""<sensor type="perspective"><float name="fov" value="38"/>{LOOK}{FILM.replace("CROP", "")}</sensor>""",
    "thinlens": f"""<sensor type="thinlens"><float name="fov" value="38"/><float name="aperture_radius" value="0.3"/>
        <float name="focus_distance" value="4.2"/>{LOOK}{FILM.replace("CROP", "")}</sensor>""",
    "orthographic": f"""<sensor type="orthographic"><transform name="to_world"><scale x="1.8" y="1.8"/>
        <lookat origin="0, 1.2, 5" target="0, 0, 0" up="0, 1, 0"/></transform>{FILM.replace("CROP", "")}</sensor>""",
    "crop": f"""<sensor type="perspective"><float name="fov" value="38"/><string name="fov_axis" value="y"/>{LOOK}
        <float name="principal_point_offset_x" value="0.1"/><float name="principal_point_offset_y" value="-0.05"/>
        <film type="hdrfilm"><integer name="width" value="80"/><integer name="height" value="60"/>
        <integer name="crop_offset_x" value="20"/><integer name="crop_offset_y" value="30"/>
        <integer name="crop_width" value="32"/><integer name="crop_height" value="24"/><rfilter type="box"/></film></sensor>""",
}
LAMP = """<shape type="rectangle"><transform name="to_world"><scale value="1.6"/><rotate x="1" angle="90"/><translate x="-0.5" y="3" z="1"/></transform>
        <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="3, 2.5, 2"/></emitter></shape>"""


def ball(bsdf):
    return LAMP + f"""
    <shape type="sphere"><transform name="to_world"><rotate x="1" angle="70"/><rotate y="1" angle="25"/></transform>{bsdf}</shape>"""


def slab(bsdf):
    """A solid that light may pass through, and a tilted plate of the same in front of the wall."""
    return LAMP + f"""
    <shape type="cube"><transform name="to_world"><scale value="0.7"/><rotate y="1" angle="30"/></transform>{bsdf}</shape>"""


def plate(bsdf):
    return LAMP + f"""
    <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-35"/><rotate y="1" angle="20"/></transform>{bsdf}</shape>"""


def grey(light):
    return light + """
    <shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></shape>"""


PICTURE = """<texture name="NAME" type="bitmap"><string name="filename" value="picture.png"/>EXTRA</texture>"""


def picture(name, extra=""):
    return PICTURE.replace("NAME", name).replace("EXTRA", extra)


GOLD = """<rgb name="eta" value="0.16, 0.43, 1.37"/><rgb name="k" value="3.9, 2.4, 1.7"/>"""
GGX = """<string name="distribution" value="ggx"/>"""
SCENES = {
    "diffuse": ball("""<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf>"""),
    "diffuse_bitmap": ball(f"""<bsdf type="diffuse">{picture("reflectance")}</bsdf>"""),
    "bitmap_wrap": plate("""<bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="picture.png"/>
        <string name="wrap_mode" value="mirror"/><string name="filter_type" value="nearest"/><boolean name="raw" value="true"/>
        <transform name="to_uv"><rotate z="1" angle="20"/><scale x="2.5" y="1.5"/><translate x="0.3" y="-0.2"/></transform></texture></bsdf>"""),
    "bitmap_clamp": plate("""<bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="picture.png"/>
        <string name="wrap_mode" value="clamp"/><transform name="to_uv"><scale x="2" y="2"/><translate x="-0.5" y="-0.5"/></transform></texture></bsdf>"""),
    "conductor": ball(f"""<bsdf type="conductor">{GOLD}</bsdf>"""),
    "conductor_named": ball("""<bsdf type="conductor"><string name="material" value="Cu"/></bsdf>"""),
    "roughconductor": ball(f"""<bsdf type="roughconductor">{GGX}<float name="alpha" value="0.25"/>{GOLD}</bsdf>"""),
    "roughconductor_beckmann": ball(f"""<bsdf type="roughconductor"><float name="alpha" value="0.25"/>{GOLD}</bsdf>"""),
    "roughconductor_anisotropic": ball(f"""<bsdf type="roughconductor">{GGX}<float name="alpha_u" value="0.08"/><float name="alpha_v" value="0.4"/>{GOLD}</bsdf>"""),
    "roughconductor_textured": plate(f"""<bsdf type="roughconductor">{GGX}{picture("alpha")}{GOLD}</bsdf>"""),
    "dielectric": slab("""<bsdf type="dielectric"/>"""),
    "roughdielectric": slab(f"""<bsdf type="roughdielectric">{GGX}<float name="alpha" value="0.2"/></bsdf>"""),
    "roughdielectric_beckmann": slab("""<bsdf type="roughdielectric"><float name="alpha" value="0.2"/></bsdf>"""),
    "thindielectric": plate("""<bsdf type="thindielectric"><rgb name="specular_transmittance" value="0.9, 0.7, 0.5"/></bsdf>"""),
    "plastic": ball("""<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.7, 0.2, 0.1"/></bsdf>"""),
    "plastic_nonlinear": ball("""<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.7, 0.2, 0.1"/><boolean name="nonlinear" value="true"/></bsdf>"""),
    # Only the coating: Mitsuba 3.9 takes the share that it throws back from inside as a plain mean over 64 cosines, ends
    # included, which makes the base 1.3 % darker than the integral does at alpha 0.2.
    "roughplastic": ball(f"""<bsdf type="roughplastic">{GGX}<float name="alpha" value="0.2"/><float name="diffuse_reflectance" value="0"/></bsdf>"""),
    "roughplastic_beckmann": ball("""<bsdf type="roughplastic"><float name="alpha" value="0.3"/><float name="diffuse_reflectance" value="0"/></bsdf>"""),
    "principled": ball("""<bsdf type="principled"><rgb name="base_color" value="0.8, 0.4, 0.1"/><float name="roughness" value="0.4"/></bsdf>"""),
    "principled_metal": ball("""<bsdf type="principled"><rgb name="base_color" value="0.8, 0.4, 0.1"/><float name="roughness" value="0.3"/>
        <float name="metallic" value="0.8"/><float name="spec_tint" value="0.4"/></bsdf>"""),
    "principled_anisotropic": ball("""<bsdf type="principled"><rgb name="base_color" value="0.8, 0.4, 0.1"/><float name="roughness" value="0.4"/>
        <float name="metallic" value="0.9"/><float name="anisotropic" value="0.8"/></bsdf>"""),
    "principled_coat": ball("""<bsdf type="principled"><rgb name="base_color" value="0.5, 0.1, 0.1"/><float name="roughness" value="0.6"/>
        <float name="clearcoat" value="1.0"/><float name="clearcoat_gloss" value="0.3"/></bsdf>"""),
    "principled_cloth": ball("""<bsdf type="principled"><rgb name="base_color" value="0.2, 0.3, 0.6"/><float name="roughness" value="0.8"/>
        <float name="sheen" value="0.8"/><float name="sheen_tint" value="0.5"/><float name="flatness" value="0.6"/></bsdf>"""),
    "principled_glass": slab("""<bsdf type="principled"><rgb name="base_color" value="0.9, 0.8, 0.7"/><float name="roughness" value="0.3"/>
        <float name="spec_trans" value="0.9"/><float name="eta" value="1.4"/></bsdf>"""),
    "blendbsdf": ball(f"""<bsdf type="blendbsdf">{picture("weight")}<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf>
        <bsdf type="roughconductor">{GGX}<float name="alpha" value="0.2"/>{GOLD}</bsdf></bsdf>"""),
    "mask": ball(f"""<bsdf type="mask">{picture("opacity")}<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf></bsdf></bsdf>"""),
    "null": ball("""<bsdf type="null"/>"""),
    "twosided": plate("""<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf><bsdf type="plastic"/></bsdf>"""),
    "normalmap": ball("""<bsdf type="normalmap"><texture name="normalmap" type="bitmap"><string name="filename" value="normals.png"/><boolean name="raw" value="true"/></texture>
        <boolean name="flip_invalid_normals" value="false"/><boolean name="use_shadowing_function" value="false"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.5, 0.3"/></bsdf></bsdf>"""),
    "bumpmap": plate("""<bsdf type="bumpmap"><texture type="bitmap"><string name="filename" value="picture.png"/><boolean name="raw" value="true"/></texture>
        <float name="scale" value="0.15"/><bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.5, 0.3"/></bsdf></bsdf>"""),
    "area_textured": grey(f"""<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate x="-0.5" y="2.5" z="1"/></transform>
        <bsdf type="diffuse"><float name="reflectance" value="0"/></bsdf><emitter type="area">{picture("radiance")}</emitter></shape>"""),
    "area_sphere": grey("""<shape type="sphere"><float name="radius" value="0.4"/><point name="center" x="-1.4" y="2" z="0.6"/>
        <emitter type="area"><rgb name="radiance" value="20, 15, 10"/></emitter></shape>"""),
    "area_disk": grey("""<shape type="disk"><transform name="to_world"><rotate x="1" angle="90"/><translate x="0.5" y="2.6" z="0.6"/></transform>
        <emitter type="area"><rgb name="radiance" value="4, 5, 6"/></emitter></shape>"""),
    "area_cylinder": grey("""<shape type="cylinder"><float name="radius" value="0.2"/><point name="p0" x="-2" y="1.5" z="0"/><point name="p1" x="-1" y="2.5" z="1"/>
        <emitter type="area"><rgb name="radiance" value="12, 10, 8"/></emitter></shape>"""),
    "point": grey("""<emitter type="point"><point name="position" x="1.5" y="2.5" z="2"/><rgb name="intensity" value="20, 18, 14"/></emitter>"""),
    "spot": grey("""<emitter type="spot"><transform name="to_world"><lookat origin="2, 3, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
        <float name="cutoff_angle" value="25"/><float name="beam_width" value="12"/><rgb name="intensity" value="60, 50, 40"/></emitter>"""),
    "spot_textured": grey(f"""<emitter type="spot"><transform name="to_world"><lookat origin="2, 3, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
        <float name="cutoff_angle" value="30"/><rgb name="intensity" value="60, 60, 60"/>{picture("texture")}</emitter>"""),
    "directional": grey("""<emitter type="directional"><vector name="direction" value="-0.5, -1, -0.7"/><rgb name="irradiance" value="3, 2.5, 2"/></emitter>"""),
    "projector": grey(f"""<emitter type="projector"><transform name="to_world"><lookat origin="1.5, 2.5, 3" target="0, 0, 0" up="0, 1, 0"/></transform>
        <float name="fov" value="35"/><float name="scale" value="40"/>{picture("irradiance")}</emitter>"""),
    "constant": grey("""<emitter type="constant"><rgb name="radiance" value="0.6, 0.7, 0.9"/></emitter>"""),
    "envmap": grey("""<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="1.5"/>
        <transform name="to_world"><rotate x="1" angle="15"/><rotate y="1" angle="130"/></transform></emitter>"""),
    "thinlens": ball("""<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf>"""),
    "orthographic": ball("""<bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.3, 0.1"/></bsdf>"""),
    "crop": grey("""<emitter type="constant"><rgb name="radiance" value="0.6, 0.7, 0.9"/></emitter>"""),
}


def png(path, pixels):
    """Writes rows of (r, g, b) bytes."""
    rows = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in pixels)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", len(pixels[0]), len(pixels), 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def write_inputs(mi, np):
    (FOLDER / "stage.xml").write_text(STAGE)
    for name, camera in CAMERAS.items():
        (FOLDER / f"stage_{name}.xml").write_text(f'<scene version="3.0.0">{camera}</scene>\n')
    side = 12
    png(FOLDER / "picture.png", [[(40 + 200 * (x * 7 + y * 3) % 211, 60 + (x * 17 + y * y * 5) % 180, 90 + 13 * ((x * y) % 12)) for x in range(side)]
                                 for y in range(side)])
    tilt = lambda i: int(127.5 + 60 * np.sin(2.0 * np.pi * i / side))
    png(FOLDER / "normals.png", [[(tilt(2 * x), tilt(y), 220) for x in range(side)] for y in range(side)])
    if not (FOLDER / "sky.exr").exists():
        y, x = np.mgrid[0:16, 0:32]
        sky = np.stack([0.2 + 0.03 * x + 0 * y, 0.3 + 0.02 * (16 - y) + 0 * x, 0.8 - 0.02 * y + 0 * x], axis=-1).astype(np.float32)
        sky[4, 9] = (60.0, 50.0, 30.0)
        mi.Bitmap(sky).write(str(FOLDER / "sky.exr"))
    for name, body in SCENES.items():
        camera = name if name in CAMERAS else "perspective"
        (FOLDER / f"{name}.xml").write_text(f"""<scene version="3.0.0">
    <integrator type="path"/>
    <default name="camera" value="stage_{camera}.xml"/>
    <include filename="stage.xml"/>
    {body}
</scene>
""")


def main():
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_rgb")
    write_inputs(mi, np)
    wanted = sys.argv[1:] or [name for name in SCENES if not (FOLDER / f"{name}.exr").exists()]
    for name in wanted:
        scene = mi.load_file(str(FOLDER / f"{name}.xml"))
        mean, variance = mean_and_variance(mi, scene, SPP, SEEDS)
        channels = ["R", "G", "B", "variance.R", "variance.G", "variance.B"]
        both = np.concatenate([mean, variance], axis=2).astype(np.float32)
        bitmap = mi.Bitmap(both, mi.Bitmap.PixelFormat.MultiChannel, channels)
        bitmap.write(str(FOLDER / f"{name}.exr"))
        print(f"{name}: mean {mean.mean(axis=(0, 1)).round(4)}", flush=True)


if __name__ == "__main__":
    main()
