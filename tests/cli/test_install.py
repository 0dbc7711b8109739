#!/usr/bin/env python3
"""What `cmake --install` puts into a folder: all of it, and it works from wherever that folder is."""

import os
import pathlib
import re
import shutil
import subprocess

import candela
from candela import CliTest, PROGRAM, ROOT, TINY, png_pixels

BUILD = pathlib.Path(PROGRAM).resolve().parents[1]


class Install(CliTest):
    def install(self):
        cmake = shutil.which("cmake")
        if not cmake or not (BUILD / "cmake_install.cmake").is_file():
            self.skipTest(f"{BUILD} is no folder of a build")
        prefix = self.folder / "prefix"
        subprocess.run([cmake, "--install", BUILD, "--prefix", prefix, "--component", "program"], check=True, stdout=subprocess.DEVNULL)
        return prefix

    def test_a_moved_folder_renders_through_a_link(self):
        moved = self.install().rename(self.folder / "another place")
        (self.folder / "bin").mkdir()
        (self.folder / "bin/candela").symlink_to(moved / "bin/candela")
        environment = {"PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}"}
        subprocess.run(["candela", "render", "demo:spheres", *TINY, "-o", "a.png", "-q"], cwd=self.folder, env=environment, check=True)
        self.assertEqual(png_pixels(self.folder / "a.png")[:2], (16, 12))
        # The verb worker looks for the program beside itself, a plan's lines are run by a shell.
        (self.folder / "jobs.txt").write_text("candela --version > version.txt\n")
        subprocess.run([moved / "bin/candela", "worker", "jobs.txt", "-q"], cwd=self.folder, env={"PATH": "/usr/bin:/bin"}, check=True)
        self.assertEqual((self.folder / "version.txt").read_text(), self.succeeds("--version").out)

    def test_manual_completion_thumbnails_and_examples_are_where_systems_look(self):
        prefix = self.install()
        pages = {page.name for page in (prefix / "share/man/man1").iterdir()}
        verbs = re.findall(r"^  ([a-z]+) +\S", self.succeeds("--help").out.partition("Verbs:")[2], re.MULTILINE)
        self.assertEqual(pages, {"candela.1", *(f"candela-{verb}.1" for verb in verbs)})
        self.assertEqual((prefix / "share/bash-completion/completions/candela").read_text(), self.succeeds("completion", "bash").out)
        self.assertEqual((prefix / "share/zsh/site-functions/_candela").read_text(), self.succeeds("completion", "zsh").out)
        self.assertIn("TryExec=candela", (prefix / "share/thumbnailers/candela.thumbnailer").read_text())
        farm = {path.name for path in (prefix / "share/doc/candela/examples/farm").iterdir()}
        self.assertEqual(farm, {path.name for path in (ROOT / "examples/farm").iterdir()})
        self.assertTrue(os.access(prefix / "share/doc/candela/examples/farm/slurm.sh", os.X_OK))

    def test_the_program_alone_brings_no_library(self):
        prefix = self.install()
        self.assertEqual({path.name for path in prefix.iterdir()}, {"bin", "share"})


if __name__ == "__main__":
    candela.main()
