#!/usr/bin/env python3
"""Every packed file of the assets is drawn as its plain twin is, by both engines.

    test_assets.py [--table] [--keep FOLDER] [NAME...]

CANDELA_ASSETS is a folder with models/ and compression/, without which nothing is tested (exit code 77). A plain twin is another variant of
the same model, what the file itself holds as a fallback, or what the decoders of npm make of the file (decode_plain.mjs; CANDELA_NODE_MODULES
names the folder that install.sh makes). --table prints the table of docs/formats.md, --keep leaves the pictures in FOLDER.
"""

import collections
import json
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "cli")]

from candela import PROGRAM, SKIPPED, png_pixels  # noqa: E402
from sources import png  # noqa: E402

ASSETS = pathlib.Path(os.environ.get("CANDELA_ASSETS", "/nonexistent"))
MODULES = os.environ.get("CANDELA_NODE_MODULES", "")
ENGINES = ("path", "raster")
WIDTH, HEIGHT = 160, 120

# What a codec loses, at most: codes of 255 in the mean over the subject, and a share of its mean light. The subject is about 100 pixels high.
# - Of the same numbers in another container, or unpacked by another decoder, nothing. UASTC in sRGB rounds half codes the other way.
# - Quantised: positions of 14 to 16 bits move nothing that is seen, coordinates of 12 bits a texture by a quarter of its texels,
#   normals of 8 bits turn by 0.2 degrees.
# - Draco, as these files have it: positions of 11 bits move edges by a fortieth of a pixel, coordinates of 10 bits textures by up to a texel,
#   octahedral normals of 8 bits turn by 0.3 degrees. A thin limb is covered in steps of a quarter pixel by the rasterizer.
# - ETC1S has one colour and four brightnesses for 4x4 texels, 2 to 4 codes of them; UASTC loses less than one.
Bound = collections.namedtuple("Bound", "codes light")
BOUNDS = {
    "container": Bound(0, 0),
    "fallback": Bound(0, 0),
    "unpacked by npm": Bound(0, 0),
    "UASTC unpacked by npm": Bound(0.01, 0.0001),
    "quantised": Bound(0.5, 0.002),
    "meshopt": Bound(0.5, 0.002),
    "Draco": Bound(1.5, 0.005),
    "ETC1S": Bound(1.5, 0.015),
    "UASTC": Bound(0.2, 0.005),
}

# `file` is what is compared with `plain`.
Pair = collections.namedtuple("Pair", "codec name file plain")


def plain_of(model):
    """The variant that the others of a model are compared with."""
    for variant in ("glTF-Binary", "glTF"):
        files = scenes_in(model / variant)
        if files:
            return files[0]
    return None


def scenes_in(folder):
    return sorted(p for p in folder.glob("*") if p.suffix in (".gltf", ".glb"))


def variants():
    codecs = {"glTF-Draco": "Draco", "glTF-Meshopt": "meshopt", "glTF-Quantized": "quantised"}
    for model in sorted((ASSETS / "models").iterdir()):
        plain = plain_of(model)
        for folder in sorted(model.glob("glTF*")):
            for file in scenes_in(folder):
                if plain and file != plain:
                    yield Pair(codecs.get(folder.name, "container"), f"{model.name}/{folder.name}", file, plain)


def from_octahedron(x, y):
    """A signed byte each, as EXT_meshopt_compression's filter unpacks them."""
    z = 127 - abs(x) - abs(y)
    fold = max(-z, 0)
    x, y = (v + (fold if v < 0 else -fold) for v in (x, y))
    scale = 127 / math.sqrt(x * x + y * y + z * z)
    return [int(v * scale + math.copysign(0.5, v)) for v in (x, y, z)]


def fallback_twin(file, folder):
    """The file without meshopt, so that what it holds for readers that cannot unpack is shown. Its writer left the normals there as the codes
    that its filter was to unpack; that is done here."""
    gltf = json.loads(file.read_text())
    folder.mkdir()
    for buffer in gltf["buffers"]:
        shutil.copy(file.parent / buffer["uri"], folder)
    fallback = folder / gltf["buffers"][1]["uri"]
    data = bytearray(fallback.read_bytes())
    for view in gltf["bufferViews"]:
        if view["extensions"]["EXT_meshopt_compression"].get("filter") == "OCTAHEDRAL":
            for at in range(view["byteOffset"], view["byteOffset"] + view["byteLength"], 4):
                struct.pack_into("3b", data, at, *from_octahedron(*struct.unpack_from("2b", data, at)))
    fallback.write_bytes(data)
    for part in gltf["bufferViews"] + gltf["buffers"]:
        part.pop("extensions", None)
    gltf["extensionsUsed"] = [name for name in gltf["extensionsUsed"] if "meshopt" not in name]
    (folder / "plain.gltf").write_text(json.dumps(gltf))
    return folder / "plain.gltf"


def samples(folder):
    """What compression/ holds: files that share a source."""
    top = ASSETS / "compression"
    pipeline = top / "gltf-pipeline"
    plain = fallback_twin(pipeline / "EXT_meshopt-fallback/meshopt-fallback.gltf", folder / "fallback")
    for file in sorted(pipeline.glob("*/*.gltf")):
        yield Pair("fallback", f"gltf-pipeline/{file.parent.name}", file, plain)
    box = plain_of(ASSETS / "models/Box")
    for name, codec in (("BoxDraco.gltf", "Draco"), ("BoxMeshopt.gltf", "meshopt"), ("BoxMeshopt.glb", "meshopt")):
        yield Pair(codec, f"gltf-transform/{name}", top / "gltf-transform" / name, box)


def textured_square(picture, extension, folder):
    """A square that shows a picture as it is."""
    corners = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
    data = corners + struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    folder.mkdir(exist_ok=True)
    shutil.copy(picture, folder)
    gltf = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit", *([extension] if extension else [])],
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "extensions": {"KHR_materials_unlit": {}}}],
        "textures": [{"extensions": {extension: {"source": 0}}} if extension else {"source": 0}],
        "images": [{"uri": picture.name}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12},
        ],
        "buffers": [{"uri": "square.bin", "byteLength": len(data)}],
    }
    (folder / "square.bin").write_bytes(data)
    file = folder / f"{picture.stem}.gltf"
    file.write_text(json.dumps(gltf))
    return file


def plain_picture(ktx2, channels, folder):
    """The largest level of a KTX 2 of plain bytes as PNG."""
    data = ktx2.read_bytes()
    width, height = struct.unpack_from("<2I", data, 20)
    offset, size = struct.unpack_from("<2Q", data, 80)
    assert size == channels * width * height

    def texel(x, y):
        at = offset + channels * (y * width + x)
        return (*data[at : at + 3], data[at + 3] if channels == 4 else 255)

    file = folder / f"{ktx2.stem}.png"
    file.write_bytes(png(width, height, texel))
    return file


def bare_textures(folder):
    """Textures without a scene, each of which shows its own name: shown on a square. Floats and the blocks of graphics cards cannot stand in
    a glTF."""
    own = ASSETS / "compression/gltf-transform"
    for name, channels in (("2d_rgb8.ktx2", 3), ("2d_rgba8.ktx2", 4)):
        plain = textured_square(plain_picture(own / name, channels, folder), None, folder / "plain")
        yield Pair("container", f"gltf-transform/{name}", textured_square(own / name, "KHR_texture_basisu", folder / "ktx2"), plain)
    for name in ("2d_etc1s.ktx2", "2d_uastc.ktx2"):
        file = textured_square(own / name, "KHR_texture_basisu", folder / "ktx2")
        yield from unpacked(file, f"gltf-transform/{name}", folder, "UASTC unpacked by npm" if "uastc" in name else "unpacked by npm")


def has_npm():
    return bool(MODULES and shutil.which("node"))


def unpacked(file, name, folder, codec="unpacked by npm"):
    """A packed file and what npm's decoders make of it."""
    if has_npm():
        own = pathlib.Path(tempfile.mkdtemp(dir=folder))
        subprocess.run(["node", HERE / "decode_plain.mjs", file, own], check=True)
        yield Pair(codec, name, file, own / "plain.gltf")


def packed_files(folder):
    """All that is packed, whether or not there is a plain variant of it."""
    for file in sorted(ASSETS.rglob("*.gl*")):
        if file.suffix in (".gltf", ".glb") and b"compression" in file.read_bytes() or "Basisu" in file.parent.name:
            yield from unpacked(file, f"{file.parent.parent.name}/{file.parent.name}/{file.name}", folder)


def encoded(folder):
    """Plain models whose pictures npm's encoder packs."""
    for model in ("BoxTextured", "CesiumMan", "CesiumMilkTruck", "Fox", "IridescenceSuzanne"):
        plain = plain_of(ASSETS / "models" / model)
        for codec in ("ETC1S", "UASTC"):
            if has_npm():
                file = folder / f"{model}-{codec}.glb"
                subprocess.run(["node", HERE / "encode_basis.mjs", plain, file, codec.lower()], check=True)
                yield Pair(codec, model, file, plain)


def view_of(scene):
    """Options that show all of it from one side, at a moment at which what is animated has moved."""
    done = subprocess.run([PROGRAM, "info", "--json", scene], capture_output=True, check=True)
    info = json.loads(done.stdout)
    lower, upper = info["bounds"]["lower"], info["bounds"]["upper"]
    middle = [(a + b) / 2 for a, b in zip(lower, upper)]
    reach = 1.5 * sum((b - a) ** 2 for a, b in zip(lower, upper)) ** 0.5
    eye = [m + reach * d for m, d in zip(middle, (0.48, 0.36, 0.8))]
    options = ["--eye", ",".join(map(str, eye)), "--target", ",".join(map(str, middle)), "--fov", "40deg"]
    if info.get("animation_list"):
        options += ["--animation", "all", "--frame-time", f"{0.4 * max(a['duration_s'] for a in info['animation_list'])}s"]
    return options


def radiance(file):
    """All floats of a Radiance picture."""
    data = file.read_bytes()
    at = data.index(b"\n\n") + 2
    at = data.index(b"\n", at) + 1
    values = []
    for _ in range(HEIGHT):
        planes = []
        at += 4
        for _ in range(4):
            row = bytearray()
            while len(row) < WIDTH:
                count = data[at]
                run = count > 128
                row += data[at + 1 : at + 2] * (count - 128) if run else data[at + 1 : at + 1 + count]
                at += 2 if run else 1 + count
            planes.append(row)
        values += [m * 2.0 ** (e - 136) for *rgb, e in zip(*planes) for m in rgb]
    return values


def picture(scene, engine, view, stem):
    """Its codes with coverage, and its light."""
    outputs = [f"{stem}.png", f"{stem}.hdr"]
    command = [PROGRAM, "render", scene, "-q", "--engine", engine, "--size", f"{WIDTH}x{HEIGHT}", "--env", "studio"]
    command += [*view, "--exposure", "0", "--background", "transparent", *(part for o in outputs for part in ("-o", o))]
    command += ["--spp", "64"] if engine == "path" else []
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.decode().strip())
    _, _, channels, rows = png_pixels(outputs[0])
    assert channels == 4
    return b"".join(rows), radiance(pathlib.Path(outputs[1]))


def difference(found, wanted):
    """Mean over what either shows, in codes of premultiplied colour, and the mean light's relative difference."""
    total, count = 0.0, 0
    for i in range(0, len(wanted[0]), 4):
        a, b = found[0][i : i + 4], wanted[0][i : i + 4]
        if a[3] or b[3]:
            total += sum(abs(x * a[3] - y * b[3]) for x, y in zip(a[:3], b[:3])) / (3 * 255)
            count += 1
    light, reference = sum(found[1]), sum(wanted[1])
    assert count > 0.02 * WIDTH * HEIGHT and reference > 0, "the subject is hardly seen"
    return total / count, abs(light / reference - 1)


def judge(pair, pictures, folder):
    """The differences by engine."""
    if pair.plain not in pictures:
        view = view_of(pair.plain)
        stem = folder / f"{len(pictures)}-plain"
        pictures[pair.plain] = view, {engine: picture(pair.plain, engine, view, f"{stem}-{engine}") for engine in ENGINES}
    view, wanted = pictures[pair.plain]
    stem = folder / (pair.codec + "-" + pair.name).replace("/", "-").replace(" ", "-")
    return {engine: difference(picture(pair.file, engine, view, f"{stem}-{engine}"), wanted[engine]) for engine in ENGINES}


def print_table(worst):
    print("| codec | files | `path`: codes, light | `raster`: codes, light | at most |\n|---|---|---|---|---|")
    for codec, found in worst.items():
        cells = [f"{max(f[e][0] for f in found):.2f}, {max(f[e][1] for f in found):.2%}" for e in ENGINES]
        print(f"| {codec} | {len(found)} | " + " | ".join(cells) + f" | {BOUNDS[codec].codes}, {BOUNDS[codec].light:.2%} |")


def main():
    arguments = sys.argv[1:]
    if not (ASSETS / "compression").is_dir():
        print(f"skipped: CANDELA_ASSETS ({ASSETS}) is absent", file=sys.stderr)
        return SKIPPED
    keep = arguments[arguments.index("--keep") + 1] if "--keep" in arguments else None
    wanted = [a for a in arguments if not a.startswith("--") and a != keep]
    failures, worst, pictures = [], collections.defaultdict(list), {}
    with tempfile.TemporaryDirectory(prefix="candela-assets-") as top:
        folder = pathlib.Path(keep or top)
        folder.mkdir(parents=True, exist_ok=True)
        own = pathlib.Path(top)
        if not has_npm():
            print("skipped: what npm's decoders and encoders make (node or CANDELA_NODE_MODULES is absent)", file=sys.stderr)
        for pair in (*variants(), *samples(own), *bare_textures(own), *packed_files(own), *encoded(own)):
            if wanted and not any(w in f"{pair.codec} {pair.name}" for w in wanted):
                continue
            found = judge(pair, pictures, folder)
            worst[pair.codec].append(found)
            bad = any(found[e][0] > BOUNDS[pair.codec].codes or found[e][1] > BOUNDS[pair.codec].light for e in ENGINES)
            failures += [pair.name] if bad else []
            said = ", ".join(f"{e} {found[e][0]:.3f} codes {found[e][1]:.3%}" for e in ENGINES)
            print(f"{'FAILED ' if bad else ''}{pair.codec}: {pair.name}: {said}", file=sys.stderr, flush=True)
    if "--table" in arguments:
        print_table(worst)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
