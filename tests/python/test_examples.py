"""The examples do what they say, at a small size."""

import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from support import Case, has_opengl, main

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "examples/python"
ENGINE = "raster" if has_opengl() else "path"


class Examples(Case):
    def run_example(self, name, *arguments):
        ran = subprocess.run([sys.executable, FOLDER / name, *arguments], capture_output=True, text=True, timeout=500,
                             env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})  # fmt: skip
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        return ran.stdout

    def test_data_set_has_twenty_models_and_is_coco(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            out = self.run_example("dataset.py", "-o", folder / "set", "-n", "16", "--size", "64", "--engine", ENGINE,
                                   "--preview", folder / "preview.png")  # fmt: skip
            self.assertIn("16 pictures of 20 models", out)
            made = json.loads((folder / "set/annotations.json").read_text())
            self.assertEqual(len(made["images"]), 16)
            self.assertEqual(len({c["name"] for c in made["categories"]}), 20)
            self.assertGreater(len(made["annotations"]), 3 * 16)
            for image in made["images"]:
                self.assertTrue((folder / "set" / image["file_name"]).read_bytes().startswith(b"\x89PNG"))
            self.assertTrue((folder / "preview.png").exists())
            if importlib.util.find_spec("pycocotools"):
                from pycocotools.coco import COCO

                theirs = COCO(str(folder / "set/annotations.json"))
                for annotation in made["annotations"]:
                    self.assertEqual(theirs.annToMask(annotation).sum(), annotation["area"])

    def test_turntable_is_a_film(self):
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("webp", "gif"):
                film = pathlib.Path(folder, "turn." + ending)
                self.assertIn("4 pictures", self.run_example("turntable.py", "-o", film, "-n", "4", "--size", "48", "--engine", ENGINE))
                data = film.read_bytes()
                self.assertEqual(data.count(b"ANMF" if ending == "webp" else b"\x21\xf9\x04"), 4)

    def test_search_finds_where_the_picture_was_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            film = pathlib.Path(folder, "search.webp")
            out = self.run_example("find_camera.py", "--steps", "6", "--spp", "16", "--film", film)
            lines = re.findall(r"azimuth ([\d.]+), elevation ([\d.]+), distance ([\d.]+)(?:, error ([\d.]+))?", out)
            before, found, truth = lines[0], lines[-2], lines[-1]
            for number, (a, b) in enumerate(zip(found[:3], truth[:3])):
                self.assertLess(abs(float(a) - float(b)), (2.0, 0.5, 0.03)[number], out)
            self.assertLess(10 * float(found[3]), float(before[3]), out)
            self.assertGreater(film.read_bytes().count(b"ANMF"), 3)  # equal frames in a row are one

    def test_lines_of_the_readme_run_as_they_stand(self):
        text = (FOLDER.parents[1] / "README.md").read_text()
        (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        picture = re.search(r'save\("([^"]+)"\)', code).group(1)
        self.assertIn(f"]({picture})", text)  # which the page shows
        small = code.replace("(512, 512), spp=64", "(48, 48), spp=4")
        self.assertNotEqual(small, code)
        with tempfile.TemporaryDirectory() as folder:
            made = pathlib.Path(folder, picture)
            made.parent.mkdir(parents=True)
            ran = subprocess.run([sys.executable, "-c", small + 'assert picture["depth"].shape == (48, 48)'], cwd=folder,
                                 capture_output=True, text=True, env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)})  # fmt: skip
            self.assertEqual((ran.returncode, ran.stderr), (0, ""))
            self.assertTrue(made.read_bytes().startswith(b"\xff\xd8"))


if __name__ == "__main__":
    main()
