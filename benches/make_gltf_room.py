#!/usr/bin/env python3
"""Writes scenes/gltf_room: a room in glTF with generated textures, a sky and a sun.

    python3 benches/make_gltf_room.py scenes/gltf_room

Python's standard library only. Everything is made here, so it may be used like the rest of the repository.
"""

import json
import math
import random
import struct
import sys
import zlib
from pathlib import Path

F32, U16 = 5126, 5123


def png(width, height, channels, texel, level=9):
    """The bytes of an 8-bit PNG; `texel(x, y)` gives each texel's channels in 0 to 1."""
    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            rows += bytes(max(0, min(255, round(255 * value))) for value in texel(x, y))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    data = zlib.compress(bytes(rows), level)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def hdr(path, width, height, texel):
    """A Radiance HDR image without run lengths; `texel(x, y)` gives linear radiance."""
    body = bytearray()
    for y in range(height):
        for x in range(width):
            rgb = texel(x, y)
            mantissa, exponent = math.frexp(max(max(rgb), 1e-32))
            scale = mantissa * 256 / max(max(rgb), 1e-32)
            body += bytes(min(255, int(value * scale)) for value in rgb) + bytes([exponent + 128])
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
    path.write_bytes(head.encode() + bytes(body))


class Noise:
    """Value noise that repeats after `period` cells, in several octaves."""

    def __init__(self, seed, period):
        self.period = period
        self.random = random.Random(seed)
        self.octaves = [[[self.random.random() for _ in range(period << o)] for _ in range(period << o)] for o in range(5)]

    def at(self, u, v):
        total, weight, sum_ = 0.0, 0.5, 0.0
        for octave, grid in enumerate(self.octaves):
            n = self.period << octave
            x, y = u * n, v * n
            i, j = int(math.floor(x)), int(math.floor(y))
            a, b = x - i, y - j
            a, b = a * a * (3 - 2 * a), b * b * (3 - 2 * b)
            p = grid[j % n][i % n] * (1 - a) + grid[j % n][(i + 1) % n] * a
            q = grid[(j + 1) % n][i % n] * (1 - a) + grid[(j + 1) % n][(i + 1) % n] * a
            total += weight * (p * (1 - b) + q * b)
            sum_ += weight
            weight /= 2
        return total / sum_


def tiles(folder, size=256):
    """Four by four glazed tiles with grout: base colour, normals, and metal and roughness."""
    noise, per = Noise(1, 4), 4
    shades = [[random.Random(31 * i + 7 * j).random() for i in range(per)] for j in range(per)]

    def tile(u, v):
        x, y = u * per, v * per
        i, j = int(x) % per, int(y) % per
        edge = min(x % 1, 1 - x % 1, y % 1, 1 - y % 1)
        return i, j, max(0.0, min(1.0, (edge - 0.02) / 0.03))  # 0: grout, 1: glaze

    def height(u, v):
        return 0.6 * tile(u % 1, v % 1)[2] + 0.06 * noise.at(u, v)

    def colour(x, y):
        u, v = (x + 0.5) / size, (y + 0.5) / size
        i, j, glaze = tile(u, v)
        n = noise.at(u, v)
        warm = (i + j) % 2
        base = (0.80, 0.74, 0.62) if warm else (0.36, 0.20, 0.14)
        shade = 0.85 + 0.15 * shades[j][i] + 0.25 * (n - 0.5)
        grout = 0.42 + 0.1 * n
        return [grout * (1 - glaze) + shade * value * glaze for value in base]

    def normal(x, y):
        u, v, step = (x + 0.5) / size, (y + 0.5) / size, 1 / size
        strength = 12 / size
        dx = (height(u + step, v) - height(u - step, v)) / (2 * step) * strength
        dy = (height(u, v - step) - height(u, v + step)) / (2 * step) * strength
        length = math.sqrt(dx * dx + dy * dy + 1)
        return [0.5 - 0.5 * dx / length, 0.5 - 0.5 * dy / length, 0.5 + 0.5 / length]

    def shine(x, y):
        u, v = (x + 0.5) / size, (y + 0.5) / size
        glaze = tile(u, v)[2]
        return [1, 0.9 * (1 - glaze) + (0.12 + 0.25 * noise.at(v, u)) * glaze, 0]

    (folder / "tiles.png").write_bytes(png(size, size, 3, colour))
    (folder / "tiles_normal.png").write_bytes(png(size, size, 3, normal))
    (folder / "tiles_shine.png").write_bytes(png(size, size, 3, shine))


def plaster(folder, size=128):
    noise = Noise(5, 3)
    (folder / "plaster.png").write_bytes(png(
        size, size, 3, lambda x, y: [(0.80 + 0.12 * noise.at(x / size, y / size)) * value for value in (1.0, 0.95, 0.86)]))


def leaves(folder, size=256):
    """A twig with leaves on it, and nothing around them."""
    shapes = []
    for index in range(9):
        side = 1 if index % 2 else -1
        y = 0.95 - 0.1 * index
        angle = math.pi / 2 - side * (0.95 - 0.05 * index)
        shapes.append((0.5 + side * 0.01, y, angle, 0.40 - 0.02 * index, 0.09))
    shapes.append((0.5, 0.2, math.pi / 2, 0.2, 0.06))

    def texel(x, y):
        u, v = (x + 0.5) / size, (y + 0.5) / size
        best = 0.0
        for px, py, angle, length, width in shapes:
            dx, dy = u - px, py - v
            along = (dx * math.cos(angle) + dy * math.sin(angle)) / length
            across = (-dx * math.sin(angle) + dy * math.cos(angle)) / width
            if 0 < along < 1:
                half = math.sin(math.pi * along ** 0.8)
                inside = half - abs(across)
                if inside > 0:
                    vein = 1 - 0.35 * math.exp(-(across * 8) ** 2)
                    best = max(best, vein * (0.75 + 0.25 * along))
        stem = 0.2 < v < 1 and abs(u - 0.5) < 0.008
        if best == 0 and not stem:
            return [0.22, 0.38, 0.10, 0]
        return [0.30, 0.20, 0.10, 1] if best == 0 else [0.25 * best + 0.05, 0.52 * best, 0.12 * best, 1]

    (folder / "leaves.png").write_bytes(png(size, size, 4, texel))


def sky(folder, width=128, height=64):
    """A clear sky that is brighter towards the horizon, and brown ground."""

    def texel(x, y):
        up = math.cos(math.pi * (y + 0.5) / height)
        if up < 0:
            return [0.16, 0.13, 0.10]
        t = (1 - up) ** 3
        glow = max(0.0, math.cos(2 * math.pi * ((x + 0.5) / width - 0.30))) ** 4 * t
        return [0.30 + 0.55 * t + 0.9 * glow, 0.50 + 0.45 * t + 0.6 * glow, 0.95 + 0.15 * t + 0.2 * glow]

    hdr(folder / "sky.hdr", width, height, texel)


class File:
    def __init__(self):
        self.bytes = bytearray()
        self.json = {
            "asset": {"version": "2.0", "generator": "benches/make_gltf_room.py"},
            "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [], "materials": [], "accessors": [],
            "bufferViews": [], "cameras": [], "textures": [], "images": [],
        }

    def add(self, name, value):
        self.json[name].append(value)
        return len(self.json[name]) - 1

    def node(self, **node):
        self.json["scenes"][0]["nodes"].append(self.add("nodes", node))

    def texture(self, uri):
        return {"index": self.add("textures", {"source": self.add("images", {"uri": uri})})}

    def accessor(self, kind, component, rows):
        flat = [value for row in rows for value in (row if isinstance(row, (list, tuple)) else [row])]
        data = struct.pack(f"<{len(flat)}{'f' if component == F32 else 'H'}", *flat)
        self.bytes += bytes(-len(self.bytes) % 4)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)})
        self.bytes += data
        accessor = {"bufferView": view, "componentType": component, "count": len(rows), "type": kind}
        if kind == "VEC3":
            accessor["min"] = [min(row[axis] for row in rows) for axis in range(3)]
            accessor["max"] = [max(row[axis] for row in rows) for axis in range(3)]
        return self.add("accessors", accessor)

    def mesh(self, name, material, positions, triangles, uvs=None, normals=None):
        attributes = {"POSITION": self.accessor("VEC3", F32, positions)}
        if normals:
            attributes["NORMAL"] = self.accessor("VEC3", F32, normals)
        if uvs:
            attributes["TEXCOORD_0"] = self.accessor("VEC2", F32, uvs)
        indices = self.accessor("SCALAR", U16, [vertex for triangle in triangles for vertex in triangle])
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        return self.add("meshes", {"name": name, "primitives": [primitive]})

    def quad(self, name, material, corner, u, v, repeat=(1, 1), uvs=True):
        """A parallelogram whose normal is u x v; the image's left runs along u and its top lies at v."""
        corners = [corner, add(corner, u), add(add(corner, u), v), add(corner, v)]
        a, b = repeat
        n = cross(u, v)
        length = math.sqrt(sum(value * value for value in n))
        normals = [[value / length for value in n]] * 4
        coordinates = [[0, b], [a, b], [a, 0], [0, 0]] if uvs else None
        return self.mesh(name, material, corners, [[0, 1, 2], [0, 2, 3]], coordinates, normals)

    def lathe(self, name, material, profile, segments=64):
        """A solid of revolution around y; the profile runs so that outside is to its right."""
        positions, normals, triangles = [], [], []
        for index, (r, y) in enumerate(profile):
            before, after = profile[max(0, index - 1)], profile[min(len(profile) - 1, index + 1)]
            dr, dy = after[0] - before[0], after[1] - before[1]
            length = math.hypot(dr, dy) or 1
            for segment in range(segments):
                angle = 2 * math.pi * segment / segments
                c, s = math.cos(angle), math.sin(angle)
                r = 0 if r < 1e-9 else r
                positions.append([r * c, y, r * s])
                normals.append([dy / length * c, -dr / length, dy / length * s])
        for ring in range(len(profile) - 1):
            for segment in range(segments):
                following = (segment + 1) % segments
                a, b = ring * segments + segment, ring * segments + following
                c, d = a + segments, b + segments
                # At the axis one edge of the cell has no length, and one of its triangles no area.
                triangles += [t for t in ([a, c, d], [a, d, b]) if len({tuple(positions[i]) for i in t}) == 3]
        return self.mesh(name, material, positions, triangles, None, normals)

    def write(self, folder):
        (folder / "room.bin").write_bytes(self.bytes)
        self.json["buffers"] = [{"byteLength": len(self.bytes), "uri": "room.bin"}]
        (folder / "room.gltf").write_text(json.dumps(self.json, indent=1) + "\n")


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def toward(direction):
    """The rotation that takes -z along the direction."""
    x, y, z = direction
    length = math.sqrt(x * x + y * y + z * z)
    yaw, pitch = math.atan2(-x, -z), math.asin(y / length)
    a, b = [0, math.sin(yaw / 2), 0, math.cos(yaw / 2)], [math.sin(pitch / 2), 0, 0, math.cos(pitch / 2)]
    return [
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    ]


def room(folder):
    file = File()
    material = lambda **value: file.add("materials", value)
    floor = material(
        name="tiles", pbrMetallicRoughness={
            "baseColorTexture": file.texture("tiles.png"), "metallicRoughnessTexture": file.texture("tiles_shine.png"),
        }, normalTexture=file.texture("tiles_normal.png"))
    wall = material(name="plaster", doubleSided=True, pbrMetallicRoughness={
        "baseColorTexture": file.texture("plaster.png"), "metallicFactor": 0, "roughnessFactor": 0.9})
    red = material(name="red wall", doubleSided=True, pbrMetallicRoughness={
        "baseColorFactor": [0.62, 0.16, 0.10, 1], "metallicFactor": 0, "roughnessFactor": 0.8})
    copper = material(name="copper", pbrMetallicRoughness={
        "baseColorFactor": [0.95, 0.64, 0.54, 1], "metallicFactor": 1, "roughnessFactor": 0.15})
    glass = material(
        name="green glass", pbrMetallicRoughness={"metallicFactor": 0, "roughnessFactor": 0},
        extensions={
            "KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5},
            "KHR_materials_volume": {
                "thicknessFactor": 0.5, "attenuationDistance": 0.4, "attenuationColor": [0.55, 0.92, 0.72]}})
    leaf = material(name="leaves", doubleSided=True, alphaMode="MASK", pbrMetallicRoughness={
        "baseColorTexture": file.texture("leaves.png"), "metallicFactor": 0, "roughnessFactor": 0.6})
    clay = material(name="clay", doubleSided=True, pbrMetallicRoughness={
        "baseColorFactor": [0.55, 0.25, 0.13, 1], "metallicFactor": 0, "roughnessFactor": 0.85})
    lacquer = material(
        name="lacquer", pbrMetallicRoughness={"baseColorFactor": [0.03, 0.09, 0.35, 1], "metallicFactor": 0, "roughnessFactor": 0.6},
        extensions={"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.05}})

    # The room: 4 wide, 3 deep, 2.6 high, with a window in the left wall and no wall in front.
    w, d, h = 2.0, 3.0, 2.6
    place = lambda mesh, **node: file.node(mesh=mesh, **node)
    place(file.quad("floor", floor, [-w, 0, d], [2 * w, 0, 0], [0, 0, -2 * d], (2, 3)))
    place(file.quad("ceiling", wall, [-w, h, -d], [2 * w, 0, 0], [0, 0, 2 * d], (2, 2)))
    place(file.quad("back wall", wall, [-w, 0, -d], [2 * w, 0, 0], [0, h, 0], (2, 1.3)))
    place(file.quad("right wall", red, [w, 0, -d], [0, 0, 2 * d], [0, h, 0], uvs=False))
    low, high, near, far = 0.7, 2.2, 0.2, -2.2
    for name, z0, z1, y0, y1 in [
        ("below the window", d, -d, 0, low), ("above the window", d, -d, high, h),
        ("before the window", d, near, low, high), ("behind the window", far, -d, low, high),
    ]:
        place(file.quad(name, wall, [-w, y0, z0], [0, 0, z1 - z0], [0, y1 - y0, 0], ((z0 - z1) / 2, (y1 - y0) / 2)))
    bar = file.quad("window bar", wall, [0, 0, 0], [0, 0, -0.05], [0, 1, 0], (0.1, 1))
    for z in (-0.6, -1.4):
        place(bar, translation=[-w, low, z], scale=[1, high - low, 1])

    arc = lambda r, y, a, b, n: [(r * math.sin(a + (b - a) * k / n), y - r * math.cos(a + (b - a) * k / n)) for k in range(n + 1)]
    ball = arc(0.42, 0.42, 0, math.pi, 40)
    place(file.lathe("glass ball", glass, ball), translation=[0.75, 0.001, -0.35])
    vase = [(0, 0), (0.2, 0)] + [(0.2 + 0.16 * math.sin(math.pi * k / 30 * 1.15), 0.9 * k / 30) for k in range(1, 31)]
    vase += [(r - 0.02, y) for r, y in reversed(vase[2:])] + [(0, 0.03)]
    place(file.lathe("copper vase", copper, vase), translation=[-0.35, 0, -1.2])
    place(file.lathe("lacquered ball", lacquer, arc(0.22, 0.22, 0, math.pi, 32)), translation=[0.1, 0.001, 0.25])
    pot = [(0, 0), (0.17, 0), (0.24, 0.36), (0.27, 0.36), (0.27, 0.42), (0.23, 0.42), (0.22, 0.36), (0, 0.36)]
    place(file.lathe("pot", clay, [p for q in pot for p in (q, q)], 48), translation=[1.35, 0, -1.7])
    twig = file.quad("twig", leaf, [-0.5, 0, 0], [1, 0, 0], [0, 1.15, 0])
    for index in range(7):
        turn, lean = 2 * math.pi * index / 7 + 0.3, 0.12 + 0.05 * (index % 3)
        yaw = [0, math.sin(turn / 2), 0, math.cos(turn / 2)]
        c, s = math.cos(lean / 2), math.sin(lean / 2)
        rotation = [yaw[3] * s, yaw[1] * c, -yaw[1] * s, yaw[3] * c]
        place(twig, translation=[1.35, 0.3, -1.7], rotation=rotation, scale=[0.9, 0.9 + 0.08 * (index % 4), 1])

    camera = file.add("cameras", {"type": "perspective", "name": "front", "perspective": {
        "yfov": math.radians(42), "aspectRatio": 1.5, "znear": 0.1}})
    eye, target = [0.35, 1.25, 4.1], [0.1, 0.85, -1.0]
    file.node(camera=camera, translation=eye, rotation=toward([b - a for a, b in zip(eye, target)]))
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"name": "sun", "type": "directional", "color": [1, 0.9, 0.72], "intensity": 20}]}}
    file.node(name="sun", rotation=toward([1.0, -0.62, -0.12]), extensions={"KHR_lights_punctual": {"light": 0}})
    file.json["extensionsUsed"] = [
        "KHR_lights_punctual", "KHR_materials_clearcoat", "KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume"]
    file.json["scenes"][0]["extras"] = {"lumbre": {"environment": {"uri": "sky.hdr", "intensity": 2.5, "rotation_degrees": 0}}}
    file.write(folder)


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: make_gltf_room.py FOLDER")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for part in (tiles, plaster, leaves, sky, room):
        part(folder)
    size = sum(path.stat().st_size for path in folder.iterdir())
    print(f"{folder}: {size} bytes")


if __name__ == "__main__":
    main()
