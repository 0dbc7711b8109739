"""candela render --part and --checkpoint, candela merge: the same bits as from one machine in one go."""

import signal
import time

import candela
from candela import CliTest, triangle_glb

SCENE = ("render", "demo:spheres", "--size", "48x32", "--spp", "80", "--env", "sky", "--aov", "albedo,depth,instance", "--cryptomatte", "object")


class Merge(CliTest):
    def parts(self, count, *options, scene=SCENE):
        names = []
        for k in range(1, count + 1):
            names.append(f"{k}.part")
            self.succeeds(*scene, "--part", f"{k}/{count}", "-o", names[-1], *options)
        return names

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def test_parts_have_the_bits_of_the_whole(self):
        self.succeeds(*SCENE, "-o", "whole.exr", "-o", "whole.png", "--exposure", "0")
        for count in (1, 2, 3, 5):
            names = self.parts(count, "--exposure", "0")
            self.succeeds("merge", *reversed(names), "-o", "merged.exr", "-o", "merged.png")
            self.assertEqual(self.bytes_of("merged.exr"), self.bytes_of("whole.exr"), count)
            self.assertEqual(self.bytes_of("merged.png"), self.bytes_of("whole.png"), count)

    def test_glass_over_nothing_and_denoising_too(self):
        glass = {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.8, 0.3, 1], "roughnessFactor": 0.2}, "doubleSided": True,
                 "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}  # fmt: skip
        (self.folder / "glass.glb").write_bytes(triangle_glb(material=glass))
        scene = ("render", "glass.glb", "--size", "48x32", "--spp", "64", "--env", "sky", "--background", "transparent")
        for options in ([], ["--denoise"]):
            self.succeeds(*scene, "-o", "whole.exr", *options)
            self.succeeds("merge", *self.parts(4, *options, scene=scene), "-o", "merged.exr")
            self.assertEqual(self.bytes_of("merged.exr"), self.bytes_of("whole.exr"), options)

    def test_missing_parts_are_told_and_the_picture_is_right_but_for_noise(self):
        names = self.parts(5)
        merged = self.succeeds("merge", names[0], names[3], "-o", "some.exr")
        self.assertRegex(merged.err, "48 of 80 samples are missing")
        self.succeeds(*SCENE, "-o", "whole.exr")
        close = self.run_candela("diff", "whole.exr", "some.exr", "--max-flip", "0.2")
        self.assertEqual(close.code, 0, close.out)
        self.fails("merge", names[0], names[3], "-o", "other.exr", "--strict", "-q", says="48 of 80 samples are missing")

    def test_what_does_not_belong_together_is_refused(self):
        names = self.parts(2)
        self.succeeds(*SCENE, "--seed", "4", "--part", "2/2", "-o", "other.part")
        self.fails("merge", names[0], "other.part", "-o", "a.exr", "-q", says="other.part: is part of another picture than 1.part")
        self.fails("merge", names[0], names[0], "-o", "a.exr", "-q", says="1.part: has samples that 1.part has")
        self.fails("merge", "absent.part", "-o", "a.exr", "-q", says="absent.part: no such file")
        good = self.bytes_of(names[0])
        for damaged in (b"", b"PNG", good[:40], good[: len(good) // 2], good[:-3], good.replace(b'"width":48', b'"width":49'),
                        good.replace(b'"width":48', b'"width":-1'), good.replace(b'"bytes":', b'"bytes":9')):  # fmt: skip
            (self.folder / "damaged.part").write_bytes(damaged)
            self.fails("merge", "damaged.part", "-o", "a.exr", "-q", says="damaged.part: (damaged|is no part)")

    def test_options_that_parts_cannot_have_are_refused(self):
        ball = ("render", "demo:spheres")
        for options, says in (
            (["--part", "0/4", "-o", "a.part"], "--part: '0/4' is no part"),
            (["--part", "5/4", "-o", "a.part"], "--part: '5/4' is no part"),
            (["--part", "1/2", "-o", "a.png"], "--output: a part of a picture is a .part"),
            (["-o", "a.part"], "--output: a .part is for --part"),
            (["--part", "1/2", "-o", "a.part", "--noise", "0.1"], "--noise: parts have their numbers"),
            (["--part", "1/2", "-o", "a.part", "--turntable", "4"], "--part: one picture"),
            (["--part", "1/2", "-o", "a.part", "--engine", "raster"], "--part: only for --engine path"),
            (["--resume", "-o", "a.png"], "--resume: from which"),
        ):
            with self.subTest(options=options):
                self.refuses(*ball, *options, says=says)
        self.fails(*ball, "--spp", "32", "--part", "1/3", "-o", "a.part", "-q", says="--part: 32 samples are 2 blocks of sixteen")


class Checkpoint(CliTest):
    SCENE = ("render", "demo:spheres", "--size", "96x64", "--env", "sky", "--bounces", "4")

    def killed(self, *options):
        """Starts a render and kills it once its checkpoint is there."""
        process = self.start_candela(*self.SCENE, *options, "--checkpoint", "so-far")
        end = time.monotonic() + 100
        while not (self.folder / "so-far").exists() and process.poll() is None and time.monotonic() < end:
            time.sleep(0.02)
        if process.poll() is not None:
            self.skipTest("it was done before the first checkpoint")
        process.send_signal(signal.SIGKILL)
        process.wait()

    def test_a_killed_render_leaves_its_checkpoint(self):
        self.killed("--spp", "16384", "-o", "killed.exr")
        # Another number of samples is another picture, whose checkpoint this is not.
        self.fails(*self.SCENE, "--spp", "512", "-o", "a.exr", "--checkpoint", "so-far", "--resume", "-q", says="so-far: is of another picture")

    def test_a_stopped_render_goes_on_to_the_same_bits(self):
        few = (*self.SCENE, "--spp", "512", "-o")
        self.succeeds(*few, "whole.exr")
        process = self.start_candela(*few, "stopped.exr", "--checkpoint", "so-far")
        time.sleep(0.7)
        process.send_signal(signal.SIGINT)
        process.communicate()
        if not (self.folder / "so-far").exists():
            self.skipTest("it was done before it was stopped")
        self.succeeds(*few, "resumed.exr", "--checkpoint", "so-far", "--resume")
        self.assertEqual((self.folder / "resumed.exr").read_bytes(), (self.folder / "whole.exr").read_bytes())
        self.assertFalse((self.folder / "so-far").exists(), "it is done")
        (self.folder / "so-far").write_bytes(b"what is this")
        self.fails(*few, "a.exr", "--checkpoint", "so-far", "--resume", "-q", says="so-far: is no picture to go on with")


if __name__ == "__main__":
    candela.main()
