"""Six small scenes, each of which holds what writers get wrong: textures, layers of materials, colours and lights, alpha, skins, morphs."""

import json
import math
import struct
import zlib


def png(width, height, texel):
    rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(width)) for y in range(height))

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


class Glb:
    """A binary glTF in the making."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0", "generator": "candela interop"}, "scene": 0, "scenes": [{"nodes": []}]}
        self.data = b""

    def add(self, key, value):
        self.json.setdefault(key, []).append(value)
        return len(self.json[key]) - 1

    def view(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        self.data += data
        return self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.data) - len(data), "byteLength": len(data)})

    def floats(self, values, bounds=False):
        kind = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[len(values[0])]
        view = self.view(b"".join(struct.pack(f"<{len(v)}f", *v) for v in values))
        accessor = {"bufferView": view, "componentType": 5126, "count": len(values), "type": kind}
        if bounds:
            accessor["min"] = [min(column) for column in zip(*values)]
            accessor["max"] = [max(column) for column in zip(*values)]
        return self.add("accessors", accessor)

    def integers(self, values, component, code, kind="SCALAR"):
        flat = [x for v in values for x in v] if kind != "SCALAR" else values
        view = self.view(struct.pack(f"<{len(flat)}{code}", *flat))
        return self.add("accessors", {"bufferView": view, "componentType": component, "count": len(values), "type": kind})

    def texture(self, picture):
        image = self.add("images", {"bufferView": self.view(picture), "mimeType": "image/png"})
        return {"index": self.add("textures", {"source": image})}

    def material(self, **members):
        for extension in members.get("extensions", {}):
            used = self.json.setdefault("extensionsUsed", [])
            if extension not in used:
                used.append(extension)
        return self.add("materials", members)

    def primitive(self, shape, material, **attributes):
        points, normals, uvs, faces = shape
        return {
            "attributes": {
                "POSITION": self.floats(points, bounds=True),
                "NORMAL": self.floats(normals),
                "TEXCOORD_0": self.floats(uvs),
                **attributes,
            },
            "indices": self.integers([i for face in faces for i in face], 5125, "I"),
            "material": material,
        }

    def node(self, root=True, **members):
        index = self.add("nodes", members)
        if root:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def show(self, shape, material, **members):
        return self.node(mesh=self.add("meshes", {"primitives": [self.primitive(shape, material)]}), **members)

    def bytes(self):
        self.data += b"\0" * (-len(self.data) % 4)
        self.json["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(self.data), b"BIN\0") + self.data
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def cube(size=1.0):
    points, normals, uvs, faces = [], [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            base = len(points)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0.0, 0.0, 0.0]
                p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = sign, u, v
                n = [0.0, 0.0, 0.0]
                n[axis] = sign
                points.append([x * size / 2 for x in p])
                normals.append(n)
                uvs.append([(u + 1) / 2, (1 - v) / 2])
            quad = (0, 1, 2, 3) if sign > 0 else (0, 3, 2, 1)
            faces += [[base + quad[0], base + quad[1], base + quad[2]], [base + quad[0], base + quad[2], base + quad[3]]]
    return points, normals, uvs, faces


def ball(radius=0.5, rings=24, segments=48):
    points, normals, uvs, faces = [], [], [], []
    for i in range(rings + 1):
        for j in range(segments + 1):
            theta, phi = math.pi * i / rings, 2 * math.pi * j / segments
            n = [math.sin(theta) * math.cos(phi), math.cos(theta), -math.sin(theta) * math.sin(phi)]
            normals.append(n)
            points.append([radius * x for x in n])
            uvs.append([j / segments, i / rings])
    for i in range(rings):
        for j in range(segments):
            a, b = i * (segments + 1) + j, (i + 1) * (segments + 1) + j
            if i > 0:
                faces.append([a, b, a + 1])
            if i < rings - 1:
                faces.append([a + 1, b, b + 1])
    return points, normals, uvs, faces


def pbr(color, metallic=0.0, roughness=0.5, **members):
    return {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness, **members}


def textured():
    glb = Glb()
    color = glb.texture(png(64, 64, lambda x, y: (255, 40 + 3 * x, 60, 255) if (x // 8 + y // 8) % 2 else (30, 60 + 2 * y, 200, 255)))
    packed = glb.texture(png(64, 64, lambda x, y: (255, 60 + 3 * x, 255 if y > 31 else 0, 255)))
    surface = {"baseColorTexture": color, "metallicRoughnessTexture": packed}
    glb.show(cube(), glb.material(name="checked", pbrMetallicRoughness=surface), rotation=[0, math.sin(0.3), 0, math.cos(0.3)])
    return glb.bytes()


def layers():
    glb = Glb()
    kinds = (
        {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1}},
        {"KHR_materials_sheen": {"sheenColorFactor": [0.8, 0.6, 0.9], "sheenRoughnessFactor": 0.4}},
        {"KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessMaximum": 380}},
        {"KHR_materials_specular": {"specularFactor": 0.3, "specularColorFactor": [1, 0.6, 0.4]}},
    )
    for i, extensions in enumerate(kinds):
        material = glb.material(name=f"layer {i}", pbrMetallicRoughness=pbr((0.3, 0.1 + 0.2 * i, 0.5), 0, 0.6), extensions=extensions)
        glb.show(ball(0.4), material, translation=[0.9 * (i % 2) - 0.45, 0.9 * (i // 2) - 0.45, 0])
    return glb.bytes()


def lights():
    glb = Glb()
    shape = ball()
    colors = [[0.5 + 0.5 * x for x in n] + [1.0] for n in shape[1]]
    material = glb.material(name="coloured", pbrMetallicRoughness=pbr((1, 1, 1), 0, 0.7))
    primitive = glb.primitive(shape, material, COLOR_0=glb.floats(colors))
    glb.node(mesh=glb.add("meshes", {"primitives": [primitive]}), name="ball")
    lamps = [{"type": "point", "intensity": 40, "color": [1, 0.8, 0.6], "name": "lamp"}, {"type": "directional", "intensity": 4, "name": "sun"}]
    glb.json["extensions"] = {"KHR_lights_punctual": {"lights": lamps}}
    glb.json.setdefault("extensionsUsed", []).append("KHR_lights_punctual")
    glb.node(translation=[1.5, 1.5, 1.5], extensions={"KHR_lights_punctual": {"light": 0}}, name="lamp")
    glb.node(rotation=[-0.5, 0, 0, math.sqrt(0.75)], extensions={"KHR_lights_punctual": {"light": 1}}, name="sun")
    camera = glb.add("cameras", {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}, "name": "eye"})
    glb.node(translation=[0, 0, 3], camera=camera, name="eye")
    return glb.bytes()


def alpha():
    glb = Glb()
    holes = glb.texture(png(32, 32, lambda x, y: (90, 200, 90, 255 if (x - 16) ** 2 + (y - 16) ** 2 > 80 else 0)))
    mask = glb.material(name="mask", pbrMetallicRoughness={"baseColorTexture": holes, "metallicFactor": 0}, alphaMode="MASK", doubleSided=True)
    glass = glb.material(name="blend", pbrMetallicRoughness={**pbr((0.2, 0.4, 0.9)), "baseColorFactor": [0.2, 0.4, 0.9, 0.4]}, alphaMode="BLEND")
    glb.show(cube(), mask, translation=[-0.6, 0, 0])
    glb.show(ball(), glass, translation=[0.6, 0, 0])
    return glb.bytes()


def skinned():
    """A column of which the upper half is bent by its second joint."""
    glb = Glb()
    points, normals, uvs, faces = [], [], [], []
    rings, sides = 12, 16
    for i in range(rings + 1):
        for j in range(sides + 1):
            a = 2 * math.pi * j / sides
            normals.append([math.cos(a), 0.0, -math.sin(a)])
            points.append([0.2 * math.cos(a), 1.6 * i / rings - 0.8, -0.2 * math.sin(a)])
            uvs.append([j / sides, i / rings])
    for i in range(rings):
        for j in range(sides):
            a, b = i * (sides + 1) + j, (i + 1) * (sides + 1) + j
            faces += [[a, a + 1, b], [a + 1, b + 1, b]]
    weights = [[1 - t, t, 0, 0] for t in (min(max((p[1] + 0.4) / 0.8, 0), 1) for p in points)]
    material = glb.material(name="column", pbrMetallicRoughness=pbr((0.8, 0.5, 0.2), 0, 0.5), doubleSided=True)
    joints = glb.integers([[0, 1, 0, 0]] * len(points), 5123, "H", "VEC4")
    primitive = glb.primitive((points, normals, uvs, faces), material, JOINTS_0=joints, WEIGHTS_0=glb.floats(weights))
    upper = glb.node(root=False, name="upper", translation=[0, 0.8, 0], rotation=[0, 0, math.sin(0.35), math.cos(0.35)])
    lower = glb.node(name="lower", translation=[0, -0.8, 0], children=[upper])

    def back(y):
        return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -y, 0, 1]

    skin = glb.add("skins", {"joints": [lower, upper], "inverseBindMatrices": glb.floats([back(-0.8), back(0.0)])})
    glb.node(mesh=glb.add("meshes", {"primitives": [primitive]}), skin=skin, name="column")
    return glb.bytes()


def morphed():
    glb = Glb()
    shape = ball(0.6)
    material = glb.material(name="egg", pbrMetallicRoughness=pbr((0.7, 0.2, 0.3), 0, 0.4))
    primitive = glb.primitive(shape, material)
    ways = [[0.0, 0.8 * p[1] if p[1] > 0 else 0.0, 0.0] for p in shape[0]]
    primitive["targets"] = [{"POSITION": glb.floats(ways, bounds=True)}]
    glb.node(mesh=glb.add("meshes", {"primitives": [primitive], "weights": [0.5]}), scale=[1, 0.8, 1], name="egg")
    return glb.bytes()


SOURCES = {"textured": textured, "layers": layers, "lights": lights, "alpha": alpha, "skinned": skinned, "morphed": morphed}
