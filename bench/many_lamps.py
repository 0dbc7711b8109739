"""Writes a hall lit by many lamps: `python3 bench/many_lamps.py KIND COUNT OUT.gltf`.

A floor of 20 m with 60 boxes and balls, and COUNT lamps 0.3 to 3 m above it that together give the same light whatever
their number, each of its own colour and power (over a decade). KIND is
  points    KHR_lights_punctual
  spots     the same, 25° wide, aimed downwards within 60°
  bowls     the lower parts of balls 6 cm wide, in 16 glowing triangles, all nodes of one mesh per colour
  panels    single glowing triangles 6 cm wide that look down within 40°, all in one primitive per colour
The surfaces of the last two cannot be seen from above, so that pictures from there compare light that was found, not
edges of lamps. docs/performance.md has the table.
"""

import base64
import json
import math
import random
import struct
import sys

COLORS = 8  # materials of the lamps that have a surface


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scaled(a, s):
    return [x * s for x in a]


def normalized(a):
    return scaled(a, 1 / math.sqrt(sum(x * x for x in a)))


def direction(rng):
    z, phi = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
    r = math.sqrt(1 - z * z)
    return [r * math.cos(phi), z, r * math.sin(phi)]


def downward(rng, least):
    d = direction(rng)
    while d[1] > -least:
        d = direction(rng)
    return d


def octahedron(levels):
    """Triangles of a ball of radius 1, corners outward in turn."""
    faces = []
    for x in (1, -1):
        for y in (1, -1):
            for z in (1, -1):
                face = [[x, 0, 0], [0, y, 0], [0, 0, z]]
                faces.append(face if x * y * z > 0 else face[::-1])
    for _ in range(levels):
        finer = []
        for a, b, c in faces:
            ab, bc, ca = (normalized(add(p, q)) for p, q in ((a, b), (b, c), (c, a)))
            finer += [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        faces = finer
    return faces


def box():
    faces = []
    for axis in range(3):
        for sign in (1, -1):
            def corner(u, v, axis=axis, sign=sign):
                p = [0, 0, 0]
                p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = sign, u * sign, v
                return p
            a, b, c, d = corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)
            faces += [[a, b, c], [a, c, d]]
    return faces


class Gltf:
    def __init__(self):
        self.data = bytearray()
        self.root = {"asset": {"version": "2.0", "generator": "many_lamps.py"}, "scene": 0, "scenes": [{"nodes": []}],
                     "nodes": [], "meshes": [], "materials": [], "accessors": [], "bufferViews": []}

    def material(self, color, emission=None, roughness=1.0):
        m = {"pbrMetallicRoughness": {"baseColorFactor": color + [1], "metallicFactor": 0, "roughnessFactor": roughness}}
        if emission:
            peak = max(emission)
            m["emissiveFactor"] = scaled(emission, 1 / peak)
            m["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": peak}}
        self.root["materials"].append(m)
        return len(self.root["materials"]) - 1

    def mesh(self, faces, material):
        points = [p for face in faces for p in face]
        offset = len(self.data)
        for p in points:
            self.data += struct.pack("<3f", *p)
        self.root["bufferViews"].append({"buffer": 0, "byteOffset": offset, "byteLength": 12 * len(points)})
        self.root["accessors"].append({
            "bufferView": len(self.root["bufferViews"]) - 1, "componentType": 5126, "type": "VEC3",
            "count": len(points), "min": [min(p[i] for p in points) for i in range(3)],
            "max": [max(p[i] for p in points) for i in range(3)]})
        self.root["meshes"].append({"primitives": [
            {"attributes": {"POSITION": len(self.root["accessors"]) - 1}, "material": material}]})
        return len(self.root["meshes"]) - 1

    def node(self, **what):
        self.root["nodes"].append(what)
        self.root["scenes"][0]["nodes"].append(len(self.root["nodes"]) - 1)

    def write(self, path):
        used = ["KHR_materials_emissive_strength"]
        if "extensions" in self.root:
            used.append("KHR_lights_punctual")
        self.root["extensionsUsed"] = used
        self.root["buffers"] = [{"byteLength": len(self.data),
                                 "uri": "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()}]
        with open(path, "w", encoding="ascii") as file:
            json.dump(self.root, file)


def rotation_to(axis):
    """The quaternion that turns -z to `axis`."""
    x, y, z = axis
    if z > 0.999999:
        return [0, 1, 0, 0]
    w = 1 - z
    return normalized([y, -x, 0, w])


def add_hall(gltf, rng):
    floor = gltf.material([0.6, 0.6, 0.6])
    gltf.node(mesh=gltf.mesh([[[-10, 0, -10], [-10, 0, 10], [10, 0, 10]], [[-10, 0, -10], [10, 0, 10], [10, 0, -10]]],
                             floor))
    shapes = []
    for i in range(6):
        material = gltf.material([rng.uniform(0.2, 0.8) for _ in range(3)], roughness=rng.uniform(0.3, 1))
        shapes.append(gltf.mesh(octahedron(3) if i % 2 else box(), material))
    for i in range(60):
        size = rng.uniform(0.15, 0.6)
        turn = rng.uniform(0, math.pi)
        gltf.node(mesh=shapes[i % 6], scale=[size] * 3, rotation=[0, math.sin(turn / 2), 0, math.cos(turn / 2)],
                  translation=[rng.uniform(-9, 9), size, rng.uniform(-9, 9)])


def add_lamps(gltf, rng, kind, count):
    powers = [10 ** rng.uniform(0, 1) for _ in range(count)]
    total = sum(powers)
    colors = [[rng.uniform(0.4, 1) for _ in range(3)] for _ in range(count)]
    places = [[rng.uniform(-10, 10), rng.uniform(0.3, 3), rng.uniform(-10, 10)] for _ in range(count)]
    candela = [400 * p / total for p in powers]
    if kind in ("points", "spots"):
        lights = []
        for i in range(count):
            light = {"type": "point", "color": colors[i], "intensity": candela[i]}
            where = {"translation": places[i]}
            if kind == "spots":
                light.update(type="spot", intensity=10 * candela[i], spot={"innerConeAngle": 0.15, "outerConeAngle": 0.22})
                where["rotation"] = rotation_to(downward(rng, 0.5))
            lights.append(light)
            gltf.node(**where, extensions={"KHR_lights_punctual": {"light": i}})
        gltf.root["extensions"] = {"KHR_lights_punctual": {"lights": lights}}
        return
    # Lamps with a surface: as many materials as there are colours, bright enough that the sum stays the same.
    half = 0.03
    bowl = [[scaled(p, half) for p in face] for face in octahedron(2) if sum(p[1] for p in face) < -3 * 0.7]
    area = math.pi * half * half
    for k in range(min(COLORS, count)):
        mine = range(k, count, COLORS)
        radiance = sum(candela[i] for i in mine) / (len(mine) * area)
        material = gltf.material([0.1, 0.1, 0.1], emission=scaled(colors[k], radiance))
        if kind == "bowls":
            ball = gltf.mesh(bowl, material)
            for i in mine:
                gltf.node(mesh=ball, translation=places[i])
            continue
        faces = []
        for i in mine:
            n, t = downward(rng, 0.77), direction(rng)
            b = normalized([n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2], n[0] * t[1] - n[1] * t[0]])
            t = [b[1] * n[2] - b[2] * n[1], b[2] * n[0] - b[0] * n[2], b[0] * n[1] - b[1] * n[0]]
            faces.append([add(places[i], scaled(t, half)), add(places[i], scaled(b, half)),
                          add(places[i], scaled(add(t, b), -half))])
        gltf.node(mesh=gltf.mesh(faces, material))


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in ("points", "spots", "bowls", "panels"):
        sys.exit(__doc__)
    gltf = Gltf()
    add_hall(gltf, random.Random(1))
    add_lamps(gltf, random.Random(2), sys.argv[1], int(sys.argv[2]))
    gltf.write(sys.argv[3])


main()
