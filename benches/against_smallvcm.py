#!/usr/bin/env python3
"""lumbre against SmallVCM (Davidovic and Georgiev 2012, github.com/SmallVCM/SmallVCM) on its own scene, with its four lights.

    git clone https://github.com/SmallVCM/SmallVCM && pip install numpy OpenEXR && cargo build --release
    benches/against_smallvcm.py SmallVCM [--lights sun ...] [--techniques path ...] [--runs 5] [--iterations 16] [--size 256]

Both render as many samples, on all processors, in turn, each run with a seed of its own. What is compared is relMSE x seconds of rendering, less
is better; the relMSE is that of one run by the variance over the runs. The floors differ: SmallVCM's is a Phong lobe, which loses light at grazing
angles (seen from the camera it has half the radiance), lumbre's a rough metal of the same width, which does not, and whose brighter lobe is noisier. So
the figure is given of all pixels, and of those that do not show the floor. SmallVCM takes no seed and no size, so a copy of its source gets both when
it is built. Its seconds are those that it states, of all threads, divided by the threads.
"""
import argparse
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

ROOT = Path(__file__).resolve().parent.parent
LUMBRE = ROOT / "target" / "release" / "lumbre"
LIGHTS = {"sun": (0, "small"), "ceiling": (1, "large"), "point": (2, "small"), "background": (3, "small")}
TECHNIQUES = {"path": "pt", "light": "lt", "bdpt": "bpt", "photon": "bpm", "vcm": "vcm"}
LONGEST = 10  # segments; SmallVCM's own limit


def build(source, folder, size):
    shutil.copytree(source / "src", folder / "src")
    config = folder / "src" / "config.hxx"
    text = config.read_text()
    text, seeds = re.subn(r"mBaseSeed\s*=\s*1234", 'mBaseSeed = getenv("SEED") ? atoi(getenv("SEED")) : 1234', text)
    text, sizes = re.subn(r"Vec2i\(512, 512\)", f"Vec2i({size}, {size})", text)
    if seeds != 1 or sizes != 1:
        sys.exit(f"{config}: no seed 1234 or no size 512 x 512 to replace; is this SmallVCM's source?")
    config.write_text("#include <cstdlib>\n" + text)
    subprocess.run(["g++", "-o", "smallvcm", "src/smallvcm.cxx", "-O3", "-march=native", "-std=c++11", "-fopenmp"], cwd=folder, check=True)
    return folder / "smallvcm"


def read_hdr(path):
    """Radiance's format, uncompressed: a mantissa for each channel and an exponent for all."""
    data = path.read_bytes()
    head = re.search(rb"-Y (\d+) \+X (\d+)\n", data)
    height, width = int(head[1]), int(head[2])
    rgbe = np.frombuffer(data[head.end():], np.uint8).reshape(height, width, 4).astype(np.float64)
    return np.where(rgbe[..., 3:] > 0, (rgbe[..., :3] + 0.5) * 2.0 ** (rgbe[..., 3:] - 136), 0.0)


def smallvcm(program, folder, args, light, technique, seed):
    output = folder / "theirs.hdr"
    done = subprocess.run([program, "-s", str(LIGHTS[light][0]), "-a", TECHNIQUES[technique], "-i", str(args.iterations), "-o", output],
                          cwd=folder, env={**os.environ, "SEED": str(1000 * seed)}, capture_output=True, text=True, check=True)
    seconds = float(re.search(r"done in ([0-9.]+) s", done.stdout)[1]) / os.cpu_count()
    return read_hdr(output), seconds


def lumbre(folder, args, light, technique, seed, further=()):
    output = folder / "ours.exr"
    done = subprocess.run([LUMBRE, "render", ROOT / "scenes" / "small_vcm.xml", "-D", f"light={light}", "-D", f"spheres={LIGHTS[light][1]}",
                           "-i", technique, "-n", str(args.iterations), "--seed", str(seed), "--size", f"{args.size}x{args.size}",
                           "--max-depth", str(LONGEST), "-o", output, "--json", "-", *further], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"lumbre failed: {done.stderr}")
    return np.asarray(OpenEXR.File(str(output)).channels()["RGB"].pixels, np.float64), json.loads(done.stdout)["seconds"]["render"]


def shows_floor(folder, args, light):
    """Whether each pixel shows the floor."""
    lumbre(folder, args, light, "path", 0, ["--aov", "material_id"])
    file = OpenEXR.File(str(folder / "ours.exr"))
    names = json.loads(file.header()["lumbre.material_names"])
    number = next(int(number) for number, name in names.items() if name == "floor")
    return np.asarray(file.channels()["material_id.X"].pixels) == number


def squared_errors(images):
    """Of each pixel, over the square of its mean; the relMSE is their mean."""
    images = np.stack(images)
    return np.mean(images.var(axis=0, ddof=1) / (images.mean(axis=0) ** 2 + 0.01), axis=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path)
    parser.add_argument("--lights", nargs="*", default=list(LIGHTS), choices=list(LIGHTS))
    parser.add_argument("--techniques", nargs="*", default=list(TECHNIQUES), choices=list(TECHNIQUES))
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--iterations", type=int, default=16)
    parser.add_argument("--size", type=int, default=256)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        program = build(args.source, folder, args.size)
        print(f"{args.size}x{args.size}, {args.iterations} samples, {args.runs} runs in turn: lumbre over SmallVCM, less is better")
        for light in args.lights:
            others = ~shows_floor(folder, args, light)
            for technique in args.techniques:
                ours, theirs = [], []
                lumbre(folder, args, light, technique, 0)  # compiles the kernels
                for seed in range(1, args.runs + 1):
                    ours.append(lumbre(folder, args, light, technique, seed))
                    theirs.append(smallvcm(program, folder, args, light, technique, seed))
                errors = [squared_errors([image for image, _ in runs]) for runs in (ours, theirs)]
                pairs = sorted(a[1] / b[1] for a, b in zip(ours, theirs))
                time = statistics.median(pairs)
                all_pixels, apart = (np.mean(errors[0][mask]) / np.mean(errors[1][mask]) for mask in (others | True, others))
                print(f"  {light:<10} {technique:<7} relMSE x s {all_pixels * time:6.3f}, without the floor {apart * time:6.3f}   "
                      f"relMSE {all_pixels:.3f}, {apart:.3f}   seconds {time:.3f} ({pairs[0]:.3f} to {pairs[-1]:.3f})", flush=True)


if __name__ == "__main__":
    main()
