#!/usr/bin/env python3
"""One scene by several techniques at equal time, side by side, with the error of each under it: the picture that README.md opens with.

    benches/strip.py [-o FILE] [--scene FILE] [-i LIST] [-t SECONDS] [--reference-time SECONDS] [--size WxH] [--lumbre PROGRAM]

Makes a reference with `lumbre reference`, which stays in out/strip for the next time, renders with each technique for the same time,
and compares with `lumbre compare`: FLIP is the difference that an eye sees (0 to 1), relMSE a mean of squares that few bright pixels can decide.
Needs Pillow for the text (`pip install pillow`).
"""

import argparse
import json
import subprocess
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parent.parent
TITLES = {
    "path": "path tracing",
    "light": "light tracing",
    "bdpt": "bidirectional",
    "vcm": "connection and merging",
    "photon": "photon mapping",
    "mlt": "Metropolis",
    "radiosity": "radiosity",
}
GAP = 4  # pixels between pictures
LINE = 17  # pixels of a line of text


def run(*command):
    """Runs the program; its standard output."""
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("-o", "--output", type=Path, default=ROOT / "docs/techniques.png")
    options.add_argument("--scene", type=Path, default=ROOT / "scenes/torus_in_glass.xml")
    options.add_argument("-i", "--techniques", default="path,light,bdpt,photon,vcm")
    options.add_argument("-t", "--time", type=float, default=20.0, help="seconds of each technique")
    options.add_argument("--reference-time", type=float, default=180.0)
    options.add_argument("--size", default="216x144")
    options.add_argument("--lumbre", type=Path, default=ROOT / "target/release/lumbre")
    args = options.parse_args()

    out = ROOT / "out/strip"
    out.mkdir(parents=True, exist_ok=True)
    reference = out / f"{args.scene.stem}-{args.size}-{args.reference_time:g}s.exr"
    if not reference.exists():
        run(args.lumbre, "reference", args.scene, "-t", args.reference_time, "--size", args.size, "-o", reference, "-q")

    pictures = []
    for technique in args.techniques.split(","):
        exr, png = out / f"{technique}.exr", out / f"{technique}.png"
        run(args.lumbre, "render", args.scene, "-i", technique, "-t", args.time, "--size", args.size, "-o", exr, "-o", png, "-q")
        compared = json.loads(run(args.lumbre, "compare", exr, reference, "--json", "-"))
        error = f"FLIP {compared['flip']:.2f}, relMSE {compared['relmse']:.2g}"
        pictures.append((Image.open(png), technique, error))
        print(f"{technique:<16} {error}", flush=True)

    width, height = pictures[0][0].size
    strip = Image.new("RGB", (len(pictures) * (width + GAP) - GAP, height + 2 * LINE + GAP), "white")
    draw, font = ImageDraw.Draw(strip), ImageFont.load_default(size=13)
    for place, (picture, technique, error) in enumerate(pictures):
        left = place * (width + GAP)
        strip.paste(picture.convert("RGB"), (left, 0))
        draw.text((left + 2, height + 2), f"{technique}: {TITLES.get(technique.split(':')[0], '')}", "black", font)
        draw.text((left + 2, height + 2 + LINE), error, "black", font)
    strip.save(args.output, optimize=True)
    print(f"wrote {args.output}, {args.output.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
