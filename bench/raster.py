#!/usr/bin/env python3
"""How fast the real-time renderer is: bench/raster.py CANDELA SCENE ENV [WxH]

Prints the wall time of the whole process with nothing cached (neither the environment's bake nor the driver's shaders) and with both
cached, the least of five runs each, and milliseconds per frame, from the difference of 17 frames and 1, on a view that a
helmet of 2 m fills half of; beside it
those of the barest shader with light from an image (bench_bare_light, where it lies beside CANDELA). bench/three/run.mjs has three.js.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time


def run(folder, *arguments, cache):
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache), "MESA_SHADER_CACHE_DIR": str(cache)}
    begin = time.monotonic()
    subprocess.run([*map(str, arguments), "--engine", "raster", "-q", "-o", folder / "a.png", "--stats", folder / "s.json"],
                   check=True, env=environment)  # fmt: skip
    return time.monotonic() - begin, json.loads((folder / "s.json").read_text())


def main():
    program, scene, env, *rest = sys.argv[1:]
    common = [program, "render", scene, "--env", env, "--eye", "1,0.66,1.5", "--target", "0,0,0", "--fov", "45deg", "--size", rest[0] if rest else "1280x720"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        first = min(run(folder, *common, cache=folder / f"first{i}")[0] for i in range(5))
        cache = folder / "cache"
        _, stats = run(folder, *common, cache=cache)
        cached = min(run(folder, *common, cache=cache)[0] for _ in range(5))
        print(f"{stats['driver']}\nfirst {first:.2f} s, cached {cached:.2f} s")

        def frame_ms(options, what, times):
            one = min(run(folder, *options, "--spp", 1, cache=cache)[1][what] for _ in range(times))
            many = min(run(folder, *options, "--spp", 17, cache=cache)[1][what] for _ in range(times))
            return 1000 * (many - one) / 16

        bare = pathlib.Path(program).parent / "bench_bare_light"
        if bare.exists():
            plain = [*common, "--msaa", 1]
            run(folder, *plain, "--spp", 2, cache=cache)
            runs, ratios = [], []
            for _ in range(5):  # one after the other, so that a busy machine slows both
                runs.append(subprocess.check_output([bare, common[-1]], text=True).splitlines())
                ratios.append(frame_ms(plain, "draw_s", 1) / float(runs[-1][-1].split()[0]))
            print("ms per frame of bare shaders that fill the picture:", *map(min, zip(*runs)), sep="\n")
            print(f"a frame with one sample takes {sorted(ratios)[2]:.2f} times the last ({min(ratios):.2f} to {max(ratios):.2f})")
        for msaa in (1, 4):
            for ao in ("0", "0.05"):
                options = [*common, "--msaa", msaa, "--ao", ao]
                run(folder, *options, "--spp", 2, cache=cache)
                ms, read = frame_ms(options, "draw_s", 3), frame_ms(options, "frame_s", 3)
                print(f"msaa {msaa} ao {ao}: {ms:.0f} ms per frame, {read:.0f} ms with reading it back")


if __name__ == "__main__":
    main()
