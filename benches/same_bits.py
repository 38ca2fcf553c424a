#!/usr/bin/env python3
"""Whether two builds of lumbre render the same bits.

    benches/same_bits.py BEFORE AFTER [--backend bvh] [--device llvmpipe]

BEFORE and AFTER are programs, each built from its commit (`git worktree add`, `cargo build --release`). Pairs of scene and technique are
rendered by both on the backend, small and with few samples, and the pixels of all layers are compared bit by bit; the header, which
holds seconds, is not. Prints a line for each pair and exits with 1 if one differs.

Drivers regroup sums and products by how code is put together, which moves last bits where nothing has changed: both render with
`--exact-arithmetic`, unless one of them does not know it yet.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).resolve().parent.parent / "scenes"

# Scene, technique, samples per pixel, further arguments.
PAIRS = [
    ("cornell.xml", "path", 16, []),
    ("cornell.xml", "path", 1024, ["--size", "40x40"]),  # enough samples for triangles as constants of the kernel
    ("cornell_spheres.xml", "bdpt", 8, ["--strategies=4"]),
    ("veach_mis.xml", "direct", 8, []),
    ("small_vcm.xml", "vcm", 4, ["--lengths"]),
    ("caustic_small_light.xml", "light", 8, []),
    ("torus_in_glass.xml", "photon", 4, []),
    ("door_ajar.xml", "mlt:form=multiplexed", 4, []),
    ("furnace_sphere.xml", "path-implicit", 8, []),
    ("cube_point_light.xml", "radiosity:solver=shoot", 2, []),
    ("cornell_spheres.xml", "whitted", 4, []),
    ("gltf_room/room.gltf", "bdpt", 1, []),
    ("gltf_room/room.gltf", "path", 2, ["--sampler", "independent"]),
    ("bumps.xml", "path", 4, ["--no-specialise", "--size", "16x16"]),
]


def exact(program):
    """The flag, if the program knows it."""
    text = subprocess.run([program, "render", "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
    return ["--exact-arithmetic"] if "--exact-arithmetic" in text else []


def pixels(path):
    """The bytes of an EXR file behind its header, which ends with an empty name."""
    data = path.read_bytes()
    at = 8
    while data[at]:
        at = data.index(0, at) + 1  # name
        at = data.index(0, at) + 1  # type
        at += 4 + int.from_bytes(data[at : at + 4], "little")
    return data[at + 1 :]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--backend", default="bvh")
    parser.add_argument("--device", default="llvmpipe")
    args = parser.parse_args()
    differing = 0
    flags = [exact(args.before), exact(args.after)]
    flag = flags[0] if all(flags) else []
    print("exact arithmetic" if flag else "arithmetic as the driver likes it")
    with tempfile.TemporaryDirectory() as folder:
        for scene, technique, spp, more in PAIRS:
            size = [] if "--size" in more else ["--size", "64x64"]
            images = []
            for name, program in (("before", args.before), ("after", args.after)):
                image = Path(folder) / f"{name}.exr"
                figures = Path(folder) / f"{name}.json"
                command = [program, "render", SCENES / scene, "-i", technique, "-n", str(spp), "-o", image, "-q", "--json", figures]
                command += ["--backend", args.backend, "--device", args.device, *size, *more, *flag]
                run = subprocess.run(command, stderr=subprocess.PIPE, text=True)
                if run.returncode != 0:
                    sys.exit(f"{' '.join(map(str, command))}: {run.stderr}")
                # The chunks' offsets count from the header's length, which numbers in it change: what follows them is compared.
                rows = json.loads(figures.read_text())["height"]
                images.append(pixels(image)[8 * rows :])
            same = images[0] == images[1]
            differing += not same
            print(f"{'same' if same else 'DIFFERENT':9} {scene:26} {technique:26} {spp:5} spp {' '.join(more)}", flush=True)
    print(f"{len(PAIRS) - differing} of {len(PAIRS)} have the same bits")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
