#!/usr/bin/env python3
"""Makes the meshes of the scenes in scenes/: lathed vessels, swept handles and spouts, boxes, a ring, a torus; and an image of heights.

    benches/make_scenes.py                  write every file
    benches/make_scenes.py --check          write nothing; exit with status 1 where a file differs from what would be written

Only the standard library; the same files every time. Binary little-endian PLY with vertex normals. Each mesh is checked
before it is written: its parts are closed and their normals point outwards, so that any of them can be glass.
"""
import argparse
import math
import struct
import sys
from pathlib import Path

from make_gltf_room import png

SCENES = Path(__file__).resolve().parent.parent / "scenes"


# Vectors

def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return mul(a, 1 / math.sqrt(dot(a, a)))


# Curves: lists of points

def bezier(points, steps):
    """A Bezier curve of any degree, `steps` + 1 points."""
    curve = []
    for step in range(steps + 1):
        t, level = step / steps, list(points)
        while len(level) > 1:
            level = [tuple((1 - t) * a + t * b for a, b in zip(p, q)) for p, q in zip(level, level[1:])]
        curve.append(level[0])
    return curve


def arc(centre, radius, start, end, steps):
    """A circular arc; the angles in degrees."""
    angles = [math.radians(start + (end - start) * step / steps) for step in range(steps + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def join(*curves):
    """One curve after another; a point that two share is kept once."""
    joined = []
    for curve in curves:
        for point in curve:
            if not joined or math.dist(joined[-1], point) > 1e-6:
                joined.append(tuple(point))
    return joined


# Meshes: (positions, triangles)

def lathe(profile, segments):
    """Turns a profile of (radius, height) about the y axis. What lies to the right of the profile is outside; it starts and
    ends on the axis, or is a closed loop."""
    profile = join(profile)
    loop = profile[0][0] > 1e-9
    positions, rings, triangles = [], [], []
    for radius, height in profile:
        if radius <= 1e-9:
            rings.append([len(positions)] * segments)
            positions.append((0.0, height, 0.0))
            continue
        rings.append(range(len(positions), len(positions) + segments))
        for j in range(segments):
            angle = math.tau * j / segments
            positions.append((radius * math.cos(angle), height, radius * math.sin(angle)))
    for low, high in zip(rings, list(rings[1:]) + ([rings[0]] if loop else [])):
        for j in range(segments):
            k = (j + 1) % segments
            quad(triangles, low[j], high[j], high[k], low[k])
    return positions, triangles


def quad(triangles, a, b, c, d):
    """Two triangles, or one where two corners coincide."""
    triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]


def sweep(path, radii, segments, flatten=1.0, back=0):
    """A tube along a path in a plane of constant z; `flatten` scales it along z. Its ends are discs. The last `back` points
    lead back into the tube: a mouth."""
    positions, triangles, last = [], [], len(path) - 1 - back
    for i, (point, radius) in enumerate(zip(path, radii)):
        i = min(i, last)
        out = cross((0.0, 0.0, 1.0), unit(sub(path[min(i + 1, last)], path[max(i - 1, 0)])))
        for j in range(segments):
            angle = math.tau * j / segments
            positions.append(add(point, add(mul(out, radius * math.cos(angle)), (0.0, 0.0, flatten * radius * math.sin(angle)))))
    for a in range(0, (len(path) - 1) * segments, segments):
        for j in range(segments):
            k = (j + 1) % segments
            quad(triangles, a + j, a + k, a + segments + k, a + segments + j)
    for first, end, turn in ((0, path[0], True), (len(path) * segments - segments, path[-1], False)):
        for j in range(segments):
            a, b = first + j, first + (j + 1) % segments
            triangles.append((len(positions), b, a) if turn else (len(positions), a, b))
        positions.append(end)
    return positions, triangles


def box(low, high):
    """An axis-aligned box."""
    positions = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    triangles = []
    for face in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
        quad(triangles, *face)
    return positions, triangles


def torus(ring, tube, along, around):
    """A torus about the y axis."""
    return lathe([(ring + tube * math.cos(math.tau * i / around), tube * math.sin(math.tau * i / around))
                  for i in range(around)], along)


def together(*meshes):
    positions, triangles = [], []
    for more_positions, more_triangles in meshes:
        first = len(positions)
        positions += more_positions
        triangles += [tuple(i + first for i in triangle) for triangle in more_triangles]
    return positions, triangles


def moved(mesh, by):
    return [add(position, by) for position in mesh[0]], mesh[1]


def along_z(mesh):
    """The y axis becomes the z axis."""
    return [(z, x, y) for x, y, z in mesh[0]], mesh[1]


def volume(mesh):
    return sum(dot(mesh[0][a], cross(mesh[0][b], mesh[0][c])) for a, b, c in mesh[1]) / 6


def check(name, mesh):
    """Every edge has one triangle on either side, and every part encloses a positive volume."""
    positions, triangles = mesh
    edges, parent = set(), list(range(len(positions)))

    def root(i):
        while parent[i] != i:
            parent[i] = parent[parent[i]]
            i = parent[i]
        return i

    for triangle in triangles:
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            if (a, b) in edges:
                sys.exit(f"{name}: the edge {a}, {b} is used twice in one direction")
            edges.add((a, b))
            parent[root(a)] = root(b)
    if any((b, a) not in edges for a, b in edges):
        sys.exit(f"{name}: not closed")
    parts = {}
    for triangle in triangles:
        parts.setdefault(root(triangle[0]), []).append(triangle)
    if any(volume((positions, part)) <= 0 for part in parts.values()):
        sys.exit(f"{name}: a part is inside out")


def encode(mesh, crease):
    """The PLY file. A corner's normal is the mean, weighted by angle, over the triangles at its vertex that lean away from its
    own by less than `crease` degrees."""
    positions, triangles = mesh
    normals, around = [], [[] for _ in positions]
    for number, triangle in enumerate(triangles):
        corners = [positions[i] for i in triangle]
        normals.append(unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]))))
        for i in range(3):
            a = unit(sub(corners[(i + 1) % 3], corners[i]))
            b = unit(sub(corners[(i + 2) % 3], corners[i]))
            around[triangle[i]].append((number, math.acos(max(-1.0, min(1.0, dot(a, b))))))
    limit = math.cos(math.radians(crease))
    vertices, faces = {}, []
    for number, triangle in enumerate(triangles):
        face = []
        for i in triangle:
            total = (0.0, 0.0, 0.0)
            for other, angle in around[i]:
                if dot(normals[number], normals[other]) > limit:
                    total = add(total, mul(normals[other], angle))
            # Rounded, so that the corners of a smooth vertex agree; + 0.0 makes a negative zero positive.
            normal = tuple(round(x, 6) + 0.0 for x in unit(total))
            position = tuple(round(x, 7) + 0.0 for x in positions[i])
            face.append(vertices.setdefault((position, normal), len(vertices)))
        faces.append(face)
    header = ("ply\nformat binary_little_endian 1.0\ncomment made by benches/make_scenes.py\n"
              f"element vertex {len(vertices)}\n" + "".join(f"property float {p}\n" for p in ("x", "y", "z", "nx", "ny", "nz"))
              + f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n")
    return (header.encode() + b"".join(struct.pack("<6f", *position, *normal) for position, normal in vertices)
            + b"".join(struct.pack("<B3i", 3, *face) for face in faces))


# Things

def egg(length):
    """An egg on its blunt end, its middle at the origin."""
    half = length / 2
    profile = []
    for step in range(97):
        t = math.pi * step / 96
        profile.append((0.72 * half * math.sin(t) * (1 + 0.13 * math.cos(t)), -half * math.cos(t)))
    profile[0], profile[-1] = (0.0, -half), (0.0, half)
    return lathe(profile, 128)


def shell(inner, outer):
    """The profile of a shell that is open at the top: up along `outer`, back along `inner`, which both start on the axis."""
    return join(outer, list(reversed(inner)))


def floor_lamp():
    """A lamp that shines upwards: a foot, a pole, a bowl."""
    foot = lathe([(0, 0), (0.16, 0), *arc((0.16, 0.012), 0.012, -90, 90, 6), (0.03, 0.03), (0, 0.03)], 48)
    pole = lathe([(0, 0.02), (0.014, 0.02), (0.014, 1.62), (0, 1.62)], 16)
    outer = bezier([(0, 1.60), (0.10, 1.60), (0.18, 1.66), (0.21, 1.80)], 16)
    inner = bezier([(0, 1.61), (0.095, 1.61), (0.17, 1.67), (0.2, 1.80)], 16)
    return together(foot, pole, lathe(shell(inner, outer), 64))


def spot_can():
    """A can that is open towards +z, its bottom at the origin, with a short stem behind it."""
    can = lathe([(0, 0), (0.055, 0), *arc((0.055, 0.015), 0.015, -90, 0, 4)[1:], (0.07, 0.24), (0.064, 0.24), (0.064, 0.006),
                 (0, 0.006)], 48)
    stem = lathe([(0, -0.1), (0.012, -0.1), (0.012, 0.003), (0, 0.003)], 16)
    return along_z(together(can, stem))


def round_table():
    """A round table on a turned leg, 0.75 high."""
    top = lathe([(0, 0.715), (0.6, 0.715), *arc((0.6, 0.7325), 0.0175, -90, 90, 8)[1:], (0, 0.75)], 96)
    leg = lathe(join([(0, 0), (0.26, 0)], arc((0.26, 0.012), 0.012, -90, 60, 6),
                     bezier([(0.266, 0.0224), (0.10, 0.05), (0.04, 0.10), (0.035, 0.2)], 12),
                     bezier([(0.035, 0.2), (0.03, 0.35), (0.075, 0.42), (0.05, 0.55)], 12),
                     bezier([(0.05, 0.55), (0.035, 0.62), (0.06, 0.68), (0.13, 0.718)], 10), [(0, 0.718)]), 48)
    return together(top, leg)


def vase():
    """A vase with a wall of 6 mm, 0.42 high."""
    outer = join([(0, 0), (0.07, 0)], bezier([(0.07, 0), (0.15, 0.10), (0.15, 0.20), (0.07, 0.30)], 20),
                 bezier([(0.07, 0.30), (0.04, 0.34), (0.05, 0.39), (0.075, 0.42)], 12))
    inner = join([(0, 0.01), (0.062, 0.01)], bezier([(0.062, 0.01), (0.143, 0.105), (0.143, 0.198), (0.064, 0.298)], 20),
                 bezier([(0.064, 0.298), (0.033, 0.342), (0.044, 0.394), (0.069, 0.422)], 12))
    return lathe(shell(inner, outer), 48)


def teapot():
    """A teapot: body, lid, spout, handle; 0.15 high."""
    body = lathe(join([(0, 0), (0.055, 0)], arc((0.055, 0.004), 0.004, -90, 0, 3),
                      bezier([(0.059, 0.004), (0.110, 0.030), (0.100, 0.105), (0.044, 0.118)], 28),
                      arc((0.044, 0.121), 0.003, -90, 90, 6), [(0, 0.124)]), 72)
    lid = lathe(join([(0, 0.122)], [(0.040, 0.122)], bezier([(0.040, 0.125), (0.034, 0.136), (0.016, 0.136), (0.008, 0.138)], 12),
                     bezier([(0.008, 0.138), (0.004, 0.142), (0.014, 0.144), (0.0135, 0.151)], 8),
                     bezier([(0.0135, 0.151), (0.012, 0.157), (0.006, 0.158), (0, 0.158)], 8)), 48)
    path = bezier([(0.070, 0.045, 0), (0.125, 0.045, 0), (0.105, 0.115, 0), (0.148, 0.124, 0)], 24)
    radii = [0.020 - 0.012 * (i / 24) ** 0.8 for i in range(25)]
    # The mouth: over the lip and back into the spout.
    spout = sweep(path + [add(path[-1], mul(unit(sub(path[-1], path[-2])), 0.0005)), path[-1], path[-5]],
                  radii + [0.0073, 0.0066, 0.006], 24, back=3)
    handle = sweep(bezier([(-0.074, 0.095, 0), (-0.125, 0.125, 0), (-0.155, 0.050, 0), (-0.074, 0.034, 0)], 28),
                   [0.0075] * 29, 16, flatten=1.3)
    return together(body, lid, spout, handle)


def jug():
    """A jug of sheet metal with a handle, 0.2 high."""
    outer = join([(0, 0), (0.05, 0)], arc((0.05, 0.004), 0.004, -90, 0, 3),
                 bezier([(0.054, 0.004), (0.095, 0.04), (0.085, 0.10), (0.042, 0.14)], 24),
                 bezier([(0.042, 0.14), (0.030, 0.152), (0.036, 0.185), (0.055, 0.2)], 14))
    inner = join([(0, 0.006), (0.05, 0.006)], bezier([(0.05, 0.006), (0.091, 0.042), (0.081, 0.099), (0.039, 0.138)], 24),
                 bezier([(0.039, 0.138), (0.027, 0.153), (0.033, 0.187), (0.052, 0.2015)], 14))
    handle = sweep(bezier([(-0.048, 0.190, 0), (-0.115, 0.215, 0), (-0.120, 0.110, 0), (-0.070, 0.085, 0)], 28),
                   [0.006] * 29, 16, flatten=1.6)
    return together(lathe(shell(inner, outer), 72), handle)


def carafe():
    """A carafe of thick glass, 0.24 high."""
    outer = join([(0, 0), (0.056, 0)], arc((0.056, 0.006), 0.006, -90, 0, 6),
                 bezier([(0.062, 0.006), (0.098, 0.06), (0.080, 0.11), (0.032, 0.145)], 32),
                 bezier([(0.032, 0.145), (0.016, 0.158), (0.020, 0.20), (0.036, 0.237)], 20))
    inner = join([(0, 0.014)], bezier([(0, 0.014), (0.04, 0.014), (0.056, 0.012), (0.0605, 0.026)], 14),
                 bezier([(0.0605, 0.026), (0.086, 0.062), (0.074, 0.107), (0.0295, 0.1415)], 32),
                 bezier([(0.0295, 0.1415), (0.0125, 0.156), (0.017, 0.201), (0.033, 0.2385)], 20))
    lip = arc((0.0345, 0.23775), math.dist((0.036, 0.237), (0.033, 0.2385)) / 2, -26.565, 153.435, 8)
    return lathe(shell(inner, join(outer, lip)), 96)


def square_table(width, depth, height):
    """A table of boards: a top and four legs."""
    x, z, leg = width / 2, depth / 2, 0.05
    parts = [box((-x, height - 0.035, -z), (x, height, z))]
    for i in (-1, 1):
        for k in (-1, 1):
            cx, cz = i * (x - 0.07), k * (z - 0.07)
            parts.append(box((cx - leg / 2, 0, cz - leg / 2), (cx + leg / 2, height - 0.035, cz + leg / 2)))
    parts.append(box((-x + 0.095, height - 0.105, -z + 0.06), (x - 0.095, height - 0.035, -z + 0.08)))
    parts.append(box((-x + 0.095, height - 0.105, z - 0.08), (x - 0.095, height - 0.035, z - 0.06)))
    return together(*parts)


DOOR = (-1.3, -0.4, 2.05)  # the opening: left, right, top


def door_wall():
    """The wall between two rooms, with the opening, from z = -0.15 to 0."""
    left, right, top = DOOR
    return together(box((-2.5, 0, -0.15), (left, 2.8, 0)), box((right, 0, -0.15), (2.5, 2.8, 0)),
                    box((left, top, -0.15), (right, 2.8, 0)))


def door_frame():
    """The casing on the near side of the opening."""
    left, right, top = DOOR
    return together(box((left - 0.09, 0, 0), (left, top + 0.09, 0.02)), box((right, 0, 0), (right + 0.09, top + 0.09, 0.02)),
                    box((left, top, 0), (right, top + 0.09, 0.02)))


def door_leaf():
    """A panelled door: the hinge is the y axis, the leaf lies along -x, from z = -0.04 to 0."""
    width, height, rail = DOOR[1] - DOOR[0] - 0.006, DOOR[2] - 0.012, 0.13
    rows = [0.008, 0.24, 0.95, 1.09, height - rail, height]
    parts = [box((-width, rows[0], -0.04), (-width + rail, height, 0)), box((-rail, rows[0], -0.04), (0, height, 0))]
    for low, high in ((0, 1), (2, 3), (4, 5)):
        parts.append(box((-width + rail, rows[low], -0.04), (-rail, rows[high], 0)))
    for low, high in ((1, 2), (3, 4)):
        parts.append(box((-width + rail, rows[low], -0.026), (-rail, rows[high], -0.014)))
        parts.append(box((-width + rail + 0.06, rows[low] + 0.06, -0.032), (-rail - 0.06, rows[high] - 0.06, -0.008)))
    return together(*parts)


def door_knob():
    """A knob on a rose, pointing along +z from the origin."""
    return along_z(lathe(join([(0, 0), (0.026, 0)], bezier([(0.026, 0.004), (0.02, 0.008), (0.01, 0.008), (0.009, 0.014)], 8),
                              bezier([(0.009, 0.014), (0.008, 0.03), (0.03, 0.03), (0.03, 0.048)], 12),
                              bezier([(0.03, 0.048), (0.03, 0.062), (0.014, 0.064), (0, 0.064)], 10)), 40))


def wine_glass():
    """A wine glass of height 1: foot, stem, and a bowl with a thin wall."""
    outer = join([(0, 0)], bezier([(0, 0), (0.1, 0), (0.2, 0), (0.255, 0)], 8), arc((0.255, 0.006), 0.006, -90, 78, 8),
                 bezier([(0.2562, 0.0119), (0.16, 0.034), (0.034, 0.03), (0.030, 0.10)], 26),
                 bezier([(0.030, 0.10), (0.026, 0.20), (0.024, 0.30), (0.030, 0.385)], 12),
                 bezier([(0.030, 0.385), (0.036, 0.44), (0.10, 0.455), (0.17, 0.50)], 20),
                 bezier([(0.17, 0.50), (0.30, 0.585), (0.275, 0.82), (0.222, 0.992)], 48))
    inner = join([(0, 0.468)], bezier([(0, 0.468), (0.06, 0.468), (0.11, 0.480), (0.160, 0.512)], 20),
                 bezier([(0.160, 0.512), (0.285, 0.594), (0.262, 0.82), (0.210, 0.988)], 48))
    middle = ((0.222 + 0.210) / 2, (0.992 + 0.988) / 2)
    tilt = math.degrees(math.atan2(0.004, 0.012))
    lip = arc(middle, math.dist((0.222, 0.992), (0.210, 0.988)) / 2, tilt, tilt + 180, 8)
    return lathe(shell(inner, join(outer, lip)), 128)


def ring():
    """A ring of height 0.5: its inner wall, of radius 1, is a cylinder up to the rounding of its edges."""
    inner, outer, height, edge = 1.0, 1.06, 0.5, 0.008
    # Normals at the ends of a wall lean towards the edges: rings close to these keep that from bending the whole wall.
    heights = [edge, 2 * edge, height - 2 * edge, height - edge]
    return lathe(join([(inner, h) for h in reversed(heights)], arc((inner + edge, edge), edge, 180, 270, 4),
                      arc((outer - edge, edge), edge, 270, 360, 4), [(outer, h) for h in heights[1:3]],
                      arc((outer - edge, height - edge), edge, 0, 90, 4),
                      arc((inner + edge, height - edge), edge, 90, 180, 4)[:-1]), 360)


# file: (mesh, crease angle in degrees)
def lantern(radius):
    """A small paper lantern of 36 triangles."""
    profile = [(0.0, -radius), (0.72 * radius, -0.66 * radius), (radius, 0.0), (0.72 * radius, 0.66 * radius), (0.0, radius)]
    return lathe(profile, 6)


def lanterns(kind, kinds=3):
    """Every third lantern of the strings across the alley, from one wall to the other."""
    parts = []
    for string in range(14):
        z, low = 0.4 - 1.05 * string, 2.25 + 0.35 * math.sin(2.1 * string)
        for i in range(15):
            if (i + 2 * string) % kinds != kind:
                continue
            t = (i + 0.5) / 15
            x, sag = -2.0 + 4.0 * t, 4 * t * (1 - t)
            size = 0.045 + 0.02 * math.sin(5.0 * i + 3.0 * string)
            parts.append(moved(lantern(size), (x, low + 0.75 * (1 - sag), z + 0.12 * math.sin(4.0 * i))))
    return together(*parts)


def stalls():
    """Boxes and barrels along both walls."""
    parts = []
    for i in range(9):
        z, side = -0.2 - 1.55 * i, -1 if i % 2 else 1
        wide, high = 0.42 + 0.14 * math.sin(3.0 * i), 0.55 + 0.3 * math.sin(7.0 * i + 1)
        low, top = sorted((side * 2.0, side * (2.0 - wide)))
        parts.append(box((low, 0.0, z - 0.5), (top, high, z + 0.35)))
        barrel = lathe([(0.0, 0.0), (0.22, 0.0), (0.27, 0.3), (0.22, 0.6), (0.0, 0.6)], 24)
        parts.append(moved(barrel, (-side * (1.62 - 0.1 * math.sin(5.0 * i)), 0.0, z - 0.3)))
    return together(*parts)


def cobbles():
    """Heights of rounded stones in rows, which go on at the edges: a PNG that is not compressed, the same bytes everywhere."""
    side, rows = 192, 6
    stones = [((column + 0.5 * (row % 2) + 0.24 * math.sin(5.3 * row + 2.9 * column)) % rows,
               row + 0.24 * math.sin(3.7 * column - 1.9 * row)) for row in range(rows) for column in range(rows)]

    def texel(x, y):
        def height(stone):
            away = [abs(place * rows / side - centre) for place, centre in zip((x, y), stone)]
            distance = math.hypot(*(min(way % rows, rows - way % rows) for way in away))
            return max(0.0, 1.0 - (distance / 0.7) ** 2)
        return [max(map(height, stones))]

    return png(side, side, 1, texel, level=0)


IMAGES = {"bumps/cobbles.png": cobbles}

MESHES = {
    "bidirectional_room/egg.ply": (lambda: egg(0.3), 35),
    "bidirectional_room/floor_lamp.ply": (floor_lamp, 40),
    "bidirectional_room/spot_can.ply": (spot_can, 40),
    "bidirectional_room/table.ply": (round_table, 35),
    "bidirectional_room/vase.ply": (vase, 35),
    "door_ajar/wall.ply": (door_wall, 30),
    "door_ajar/frame.ply": (door_frame, 30),
    "door_ajar/door.ply": (door_leaf, 30),
    "door_ajar/knob.ply": (door_knob, 40),
    "door_ajar/table.ply": (lambda: square_table(1.3, 0.75, 0.74), 30),
    "door_ajar/teapot.ply": (teapot, 35),
    "door_ajar/jug.ply": (jug, 35),
    "door_ajar/carafe.ply": (carafe, 35),
    "caustic_small_light/wine_glass.ply": (wine_glass, 40),
    "ring_caustic/ring.ply": (ring, 35),
    "many_lights/lanterns_warm.ply": (lambda: lanterns(0), 35),
    "many_lights/lanterns_red.ply": (lambda: lanterns(1), 35),
    "many_lights/lanterns_cool.ply": (lambda: lanterns(2), 35),
    "many_lights/stalls.ply": (stalls, 30),
    "bumps/ball.ply": (lambda: lathe(arc((0, 0), 0.45, -90, 90, 6), 10), 180),
    "torus_in_glass/torus.ply": (lambda: torus(0.6, 0.22, 128, 56), 35),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; exit with status 1 where a file differs")
    args = parser.parse_args()
    differ = []

    def put(name, data, what):
        path = SCENES / name
        if args.check:
            if not path.exists() or path.read_bytes() != data:
                differ.append(name)
            return
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)
        print(f"{name}: {what}, {len(data) / 1000:.0f} kB")

    for name, (make, crease) in MESHES.items():
        mesh = make()
        check(name, mesh)
        put(name, encode(mesh, crease), f"{len(mesh[1])} triangles")
    for name, make in IMAGES.items():
        put(name, make(), "an image")
    if differ:
        sys.exit("differ: " + ", ".join(differ))


if __name__ == "__main__":
    main()
