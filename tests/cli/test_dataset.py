"""candela render --dataset and --cryptomatte: what the files say, read by the rules that their formats publish."""

import json
import math
import struct

import candela
from candela import CliTest, png_numbers, png_pixels

SPHERES = ("render", "demo:spheres", "--env", "furnace", "--spp", "2", "--size", "60x40")
THREE = ("--cameras", "sphere:3,1")


def unpacked(segmentation):
    """The pixels of COCO's compressed run lengths, by rows (cocodataset/cocoapi, common/maskApi.c: rleFrString)."""
    height, width = segmentation["size"]
    counts, at, text = [], 0, segmentation["counts"]
    while at < len(text):
        x, k, more = 0, 0, True
        while more:
            c = ord(text[at]) - 48
            x |= (c & 31) << 5 * k
            more = bool(c & 32)
            at, k = at + 1, k + 1
            if not more and c & 16:
                x |= -1 << 5 * k
        counts.append(x + (counts[-2] if len(counts) > 2 else 0))
    flat = [value for i, n in enumerate(counts) for value in [i % 2] * n]
    return [[flat[x * height + y] for x in range(width)] for y in range(height)]


def box_of(rows):
    found = [(x, y) for y, row in enumerate(rows) for x, value in enumerate(row) if value]
    if not found:
        return None
    xs, ys = [x for x, _ in found], [y for _, y in found]
    return [min(xs), min(ys), max(xs) - min(xs) + 1, max(ys) - min(ys) + 1]


class Dataset(CliTest):
    def load(self, name):
        return json.loads((self.folder / name).read_text())

    def test_masks_are_the_pictures_of_their_numbers(self):
        for engine in ("path", "raster"):
            with self.subTest(engine=engine):
                options = ("--engine", engine) if engine == "path" else ("--engine", engine, "--no-cache")
                command = [*SPHERES, "--dataset", "masks", "-o", engine, *THREE, *options]
                self.succeeds(*command)
                pictures = self.load(f"{engine}/objects.json")["pictures"]
                self.assertEqual([p["file"] for p in pictures], ["000000.png", "000001.png", "000002.png"])
                for picture in pictures:
                    stem = picture["file"][:-4]
                    width, height, bits, numbers = png_numbers(self.folder / engine / f"{stem}-instance.png")
                    self.assertEqual((width, height, bits), (60, 40, 16))
                    self.assertEqual(png_pixels(self.folder / engine / picture["file"])[:2], (60, 40))
                    self.assertGreater(len(picture["instances"]), 1)
                    for one in picture["instances"]:
                        n = one["instance"]
                        visible = png_numbers(self.folder / engine / f"{stem}-mask-{n}.png")[3]
                        amodal = png_numbers(self.folder / engine / f"{stem}-amodal-{n}.png")[3]
                        self.assertEqual(visible, [[255 if v == n else 0 for v in row] for row in numbers])
                        self.assertEqual(one["pixels"], sum(v > 0 for row in visible for v in row))
                        self.assertEqual(one["box"], box_of(visible))
                        self.assertEqual(one["amodal_box"], box_of(amodal))
                        for seen, there in zip(visible, amodal):
                            for v, a in zip(seen, there):
                                self.assertLessEqual(v, a, "what is seen is there")
                    self.assertEqual({v for row in numbers for v in row} - {0},
                                     {i["instance"] for i in picture["instances"] if i["pixels"]})  # fmt: skip

    def test_coco_is_read_by_its_rules(self):
        self.succeeds(*SPHERES, "--dataset", "coco", "-o", "set", *THREE)
        self.succeeds(*SPHERES, "--dataset", "masks", "-o", "masks", *THREE)
        coco, masks = self.load("set/annotations.json"), self.load("masks/objects.json")
        self.assertEqual([image["id"] for image in coco["images"]], [1, 2, 3])
        categories = {c["id"]: c["name"] for c in coco["categories"]}
        self.assertEqual(len(categories), len(coco["categories"]))
        self.assertGreater(len(coco["annotations"]), 3)
        for number, a in enumerate(coco["annotations"], 1):
            self.assertEqual(a["id"], number)
            picture = masks["pictures"][a["image_id"] - 1]
            (one,) = [i for i in picture["instances"] if i["instance"] == a["instance"]]
            rows = unpacked(a["segmentation"])
            visible = png_numbers(self.folder / "masks" / f"{picture['file'][:-4]}-mask-{one['instance']}.png")[3]
            self.assertEqual(rows, [[v // 255 for v in row] for row in visible])
            self.assertEqual(a["bbox"], one["box"])
            self.assertEqual(a["area"], one["pixels"])
            self.assertEqual(box_of(unpacked(a["amodal_segmentation"])), a["amodal_bbox"])
            self.assertEqual(categories[a["category_id"]], one["category"])
        try:
            from pycocotools.coco import COCO
        except ImportError:
            return
        theirs = COCO(str(self.folder / "set/annotations.json"))
        for a in coco["annotations"]:
            self.assertEqual(theirs.annToMask(a).tolist(), unpacked(a["segmentation"]))

    def test_bop_poses_bring_models_to_their_masks(self):
        self.succeeds("render", "demo:spheres", "--env", "furnace", "--spp", "1", "--size", "90x60", "--dataset", "bop",
                      "-o", "set", *THREE)  # fmt: skip
        scene = self.folder / "set/train_pbr/000000"
        camera, truth, info = (json.loads((scene / f"scene_{name}.json").read_text()) for name in ("camera", "gt", "gt_info"))
        models = self.load("set/models/models_info.json")
        self.assertEqual(sorted(truth), ["0", "1", "2"])
        for image, objects in truth.items():
            k = camera[image]["cam_K"]
            _, _, bits, depth = png_numbers(scene / f"depth/00000{image}.png")
            self.assertEqual(bits, 16)
            for number, (pose, facts) in enumerate(zip(objects, info[image])):
                r, t = pose["cam_R_m2c"], pose["cam_t_m2c"]
                self.assertAlmostEqual(sum(v * v for v in r), 3.0, 4)
                points = self.ply(self.folder / f"set/models/obj_{pose['obj_id']:06}.ply")
                lower = [min(p[i] for p in points) for i in range(3)]
                self.assertAlmostEqual(models[str(pose["obj_id"])]["min_x"], lower[0], 2)
                seen = [[sum(r[3 * i + j] * p[j] for j in range(3)) + t[i] for i in range(3)] for p in points]
                us = [k[0] * p[0] / p[2] + k[1] * p[1] / p[2] + k[2] + 0.5 for p in seen]
                vs = [k[4] * p[1] / p[2] + k[5] + 0.5 for p in seen]
                x, y, w, h = facts["bbox_obj"]
                # Pixels whose centres the model covers, of what is in the picture.
                for low, high, start, size, side in ((min(us), max(us), x, w, 90), (min(vs), max(vs), y, h, 60)):
                    self.assertLess(abs(max(low, 0) - start), 1.6)
                    self.assertLess(abs(min(high, side) - start - size), 1.6)
                visible = png_numbers(scene / f"mask_visib/00000{image}_{number:06}.png")[3]
                self.assertEqual(facts["px_count_visib"], sum(v > 0 for row in visible for v in row))
                if pose["obj_id"] == 1:  # a ball of 50 mm about its origin: depths lie on it
                    where = [(x, y) for y, row in enumerate(visible) for x, v in enumerate(row) if v]
                    for u, v in where:
                        z = depth[v][u] * camera[image]["depth_scale"]
                        p = [(u - k[2]) / k[0] * z - t[0], (v - k[5]) / k[4] * z - t[1], z - t[2]]
                        self.assertLess(abs(math.hypot(*p) - 50), 1.0)
                near = min(p[2] for p in seen)
                found = [d * camera[image]["depth_scale"]
                         for row, mask in zip(depth, visible) for d, v in zip(row, mask) if v]  # fmt: skip
                if found:
                    self.assertGreater(min(found), near - 2.0)
                    self.assertLess(min(found), max(p[2] for p in seen))

    @staticmethod
    def ply(path):
        header, _, body = path.read_bytes().partition(b"end_header\n")
        count = int(header.split(b"element vertex ")[1].split(b"\n")[0])
        return [struct.unpack_from("<3f", body, 24 * i) for i in range(count)]

    def test_transforms_have_pictures_and_depths(self):
        self.succeeds(*SPHERES, "--dataset", "transforms", "-o", "set", *THREE)
        transforms = self.load("set/transforms.json")
        self.assertEqual(len(transforms["frames"]), 3)
        for frame in transforms["frames"]:
            self.assertEqual(png_pixels(self.folder / "set" / frame["file_path"])[:2], (60, 40))
            width, height, bits, depth = png_numbers(self.folder / "set" / frame["depth_file_path"])
            self.assertEqual((width, height, bits), (60, 40, 16))
            place = [row[3] for row in frame["transform_matrix"]]
            most = max(v for row in depth for v in row)
            self.assertGreater(most, 0)
            self.assertLess(min(v for row in depth for v in row if v), 1000 * math.hypot(*place[:3]))

    def test_several_scenes_make_one_set_of_their_names(self):
        self.succeeds("render", "demo:spheres", "demo:cornell", "--env", "furnace", "--spp", "1", "--size", "24x16", "--dataset",
                      "coco", "-o", "set", "--views", "front,top")  # fmt: skip
        coco = self.load("set/annotations.json")
        self.assertEqual(len(coco["images"]), 4)
        self.assertEqual([c["name"] for c in coco["categories"]], ["spheres", "cornell"])
        for image in coco["images"]:
            self.assertTrue((self.folder / "set" / image["file_name"]).is_file())

    def test_what_a_data_set_cannot_be_is_refused(self):
        for options, says in (
            (["--dataset", "coco"], "--dataset: needs the folder"),
            (["--dataset", "coco", "-o", "a.png"], "--output: a data set is a folder"),
            (["--dataset", "yolo", "-o", "set"], "--dataset: unknown data set"),
            (["--dataset", "bop", "-o", "set", "--projection", "orthographic"], "--projection: the format has no orthographic"),
            (["--dataset", "coco", "-o", "set", "--aov", "depth"], "--aov: only an .exr"),
            (["--dataset", "transforms", "-o", "set", "--instances", "scene"], "--instances: transforms.json"),
            (["--instances", "scene"], "--instances: only with --dataset"),
            (["--cryptomatte", "object", "-o", "a.png"], "--cryptomatte: only an .exr"),
            (["--cryptomatte", "asset", "-o", "a.exr"], "--cryptomatte: unknown matte"),
        ):
            with self.subTest(options=options):
                self.refuses("render", "demo:spheres", *options, says=says)

    def test_a_scene_in_the_folder_of_the_set_is_not_overwritten(self):
        (self.folder / "set").mkdir()
        (self.folder / "set/a.glb").write_bytes(candela.triangle_glb())
        for name in ("set", "new/../set", "new/.."):
            self.fails("render", "set/a.glb", "--size", "8x8", "--spp", "1", "--dataset", "masks", "-o", name,
                       says="lies in the output folder")  # fmt: skip


class Layers(CliTest):
    def test_both_engines_write_every_layer_and_mattes(self):
        layers = "albedo,normal,camera-normal,base-color,depth,distance,position,uv,node,instance,mesh,material,face"
        for engine in ("path", "raster"):
            self.succeeds("render", "demo:spheres", "--env", "furnace", "--spp", "2", "--size", "60x40", "--engine", engine,
                          "-o", f"{engine}.exr", "--aov", layers, "--cryptomatte", "object,material")  # fmt: skip
            info = json.loads(self.succeeds("info", f"{engine}.exr", "--json").out)
            wanted = set(layers.replace("node", "id").split(","))
            self.assertLessEqual(wanted | {"CryptoObject00", "CryptoMaterial02"}, set(info["layers"]))
        for layer, tolerance in (("instance", 0), ("face", 0), ("depth", 1e-3), ("uv", 1e-3)):
            found = self.run_candela("diff", f"path.exr:{layer}", f"raster.exr:{layer}", "--json", "--tolerance", tolerance)
            changed = json.loads(found.out)["pairs"][0]
            self.assertLess(changed["layers"][0]["changed_pixels"], 60 * 40 / 20, layer)

    def test_motion_is_that_of_the_next_picture(self):
        self.succeeds("render", "demo:spheres", "--env", "furnace", "--spp", "1", "--size", "60x40", "--aov", "motion",
                      "-o", "%d.exr", "--turntable", "8")  # fmt: skip
        still = self.succeeds("render", "demo:spheres", "--env", "furnace", "--spp", "1", "--size", "60x40", "--aov",
                              "motion", "-o", "still.exr")  # fmt: skip
        self.assertRegex(still.err, "motion is 0: nothing moves")
        same = json.loads(self.run_candela("diff", "0.exr:motion", "still.exr:motion", "--json").out)
        self.assertGreater(same["pairs"][0]["layers"][0]["max"], 1.0, "pixels")


if __name__ == "__main__":
    candela.main()
