#!/usr/bin/env python3
"""Denoises an image with Intel Open Image Denoise, which takes the layers of lumbre as they are.

    pip install pyoidn OpenEXR numpy        (pyoidn brings the library)
    lumbre render SCENE --aov albedo,normal -o noisy.exr
    benches/denoise.py noisy.exr denoised.exr [--reference reference.exr]

With a reference: prints the relMSE of the noisy image, and of what denoising makes of it with and without the layers.
"""
import argparse

import numpy as np
import OpenEXR
import pyoidn


def read(path):
    """The channels of a file: groups such as RGB or XYZ come as arrays of three numbers per pixel, by the name of their layer."""
    channels = OpenEXR.File(str(path), separate_channels=True).channels()

    def layer(name, letters):
        names = [f"{name}.{letter}" if name else letter for letter in letters]
        return np.stack([channels[own].pixels for own in names], axis=-1).astype(np.float32)

    return layer


def relmse(image, reference):
    return float(((image.astype(np.float64) - reference) ** 2 / (reference.astype(np.float64) ** 2 + 0.01)).mean())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("noisy")
    parser.add_argument("output")
    parser.add_argument("--reference")
    args = parser.parse_args()
    layer = read(args.noisy)
    noisy, albedo, normal = layer("", "RGB"), layer("albedo", "RGB"), layer("normal", "XYZ")
    denoised = pyoidn.denoise(noisy, albedo=albedo, normal=normal, hdr=True)
    OpenEXR.File({}, {"RGB": denoised}).write(args.output)
    if args.reference:
        truth = read(args.reference)("", "RGB")
        alone = pyoidn.denoise(noisy, hdr=True)
        for what, image in [("noisy", noisy), ("denoised without layers", alone), ("denoised with albedo and normal", denoised)]:
            print(f"relMSE {relmse(image, truth):.5f}  {what}")


if __name__ == "__main__":
    main()
