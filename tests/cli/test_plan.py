"""candela render --pictures and candela plan: work that is divided makes what the whole would have made."""

import os
import pathlib
import subprocess

import candela
from candela import CliTest, triangle_glb, variants_gltf

TINY = ("--size", "32x24", "--spp", "16", "--env", "sky")
FIXED = ("--exposure", "0")


class Pictures(CliTest):
    def folder_bytes(self, name):
        return {path.name: path.read_bytes() for path in sorted((self.folder / name).iterdir())}

    def test_some_of_a_set_are_those_of_the_whole(self):
        for engine in ("path", "raster"):
            turntable = ("render", "demo:spheres", *TINY[:2], "--spp", "4", "--env", "sky", "--engine", engine, "--turntable", "5", *FIXED)
            self.succeeds(*turntable, "-o", f"{engine}/all-%03d.png")
            self.succeeds(*turntable, "-o", f"{engine}-some/all-%03d.png", "--pictures", "2-3")
            self.succeeds(*turntable, "-o", f"{engine}-some/all-%03d.png", "--pictures", "5")
            whole, some = self.folder_bytes(engine), self.folder_bytes(engine + "-some")
            self.assertEqual(sorted(some), ["all-001.png", "all-002.png", "all-004.png"])
            for name, data in some.items():
                self.assertEqual(data, whole[name], name)

    def test_some_of_several_looks_are_those_of_the_whole(self):
        (self.folder / "dress.gltf").write_text(variants_gltf())
        for engine in ("path", "raster"):
            looks = ("render", "dress.gltf", "--size", "16x12", "--spp", "1", "--engine", engine, "--variants", "all", "--views", "front,iso")
            self.succeeds(*looks, "-o", engine + "/{variant}-{view}.png")
            whole = self.folder_bytes(engine)
            for i in range(4):
                self.succeeds(*looks, "-o", f"{engine}-{i}/{{variant}}-{{view}}.png", "--pictures", i + 1, *FIXED)
                ((name, data),) = self.folder_bytes(f"{engine}-{i}").items()
                self.assertEqual(data, whole[name], name)

    def test_ranges_are_metered_alike(self):
        # The triangle's back is in its own shadow: each picture for itself would have another exposure.
        lamp = {"type": "point", "intensity": 40}
        (self.folder / "lit.glb").write_bytes(triangle_glb(light=lamp, material={"doubleSided": True}))
        for engine in ("path", "raster"):
            turn = ("render", "lit.glb", "--size", "24x24", "--spp", "16", "--engine", engine, "--env", "none", "--exposure", "auto", "--turntable", "4")
            self.succeeds(*turn, "-o", f"{engine}/%03d.png", "--pictures", "1-4")
            for i in range(4):
                self.succeeds(*turn, "-o", f"{engine}-one/%03d.png", "--pictures", i + 1)
            self.assertEqual(self.folder_bytes(engine), self.folder_bytes(engine + "-one"))
            pictures = self.folder_bytes(engine)
            self.assertNotEqual(pictures["000.png"], pictures["002.png"])

    def test_some_of_several_scenes(self):
        for name in "abc":
            (self.folder / f"{name}.glb").write_bytes(triangle_glb())
        self.succeeds("render", "a.glb", "b.glb", "c.glb", "-o", "out/", *TINY, "--pictures", "2-3")
        self.assertEqual(sorted(self.folder_bytes("out")), ["b.png", "c.png"])
        self.fails("render", "a.glb", "b.glb", "-o", "more/", "-q", "--pictures", "3", says="--pictures: there are 2 scenes")

    def test_a_picture_of_a_set_may_be_parted(self):
        turntable = ("render", "demo:spheres", "--size", "32x24", "--spp", "32", "--env", "sky", "--turntable", "3", *FIXED)
        self.succeeds(*turntable, "-o", "all-%03d.exr")
        for part in (1, 2):
            self.succeeds(*turntable, "--pictures", "2", "--part", f"{part}/2", "-o", f"%03d-{part}.part")
        self.succeeds("merge", "001-1.part", "001-2.part", "-o", "merged.exr")
        self.assertEqual((self.folder / "merged.exr").read_bytes(), (self.folder / "all-001.exr").read_bytes())
        self.succeeds(*turntable, "--pictures", "3", "--part", "2/2", "-o", "%03d-2.part")
        self.fails("merge", "001-1.part", "002-2.part", "-o", "no.exr", "-q", says="another picture")

    def test_what_is_no_range_is_refused(self):
        ball = ("render", "demo:spheres", "-o", "%03d.png", "--turntable", "4")
        self.fails(*ball, "-q", "--pictures", "3-5", says="--pictures: of demo:spheres there are 4 pictures")
        for text in ("0", "3-2", "x", "2-", ""):
            self.refuses(*ball, "--pictures", text, says="--pictures: .* are no pictures")
        self.refuses("render", "demo:spheres", "-o", "a.png", "--pictures", "1", says="--pictures: there is only one")
        self.refuses("render", "demo:spheres", "-o", "a.gif", "--turntable", "4", "--pictures", "1", says="--pictures: a film has all")
        self.refuses("render", "demo:spheres", "--dataset", "masks", "-o", "d", "--views", "front,iso", "--pictures", "1",
                     says="--pictures: a data set is made as a whole")  # fmt: skip


class Plan(CliTest):
    def lines(self, name):
        return (self.folder / name).read_text().splitlines()

    def run_lines(self, name):
        """As a scheduler would: by a shell, in another folder, the last line first."""
        path = f"{pathlib.Path(candela.PROGRAM).resolve().parent}:{os.environ['PATH']}"
        for line in reversed(self.lines(name)):
            subprocess.run(["sh", "-c", line], check=True, cwd="/", env={**os.environ, "PATH": path}, stderr=subprocess.DEVNULL)

    def test_lines_make_the_pictures_of_the_whole(self):
        scene = ("demo:spheres", *TINY, *FIXED, "--turntable", "5")
        self.succeeds("render", *scene, "-o", "whole/%03d.png")
        plan = self.succeeds("plan", "-o", "work.txt", "--picture-time", "100s", "--", *scene, "-o", "lines/%03d.png")
        self.assertRegex(plan.err, r"work.txt: 2 lines, 8 min 20 s of work")
        self.assertEqual([line.split("--pictures ")[1] for line in self.lines("work.txt")], ["1-2", "3-5"])
        self.run_lines("work.txt")
        for i in range(5):
            self.assertEqual((self.folder / f"lines/{i:03}.png").read_bytes(), (self.folder / f"whole/{i:03}.png").read_bytes(), i)

    def test_parts_make_the_pictures_of_the_whole(self):
        scene = ["demo:spheres", "--size", "32x24", "--env", "sky", "--spp", "48", *FIXED, "--views", "front,iso"]
        self.succeeds("render", *scene, "-o", "whole/{view}.exr", "-o", "whole/{view}.png")
        self.succeeds("plan", "-o", "farm/", "--picture-time", "12min", "--", "render", *scene, "-o", "out/{view}.exr", "--output=out/{view}.png")
        self.assertEqual(len(self.lines("farm/jobs.txt")), 6)
        self.assertEqual(len(self.lines("farm/jobs-merge.txt")), 2)
        self.run_lines("farm/jobs.txt")
        self.run_lines("farm/jobs-merge.txt")
        for name in ("front.exr", "iso.exr", "front.png", "iso.png"):
            self.assertEqual((self.folder / "out" / name).read_bytes(), (self.folder / "whole" / name).read_bytes(), name)

    def test_a_look_at_the_first_picture_sizes_them(self):
        job = ("demo:spheres", *TINY, "--turntable", "40", "-o", "%03d.png")
        self.succeeds("plan", "-o", "work.txt", "--each", "10h", "--", *job)
        self.assertEqual(len(self.lines("work.txt")), 1)
        self.assertEqual(self.files(), ["work.txt"])
        self.succeeds("plan", "-o", "work.txt", "--each", "1ms", "--", *job[:3], "--spp", "100000", "--turntable", "2", "-o", "%03d.exr")
        self.assertGreater(len(self.lines("work.txt")), 4)
        self.succeeds("plan", "-o", "work.txt", "--each", "10h", "--", *job, "--engine", "raster")

    def test_jobs_come_as_words_as_one_and_as_a_list(self):
        job = "demo:spheres --turntable 4 -o a-%03d.png"
        (self.folder / "list.txt").write_text(f"# two\ncandela render {job}\n\n{job.replace('a-', 'b-')}\n")
        two = [job, "candela render " + job.replace("a-", "c-")]
        for words, count in (([job], 2), (["--", "candela", "render", *job.split()], 2), (["list.txt"], 4), (two, 4)):
            self.succeeds("plan", "-o", "work.txt", "--picture-time", "100s", *words)
            self.assertEqual(len(self.lines("work.txt")), count, words)
            self.assertTrue(self.lines("work.txt")[0].startswith(f"cd {self.folder} && candela render demo:spheres --turntable 4"))
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "1s", "--folder", "", job)
        self.assertEqual(self.lines("work.txt"), [f"candela render {job} --pictures 1-4"])
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "1s", "--folder", "", job + " " * 300)  # no file has such a name
        self.assertEqual(self.lines("work.txt"), [f"candela render {job} --pictures 1-4"])
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "1s", "--folder", "/farm/a b", "demo:spheres")
        self.assertEqual(self.lines("work.txt"), ["cd '/farm/a b' && candela render demo:spheres"])

    def test_names_stand_in_lines_as_they_are(self):
        folder = self.folder / "it's a $HOME"
        folder.mkdir()
        (folder / "a;b.glb").write_bytes(triangle_glb())
        names = ("it's a $HOME/a;b.glb", "-o", "it's a $HOME/100%.png")
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "20min", "--", *names, *TINY[:2], "--spp", "32")
        self.run_lines("work.txt")
        self.run_lines("work-merge.txt")
        self.assertTrue((folder / "100%.png").is_file())

    def test_several_scenes(self):
        for name in "abc":
            (self.folder / f"{name}.glb").write_bytes(triangle_glb())
        self.succeeds("plan", "-o", "work.txt", "--picture-time", "150s", "--", "a.glb", "b.glb", "c.glb", *TINY, "-o", "out/")
        self.assertEqual(len(self.lines("work.txt")), 2)
        self.run_lines("work.txt")
        self.assertEqual(sorted(path.name for path in (self.folder / "out").iterdir()), ["a.png", "b.png", "c.png"])

    def test_what_cannot_be_divided_is_refused(self):
        plan = ("plan", "-o", "work.txt", "--picture-time", "1s", "--", "demo:spheres")
        for options, says in (
            (["--dataset", "masks", "-o", "d"], "--dataset: is made as a whole"),
            (["--turntable", "4", "-o", "a.gif"], "--output: a.gif is a film"),
            (["--stats", "s.json"], "--stats: would be written by every line"),
            (["--part", "1/2", "-o", "a.part"], "--part: the plan says which"),
            (["--turntable", "4", "-o", "%d.png", "--pictures", "2"], "--pictures: the plan says which"),
            (["--checkpoint", "c"], "--checkpoint"),
            (["--size", "0x1"], "--size"),
            (["-o", "-"], "--output: a job writes to a file"),
        ):
            with self.subTest(options=options):
                self.refuses(*plan, *options, says=says)
        self.refuses("plan", "-o", "work.txt", says="JOB is missing")
        self.refuses("plan", "demo:spheres", says="--output: where to")
        self.fails("plan", "-o", "work.txt", "-q", "absent.glb", says="absent.glb: no such file")

    def test_nothing_that_is_read_is_written(self):
        (self.folder / "list.txt").write_text("demo:spheres\n")
        self.fails("plan", "-o", "list.txt", "list.txt", "-q", says="list.txt: .*the list of jobs")
        (self.folder / "a.glb").write_bytes(triangle_glb())
        self.fails("plan", "-o", "a.glb", "-q", "a.glb", says="a.glb")
        (self.folder / "work.txt.work").mkdir()
        self.fails("plan", "-o", "work.txt", "-q", "a.glb", says="work.txt.work: is of an earlier plan")


if __name__ == "__main__":
    candela.main()
