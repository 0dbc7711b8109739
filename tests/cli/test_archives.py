#!/usr/bin/env python3
"""Scenes in a .zip: shown as their folder is, whatever the names say, and nothing that an archive claims is believed."""

import json
import resource
import shutil
import struct
import zipfile
import zlib

import candela
from candela import TINY, CliTest
from test_check import Asset, pbr, png

BIN, PICTURE = "data of it.bin", "textures/grün.png"


def textured(picture=PICTURE):
    """A glTF of a quad whose buffer and texture are files, and these files by name."""
    asset = Asset()
    asset.json["images"].append({"uri": picture.replace(" ", "%20")})
    asset.json["textures"].append({"source": 0})
    asset.quad(asset.material(pbr(baseColorTexture={"index": 0})))
    scene = json.loads(asset.text())
    scene["buffers"] = [{"byteLength": len(asset.data), "uri": BIN.replace(" ", "%20")}]
    return {"scene.gltf": json.dumps(scene).encode(), BIN: bytes(asset.data), PICTURE: png(4, 4, lambda x, y: (20, 180, 90))}


def limit_memory():
    """Of everything, the program's own libraries and threads included."""
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))


class Archives(CliTest):
    def zip(self, files, name="a.zip", method=zipfile.ZIP_DEFLATED):
        with zipfile.ZipFile(self.folder / name, "w", method) as archive:
            for entry, content in files.items():
                archive.writestr(entry, content)

    def lay_out(self, files, folder="plain"):
        for name, content in files.items():
            path = self.folder / folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    def picture(self, scene, engine="path"):
        done = self.succeeds("render", scene, *TINY, "--engine", engine, "-o", "out.png")
        self.assertEqual(done.err.count("warning"), 0, done.err)
        return (self.folder / "out.png").read_bytes()

    # ----- shown as their folder is

    def test_what_an_archive_holds_is_shown_as_its_folder_is(self):
        files = textured()
        self.lay_out(files)
        nested = {f"model/source/{name}": content for name, content in files.items()}
        junk = {"__MACOSX/._scene.gltf": b"{", "__MACOSX/model/._scene.glb": b"glTF", "._scene.gltf": b"{", ".DS_Store": b"x", "license.txt": b"CC", "package.json": b"{}"}
        self.zip(files, "flat.zip")
        self.zip({**junk, **nested}, "nested.zip")
        self.zip(files, "stored.zip", zipfile.ZIP_STORED)
        self.zip({name.replace("/", "\\"): content for name, content in files.items()}, "windows.zip")
        self.zip({"./" + name: content for name, content in files.items()}, "dotted.zip")
        up = json.loads(files["scene.gltf"])
        up["images"][0]["uri"] = "../textures/gr%C3%BCn.png"
        up["buffers"][0]["uri"] = "../" + BIN
        self.zip({"gltf/scene.gltf": json.dumps(up), BIN: files[BIN], PICTURE: files[PICTURE]}, "beside.zip")
        for engine in ("path", "raster"):
            expected = self.picture("plain/scene.gltf", engine)
            for name in ("flat.zip", "nested.zip", "stored.zip", "windows.zip", "dotted.zip", "beside.zip"):
                self.assertEqual(self.picture(name, engine), expected, name)

    def test_a_glb_in_an_archive_is_shown(self):
        glb = candela.triangle_glb()
        (self.folder / "plain.glb").write_bytes(glb)
        self.zip({"deep/er/triangle.GLB": glb, "readme.md": "no"})
        self.assertEqual(self.picture("a.zip"), self.picture("plain.glb"))

    def test_content_decides_and_no_name(self):
        files = textured()
        self.lay_out(files)
        expected = self.picture("plain/scene.gltf")
        self.zip(files, "scene.glb")
        self.assertEqual(self.picture("scene.glb"), expected)
        # In the archive too, where no name promises a glTF.
        self.zip({"asset.json": files["scene.gltf"], "other.json": b'{"name": 1}', BIN: files[BIN], PICTURE: files[PICTURE]}, "names")
        self.assertEqual(self.picture("names"), expected)
        (self.folder / "plain" / "scene.zip").write_bytes(files["scene.gltf"])
        self.assertEqual(self.picture("plain/scene.zip"), expected)

    def test_info_and_check_look_inside(self):
        self.zip({"model/" + name: content for name, content in textured().items()})
        info = json.loads(self.succeeds("info", "a.zip", "--json").out)
        self.assertEqual(info["archive_entry"], "model/scene.gltf")
        self.assertEqual((info["triangles"], len(info["images"]), info["warnings"]), (2, 1, []))
        self.assertRegex(self.succeeds("info", "a.zip").out, r"in archive +model/scene.gltf")
        self.assertNotIn("cannot be read", self.succeeds("check", "a.zip").out)
        # A folder is searched for archives with a scene, and others are none of its business.
        self.zip({"notes.txt": "nothing"}, "notes.zip")
        found = json.loads(self.succeeds("check", ".", "--json").out)
        self.assertEqual([asset["file"] for asset in found["assets"]], ["./a.zip"])

    def test_what_is_missing_in_an_archive_is_told_with_its_place(self):
        files = textured()
        picture = files.pop(PICTURE)
        self.zip(files)
        (self.folder / "textures").mkdir()
        (self.folder / PICTURE).write_bytes(picture)  # beside the archive is not in it
        told = self.succeeds("render", "a.zip", *TINY, "-o", "a.png").err
        self.assertRegex(told, "warning: a.zip:scene.gltf#/images/0.*no such file in the archive; shown without it")
        del files[BIN]
        self.zip(files)
        self.fails("render", "a.zip", *TINY, "-q", "-o", "b.png", says="a.zip:scene.gltf#/buffers/0/uri: .*no such file in the archive")

    # ----- not overwritten

    def test_an_archive_that_is_read_is_not_overwritten(self):
        self.zip(textured(), "scene.png")
        before = (self.folder / "scene.png").read_bytes()
        self.fails("render", "scene.png", *TINY, "-q", "-o", "scene.png", says="is an input and would be overwritten")
        (self.folder / "link.png").symlink_to("scene.png")
        self.fails("render", "scene.png", *TINY, "-q", "-o", "link.png", says="is an input and would be overwritten")
        self.succeeds("render", "scene.png", *TINY)
        self.assertEqual((self.folder / "scene.png").read_bytes(), before)
        self.assertTrue((self.folder / "scene-2.png").is_file())
        self.succeeds("render", "scene.png", "demo:furnace", *TINY, "-o", ".")
        self.assertEqual((self.folder / "scene.png").read_bytes(), before)

    # ----- not to be believed

    def test_several_scenes_are_named_and_none_is_guessed(self):
        glb = candela.triangle_glb()
        self.zip({"one/a.glb": glb, "two/b.gltf": textured()["scene.gltf"]})
        for verb in (("render", "-q", *TINY), ("info",)):
            self.fails(*verb, "a.zip", says=r"a.zip: the archive holds 2 glTF files.*one/a.glb, two/b.gltf")
        self.assertRegex(self.run_candela("check", "a.zip").out, "holds 2 glTF files")
        self.zip({f"{i}.glb": glb for i in range(40)})
        self.fails("info", "a.zip", says="holds 40 glTF files.*and 34 more")

    def test_archives_without_a_scene_say_what_they_hold(self):
        self.zip({"a.obj": b"v 0 0 0", "b.mtl": b""})
        self.fails("info", "a.zip", says="a.zip: the archive holds no glTF, but a.obj, b.mtl")
        self.zip({})
        self.fails("info", "a.zip", says="a.zip: the archive is empty")
        self.zip({"a.glb": b"version https://git-lfs.github.com/spec/v1\n"})
        self.fails("info", "a.zip", says="the archive holds no glTF")

    def test_names_that_leave_the_archive_are_refused(self):
        for name in ("../evil.txt", "a/../../evil.txt", "/etc/evil", "..\\evil.txt", "C:\\evil.txt", "model/.."):
            self.zip({**textured(), name: b"x"})
            self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="a.zip: the name .* leads out of the archive")
            self.fails("info", "a.zip", says="leads out of the archive")

    def test_a_scene_in_an_archive_reads_nothing_else(self):
        (self.folder / "secret.png").write_bytes(png(2, 2, lambda x, y: (255, 0, 0)))
        (self.folder / "model").mkdir()
        absolute = self.folder / "secret.png"
        for uri in ("../secret.png", "..%2fsecret.png", "%2e%2e/secret.png", "textures/../../secret.png", str(absolute), f"file://{absolute}", f"FILE:{absolute}"):
            files = textured()
            scene = json.loads(files["scene.gltf"])
            scene["images"][0]["uri"] = uri
            self.zip({**files, "scene.gltf": json.dumps(scene)})
            says = "a.zip:scene.gltf#/images/0/uri: .*(leads out of the archive|is not a relative file name)"
            self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says=says)
            self.fails("info", "a.zip", says=says)

    def test_links_in_an_archive_are_no_files(self):
        files = textured()
        with zipfile.ZipFile(self.folder / "a.zip", "w") as archive:
            for name in ("scene.gltf", BIN):
                archive.writestr(name, files[name])
            link = zipfile.ZipInfo(PICTURE)
            link.create_system = 3
            link.external_attr = 0o120777 << 16
            archive.writestr(link, "/etc/passwd")
        self.assertIn("no such file in the archive", self.succeeds("render", "a.zip", *TINY, "-o", "a.png").err)

    def test_an_encrypted_archive_is_refused(self):
        self.zip(textured())
        data = bytearray((self.folder / "a.zip").read_bytes())
        for magic, flags in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
            at = data.find(magic)
            while at >= 0:
                data[at + flags] |= 1
                at = data.find(magic, at + 4)
        (self.folder / "a.zip").write_bytes(data)
        self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="a.zip:scene.gltf: is encrypted")

    # ----- bombs

    def bomb(self, true_size, claimed=None, name=PICTURE):
        """One file of zeros, and what the archive says of its size."""
        self.zip({key: value for key, value in textured().items() if key != name})
        with zipfile.ZipFile(self.folder / "a.zip", "a", zipfile.ZIP_DEFLATED) as archive:
            with archive.open(name, "w", force_zip64=False) as entry:
                zeros = bytes(1 << 20)
                for _ in range(true_size >> 20):
                    entry.write(zeros)
        if claimed is None:
            return
        data = bytearray((self.folder / "a.zip").read_bytes())
        for offset in (data.rfind(b"PK\1\2") + 24, data.find(b"PK\3\4", data.find(name.encode()) - 30) + 22):
            struct.pack_into("<I", data, offset, claimed)
        (self.folder / "a.zip").write_bytes(data)

    def test_bombs_do_not_fill_memory(self):
        self.bomb(1 << 30, name=BIN)
        self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="unpacks to more than .* MiB: it is made to fill memory", preexec_fn=limit_memory)
        # What it says of itself is not believed either.
        for claimed in (200, 0):
            self.bomb(256 << 20, claimed, BIN)
            self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="longer than the archive says|inconsisten|claims|CRC", preexec_fn=limit_memory)
        self.bomb(1 << 20, 0xFFFFFFF0, BIN)
        self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="unpacks to more than", preexec_fn=limit_memory)

    def test_many_small_bombs_count_together(self):
        files = textured()
        scene = json.loads(files["scene.gltf"])
        count = 24
        scene["buffers"] += [{"byteLength": 16 << 20, "uri": f"{i}.bin"} for i in range(count)]
        scene["bufferViews"] += [{"buffer": i + 1, "byteLength": 36} for i in range(count)]
        accessors = scene["accessors"]
        first = len(accessors)
        accessors += [{"bufferView": len(scene["bufferViews"]) - count + i, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]} for i in range(count)]
        scene["meshes"][0]["primitives"] += [{"attributes": {"POSITION": first + i}} for i in range(count)]
        self.zip({**files, "scene.gltf": json.dumps(scene), **{f"{i}.bin": bytes(16 << 20) for i in range(count)}})
        self.fails("render", "a.zip", *TINY, "-q", "-o", "a.png", says="unpacks to more than .* MiB", preexec_fn=limit_memory)

    # ----- damage

    def test_damage_is_told_in_one_line(self):
        self.zip(textured())
        whole = (self.folder / "a.zip").read_bytes()
        for cut in (4, 30, 200, len(whole) // 2, len(whole) - 22, len(whole) - 1):
            (self.folder / "a.zip").write_bytes(whole[:cut])
            self.fails("info", "a.zip", says="a.zip: ")
        # A flipped bit of what is packed is seen by its check sum.
        data = bytearray(whole)
        data[data.find(b"scene.gltf") + 60] ^= 4
        (self.folder / "a.zip").write_bytes(data)
        self.fails("info", "a.zip", says="a.zip:scene.gltf: ")


if __name__ == "__main__":
    candela.main()
