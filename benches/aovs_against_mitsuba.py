#!/usr/bin/env python3
"""The AOVs of lumbre against those of Mitsuba 3 on the very same scene files.

    pip install mitsuba numpy
    cargo build --release
    benches/aovs_against_mitsuba.py [SCENE ...]

Means are compared region by region: off by no more than 1 % of the layer's greatest value, or 4 standard errors of two Monte Carlo means. Left out
are albedos of what has no diffuse reflectance, which Mitsuba has as 0, and texture coordinates of meshes without any, whose triangles both number
from a corner of their choice. Numbers of objects must each stand for one of Mitsuba's wherever nine pixels in a square
show one object. Exits with status 1
where a layer differs. Scenes with bump or normal maps are no use: Mitsuba tells their shading normals in the surface's own frame.
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LUMBRE = ROOT / "target" / "release" / "lumbre"
# Layers of lumbre with their channels, and Mitsuba's type.
LAYERS = {
    "albedo": ("RGB", "albedo"),
    "normal": ("XYZ", "sh_normal"),
    "geometric_normal": ("XYZ", "geo_normal"),
    "position": ("XYZ", "position"),
    "depth": ("Z", "depth"),
    "uv": ("UV", "uv"),
    "object_id": ("X", "shape_index"),
}
BLOCK = 8

# Textures, a lens, a crop, instances, what is not diffuse alone.
SHAPES = """<scene version="3.0.0">
<default name="spp" value="16"/>
<sensor type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.02"/><float name="focus_distance" value="5"/>
 <transform name="to_world"><lookat origin="1, 2, 5" target="0, 0.5, 0" up="0, 1, 0"/></transform>
 <film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="192"/><integer name="crop_offset_x" value="32"/>
 <integer name="crop_width" value="192"/><integer name="crop_height" value="160"/><rfilter type="box"/></film>
 <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform><bsdf type="diffuse">
 <texture name="reflectance" type="checkerboard"><rgb name="color0" value="0.8, 0.3, 0.1"/><rgb name="color1" value="0.1, 0.2, 0.7"/>
 <transform name="to_uv"><scale x="4" y="4"/></transform></texture></bsdf></shape>
<shape type="sphere"><point name="center" x="-1" y="0.6" z="0"/><float name="radius" value="0.6"/>
 <bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.2, 0.5, 0.3"/><float name="alpha" value="0.2"/></bsdf></shape>
<shape type="cube"><transform name="to_world"><scale value="0.4"/><rotate y="1" angle="30"/><translate x="0.4" y="0.4" z="0.8"/></transform>
 <bsdf type="principled"><rgb name="base_color" value="0.7, 0.6, 0.1"/><float name="roughness" value="0.4"/></bsdf></shape>
<shape type="cylinder"><point name="p0" x="0.4" y="0" z="-1"/><point name="p1" x="0.4" y="1.4" z="-1"/><float name="radius" value="0.3"/>
 <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.1, 0.5"/></bsdf></bsdf></shape>
<shape type="shapegroup" id="pane"><shape type="rectangle"><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape></shape>
<shape type="instance"><ref id="pane"/><transform name="to_world"><scale value="0.4"/><rotate y="1" angle="20"/><translate x="1.5" y="0.5"/></transform></shape>
<shape type="instance"><ref id="pane"/><transform name="to_world"><scale x="0.3" y="0.6"/><translate x="-1" y="1.8" z="-1"/></transform></shape>
<shape type="rectangle"><transform name="to_world"><scale value="0.5"/><rotate x="1" angle="90"/><translate y="2.4"/></transform>
 <emitter type="area"><rgb name="radiance" value="5, 4, 3"/></emitter></shape>
<emitter type="constant"><rgb name="radiance" value="0.2, 0.3, 0.4"/></emitter>
</scene>"""


def blocks(np, image):
    """Means of regions of BLOCK x BLOCK pixels."""
    height, width, channels = image.shape
    height, width = height // BLOCK * BLOCK, width // BLOCK * BLOCK
    cut = image[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, channels)
    return cut.mean(axis=(1, 3))


def theirs(mi, np, path, args):
    """Mitsuba's layers, and their variance over seeds."""
    scene = mi.load_file(str(path), spp="1")
    parameters = mi.traverse(scene.sensors()[0])
    if "near_clip" in parameters:
        parameters["near_clip"] = 1e-4  # its depth begins there
        parameters.update()
    aovs = ",".join(f"{name}:{kind}" for name, (_, kind) in LAYERS.items())
    integrator = mi.load_dict({"type": "aov", "aovs": aovs})
    emission = mi.load_dict({"type": "path", "max_depth": 1})
    found = {}
    for seed in range(args.seeds):
        image = np.array(mi.render(scene, integrator=integrator, spp=args.spp // args.seeds, seed=seed + 1), dtype=np.float64)
        seen = np.array(mi.render(scene, integrator=emission, spp=args.spp // args.seeds, seed=seed + 1), dtype=np.float64)[..., :3]
        at = image.shape[-1] - sum(len(letters) for letters, _ in LAYERS.values())
        for name, (letters, _) in LAYERS.items():
            found.setdefault(name, []).append(image[..., at:at + len(letters)])
            at += len(letters)
        found.setdefault("emission", []).append(seen)
    return found, scene.shapes()


def interiors(np, image):
    """Pixels with the same whole number as all around them."""
    inside = image == np.round(image)
    for shift in [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1)]:
        inside &= np.roll(image, shift, axis=(0, 1)) == image
    inside[[0, -1], :] = inside[:, [0, -1]] = False
    return inside


def comparable(mi, np, name, numbers, shapes):
    """Pixels where a layer means the same to both, given the numbers of the shapes there."""
    def is_told(shape):
        if shape.class_name() == "Instance":
            return True
        if name == "albedo":
            return shape.is_emitter() or mi.has_flag(shape.bsdf().flags(), mi.BSDFFlags.DiffuseReflection)
        return name != "uv" or not shape.is_mesh() or shape.has_vertex_texcoords()

    told = np.array([True] + [is_told(shape) for shape in shapes])
    return np.ones(numbers.shape, bool) if told.all() else told[np.round(numbers).astype(int)] & interiors(np, numbers)


def ours(mi, np, path, args, folder):
    output = Path(folder) / "image.exr"
    command = [LUMBRE, "render", path, "-i", "path", "--max-depth", "1", "-n", args.spp, "--aov", "all", "-o", output, "-q"]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"lumbre failed: {done.stderr}")
    bitmap = mi.Bitmap(str(output))
    names = [field.name for field in bitmap.struct_()]
    pixels = np.array(bitmap, dtype=np.float64)
    channels = {name: letters for name, (letters, _) in LAYERS.items()} | {"emission": "RGB", "material_id": "X"}
    return {name: pixels[..., [names.index(f"{name}.{letter}") for letter in letters]] for name, letters in channels.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", type=Path, help="by default cornell_spheres, veach_mis and one of its own")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--variant", default="scalar_rgb")
    args = parser.parse_args()
    import mitsuba as mi
    import numpy as np

    mi.set_variant(args.variant)
    failed = False
    own_scene = tempfile.NamedTemporaryFile(suffix=".xml", mode="w")
    own_scene.write(SHAPES)
    own_scene.flush()
    default = [ROOT / "scenes" / name for name in ["cornell_spheres.xml", "veach_mis.xml"]] + [Path(own_scene.name)]
    for path in args.scenes or default:
        with tempfile.TemporaryDirectory() as folder:
            own = ours(mi, np, path, args, folder)
        other, shapes = theirs(mi, np, path, args)
        numbers = np.mean(other["object_id"], axis=0)[..., 0]
        print(f"{path.name}, {args.spp} spp, Mitsuba {mi.__version__} {args.variant}")
        for name, runs in other.items():
            mean = np.mean(runs, axis=0)
            if name == "object_id":
                whole = interiors(np, numbers)[..., None]
                # Whatever the numbers are, one of lumbre's stands for one of Mitsuba's, which makes one shape of several meshes with one BSDF.
                pairs = set(zip(own[name][whole].astype(int).tolist(), np.round(mean[whole]).astype(int).tolist()))
                ok = len(pairs) == len({a for a, _ in pairs})
                print(f"  {name:<17} {len(pairs)} numbers for {len({b for _, b in pairs})} of Mitsuba's, in {int(whole.sum())} pixels: {'ok' if ok else 'DIFFERS'}")
            else:
                # A region counts where all of its pixels do.
                counts = blocks(np, comparable(mi, np, name, numbers, shapes)[..., None].astype(float)) == 1
                error = np.sqrt(2 * np.var([blocks(np, run) for run in runs], axis=0, ddof=1) / args.seeds)
                off = np.abs(blocks(np, own[name]) - blocks(np, mean))
                scale = np.abs(mean).max() or 1.0
                share = off / scale * counts
                beyond = (share > 0.01) & (off > 4 * error)
                ok = not beyond.any()
                whole = ((blocks(np, own[name]) - blocks(np, mean)) * counts).sum(axis=(0, 1)) / max(counts.sum(), 1)
                print(f"  {name:<17} mean off by {np.abs(whole).max() / scale:.6f} of the greatest value, regions by {share.max():.4f} at most, "
                      f"{int(beyond.sum())} of {int(counts.sum())} beyond: {'ok' if ok else 'DIFFERS'}")
            failed |= not ok
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
