#!/usr/bin/env python3
"""--root: whatever a scene names lies inside one folder, or it is not read; without it `check` says what lies outside."""

import json
import os
import zipfile

import candela
from candela import TINY, CliTest
from test_archives import BIN, PICTURE, textured
from test_check import png

IES = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 100\n0 90\n0\n1000 0\n"


def with_uri(place, uri):
    """A scene that names `uri` where a buffer, an image or a profile of light is named, as text."""
    files = textured()
    scene = json.loads(files["scene.gltf"])
    if place == "buffer":
        scene["buffers"][0]["uri"] = uri
    elif place == "image":
        scene["images"][0]["uri"] = uri
    elif place == "unused image":
        scene["images"].append({"uri": uri})
    elif place == "profile":
        scene["extensionsUsed"] = ["EXT_lights_ies"]
        scene["extensions"] = {"EXT_lights_ies": {"lights": [{"uri": uri}]}}
        scene["nodes"].append({"extensions": {"EXT_lights_ies": {"light": 0}}})
        scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
    elif place == "profile in extras":
        scene["extensionsUsed"] = ["KHR_lights_punctual"]
        scene["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "extras": {"candela": {"ies": uri}}}]}}
        scene["nodes"].append({"extensions": {"KHR_lights_punctual": {"light": 0}}})
        scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
    return json.dumps(scene)


FILES = {"buffer": BIN, "image": "out.png", "unused image": "out.png", "profile": "lamp.ies", "profile in extras": "lamp.ies"}


class Root(CliTest):
    def setUp(self):
        super().setUp()
        files = textured()
        self.outside = self.folder / "outside"
        self.inside = self.folder / "inside" / "scene"
        for folder in (self.outside, self.inside):
            folder.mkdir(parents=True)
            (folder / BIN).write_bytes(files[BIN])
            (folder / "out.png").write_bytes(png(2, 2, lambda x, y: (200, 10, 10)))
            (folder / "lamp.ies").write_text(IES)
        (self.inside / "textures").mkdir()
        (self.inside / PICTURE).write_bytes(files[PICTURE])
        (self.inside / "scene.gltf").write_bytes(files["scene.gltf"])

    def write(self, text):
        (self.inside / "a.gltf").write_text(text)

    def each_verb(self):
        yield ("render", "inside/scene/a.gltf", "-q", *TINY, "-o", "a.png")
        yield ("render", "inside/scene/a.gltf", "-q", *TINY, "--engine", "raster", "-o", "a.png")
        yield ("info", "inside/scene/a.gltf")
        yield ("bake", "--from-scene", "inside/scene/a.gltf", "--at", "0,0,1", "-q", "--size", "8", "--levels", "1", "--spp", "1", "-o", "baked")

    def test_what_leads_out_is_refused_by_every_verb(self):
        # A link beside the scene, a folder that is one, and names that say so.
        (self.inside / "away").symlink_to("../../outside")
        for place, file in FILES.items():
            link = self.inside / ("linked" + os.path.splitext(file)[1])
            if not link.is_symlink():
                link.symlink_to(f"../../outside/{file}")
            for uri in (f"../../outside/{file}", f"..%2f..%2foutside/{file}", f"%2e%2e/%2E%2e/outside/{file}", f"textures/../../../outside/{file}", f"away/{file}", link.name, "nowhere/../../../x"):
                self.write(with_uri(place, uri.replace(" ", "%20")))
                says = "inside/scene/a.gltf#/.*: .*leads out of '.*inside', where all files of a scene must be"
                for verb in self.each_verb() if uri.startswith("../") else [("info", "inside/scene/a.gltf")]:
                    self.fails(*verb, "--root", "inside", says=says)
                self.assertRegex(self.run_candela("check", "inside/scene/a.gltf", "--root", "inside").out, "leads out of")

    def test_absolute_names_are_refused(self):
        for place, file in FILES.items():
            for path in (self.outside / file, self.inside / file):
                for uri in (str(path), f"file://{path}", f"FILE:{path}", f"%2f{str(path)[1:]}", f"file%3a//{path}"):
                    self.write(with_uri(place, uri.replace(" ", "%20")))
                    self.fails("info", "inside/scene/a.gltf", "--root", "inside", says="is not a relative file name")

    def test_what_stays_inside_is_shown_as_without_it(self):
        (self.inside / "by-link").symlink_to("../scene")
        (self.folder / "door").symlink_to("inside")
        os.rename(self.inside / BIN, self.folder / "inside" / BIN)
        for uri in ("../" + BIN, "%2e%2e/" + BIN, "by-link/../" + BIN, "textures/../../" + BIN):
            self.write(with_uri("buffer", uri.replace(" ", "%20")))
            self.succeeds("render", "inside/scene/a.gltf", "-q", *TINY, "-o", "free.png")
            for root in ("inside", "door", self.folder, ".", "/"):
                self.succeeds("render", "inside/scene/a.gltf", "--root", root, "-q", *TINY, "-o", "kept.png")
                self.assertEqual((self.folder / "kept.png").read_bytes(), (self.folder / "free.png").read_bytes())
            self.succeeds("render", "door/scene/a.gltf", "--root", "inside", "-q", *TINY, "-o", "kept.png")
            self.fails("info", "inside/scene/a.gltf", "--root", "inside/scene", says="leads out of")
        self.succeeds("info", "demo:furnace", "--root", "inside")

    def test_the_scene_itself_lies_inside(self):
        (self.outside / "glb.glb").write_bytes(candela.triangle_glb())
        (self.inside / "linked.glb").symlink_to("../../outside/glb.glb")
        (self.folder / "inside-out").mkdir()
        (self.folder / "inside-out" / "b.glb").write_bytes(candela.triangle_glb())
        for name in ("outside/glb.glb", "inside/scene/linked.glb", "inside/../outside/glb.glb", "inside-out/b.glb"):
            self.fails("info", name, "--root", "inside", says=f"{name}: leads out of")
            self.fails("render", name, "--root", "inside", "-q", *TINY, "-o", "a.png", says=f"{name}: leads out of")
        with zipfile.ZipFile(self.outside / "a.zip", "w") as archive:
            archive.writestr("a.glb", candela.triangle_glb())
        self.fails("info", "outside/a.zip", "--root", "inside", says="leads out of")
        self.succeeds("info", "outside/a.zip", "--root", "outside")

    def test_no_folder_is_wrong_usage(self):
        for verb in self.each_verb():
            for root in ("nowhere", "inside/scene/scene.gltf", ""):
                result = self.run_candela(*verb, "--root", root)
                self.assertEqual(result.code, 2)
                self.assertIn("--root: is no folder", result.err)
        self.assertIn("--root", self.succeeds("view", "--help").out)
        result = self.run_candela("bake", "inside", "--root", ".", "-o", "baked")
        self.assertEqual(result.code, 2)
        self.assertIn("only with --from-scene", result.err)

    def test_without_it_files_outside_are_read_and_check_says_so(self):
        for place, file in FILES.items():
            self.write(with_uri(place, f"../../outside/{file}".replace(" ", "%20")))
            self.succeeds("render", "inside/scene/a.gltf", "-q", *TINY, "-o", "a.png")
            checked = json.loads(self.succeeds("check", "inside/scene/a.gltf", "--json").out)
            found = [f for f in checked["assets"][0]["findings"] if f["code"] == "file-outside"]
            self.assertEqual([f["severity"] for f in found], ["warning"], place)
            self.assertIn("outside/" + file.replace(" ", "%20"), found[0]["message"])
            self.assertIn("a.gltf#/", found[0]["subject"])
        # A link that leads out does, and one that does not, or a name that comes back, does not.
        (self.inside / "linked.png").symlink_to("../../outside/out.png")
        (self.inside / "near.png").symlink_to("out.png")
        for uri, count in (("linked.png", 1), ("near.png", 0), ("textures/../out.png", 0), ("../scene/out.png", 0), ("out.png", 0)):
            self.write(with_uri("image", uri))
            findings = json.loads(self.succeeds("check", "inside/scene/a.gltf", "--json").out)["assets"][0]["findings"]
            self.assertEqual(sum(f["code"] == "file-outside" for f in findings), count, uri)


if __name__ == "__main__":
    candela.main()
