#!/usr/bin/env python3
"""Writes scenes/gltf_room as a scene of Mitsuba's format, for renderers that read no glTF.

    pip install numpy pillow
    benches/gltf_room_as_mitsuba.py scenes/gltf_room FOLDER     writes FOLDER/gltf_room.xml, its meshes and its textures

Metallic-roughness materials become `principled`, with the images' channels as files of their own; clear glass becomes `dielectric`, without what its
volume absorbs, which Mitsuba's `path` does not render. It reads what that room has, not glTF at large.
"""
import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image

COMPONENTS = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Room:
    def __init__(self, source, target):
        self.source, self.target = source, target
        self.json = json.loads((source / "room.gltf").read_text())
        self.buffers = [(source / buffer["uri"]).read_bytes() for buffer in self.json["buffers"]]
        self.lines, self.parts = [], 0

    def array(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, width = COMPONENTS[accessor["componentType"]], WIDTHS[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        data = np.frombuffer(self.buffers[view["buffer"]], kind, accessor["count"] * width, start)
        return data.reshape(-1, width)

    def image(self, texture):
        return Image.open(self.source / self.json["images"][self.json["textures"][texture["index"]]["source"]]["uri"])

    def bitmap(self, role, name, texture, channel=None, raw=False):
        """A texture element that shows an image, or one channel of it."""
        image = self.image(texture)
        file = f"{name}_{channel if channel is not None else 'rgb'}.png"
        image = image.convert("RGBA").getchannel(channel) if channel is not None else image.convert("RGB")
        image.save(self.target / file)
        raw = raw or channel is not None
        flag = '<boolean name="raw" value="true"/>' if raw else ""
        return f'<texture type="bitmap" name="{role}"><string name="filename" value="{file}"/>{flag}</texture>'

    def material(self, index):
        material = self.json["materials"][index]
        name, pbr = material["name"].replace(" ", "_"), material.get("pbrMetallicRoughness", {})
        extensions = material.get("extensions", {})
        if "KHR_materials_transmission" in extensions:
            return f'<bsdf type="dielectric" id="{name}"><float name="int_ior" value="{extensions["KHR_materials_ior"]["ior"]}"/></bsdf>'
        if "baseColorTexture" in pbr:
            colour = self.bitmap("base_color", name + "_colour", pbr["baseColorTexture"])
        else:
            rgb = ", ".join(str(value) for value in pbr.get("baseColorFactor", [1, 1, 1])[:3])
            colour = f'<rgb name="base_color" value="{rgb}"/>'
        if "metallicRoughnessTexture" in pbr:
            channels = (("roughness", "G"), ("metallic", "B"))
            surface = "".join(self.bitmap(role, f"{name}_{role}", pbr["metallicRoughnessTexture"], channel) for role, channel in channels)
        else:
            surface = f'<float name="roughness" value="{pbr.get("roughnessFactor", 1)}"/><float name="metallic" value="{pbr.get("metallicFactor", 1)}"/>'
        coat = extensions.get("KHR_materials_clearcoat")
        if coat:
            surface += f'<float name="clearcoat" value="{coat["clearcoatFactor"]}"/><float name="clearcoat_gloss" value="{1 - coat["clearcoatRoughnessFactor"]}"/>'
        bsdf = f'<bsdf type="principled">{colour}{surface}</bsdf>'
        if "normalTexture" in material:
            bsdf = f'<bsdf type="normalmap">{self.bitmap("normalmap", name + "_normal", material["normalTexture"], raw=True)}{bsdf}</bsdf>'
        if material.get("doubleSided"):
            bsdf = f'<bsdf type="twosided">{bsdf}</bsdf>'
        if material.get("alphaMode") == "MASK":
            opacity = self.bitmap("opacity", name + "_opacity", pbr["baseColorTexture"], "A")
            bsdf = f'<bsdf type="mask">{opacity}{bsdf}</bsdf>'
        return bsdf.replace(">", f' id="{name}">', 1)

    def mesh(self, primitive, matrix):
        attributes = primitive["attributes"]
        positions = self.array(attributes["POSITION"]).astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        columns = [positions]
        names = ["x", "y", "z"]
        if "NORMAL" in attributes:
            normals = self.array(attributes["NORMAL"]) @ np.linalg.inv(matrix[:3, :3])
            columns.append(normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30))
            names += ["nx", "ny", "nz"]
        if "TEXCOORD_0" in attributes:
            columns.append(self.array(attributes["TEXCOORD_0"]))
            names += ["u", "v"]
        vertices = np.hstack(columns).astype("<f4")
        triangles = self.array(primitive["indices"]).astype("<i4").reshape(-1, 3)
        file = f"room_{self.parts}.ply"
        self.parts += 1
        head = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(vertices)}\n"
        head += "".join(f"property float {name}\n" for name in names)
        head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
        faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, triangles
        (self.target / file).write_bytes(head.encode() + vertices.tobytes() + faces.tobytes())
        name = self.json["materials"][primitive["material"]]["name"].replace(" ", "_")
        flat = "" if "NORMAL" in attributes else '<boolean name="face_normals" value="true"/>'
        self.lines.append(f'<shape type="ply"><string name="filename" value="{file}"/>{flat}<ref id="{name}"/></shape>')

    def node(self, node):
        matrix = np.eye(4)
        x, y, z, w = node.get("rotation", [0, 0, 0, 1])
        matrix[:3, :3] = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                                   [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                                   [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]) * np.array(node.get("scale", [1, 1, 1]))
        matrix[:3, 3] = node.get("translation", [0, 0, 0])
        if "mesh" in node:
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                self.mesh(primitive, matrix)
        if "camera" in node:
            camera = self.json["cameras"][node["camera"]]["perspective"]
            origin, target = matrix[:3, 3], matrix[:3, 3] - matrix[:3, 2]
            text = lambda v: ", ".join(f"{value:.9g}" for value in v)
            self.lines.append(f'<sensor type="perspective"><float name="fov" value="{np.degrees(camera["yfov"]):.9g}"/><string name="fov_axis" value="y"/>'
                              f'<transform name="to_world"><lookat origin="{text(origin)}" target="{text(target)}" up="{text(matrix[:3, 1])}"/></transform>'
                              '<film type="hdrfilm"><integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="box"/></film>'
                              '<sampler type="independent"><integer name="sample_count" value="$spp"/></sampler></sensor>')
        light = node.get("extensions", {}).get("KHR_lights_punctual")
        if light:
            sun = self.json["extensions"]["KHR_lights_punctual"]["lights"][light["light"]]
            irradiance = ", ".join(str(sun["intensity"] * value) for value in sun["color"])
            direction = ", ".join(f"{-value:.9g}" for value in matrix[:3, 2])
            self.lines.append(f'<emitter type="directional"><vector name="direction" value="{direction}"/><rgb name="irradiance" value="{irradiance}"/></emitter>')

    def write(self):
        self.target.mkdir(parents=True, exist_ok=True)
        self.lines += [self.material(index) for index in range(len(self.json["materials"]))]
        for node in self.json["nodes"]:
            self.node(node)
        sky = self.json["scenes"][0]["extras"]["lumbre"]["environment"]
        (self.target / "sky.hdr").write_bytes((self.source / sky["uri"]).read_bytes())
        self.lines.append(f'<emitter type="envmap"><string name="filename" value="sky.hdr"/><float name="scale" value="{sky["intensity"]}"/></emitter>')
        head = '<scene version="3.0.0">\n' + "".join(f'<default name="{name}" value="{value}"/>\n' for name, value in (("spp", 64), ("width", 768), ("height", 512)))
        head += '<integrator type="path"/>\n'
        (self.target / "gltf_room.xml").write_text(head + "\n".join(self.lines) + "\n</scene>\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    Room(Path(sys.argv[1]), Path(sys.argv[2])).write()
