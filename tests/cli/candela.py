"""Runs the real program in a folder of its own. Needs the standard library alone.

The environment variable CANDELA names the program [build/dev/bin/candela]; CANDELA_ASSETS a folder with models/ and environments/, which may
be absent: tests that want it skip then.
"""

import base64
import dataclasses
import json
import os
import pathlib
import pty
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("CANDELA", str(ROOT / "build/dev/bin/candela"))
TINY = ("--size", "16x12", "--spp", "2", "--threads", "2")
SKIPPED = 77  # what ctest takes for "skipped"


@dataclasses.dataclass
class Result:
    code: int
    out: str
    err: str


class CliTest(unittest.TestCase):
    """Each test starts in an empty folder, `self.folder`."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="candela-cli-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def run_candela(self, *arguments, timeout=120, **options):
        done = subprocess.run(
            [PROGRAM, *map(str, arguments)],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=options.pop("stdout", subprocess.PIPE),
            stderr=subprocess.PIPE,
            timeout=timeout,
            check=False,
            **options,
        )
        return Result(done.returncode, (done.stdout or b"").decode(), done.stderr.decode())

    def on_terminal(self, *arguments, environment=None):
        """Its exit code, and what a terminal gets that is its standard error."""
        try:
            master, slave = pty.openpty()
        except OSError as error:
            self.skipTest(f"no terminals here: {error}")
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL, stderr=slave,
                                   env={**(environment or os.environ), "TERM": "xterm"})  # fmt: skip
        os.close(slave)
        seen = b""
        while True:
            try:
                block = os.read(master, 4096)
            except OSError:
                break
            if not block:
                break
            seen += block
        os.close(master)
        return process.wait(), seen.decode()

    def start_candela(self, *arguments):
        process = subprocess.Popen(
            [PROGRAM, *map(str, arguments)],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def succeeds(self, *arguments, **options):
        result = self.run_candela(*arguments, **options)
        self.assertEqual(result.code, 0, result.err)
        return result

    def fails(self, *arguments, says, **options):
        """Bad input: exit code 1, one line that says what, and no file left behind."""
        before = sorted(self.folder.rglob("*"))
        result = self.run_candela(*arguments, **options)
        self.assertEqual(result.code, 1, result.err)
        self.assertEqual(result.err.count("\n"), 1, result.err)
        self.assertTrue(result.err.startswith("candela: "), result.err)
        self.assertRegex(result.err, says)
        self.assertEqual(sorted(self.folder.rglob("*")), before, "a file was left behind")
        return result

    def refuses(self, *arguments, says):
        """Wrong usage: exit code 2, one line that says what, a hint, and no file left behind."""
        result = self.run_candela(*arguments)
        self.assertEqual(result.code, 2, result.err)
        self.assertEqual(result.err.count("\n"), 2, result.err)
        self.assertTrue(result.err.startswith("candela: "), result.err)
        self.assertRegex(result.err.splitlines()[0], says)
        self.assertIn("--help", result.err.splitlines()[1])
        self.assertEqual(list(self.folder.iterdir()), [], "a file was left behind")
        return result

    def assets(self):
        folder = pathlib.Path(os.environ.get("CANDELA_ASSETS", "/nonexistent"))
        if not (folder / "models").is_dir():
            self.skipTest(f"CANDELA_ASSETS ({folder}) is absent")
        return folder

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())


def triangle_glb(light=None, material=None, planes=None):
    """One triangle 2 m wide in the plane z = 0, and two cameras in front of it: "near", and one on the node "far".
    `light` of KHR_lights_punctual hangs 2 m in front of its middle; `material` is the triangle's, `planes` more of the cameras'."""
    positions = struct.pack("<9f", -1, 0, 0, 1, 0, 0, 0, 2, 0)
    lens = {"yfov": 0.8, "znear": 0.1, **(planes or {})}
    scene = {
        "asset": {"version": "2.0", "generator": "candela tests"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"mesh": 0},
            {"camera": 0, "translation": [0, 1, 3]},
            {"camera": 1, "translation": [0, 1, 6], "name": "far"},
        ],
        "cameras": [
            {"type": "perspective", "name": "near", "perspective": lens},
            {"type": "perspective", "perspective": lens},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 0, 0], "max": [1, 2, 0]}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(positions)}],
        "buffers": [{"byteLength": len(positions)}],
    }
    if light:
        scene["nodes"].append({"translation": [0, 1, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}})
        scene["scenes"][0]["nodes"].append(3)
        scene["extensionsUsed"] = ["KHR_lights_punctual"]
        scene["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    if material:
        scene["materials"] = [material]
        scene["meshes"][0]["primitives"][0]["material"] = 0
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(positions), b"BIN\0") + positions
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def variants_gltf():
    """One triangle that fills most of a picture and shines green; its variant "sunset" shines red and has a coat."""
    positions = base64.b64encode(struct.pack("<9f", -4, -4, 0, 4, -4, 0, 0, 8, 0)).decode()
    coat = {"extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1}}}
    dressed = {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [1]}]}}
    scene = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_variants", "KHR_materials_clearcoat"],
        "extensions": {"KHR_materials_variants": {"variants": [{"name": "noon"}, {"name": "sunset"}]}},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0, "extensions": dressed}]}],
        "materials": [
            {"name": "green", "emissiveFactor": [0, 1, 0]},
            {"name": "red", "emissiveFactor": [1, 0, 0], **coat},
        ],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + positions}],
    }
    return json.dumps(scene)


def png_pixels(path):
    """(width, height, channels, rows of bytes) of an 8-bit PNG; raises for anything that is not whole."""
    width, height, bits, channels, rows = png_rows(path)
    assert bits == 8
    return width, height, channels, rows


def png_numbers(path):
    """(width, height, bits, rows of numbers) of a grey PNG."""
    width, height, bits, channels, rows = png_rows(path)
    assert channels == 1
    size = bits // 8
    return width, height, bits, [[int.from_bytes(r[size * x : size * (x + 1)], "big") for x in range(width)] for r in rows]


def png_rows(path):
    """(width, height, bits, channels, rows of bytes)."""
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    at, packed, header, ended = 8, b"", None, False
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        assert zlib.crc32(kind + body) == struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0], "bad checksum"
        if kind == b"IHDR":
            header = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        ended = kind == b"IEND"
        at += 12 + size
    assert ended, "cut short"
    width, height, bits, color = header
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    step = channels * bits // 8
    raw, stride, rows = zlib.decompress(packed), width * step, []
    assert len(raw) == height * (stride + 1), "wrong size"
    previous = bytearray(stride)
    for y in range(height):
        kind, *row = raw[y * (stride + 1) : (y + 1) * (stride + 1)]
        row = bytearray(row)
        for i in range(stride):
            left = row[i - step] if i >= step else 0
            up, corner = previous[i], previous[i - step] if i >= step else 0
            row[i] = (row[i] + predict(kind, left, up, corner)) & 255
        rows.append(bytes(row))
        previous = row
    return width, height, bits, channels, rows


def predict(kind, left, up, corner):
    if kind == 4:  # Paeth
        guess = left + up - corner
        return min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
    return (0, left, up, (left + up) // 2)[kind]


def main():
    """Like unittest.main, but a run in which every test was skipped says so to ctest."""
    program = unittest.main(module="__main__", exit=False, verbosity=2)
    result = program.result
    if not result.wasSuccessful():
        sys.exit(1)
    sys.exit(SKIPPED if result.skipped and len(result.skipped) == result.testsRun else 0)
