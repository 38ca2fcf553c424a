#!/usr/bin/env python3
"""Two scenes of the kind that people render, for benches against other renderers; deterministic, nothing of them is kept in the repository.

    pip install numpy
    benches/make_peer_scenes.py FOLDER

FOLDER/interior.xml   a room by day: some 4,500 triangles, four textures, diffuse surfaces, plastics and metals; light from a window and lamps
FOLDER/hull.xml       the inside of a dark hull: some 250,000 triangles, 1,600 of which emit; rough conductors, rough plastics and glass
"""
import sys
from pathlib import Path

import numpy as np

from make_gltf_room import png


class Mesh:
    """Triangles with texture coordinates."""

    def __init__(self):
        self.points, self.uvs, self.faces = [], [], []
        self.count = 0

    def add(self, points, uvs, faces):
        self.points.append(np.asarray(points, np.float32))
        self.uvs.append(np.asarray(uvs, np.float32))
        self.faces.append(np.asarray(faces, np.int32) + self.count)
        self.count += len(points)

    def quad(self, origin, u, v, tiles=(1.0, 1.0)):
        """A parallelogram that faces along u x v."""
        o, u, v = (np.asarray(a, float) for a in (origin, u, v))
        a, b = tiles
        self.add([o, o + u, o + u + v, o + v], [(0, 0), (a, 0), (a, b), (0, b)], [(0, 1, 2), (0, 2, 3)])

    def box(self, low, high, turn=0.0, tiles=(1.0, 1.0)):
        """A box, turned about the vertical through its centre by degrees."""
        low, high = np.asarray(low, float), np.asarray(high, float)
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        rotation = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        centre, half = (low + high) / 2, (high - low) / 2
        for axis in range(3):
            for sign in (-1, 1):
                n, u, v = np.zeros(3), np.zeros(3), np.zeros(3)
                n[axis], u[(axis + 1) % 3], v[(axis + 2) % 3] = sign, sign, 1
                o = centre + rotation @ (half * (n - u - v))
                self.quad(o, rotation @ (2 * half * u), rotation @ (2 * half * v), tiles)

    def lathe(self, base, profile, around, axis=1):
        """A profile of (radius, height) turned about an axis, with `around` quadrilaterals to the ring."""
        rings = len(profile)
        t = np.linspace(0, 1, around + 1)
        angle = 2 * np.pi * t
        points, uvs = [], []
        for row, (radius, height) in enumerate(profile):
            ring = np.zeros((around + 1, 3))
            ring[:, (axis + 1) % 3], ring[:, axis], ring[:, (axis + 2) % 3] = radius * np.cos(angle), height, radius * np.sin(angle)
            points.append(ring + np.asarray(base, float))
            uvs.append(np.stack([t, np.full(around + 1, row / max(rings - 1, 1))], 1))
        faces = []
        for row in range(rings - 1):
            a = row * (around + 1) + np.arange(around)
            b = a + around + 1
            faces += [np.stack([a, b, b + 1], 1), np.stack([a, b + 1, a + 1], 1)]
        self.add(np.concatenate(points), np.concatenate(uvs), np.concatenate(faces))

    def triangles(self):
        return sum(len(faces) for faces in self.faces)

    def write(self, path):
        points, uvs, faces = (np.concatenate(all) for all in (self.points, self.uvs, self.faces))
        vertices = np.concatenate([points, uvs], 1).astype("<f4")
        records = np.empty(len(faces), dtype=[("count", "u1"), ("at", "<i4", 3)])
        records["count"], records["at"] = 3, faces
        header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
                  + "".join(f"property float {name}\n" for name in "xyzuv")
                  + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
        path.write_bytes(header.encode() + vertices.tobytes() + records.tobytes())


def noise(random, size, octaves):
    """Noise between 0 and 1 that repeats."""
    total = np.zeros((size, size))
    for octave in octaves:
        coarse = random.random((octave, octave))
        coarse = np.pad(coarse, ((0, 1), (0, 1)), mode="wrap")
        at = np.arange(size) * octave / size
        i, f = at.astype(int), (at % 1)
        rows = coarse[i] * (1 - f)[:, None] + coarse[i + 1] * f[:, None]
        total += (rows[:, i] * (1 - f) + rows[:, i + 1] * f) / octave ** 0.5
    return (total - total.min()) / (total.max() - total.min())


def save(path, rgb):
    levels = np.floor(np.clip(rgb, 0, 1) * 255) / 255
    path.write_bytes(png(rgb.shape[1], rgb.shape[0], 3, lambda x, y: levels[y, x]))


def textures(folder, random):
    mix = lambda t, a, b: (1 - t[..., None]) * np.array(a) + t[..., None] * np.array(b)
    y, x = np.mgrid[0:512, 0:512] / 512
    grain = noise(random, 512, [4, 8, 32, 128])
    planks = np.floor(y * 8)
    save(folder / "wood.png", mix((grain * 0.6 + 0.4 * np.sin(planks * 2.7) ** 2) * (np.abs((y * 8) % 1 - 0.5) < 0.48), (0.16, 0.08, 0.04), (0.55, 0.34, 0.18)))
    save(folder / "wall.png", mix((np.sin(x * 50) * np.sin(y * 50) > 0.2) * 0.5 + 0.3 * grain, (0.75, 0.72, 0.62), (0.45, 0.52, 0.5)))
    save(folder / "rug.png", mix((np.floor(x * 12) + np.floor(y * 12)) % 2 * 0.8 + 0.2 * grain, (0.5, 0.08, 0.08), (0.7, 0.6, 0.35)))
    save(folder / "spines.png", mix(np.clip(np.sin(np.floor(x * 24) * 12.9898) * 0.5 + 0.5, 0, 1), (0.1, 0.15, 0.35), (0.6, 0.3, 0.12)) * (0.6 + 0.4 * grain[..., None]))


DIFFUSE = "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='{}'/></bsdf></bsdf>"
TEXTURED = ("<bsdf type='twosided'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'>"
            "<string name='filename' value='{}.png'/></texture></bsdf></bsdf>")
PLASTIC = "<bsdf type='twosided'><bsdf type='plastic'><rgb name='diffuse_reflectance' value='{}'/></bsdf></bsdf>"
ROUGH_PLASTIC = ("<bsdf type='twosided'><bsdf type='roughplastic'><string name='distribution' value='ggx'/><float name='alpha' value='{1}'/>"
                 "<rgb name='diffuse_reflectance' value='{0}'/></bsdf></bsdf>")
METAL = ("<bsdf type='twosided'><bsdf type='roughconductor'><string name='material' value='{0}'/><string name='distribution' value='ggx'/>"
         "<float name='alpha' value='{1}'/></bsdf></bsdf>")
GLASS = "<bsdf type='dielectric'/>"


def scene(folder, name, camera, size, parts):
    """Writes the meshes and the scene; parts are (name, mesh, BSDF, radiance or nothing)."""
    width, height = size
    origin, target, fov = camera
    shapes = []
    for part, mesh, bsdf, radiance in parts:
        mesh.write(folder / f"{name}_{part}.ply")
        emitter = f"<emitter type='area'><rgb name='radiance' value='{radiance}'/></emitter>" if radiance else ""
        shapes.append(f"    <shape type='ply'><string name='filename' value='{name}_{part}.ply'/>"
                      f"<boolean name='face_normals' value='true'/>{bsdf}{emitter}</shape>\n")
    (folder / f"{name}.xml").write_text(
        "<scene version='3.0.0'>\n    <default name='spp' value='64'/>\n    <integrator type='path'/>\n"
        f"    <sensor type='perspective'><float name='fov' value='{fov}'/>\n"
        f"        <transform name='to_world'><lookat origin='{origin}' target='{target}' up='0, 1, 0'/></transform>\n"
        "        <sampler type='independent'><integer name='sample_count' value='$spp'/></sampler>\n"
        f"        <film type='hdrfilm'><integer name='width' value='{width}'/><integer name='height' value='{height}'/>"
        "<rfilter type='box'/></film></sensor>\n" + "".join(shapes) + "</scene>\n")
    emissive = sum(mesh.triangles() for _, mesh, _, radiance in parts if radiance)
    print(f"{name}: {sum(mesh.triangles() for _, mesh, _, _ in parts)} triangles, {emissive} of which emit")


def interior(folder, random):
    textures(folder, random)
    floor, walls, ceiling, rug, books, wood, white, metal, brass, red, blue, window, bulbs = (Mesh() for _ in range(13))
    floor.quad((0, 0, 0), (0, 0, 5), (6, 0, 0), (3, 3))
    ceiling.quad((0, 2.8, 0), (6, 0, 0), (0, 0, 5))
    walls.quad((0, 0, 0), (6, 0, 0), (0, 2.8, 0), (4, 2))
    walls.quad((6, 0, 5), (-6, 0, 0), (0, 2.8, 0), (4, 2))
    walls.quad((6, 0, 0), (0, 0, 5), (0, 2.8, 0), (3, 2))
    # The wall with the window, in four parts.
    for z0, z1, y0, y1 in [(0, 1.5, 0, 2.8), (3.5, 5, 0, 2.8), (1.5, 3.5, 0, 0.9), (1.5, 3.5, 2.3, 2.8)]:
        walls.quad((0, y0, z1), (0, 0, z0 - z1), (0, y1 - y0, 0))
    window.quad((-0.3, 0.9, 3.5), (0, 0, -2), (0, 1.4, 0))
    for z in np.linspace(1.5, 3.5, 5):
        white.box((-0.06, 0.9, z - 0.02), (0.0, 2.3, z + 0.02))
    for y in (0.9, 1.6, 2.3):
        white.box((-0.06, y - 0.02, 1.5), (0.04, y + 0.02, 3.5))
    rug.quad((1.8, 0.005, 1.3), (0, 0, 2.4), (2.4, 0, 0), (2, 2))
    # A table and four chairs.
    wood.box((2.2, 0.72, 1.8), (3.8, 0.76, 3.2), 0, (2, 1))
    for x in (2.3, 3.7):
        for z in (1.9, 3.1):
            metal.lathe((x, 0, z), [(0.02, 0.0), (0.03, 0.05), (0.02, 0.72)], 12)
    for x, z, turn in [(1.9, 2.1, 10), (1.9, 2.9, -8), (4.1, 2.1, 170), (4.1, 2.9, 188)]:
        wood.box((x - 0.2, 0.42, z - 0.2), (x + 0.2, 0.46, z + 0.2), turn)
        side = -0.18 if turn < 90 else 0.18
        wood.box((x + side - 0.02, 0.46, z - 0.2), (x + side + 0.02, 0.95, z + 0.2), turn)
        for dx in (-0.17, 0.17):
            for dz in (-0.17, 0.17):
                metal.lathe((x + dx, 0, z + dz), [(0.015, 0), (0.015, 0.42)], 8)
    # Shelves with books.
    for y in (0.4, 0.8, 1.2, 1.6, 2.0):
        wood.box((5.65, y - 0.02, 0.6), (5.98, y, 3.8), 0, (4, 1))
        z = 0.65
        while z < 3.7:
            thick, tall = random.uniform(0.02, 0.06), random.uniform(0.2, 0.34)
            books.box((5.72, y, z), (5.94, y + tall, z + thick), random.uniform(-3, 3))
            z += thick + random.choice([0.004, 0.006, 0.12], p=[0.5, 0.4, 0.1])
    # Bowls, vases, a floor lamp and a pendant.
    wave = lambda r, h, n: [(r * (0.6 + 0.4 * np.sin(3.4 * t + 0.4)), h * t) for t in np.linspace(0, 1, n)]
    red.lathe((2.7, 0.76, 2.3), wave(0.12, 0.3, 10), 24)
    blue.lathe((3.2, 0.76, 2.8), wave(0.16, 0.18, 10), 24)
    brass.lathe((3.3, 0.76, 2.1), wave(0.08, 0.22, 10), 20)
    brass.lathe((5.2, 0, 4.4), [(0.18, 0), (0.16, 0.03), (0.015, 0.05), (0.015, 1.5), (0.05, 1.55)], 20)
    white.lathe((5.2, 1.4, 4.4), [(0.28, 0), (0.16, 0.35)], 24)
    bulbs.lathe((5.2, 1.5, 4.4), [(0.001, 0), (0.05, 0.04), (0.05, 0.08), (0.001, 0.12)], 8)
    metal.lathe((3.0, 1.9, 2.5), [(0.3, 0), (0.25, 0.12), (0.05, 0.2), (0.01, 0.22), (0.01, 0.9)], 24)
    bulbs.lathe((3.0, 1.93, 2.5), [(0.001, 0), (0.06, 0.04), (0.06, 0.08), (0.001, 0.12)], 8)
    scene(folder, "interior", ("5.2, 1.6, 3.7", "1.9, 0.8, 1.8", 62), (320, 240), [
        ("floor", floor, TEXTURED.format("wood"), None), ("walls", walls, TEXTURED.format("wall"), None),
        ("ceiling", ceiling, DIFFUSE.format("0.8, 0.8, 0.78"), None), ("rug", rug, TEXTURED.format("rug"), None),
        ("books", books, TEXTURED.format("spines"), None), ("wood", wood, ROUGH_PLASTIC.format("0.35, 0.2, 0.1", 0.15), None),
        ("white", white, PLASTIC.format("0.7, 0.7, 0.68"), None), ("metal", metal, METAL.format("Al", 0.2), None),
        ("brass", brass, METAL.format("Au", 0.12), None), ("red", red, PLASTIC.format("0.6, 0.08, 0.05"), None),
        ("blue", blue, ROUGH_PLASTIC.format("0.05, 0.12, 0.5", 0.1), None),
        ("window", window, DIFFUSE.format("0, 0, 0"), "9, 10, 12"), ("bulbs", bulbs, DIFFUSE.format("0, 0, 0"), "40, 32, 20"),
    ])


def hull(folder, random):
    steel, dark, copper, panels, cables, crates, glass, leds, warm = (Mesh() for _ in range(9))
    length = 24.0
    # Plating in small tiles on an octagonal tube, each somewhat off its place.
    corners = [(2.2 * np.cos(a), 1.6 + 1.6 * np.sin(a)) for a in np.radians(22.5 + 45 * np.arange(9))]
    for (x0, y0), (x1, y1) in zip(corners, corners[1:]):
        for i, z in enumerate(np.arange(0, length, 0.15)):
            for j in range(6):
                a, b = j / 6, (j + 0.96) / 6
                lift = random.uniform(0, 0.02)
                inward = np.array([-(x0 + x1) / 2, 1.6 - (y0 + y1) / 2, 0])
                inward *= lift / np.linalg.norm(inward)
                at = np.array([x0 + a * (x1 - x0), y0 + a * (y1 - y0), z]) + inward
                mesh = steel if (i + j) % 5 else (dark if j % 2 else panels)
                mesh.quad(at, (0, 0, 0.145), ((b - a) * (x1 - x0), (b - a) * (y1 - y0), 0))
        dark.quad((x0 * 1.02, 1.6 + (y0 - 1.6) * 1.02, 0), (0, 0, length), ((x1 - x0) * 1.02, (y1 - y0) * 1.02, 0))
    for z in (0.0, length):
        dark.box((-3, -1, z - 0.1), (3, 4, z + 0.1))
    # Ribs, pipes with flanges, cables.
    for z in np.arange(1, length, 2.0):
        for (x0, y0), (x1, y1) in zip(corners, corners[1:]):
            for t in np.linspace(0, 1, 6):
                x, y = (x0 + t * (x1 - x0)) * 0.95, 1.6 + (y0 + t * (y1 - y0) - 1.6) * 0.95
                steel.box((x - 0.06, y - 0.06, z - 0.05), (x + 0.06, y + 0.06, z + 0.05), 0)
    for x, y, radius, mesh in [(-1.5, 2.6, 0.09, copper), (-1.3, 2.8, 0.06, copper), (1.5, 2.6, 0.12, steel), (1.75, 1.0, 0.08, copper),
                               (-1.75, 0.9, 0.07, steel), (1.25, 2.85, 0.05, copper)]:
        profile = []
        for z in np.arange(0, length, 0.1):
            profile.append((radius * (1.35 if int(z * 10) % 20 == 0 else 1.0), z))
        mesh.lathe((x, y, 0), profile, 40, axis=2)
    for _ in range(30):
        x, y, phase = random.uniform(-1.2, 1.2), random.uniform(2.75, 2.95), random.uniform(0, 6)
        z = np.arange(0, length, 0.25)
        cables.lathe((x, y - 0.05 * abs(np.sin(phase)), 0), [(0.012, v) for v in z], 10, axis=2)
    # A floor grating, crates, glass cylinders.
    for z in np.arange(0, length, 0.12):
        dark.box((-0.9, 0.2, z), (0.9, 0.23, z + 0.03))
    for x in np.linspace(-0.9, 0.9, 13):
        dark.box((x - 0.01, 0.17, 0), (x + 0.01, 0.2, length))
    for _ in range(60):
        z, side, s = random.uniform(1, length - 1), random.choice([-1, 1]), random.uniform(0.1, 0.28)
        crates.box((side * 1.05 - s / 2, 0.23, z - s / 2), (side * 1.05 + s / 2, 0.23 + s, z + s / 2), random.uniform(0, 90))
    for z in np.arange(3, length, 3.0):
        for side in (-1, 1):
            profile = [(0.001, 0)] + [(0.16, h) for h in np.linspace(0.0, 0.7, 24)] + [(0.001, 0.7)]
            glass.lathe((side * 1.2, 0.24, z), profile, 64)
            copper.lathe((side * 1.2, 0.3, z), [(0.05 * (1 + 0.4 * np.sin(9 * t)), 0.5 * t) for t in np.linspace(0, 1, 60)], 48)
    # 800 lamps of two triangles each: strips along the walls, and a few warm ones overhead.
    for z in np.linspace(0.5, length - 0.5, 350):
        for side in (-1, 1):
            x = side * 1.48
            leds.quad((x, 0.62, z), (0, 0, 0.03 * side), (0, 0.02, 0)) if side < 0 else leds.quad((x, 0.62, z), (0, 0, 0.03), (0, 0.02, 0))
    for z in np.linspace(1.5, length - 1.5, 50):
        for x in (-0.5, 0.5):
            warm.quad((x - 0.05, 2.74, z), (0.1, 0, 0), (0, 0, 0.04))
    scene(folder, "hull", ("0.3, 1.5, 1.0", "-0.1, 1.3, 12", 70), (320, 240), [
        ("steel", steel, METAL.format("Cr", 0.25), None), ("dark", dark, ROUGH_PLASTIC.format("0.05, 0.05, 0.06", 0.2), None),
        ("copper", copper, METAL.format("Cu", 0.15), None), ("panels", panels, ROUGH_PLASTIC.format("0.3, 0.3, 0.28", 0.1), None),
        ("cables", cables, ROUGH_PLASTIC.format("0.1, 0.02, 0.02", 0.3), None), ("crates", crates, DIFFUSE.format("0.4, 0.35, 0.2"), None),
        ("glass", glass, GLASS, None), ("leds", leds, DIFFUSE.format("0, 0, 0"), "20, 28, 40"), ("warm", warm, DIFFUSE.format("0, 0, 0"), "40, 26, 12"),
    ])


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    interior(folder, np.random.default_rng(7))
    hull(folder, np.random.default_rng(11))


if __name__ == "__main__":
    main()
