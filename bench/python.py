#!/usr/bin/env python3
"""What the Python package costs: bench/python.py CANDELA SCENE.glb

Run it by a Python that has the package. Prints, each the median of so many fresh processes and the least:
- `import candela`, after an interpreter that has started, and what of it numpy would cost;
- loading the scene, drawing it at 256 x 256 by the rasterizer, and having it as an array, beside the same work of the program without
  its start (what --stats says, less writing the file). Both find the environment's bake and the driver's shaders in a cache.
- a second picture of the same scene from elsewhere.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

RUNS = 11

IMPORT = "import time; t = time.perf_counter(); import {}; print(time.perf_counter() - t)"
PICTURE = """
import numpy, candela, time
t = time.perf_counter()
scene = candela.load({!r})
picture = candela.render(scene, size=(256, 256), engine="raster")
beauty = picture["beauty"]
print(time.perf_counter() - t)
t = time.perf_counter()
candela.render(scene, size=(256, 256), engine="raster", camera=candela.fit("left"))["beauty"]
print(time.perf_counter() - t)
"""


def text(seconds):
    return f"{1000 * statistics.median(seconds):.1f} ms (least {1000 * min(seconds):.1f})"


def main():
    program, scene = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache"), "MESA_SHADER_CACHE_DIR": str(folder / "cache")}

        def python(code):
            return [float(line) for line in subprocess.check_output([sys.executable, "-c", code], text=True, env=environment).split()]

        def of_program():
            subprocess.run([program, "render", scene, "--size", "256x256", "--engine", "raster", "-q", "-o", folder / "a.exr", "--stats",
                            folder / "s.json"], check=True, env=environment)  # fmt: skip
            times = json.loads((folder / "s.json").read_text())
            return times["total_s"] - times["write_s"]

        of_program(), python(PICTURE.format(scene))
        for module in ("candela", "numpy"):
            print(f"import {module}: {text([python(IMPORT.format(module))[0] for _ in range(RUNS)])}")
        here, there, again = [], [], []
        for _ in range(RUNS):  # one after the other, so that a busy machine slows both
            first, second = python(PICTURE.format(scene))
            here.append(first), again.append(second), there.append(of_program())
        print(f"load + render + array: {text(here)}; program {text(there)}; ratio {statistics.median(here) / statistics.median(there):.2f}")
        print(f"from elsewhere: {text(again)}")


if __name__ == "__main__":
    main()
