#!/usr/bin/env python3
"""Writes a columned atrium open to the sky as a .glb: two storeys of columns and arches, curtains, and plants whose leaves are alpha-masked cards, with
brick, plaster, cloth and leaf textures. About 300 000 triangles. An interior for measurements: light enters from above and bounces.

    bench/atrium.py atrium.glb
    candela render atrium.glb -o atrium.png --env street.hdr --eye=-9,1.8,0.6 --target=6,3,-0.4 --fov 60
"""

import json
import math
import random
import struct
import sys
import zlib

LENGTH, WIDTH, STOREY = 22.0, 12.0, 4.0  # metres; the court in the middle is open
AISLE = 3.0
TEXTURE = 512


def png(pixels, width, height, channels):
    rows = b"".join(b"\0" + bytes(pixels[y * width * channels : (y + 1) * width * channels]) for y in range(height))
    chunk = lambda name, data: struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b"")


class Noise:
    """Value noise that repeats after `period` cells."""

    def __init__(self, seed, period):
        generator = random.Random(seed)
        self.period = period
        self.values = [[generator.random() for _ in range(period)] for _ in range(period)]

    def __call__(self, u, v):
        x, y = u * self.period, v * self.period
        i, j = math.floor(x), math.floor(y)
        s, t = x - i, y - j
        s, t = s * s * (3 - 2 * s), t * t * (3 - 2 * t)
        at = lambda a, b: self.values[b % self.period][a % self.period]
        top = at(i, j) * (1 - s) + at(i + 1, j) * s
        return top * (1 - t) + (at(i, j + 1) * (1 - s) + at(i + 1, j + 1) * s) * t


def wall_maps(seed, color, mortar, bricks):
    """Base colour, normal and occlusion-roughness-metallic of bricks (rows, columns)."""
    coarse, fine = Noise(seed, 8), Noise(seed + 1, 64)
    size = TEXTURE
    height, shade = [], []
    for y in range(size):
        v = y / size * bricks[0]
        for x in range(size):
            u = x / size * bricks[1] + 0.5 * (math.floor(v) % 2)
            edge = min(u % 1, 1 - u % 1, v % 1 * bricks[1] / bricks[0], (1 - v % 1) * bricks[1] / bricks[0])
            inside = min(max((edge - 0.03) / 0.04, 0), 1) if bricks[0] > 1 else 1.0
            n = 0.6 * coarse(x / size, y / size) + 0.4 * fine(x / size, y / size)
            height.append(0.7 * inside + 0.3 * n)
            shade.append((inside, n))
    base, normal, orm = bytearray(), bytearray(), bytearray()
    for y in range(size):
        for x in range(size):
            inside, n = shade[y * size + x]
            base += bytes(int(255 * (mortar[c] * (1 - inside) + color[c] * inside) * (0.75 + 0.25 * n)) for c in range(3))
            dx = height[y * size + (x + 1) % size] - height[y * size + x - 1]
            dy = height[(y + 1) % size * size + x] - height[(y - 1) * size + x]
            length = math.sqrt(4 * dx * dx + 4 * dy * dy + 1)
            normal += bytes(int(127.5 + 127.5 * c / length) for c in (-2 * dx, 2 * dy, 1))
            orm += bytes((255, int(255 * (0.6 + 0.3 * n)), 0))
    return [png(pixels, size, size, 3) for pixels in (base, normal, orm)]


def leaf_map():
    size = 128
    pixels = bytearray()
    for y in range(size):
        for x in range(size):
            u, v = 2 * (x + 0.5) / size - 1, (y + 0.5) / size
            width = 0.85 * math.sin(math.pi * v) ** 0.8
            vein = 0.2 if abs(u) < 0.03 else 0.0
            pixels += bytes((40, int(110 + 60 * v - 100 * vein), 30, 255 if abs(u) < width else 0))
    return png(pixels, size, size, 4)


class Mesh:
    def __init__(self):
        self.positions, self.normals, self.uvs, self.indices = [], [], [], []

    def grid(self, surface, nu, nv, uv_scale=(1, 1)):
        """`surface(u, v)` over the unit square; normals by differences, front where u × v points."""
        first, step = len(self.positions), 1e-4
        for j in range(nv + 1):
            for i in range(nu + 1):
                u, v = i / nu, j / nv
                p, q, r = surface(u, v), surface(u + step, v), surface(u, v + step)
                a, b = [q[k] - p[k] for k in range(3)], [r[k] - p[k] for k in range(3)]
                n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
                length = math.sqrt(sum(c * c for c in n)) or 1.0
                self.positions.append(p)
                self.normals.append([c / length for c in n])
                self.uvs.append((u * uv_scale[0], v * uv_scale[1]))
        for j in range(nv):
            for i in range(nu):
                a = first + j * (nu + 1) + i
                self.indices += [a, a + 1, a + nu + 2, a, a + nu + 2, a + nu + 1]

    def quad(self, origin, u, v, cells, uv_scale):
        self.grid(lambda s, t: [origin[k] + s * u[k] + t * v[k] for k in range(3)], *cells, uv_scale)


def lathe(mesh, x, y, z, profile, around=48, along=4):
    """A body of revolution about the vertical axis; `profile` lists (radius, height)."""

    def surface(u, v):
        place = min(max(v, 0.0), 1.0) * (len(profile) - 1)
        i = min(int(place), len(profile) - 2)
        t = place - i
        radius = profile[i][0] * (1 - t) + profile[i + 1][0] * t
        height = profile[i][1] * (1 - t) + profile[i + 1][1] * t
        if v > 1.0:  # for the difference at the end
            height += (v - 1.0) * (profile[-1][1] - profile[-2][1] + 1e-3)
        return [x + radius * math.cos(-2 * math.pi * u), y + height, z + radius * math.sin(-2 * math.pi * u)]

    mesh.grid(surface, around, along * (len(profile) - 1), (3, 4))


def build():
    stone, brick, plaster, leaves = Mesh(), Mesh(), Mesh(), Mesh()
    curtains = [Mesh(), Mesh(), Mesh()]
    half_l, half_w, inner = LENGTH / 2, WIDTH / 2, WIDTH / 2 - AISLE
    plaster.quad([-half_l, 0, half_w], [LENGTH, 0, 0], [0, 0, -WIDTH], (60, 40), (22, 12))
    for side in (-1, 1):
        brick.quad([-side * half_l, 0, -side * half_w], [side * LENGTH, 0, 0], [0, 2 * STOREY, 0], (60, 30), (11, 4))
        brick.quad([side * half_l, 0, -side * half_w], [0, 0, side * WIDTH], [0, 2 * STOREY, 0], (40, 30), (6, 4))
        for storey in (1, 2):  # ceiling and floor of the aisles
            y = storey * STOREY
            plaster.quad([-half_l, y, side * inner if side > 0 else -half_w], [LENGTH, 0, 0], [0, 0, AISLE], (60, 10), (22, 3))
            plaster.quad([-half_l, y + 0.3, half_w if side > 0 else -inner], [LENGTH, 0, 0], [0, 0, -AISLE], (60, 10), (22, 3))
            brick.quad([-side * half_l, y, side * inner], [side * LENGTH, 0, 0], [0, 0.3, 0], (60, 2), (22, 0.3))
            brick.quad([side * half_l, y, side * inner], [-side * LENGTH, 0, 0], [0, 0.3, 0], (60, 2), (22, 0.3))
    shaft = [(0.42, 0), (0.42, 0.12), (0.3, 0.2), (0.28, 0.25), (0.25, 1.5), (0.22, 2.6), (0.3, 2.7), (0.4, 2.85), (0.4, 3.0)]
    columns = [-half_l + 1.5 + i * (LENGTH - 3.0) / 7 for i in range(8)]
    for storey in range(2):
        for side in (-1, 1):
            for i, x in enumerate(columns):
                lathe(stone, x, storey * (STOREY + 0.3) if storey else 0.0, side * inner, shaft, 48, 4)
                if i + 1 < len(columns):  # an arch to the next
                    middle, radius = 0.5 * (x + columns[i + 1]), 0.5 * (columns[i + 1] - x)
                    y = storey * (STOREY + 0.3) + 3.0

                    def arch(u, v, middle=middle, radius=radius, y=y, side=side):
                        angle, turn = math.pi * u, 2 * math.pi * v
                        r = radius + 0.14 * math.cos(turn)
                        return [middle - r * math.cos(angle), y + 0.62 * r * math.sin(angle) * 0.9, side * inner - 0.2 * math.sin(turn)]

                    stone.grid(arch, 48, 16, (6, 1))
    generator = random.Random(7)
    for i in range(0, 7):  # cloth between the upper columns
        for side in (-1, 1):
            x, waves = columns[i], generator.choice((5, 6, 7))
            width, drop = columns[1] - columns[0] - 0.8, generator.uniform(1.6, 2.4)

            def cloth(u, v, x=x, waves=waves, width=width, drop=drop, side=side):
                fold = 0.08 * math.sin(2 * math.pi * waves * u + 0.6 * v) * (0.3 + v)
                return [x + 0.4 + width * u, STOREY + 3.1 - drop * v, side * (inner - 0.25) + fold]

            curtains[(i + (side > 0)) % 3].grid(cloth, 72, 20, (4, 4))
    pots = [(x, z) for x in columns[::2] for z in (-1.6, 1.6)]
    for x, z in pots:
        lathe(stone, x, 0, z, [(0.25, 0), (0.35, 0.35), (0.4, 0.45), (0.36, 0.46), (0.3, 0.4)], 48, 6)
        for _ in range(900):
            turn, rise = generator.uniform(0, 2 * math.pi), math.sqrt(generator.random())
            reach = generator.uniform(0.05, 0.55) * rise
            base = [x + reach * math.cos(turn), 0.45 + 1.1 * generator.random() * rise, z + reach * math.sin(turn)]
            lean, size = generator.uniform(0.3, 1.2), generator.uniform(0.12, 0.25)
            out, across = (math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))

            def leaf(u, v, base=base, lean=lean, size=size, out=out, across=across):
                bend = lean + 0.8 * v
                s, w = size * v, 0.35 * size * (u - 0.5)
                return [base[0] + out[0] * s * math.sin(bend) + across[0] * w, base[1] + s * math.cos(bend),
                        base[2] + out[1] * s * math.sin(bend) + across[1] * w]

            leaves.grid(leaf, 2, 3)
    return stone, brick, plaster, leaves, curtains


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    stone, brick, plaster, leaves, curtains = build()
    binary, views, accessors = bytearray(), [], []

    def view(data):
        binary.extend(b"\0" * (-len(binary) % 4))
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        binary.extend(data)
        return len(views) - 1

    def accessor(values, kind, code, component):
        flat = [c for v in values for c in v] if kind != "SCALAR" else values
        accessors.append({"bufferView": view(struct.pack(f"<{len(flat)}{code}", *flat)), "componentType": component,
                          "count": len(values), "type": kind})  # fmt: skip
        if kind == "VEC3":
            accessors[-1]["min"] = [min(v[k] for v in values) for k in range(3)]
            accessors[-1]["max"] = [max(v[k] for v in values) for k in range(3)]
        return len(accessors) - 1

    images, materials, meshes = [], [], []

    def image(data):
        images.append({"bufferView": view(data), "mimeType": "image/png"})
        return {"index": len(images) - 1}

    def textured(name, maps):
        base, normal, orm = (image(data) for data in maps)
        materials.append({"name": name, "normalTexture": normal, "pbrMetallicRoughness": {
            "baseColorTexture": base, "metallicRoughnessTexture": orm}})  # fmt: skip

    textured("stone", wall_maps(1, (0.72, 0.66, 0.56), (0.5, 0.5, 0.5), (1, 1)))
    textured("brick", wall_maps(3, (0.62, 0.42, 0.3), (0.6, 0.57, 0.52), (8, 4)))
    textured("plaster", wall_maps(5, (0.68, 0.64, 0.58), (0.45, 0.42, 0.4), (2, 2)))
    materials.append({"name": "leaf", "alphaMode": "MASK", "doubleSided": True,
                      "pbrMetallicRoughness": {"baseColorTexture": image(leaf_map()), "metallicFactor": 0, "roughnessFactor": 0.6}})
    for name, color in (("red", (0.55, 0.06, 0.05)), ("green", (0.08, 0.3, 0.1)), ("blue", (0.06, 0.12, 0.4))):
        materials.append({"name": name, "doubleSided": True, "pbrMetallicRoughness": {
            "baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 0.8}})  # fmt: skip
    triangles = 0
    for i, mesh in enumerate((stone, brick, plaster, leaves, *curtains)):
        triangles += len(mesh.indices) // 3
        meshes.append({"primitives": [{"material": i, "attributes": {
            "POSITION": accessor(mesh.positions, "VEC3", "f", 5126), "NORMAL": accessor(mesh.normals, "VEC3", "f", 5126),
            "TEXCOORD_0": accessor(mesh.uvs, "VEC2", "f", 5126)}, "indices": accessor(mesh.indices, "SCALAR", "I", 5125)}]})
    scene = {"asset": {"version": "2.0", "generator": "Candela bench/atrium.py"}, "scene": 0,
             "scenes": [{"nodes": list(range(len(meshes)))}], "nodes": [{"mesh": i} for i in range(len(meshes))],
             "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views, "images": images,
             "textures": [{"source": i} for i in range(len(images))], "buffers": [{"byteLength": len(binary)}]}  # fmt: skip
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    binary.extend(b"\0" * (-len(binary) % 4))
    with open(sys.argv[1], "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(binary)))
        file.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
        file.write(struct.pack("<II", len(binary), 0x004E4942) + binary)
    print(f"{sys.argv[1]}: {triangles} triangles")


if __name__ == "__main__":
    main()
