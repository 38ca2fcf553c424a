#!/usr/bin/env python3
"""Mitsuba 3 as a peer of `lumbre bench`.

    pip install mitsuba                     (3.7 or later; llvm_ad_rgb also needs an LLVM library, DRJIT_LIBLLVM_PATH)

    lumbre bench SCENE --peer 'mitsuba=benches/peers/mitsuba.py scalar_rgb'
    lumbre bench SCENE --peer 'mitsuba llvm=benches/peers/mitsuba.py llvm_ad_rgb'

The protocol is one JSON object per line on standard input, each answered by one on standard output:

    {"open": {"scene": FILE, "defines": {NAME: VALUE}, "width": W, "height": H, "max_depth": N, "rr_depth": N or null, "folder": FOLDER}}
        {"renderer": .., "variant": .., "technique": .., "setup": {"load": S, "build": S, "compile": S}, "notes": [..]}
    {"begin": SEED}
        {"ok": true}
    {"advance": {"spp": N, "seconds": T or null}}   until N samples per pixel or T seconds of rendering since `begin`
        {"spp": N, "seconds": S, "image": FILE, "nonfinite": N}

and {"error": "one line"} wherever something cannot be done. src/bench/peer.rs says the rest.
"""
import json
import os
import sys
import time
from pathlib import Path

# This file's own folder would make `import mitsuba` find this file.
sys.path[0] = str(Path(__file__).resolve().parent.parent)

# Samples of one call of the renderer in the vectorised variants, which keep all of them in memory.
MOST_LANES = 1 << 24

# Blocks of pixels that Mitsuba's scalar renderer seeds one after the other have this side at most.
BLOCK = 32


class Failure(Exception):
    """What a user can cause, in one line."""


def load_mitsuba(variant):
    try:
        import mitsuba as mi
    except ImportError as error:
        raise Failure(f"Mitsuba 3 cannot be imported ({error}): pip install mitsuba") from None
    if not hasattr(mi, "parser"):
        raise Failure(f"Mitsuba {mi.__version__} is too old, 3.7 or later is needed: pip install --upgrade mitsuba")
    if variant not in mi.variants():
        raise Failure(f"Mitsuba has no variant '{variant}': valid are {', '.join(mi.variants())}")
    try:
        mi.set_variant(variant)
    except ImportError as error:
        raise Failure(f"{variant}: {error}") from None
    return mi


def load_scene(mi, request):
    """The scene with the film's size as asked for; independent samples, because other samplers round their number up."""
    path = Path(request["scene"])
    if path.suffix != ".xml":
        raise Failure(f"{path.name}: Mitsuba reads scenes from .xml files only")
    mi.file_resolver().prepend(str(path.parent))
    config = mi.parser.ParserConfig(mi.variant())
    state = mi.parser.parse_file(config, str(path), **request["defines"])
    films = [node.props for node in state.nodes if node.type == mi.ObjectType.Film]
    if not films:
        raise Failure(f"{path.name}: the scene has no film whose size could be set")
    for film in films:
        size = request["width"], request["height"]
        if "crop_width" in film or "crop_height" in film:
            if (film.get("crop_width"), film.get("crop_height")) != size:
                raise Failure(f"{path.name}: the film has a crop, whose size must stay")
        else:
            film["width"], film["height"] = size
        film["pixel_format"] = "rgb"
    for node in state.nodes:
        if node.type == mi.ObjectType.Sampler:
            node.props.set_plugin_name("independent")
    mi.parser.transform_all(config, state)
    scene = mi.parser.instantiate(config, state)
    return scene[0] if isinstance(scene, list) else scene


class Run:
    """A scene and the passes over it so far."""

    def __init__(self, variant, request):
        import numpy as np

        self.np, self.mi = np, load_mitsuba(variant)
        started = time.perf_counter()
        self.scene = load_scene(self.mi, request)
        self.load = time.perf_counter() - started
        self.sensor = self.scene.sensors()[0]
        depths = {name: request[name] for name in ("max_depth", "rr_depth") if request[name] is not None}
        self.integrator = self.mi.load_dict({"type": "path", **depths})
        self.pixels = request["width"] * request["height"]
        self.folder = Path(request["folder"])
        self.scalar = variant.startswith("scalar")
        self.seed = 0
        self.restart()
        self.compile = 0.0
        if not self.scalar:
            # Kernels differ for few samples and many, and where their number is no power of two. The second time nothing is
            # left to compile.
            for spp in (1, 2, 3, 4, 5):
                first, second = (self.render(spp, 0)[1] for _ in range(2))
                self.compile += max(0.0, first - second)

    def restart(self):
        self.sums, self.spp, self.passes, self.seconds, self.nonfinite = None, 0, 0, 0.0, 0

    def seed_of(self, number):
        """The renderer's seed of a pass, another one for every pass of every run."""
        if not self.scalar:
            return (self.seed * 65536 + number) % 2**32
        # The scalar renderer numbers the pixels of all seeds through, in blocks, and repeats after 2^32: runs get 64 seeds each
        # that are as far apart as its blocks are large.
        width, height = (int(side) for side in self.sensor.film().crop_size())
        blocks = -(-width // BLOCK) * -(-height // BLOCK) * BLOCK * BLOCK
        apart = -(-blocks // self.pixels)
        runs = max(1, 2**32 // (self.pixels * apart * 64))
        if number >= 64 or runs <= self.seed < 2**31:
            raise Failure(f"Mitsuba's random numbers of {width}x{height} pixels repeat after {runs} runs of 64 passes")
        return (self.seed % runs * 64 + number) * apart

    def render(self, spp, seed):
        """Sums of weighted samples and of their weights for every pixel: what a filter makes of one pass alone would be divided by
        its own few weights. Seconds include all but the conversion to double precision."""
        from mitsuba_runs import to_numpy

        started = time.perf_counter()
        self.integrator.render(self.scene, self.sensor, seed=seed, spp=spp, develop=False)
        sums = to_numpy(self.mi, self.sensor.film().develop(raw=True))
        return sums, time.perf_counter() - started

    def advance(self, most, limit):
        """Passes of 1, 1, 2, 4, ... samples, the last ones as many as there is time for."""
        while self.spp < most and (limit is None or self.seconds < limit):
            spp = min(most - self.spp, max(1, self.spp))
            if not self.scalar:
                spp = min(spp, max(1, MOST_LANES // self.pixels))
            if limit is not None and self.spp > 0:
                spp = min(spp, max(1, round((limit - self.seconds) / self.seconds * self.spp)))
            sums, seconds = self.render(spp, self.seed_of(self.passes))
            bad = ~self.np.isfinite(sums).all(axis=2)
            sums[bad] = 0
            self.sums = sums if self.sums is None else self.sums + sums
            self.nonfinite += int(bad.sum())
            self.spp += spp
            self.passes += 1
            self.seconds += seconds

    def write(self):
        path = self.folder / "image.exr"
        weights = self.np.where(self.sums[..., -1:] == 0, 1, self.sums[..., -1:])
        image = (self.sums[..., :3] / weights).astype(self.np.float32)
        self.mi.Bitmap(image, self.mi.Bitmap.PixelFormat.RGB).write(str(path))
        return path

    def notes(self):
        notes = [
            "samples are independent random numbers, whichever sampler the scene names",
            "one light is chosen for each vertex, all with the same probability unless the scene weights them",
            "Russian roulette: paths survive with the largest component of their throughput, at most 0.95",
            "passes of 1, 1, 2, 4, ... samples per pixel, the last ones of a limited time cut to fit",
            f"on all {os.cpu_count()} processors of the host, whichever device the others run on",
        ]
        if "box" not in str(self.sensor.film().rfilter()).lower():
            notes.append("the pixel filter is splatted: neighbouring pixels share samples, which lowers the error of each")
        if not self.scalar:
            notes.append("passes of 1 to 5 samples per pixel compile the kernels beforehand; Dr.Jit keeps kernels from earlier calls on disk")
        return notes

    def opened(self, variant):
        return {
            "renderer": f"Mitsuba {self.mi.__version__}",
            "variant": variant,
            "technique": "path",
            # Mitsuba builds its acceleration structure while it loads, and compiles nothing in scalar variants.
            "setup": {"load": self.load, "build": 0.0, "compile": self.compile},
            "notes": self.notes(),
        }


def answer(message, run, variant):
    """The run after a message, and the answer to it."""
    if "open" in message:
        run = Run(variant, message["open"])
        return run, run.opened(variant)
    if run is None:
        raise Failure("no scene is open")
    if "begin" in message:
        run.seed = message["begin"]
        run.restart()
        return run, {"ok": True}
    if "advance" in message:
        run.advance(message["advance"]["spp"], message["advance"]["seconds"])
        return run, {"spp": run.spp, "seconds": run.seconds, "image": str(run.write()), "nonfinite": run.nonfinite}
    raise Failure(f"unknown message {', '.join(message)}: valid are open, begin and advance")


def main():
    if len(sys.argv) != 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__ + "\nusage: mitsuba.py VARIANT")
    # What Mitsuba prints must not come between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    run = None
    for line in sys.stdin:
        try:
            run, said = answer(json.loads(line), run, sys.argv[1])
        except Failure as failure:
            said = {"error": str(failure)}
        except Exception as error:
            said = {"error": " ".join(f"{type(error).__name__}: {error}".split())}
        print(json.dumps(said), file=answers, flush=True)


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        os._exit(130)
