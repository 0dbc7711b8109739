#!/usr/bin/env python3
"""Draws every glTF below a folder by both engines, and writes the gallery of docs/gap.md.

    tools/gap_gallery.py CANDELA MODELS_FOLDER ENVIRONMENT WORK_FOLDER [--spp 256] [--size 320x240] [--only NAME,NAME]
                         [--page docs/gap.md]

The path-traced pictures stay in WORK_FOLDER and are taken from there the next time; frames are drawn anew. With --page the
part of that file between its two marks is written anew, and the pictures beside it in images/gap/: of the models whose
licence allows it, which the table in MODELS_FOLDER/../README.md says.

Prints each model's FLIP, and the median and the worst of all. Needs ImageMagick's `convert` for --page.
"""
import argparse
import base64
import json
import pathlib
import re
import statistics
import subprocess
import sys

from contact_sheet import scene_file

BEGIN, END = "<!-- gallery -->\n", "<!-- /gallery -->\n"
FREE = {"CC0", "CC-BY 4.0"}


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1])
    return done.stdout


def compare(options, model, folder):
    """The mean FLIP of the frame; leaves truth.exr, frame.exr and pair.html in the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    truth, frame = folder / "truth.exr", folder / "frame.exr"
    common = [options.candela, "render", scene_file(model), "--env", options.environment, "--size", options.size, "-q"]
    if not truth.is_file():
        run(*common, "--spp", options.spp, "-o", truth)
    run(*common, "--engine", "raster", "-o", frame)
    judged = run(options.candela, "diff", truth, frame, "--json", "-q", "-o", folder / "pair.html")
    return json.loads(judged)["pairs"][0]["flip"]


def licences(readme):
    """Licence and author by model, from the table of that page."""
    rows = [line.split("|") for line in readme.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    return {row[1].strip(): (row[3].strip(), row[4].strip()) for row in rows if len(row) > 5}


def side_by_side(folder, output):
    page = (folder / "pair.html").read_text(encoding="utf-8")
    halves = []
    for i, (kind, data) in enumerate(re.findall(r'src="data:image/(\w+);base64,([^"]+)"', page)[:2]):
        halves.append(folder / f"{i}.{kind}")
        halves[-1].write_bytes(base64.b64decode(data))
    run("convert", *halves, "+append", "-resize", "480x", "-quality", "80", output)


def write_page(options, found):
    pictures = options.page.parent / "images" / "gap"
    pictures.mkdir(parents=True, exist_ok=True)
    allowed = licences(options.models.parent / "README.md")
    lines = ["| model | path traced, in real time | FLIP |\n", "|---|---|---|\n"]
    for name, flip in found:
        licence, author = allowed.get(name, ("", ""))
        picture = "no picture: its licence or its logo"
        is_free = licence != "" and set(licence.split("; ")) <= FREE
        if is_free:
            file = re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-") + ".jpg"
            side_by_side(options.work / name, pictures / file)
            picture = f"![{name}](images/gap/{file})"
        credit = f"<br>{author}, {licence}" if is_free else ""
        lines.append(f"| {name}{credit} | {picture} | {flip:.3f} |\n")
    text = options.page.read_text(encoding="utf-8")
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    options.page.write_text(text[:begin] + "".join(lines) + text[end:], encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("candela")
    parser.add_argument("models", type=pathlib.Path)
    parser.add_argument("environment", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--only", default="")
    parser.add_argument("--page", type=pathlib.Path)
    options = parser.parse_args()
    only = set(filter(None, options.only.split(",")))

    found = []
    for model in sorted(p for p in options.models.iterdir() if p.is_dir()):
        if scene_file(model) is None or (only and model.name not in only):
            continue
        try:
            found.append((model.name, compare(options, model, options.work / model.name)))
            print(f"{found[-1][1]:.3f} {model.name}", flush=True)
        except RuntimeError as error:
            print(f"      {model.name}: {error}", flush=True)
    if not found:
        sys.exit("no model")
    found.sort(key=lambda row: -row[1])
    flips = [flip for _, flip in found]
    print(f"{len(found)} models: median {statistics.median(flips):.3f}, worst {flips[0]:.3f} ({found[0][0]})")
    if options.page:
        write_page(options, found)


if __name__ == "__main__":
    main()
