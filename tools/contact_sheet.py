#!/usr/bin/env python3
"""Renders every glTF below a folder small and puts the pictures on one sheet, so that a person can look at all of them.

    tools/contact_sheet.py CANDELA MODELS_FOLDER -o sheet.png [--spp 64] [--size 240] [--columns 8] [--only NAME,NAME]
                           [--both] [-- further options of `candela render`]

With --both each model is there twice, side by side: by the path tracer, and by the rasterizer in four frames.

Prints each model's warnings and failures. Needs ImageMagick's `montage` and the DejaVu fonts for the sheet.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

PREFERRED = ["glTF-Binary", "glTF", "glTF-Embedded", "glTF-Quantized", "glTF-Draco", "glTF-Meshopt", "glTF-KTX2-Basisu"]


def scene_file(model: pathlib.Path):
    """The variant of a model folder that is simplest to read, or None."""
    for variant in PREFERRED:
        files = sorted((model / variant).glob("*.gl*"))
        if files:
            return files[0]
    files = sorted(model.glob("*.gl*"))
    return files[0] if files else None


def main():
    arguments = sys.argv[1:]
    further = []
    if "--" in arguments:
        split = arguments.index("--")
        arguments, further = arguments[:split], arguments[split + 1:]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("candela")
    parser.add_argument("models", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--size", type=int, default=240)
    parser.add_argument("--columns", type=int, default=8)
    parser.add_argument("--only", default="")
    parser.add_argument("--both", action="store_true")
    options = parser.parse_args(arguments)

    only = set(filter(None, options.only.split(",")))
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        tiles = []
        for model in sorted(p for p in options.models.iterdir() if p.is_dir()):
            scene = scene_file(model)
            if scene is None or (only and model.name not in only):
                continue
            size = f"{options.size}x{options.size}"
            engines = [("path", options.spp)] + ([("raster", 4)] if options.both else [])
            shown = []
            for engine, samples in engines:
                picture = pathlib.Path(folder) / f"{len(tiles) // 3:03}-{engine}.png"
                command = [options.candela, "render", str(scene), "-o", str(picture), "--size", size, "--engine", engine,
                           "--spp", str(samples), *further]
                run = subprocess.run(command, capture_output=True, text=True)
                for line in run.stderr.splitlines():
                    if "warning:" in line or line.startswith("candela:"):
                        print(f"{model.name}, {engine}: {line}")
                if run.returncode == 0:
                    label = f"{model.name}, {engine}" if options.both else model.name
                    shown += ["-label", label, str(picture)]
            # Pairs stay pairs.
            if len(shown) == 3 * len(engines):
                tiles += shown
            else:
                failed += 1
        columns = min(options.columns, max(len(tiles) // 3, 1))
        subprocess.run(["montage", *tiles, "-tile", f"{columns}x", "-geometry", "+4+4", "-pointsize", "13",
                        "-font", "DejaVu-Sans", "-background", "#202020", "-fill", "white", str(options.output)], check=True)
    print(f"{options.output}: {len(tiles) // 3} pictures, {failed} failed")


if __name__ == "__main__":
    main()
