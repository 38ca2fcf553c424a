#!/usr/bin/env python3
"""Mitsuba's own test scenes: do they load as they are, and do they agree?

    pip install mitsuba
    git clone https://github.com/mitsuba-renderer/mitsuba-data
    cargo build --release
    benches/mitsuba_scenes.py mitsuba-data [NAME ...] [--seeds 8] [--spp 32] [--samples 512]

The tutorials (mitsuba-renderer/mitsuba-tutorials) can stand in place of mitsuba-data. Loads each surface scene of tests/scenes (media are left out) and of scenes/, renders it here and with Mitsuba, and compares linear images:
the energy (within 0.3 % or three standard deviations) and the means of tiles (a z-test of each, Sidak-corrected at 1 %). The variance of
Mitsuba's image is that over seeds, the variance of lumbre's its own `--aov variance`. Prints a line for each scene, and exits with 1 if one
does not load or differs. NAME picks the scenes whose path has it.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from math import erf, sqrt
from pathlib import Path

from mitsuba_runs import to_numpy

ROOT = Path(__file__).resolve().parent.parent

# Files of tests/scenes and scenes that are parts of others, or of media.
LEFT_OUT = ["participating_media", "fragments", "spectral"]
# Light that Mitsuba's own integrator of the scene shows as `path` does, with less noise.
INSTEAD = {"ptracer": "path"}


def scenes(data, names):
    found = sorted([*(data / "tests" / "scenes").rglob("*.xml"), *(data / "scenes").rglob("*.xml")])
    found = [path for path in found if not any(part in str(path.relative_to(data)) for part in LEFT_OUT)]
    return [path for path in found if not names or any(name in str(path) for name in names)]


def compare(np, image, own_variance, runs):
    """Energy ratio, its distance in standard deviations, largest z over tiles and its p value."""
    mean, variance = np.mean(runs, axis=0), np.var(runs, axis=0, ddof=1) / len(runs)
    side = max(4, min(image.shape[:2]) // 8)
    rows, columns = image.shape[0] // side, image.shape[1] // side
    tiles = lambda a: a[: rows * side, : columns * side].reshape(rows, side, columns, side, 3).sum(axis=(1, 3))
    # Mitsuba's pixels share samples where its filter is wider than a pixel: how much more the sums of tiles vary than they would without.
    of_pixels = tiles(variance).mean()
    shared = np.var([tiles(run) for run in runs], axis=0, ddof=1).mean() / len(runs) / of_pixels if of_pixels > 0 else 1.0
    variance = variance * max(1.0, shared)
    total = np.sqrt(own_variance.sum() + variance.sum())
    ratio, sigmas = image.sum() / mean.sum(), (image.sum() - mean.sum()) / total if total > 0 else 0.0
    spread = np.sqrt(tiles(own_variance) + tiles(variance))
    difference = tiles(image) - tiles(mean)
    # Where both are certain, what rounding leaves: single precision over a path.
    spread = np.sqrt(spread**2 + (1e-4 * np.abs(tiles(mean)))**2 + 1e-24)
    z = np.abs(difference / spread)
    # The worst of many tiles is corrected for their number (Sidak).
    p = 1 - erf(float(z.max()) / sqrt(2)) ** z.size
    return ratio, sigmas, float(z.max()), z.size, p, float(np.sqrt((z**2).mean()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--lumbre", type=Path, default=ROOT / "target" / "release" / "lumbre")
    parser.add_argument("--variant", default="scalar_rgb")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--spp", type=int, default=32, help="samples per pixel of each of Mitsuba's renderings")
    parser.add_argument("--samples", type=int, default=512, help="samples per pixel here")
    parser.add_argument("--loads", action="store_true", help="only tell what loads")
    args = parser.parse_args()
    import mitsuba as mi
    import numpy as np

    mi.set_variant(args.variant)
    mi.set_log_level(mi.LogLevel.Error)
    bad = []
    for path in scenes(args.data, args.names):
        name = str(path.relative_to(args.data))
        info = subprocess.run([args.lumbre, "info", path, "--json", "-"], capture_output=True, text=True)
        if info.returncode != 0:
            print(f"{name}: REFUSED: {info.stderr.strip().splitlines()[-1]}", flush=True)
            bad.append(name)
            continue
        if args.loads:
            print(f"{name}: loads", flush=True)
            continue
        text = path.read_text()
        chosen = next((INSTEAD[kind] for kind in INSTEAD if f'"{kind}"' in text), None)
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / "image.exr"
            command = [args.lumbre, "render", path, "-n", str(args.samples), "-o", output, "-q", "--aov", "variance"]
            command += ["-i", chosen] if chosen else []
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                print(f"{name}: FAILS: {done.stderr.strip().splitlines()[-1]}", flush=True)
                bad.append(name)
                continue
            bitmap = mi.Bitmap(str(output))
            channels = [field.name for field in bitmap.struct_()]
            pixels = np.array(bitmap, dtype=np.float64)
            pick = lambda prefix: pixels[..., [channels.index(prefix + channel) for channel in "RGB"]]
            image, own_variance = pick(""), pick("variance.")
        try:
            # Mitsuba 3.9.1's `path` counts the opacity of a mask twice where it samples lights: 0.207 where its `direct` and `volpath` have 0.409.
            masked = "sphere_grid" in text or '"mask"' in text
            theirs = mi.load_file(str(path), **({"integrator": "volpath" if masked else chosen} if masked or chosen else {}))
            # Mitsuba's `direct` counts lights without a surface once for each of several emitter samples, and does not divide by their number.
            several = 'name="emitter_samples"' in text
            own = {"integrator": mi.load_dict({"type": "direct"})} if several else {}
            runs = [to_numpy(mi, mi.render(theirs, spp=args.spp, seed=seed + 1, **own))[..., :3] for seed in range(args.seeds)]
        except Exception as error:  # whatever Mitsuba throws
            print(f"{name}: Mitsuba fails: {str(error).strip().splitlines()[-1]}", flush=True)
            bad.append(name)
            continue
        ratio, sigmas, worst, count, p, rms = compare(np, image, own_variance, runs)
        ok = (abs(ratio - 1) <= 0.003 or abs(sigmas) <= 3) and p > 0.01
        print(f"{name}: energy {ratio:.5f} ({sigmas:+.1f} sigma), largest z of {count} {worst:.2f} (p {p:.1e}), rms z {rms:.2f}: "
              f"{'agrees' if ok else 'DIFFERS'}", flush=True)
        if not ok:
            bad.append(name)
    print(f"{len(bad)} refused, failed or different{': ' if bad else ''}{', '.join(bad)}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
