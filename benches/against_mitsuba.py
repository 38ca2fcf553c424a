#!/usr/bin/env python3
"""lumbre against Mitsuba 3 on the very same scene files.

    pip install mitsuba                     (3.5 or later; llvm_ad_rgb also needs an LLVM library, DRJIT_LIBLLVM_PATH)
    cargo build --release

    benches/against_mitsuba.py agree                two independent renderers, one image: energy ratio, z-test of every region
    benches/against_mitsuba.py speed                samples per second, the renderers in turn, medians

Both exit with status 1 where a bound is missed, and say which.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from math import erf, sqrt
from pathlib import Path

from mitsuba_runs import mean_and_variance, to_numpy

ROOT = Path(__file__).resolve().parent.parent
LUMBRE = ROOT / "target" / "release" / "lumbre"


def lumbre(scene, output, spp, size, depth, extra=()):
    """Renders with lumbre; its JSON report."""
    command = [LUMBRE, "render", scene, "-n", str(spp), "--size", f"{size}x{size}", "--max-depth", str(depth), "-o", output,
               "--json", "-", *extra]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"lumbre failed: {done.stderr}")
    return json.loads(done.stdout)


def layers(mi, np, path):
    """The image and its variance from an EXR file that lumbre wrote with --aov variance."""
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    pixels = np.array(bitmap, dtype=np.float64)
    pick = lambda prefix: pixels[..., [names.index(prefix + channel) for channel in "RGB"]]
    return pick(""), pick("variance.")


def agree(args):
    import mitsuba as mi
    import numpy as np

    mi.set_variant(args.variant)
    failed = False
    for name in args.scenes:
        scene = ROOT / "scenes" / name
        theirs = mi.load_file(str(scene), size=str(args.size), max_depth=str(args.depth), spp="1")
        mean, variance = mean_and_variance(mi, theirs, args.spp // args.seeds, args.seeds)
        for backend in args.backends:
            with tempfile.TemporaryDirectory() as folder:
                output = Path(folder) / "image.exr"
                lumbre(scene, output, args.spp, args.size, args.depth, ["--backend", backend, "--aov", "variance"])
                image, own_variance = layers(mi, np, output)
            ratio = image.mean() / mean.mean()
            # Regions of 16 x 16 pixels, each channel: a z-test, Sidak-corrected.
            blocks = lambda a: a.reshape(args.size // 16, 16, args.size // 16, 16, 3).mean(axis=(1, 3))
            difference = blocks(image) - blocks(mean)
            z = difference / np.sqrt((blocks(own_variance) + blocks(variance)) / 256)
            worst = float(np.abs(z).max())
            p = 1 - erf(worst / sqrt(2))
            bound = 1 - (1 - 0.01) ** (1 / z.size)
            ok = abs(ratio - 1) <= 0.002 and p > bound
            failed |= not ok
            print(f"{name} {args.size}x{args.size} {args.spp} spp depth {args.depth}, {backend} against Mitsuba {mi.__version__} "
                  f"{args.variant}: energy ratio {ratio:.5f} (bound 1 +- 0.002), largest z of {z.size} regions {worst:.2f} "
                  f"(p {p:.1e}, bound {bound:.1e}), rms z {float(np.sqrt((z ** 2).mean())):.3f}: {'ok' if ok else 'DIFFERS'}")
    return failed


def speed(args):
    import mitsuba as mi

    samples = args.size * args.size * args.spp
    contestants = {}
    for backend in args.backends:
        def run(backend=backend):
            report = lumbre(args.scene, output, args.spp, args.size, args.depth, ["--backend", backend])
            return report["samples_per_s"] / 1e6
        contestants[f"lumbre {backend}"] = run
    for variant in args.variants:
        mi.set_variant(variant)
        scene = mi.load_file(str(args.scene), size=str(args.size), max_depth=str(args.depth), spp=str(args.spp))
        seeds = iter(range(1, 10_000))
        def run(variant=variant, scene=scene, seeds=seeds):
            mi.set_variant(variant)
            started = time.perf_counter()
            to_numpy(mi, mi.render(scene, spp=args.spp, seed=next(seeds)))
            return samples / (time.perf_counter() - started) / 1e6
        contestants[f"mitsuba {variant}"] = run
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "image.png"
        rates = {name: [] for name in contestants}
        for turn in range(args.repeats + 1):  # the first turn warms caches up and does not count
            for name, run in contestants.items():
                rate = run()
                if turn > 0:
                    rates[name].append(rate)
    print(f"{args.scene.name} {args.size}x{args.size} {args.spp} spp depth {args.depth}, Msamples/s, median of {args.repeats} in turn "
          f"(least to most); Mitsuba {mi.__version__}")
    for name, values in rates.items():
        print(f"  {name:<24} {statistics.median(values):8.3f}  ({min(values):.3f} to {max(values):.3f})")
    if "lumbre bvh" in rates and "mitsuba llvm_ad_rgb" in rates:
        ratios = sorted(a / b for a, b in zip(rates["lumbre bvh"], rates["mitsuba llvm_ad_rgb"]))
        print(f"  lumbre bvh over mitsuba llvm_ad_rgb, pair by pair: {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})")
        return statistics.median(ratios) < 1
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("agree")
    one.add_argument("scenes", nargs="*", default=["cornell.xml", "cornell_spheres.xml"])
    one.add_argument("--variant", default="scalar_rgb")
    one.add_argument("--size", type=int, default=256)
    one.add_argument("--spp", type=int, default=1024)
    one.add_argument("--seeds", type=int, default=16)
    one.add_argument("--depth", type=int, default=-1)
    one.add_argument("--backends", nargs="*", default=["bvh", "ray-query"])
    two = commands.add_parser("speed")
    two.add_argument("scene", nargs="?", type=Path, default=ROOT / "scenes" / "cornell.xml")
    two.add_argument("--variants", nargs="*", default=["scalar_rgb", "llvm_ad_rgb"])
    two.add_argument("--size", type=int, default=512)
    two.add_argument("--spp", type=int, default=32)
    two.add_argument("--depth", type=int, default=8)
    two.add_argument("--repeats", type=int, default=5)
    two.add_argument("--backends", nargs="*", default=["bvh", "ray-query"])
    args = parser.parse_args()
    sys.exit(1 if {"agree": agree, "speed": speed}[args.command](args) else 0)


if __name__ == "__main__":
    main()
