"""Scenes that are made and changed in Python."""

import threading
import unittest

import numpy

import candela
from support import FRONT, Case, draw, has_opengl, main, quad, small_scene

ENGINES = ["path"] + (["raster"] if has_opengl() else [])
TRIANGLE = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


class Making(Case):
    def test_arrays_come_back_as_they_were_given(self):
        scene = candela.Scene("made")
        positions = numpy.random.default_rng(1).random((5, 3)).astype("float32")
        normals = numpy.tile([0, 0, 1], (5, 1))
        uvs = numpy.linspace(0, 1, 10).reshape(5, 2)
        colors = numpy.full((5, 3), 0.5)
        triangles = [[0, 1, 2], [2, 3, 4]]
        mesh = scene.add_mesh(positions, triangles, normals=normals, uvs=uvs, colors=colors, name="five")
        arrays = mesh.arrays()
        numpy.testing.assert_array_equal(arrays["positions"], positions)
        numpy.testing.assert_array_equal(arrays["triangles"], triangles)
        numpy.testing.assert_array_equal(arrays["normals"], normals)
        numpy.testing.assert_allclose(arrays["uvs"], uvs, rtol=1e-6)
        numpy.testing.assert_array_equal(arrays["colors"], numpy.hstack([colors, numpy.ones((5, 1))]))
        self.assertEqual(scene.meshes["five"], mesh)

    def test_any_kind_of_array_of_numbers_will_do(self):
        positions, triangles = TRIANGLE
        for kind in ("float32", "float64", "float16", "int32", "uint8"):
            mesh = candela.Scene().add_mesh(numpy.array(positions, dtype=kind), numpy.array(triangles, dtype="uint16"))
            numpy.testing.assert_array_equal(mesh.arrays()["positions"], positions)
        backwards = numpy.asfortranarray(numpy.array(positions, dtype="float32")[::-1])
        numpy.testing.assert_array_equal(candela.Scene().add_mesh(backwards, triangles).arrays()["positions"],
                                         positions[::-1])

    def test_normals_are_flat_or_smooth_where_none_are_given(self):
        roof = ([[-1, 0, 0], [0, 1, 0], [0, 1, 1], [-1, 0, 1], [1, 0, 0], [1, 0, 1]],
                [[0, 3, 2], [0, 2, 1], [1, 2, 5], [1, 5, 4]])  # fmt: skip
        flat = candela.Scene().add_mesh(*roof).arrays()
        self.assertEqual(len(flat["positions"]), 12)
        self.assertEqual(len(numpy.unique(flat["normals"].round(4), axis=0)), 2)
        smooth = candela.Scene().add_mesh(*roof, normals="smooth").arrays()
        self.assertEqual(len(smooth["positions"]), 6)
        numpy.testing.assert_allclose(numpy.linalg.norm(smooth["normals"], axis=1), 1, rtol=1e-6)
        self.assertGreater(smooth["normals"][1, 1], 0.9)

    def test_arrays_are_refused_by_name(self):
        scene = candela.Scene()
        positions, triangles = TRIANGLE
        nan = numpy.array(positions, dtype="float32")
        nan[1, 2] = numpy.nan
        for says, change in (
            (["positions", "(3, 2)", "(n, 3)"], {"positions": [[0, 0], [1, 0], [0, 1]]}),
            (["positions", "(9,)"], {"positions": numpy.zeros(9)}),
            (["positions", "row 1", "not finite"], {"positions": nan}),
            (["positions", "not finite"], {"positions": [[1e300, 0, 0], [1, 0, 0], [0, 1, 0]]}),
            (["positions", "dtype", "numbers"], {"positions": [["a", "b", "c"]] * 3}),
            (["positions", "dtype bool"], {"positions": numpy.zeros((3, 3), dtype=bool)}),
            (["positions", "dtype complex128"], {"positions": numpy.zeros((3, 3), dtype=complex)}),
            (["positions", "no array"], {"positions": [[0, 0, 0], [1, 0]]}),
            (["triangles", "row 0", "3 of 3"], {"triangles": [[0, 1, 3]]}),
            (["triangles", "-1"], {"triangles": [[0, 1, -1]]}),
            (["triangles", "dtype float64", "whole numbers"], {"triangles": [[0.0, 1.0, 2.0]]}),
            (["triangles", "(1, 4)"], {"triangles": [[0, 1, 2, 2]]}),
            (["normals", "(2, 3)", "(3, 3)"], {"normals": [[0, 0, 1]] * 2}),
            (["normals", "flat"], {"normals": "round"}),
            (["uvs", "(3, 3)", "(3, 2)"], {"uvs": [[0, 0, 0]] * 3}),
            (["colors", "(3, 2)"], {"colors": [[0, 0]] * 3}),
        ):
            with self.subTest(change):
                self.refuses(says, scene.add_mesh, **{"positions": positions, "triangles": triangles, **change})
        self.assertEqual(len(scene.meshes), 0)

    def test_objects_of_another_scene_are_refused(self):
        scene, other = small_scene(), small_scene()
        self.refuses(["mesh", "another scene"], scene.add, other.meshes[0])
        self.refuses(["material", "another scene"], quad, scene, "", other.materials[0])
        with self.assertRaises(candela.Error):
            scene.nodes[0].light = other.lights[0]

    def test_lists_are_asked_by_number_and_name(self):
        scene = small_scene()
        self.assertEqual(scene.nodes["wall"], scene.nodes[1])
        self.assertEqual(scene.nodes[-1].name, "lamp")
        self.assertEqual([node.name for node in scene.nodes], ["square", "wall", "lamp"])
        self.refuses(["no node 'door'", "wall"], lambda: scene.nodes["door"])
        with self.assertRaises(IndexError):
            scene.nodes[3]

    def test_transforms_are_refused_where_they_are_none(self):
        scene = small_scene()
        node = scene.nodes[0]
        for says, value in ((["transform", "(3, 3)"], numpy.eye(3)), (["transform", "0 0 0 1"], numpy.ones((4, 4))),
                            (["transform", "not finite"], numpy.eye(4) * numpy.inf)):  # fmt: skip
            with self.subTest(says):
                self.refuses(says, setattr, node, "transform", value)
        numpy.testing.assert_array_equal(node.transform, numpy.eye(4))


class Materials(Case):
    def test_every_property_can_be_set_and_read(self):
        material = candela.Scene().add_material("all")
        numbers = [name for name in dir(material) if isinstance(getattr(material, name), (float, tuple))]
        self.assertGreater(len(numbers), 40)
        for name in numbers:
            if isinstance(getattr(material, name), tuple):
                setattr(material, name, (0.25, 0.5, 0.75))
                numpy.testing.assert_allclose(getattr(material, name), (0.25, 0.5, 0.75))
            else:
                value = 1.25 if "ior" in name else 0.5
                setattr(material, name, value)
                self.assertEqual(getattr(material, name), value, name)

    def test_keywords_are_properties(self):
        scene = candela.Scene()
        material = scene.add_material("gold", base_color="#ffcc33", metallic=1, roughness=0.25, alpha_mode="mask",
                                      double_sided=True, emission=2.0)  # fmt: skip
        self.assertEqual((material.metallic, material.roughness, material.alpha_mode), (1.0, 0.25, "mask"))
        self.assertEqual(material.emission, (2.0, 2.0, 2.0))
        self.assertAlmostEqual(material.base_color[1], 0.604, 3)  # decoded from sRGB
        self.assertTrue(material.double_sided)
        self.assertEqual(scene.add_material().metallic, 0.0)

    def test_values_are_refused_by_name(self):
        scene = candela.Scene()
        for says, properties in (
            (["roughness", "1.5", "0 to 1"], {"roughness": 1.5}),
            (["roughness", "nan"], {"roughness": float("nan")}),
            (["roughness", "no number"], {"roughness": "rough"}),
            (["base_color", "(2,)"], {"base_color": (1, 0)}),
            (["base_color", "not finite"], {"base_color": (1, 0, float("inf"))}),
            (["base_color"], {"base_color": "redd"}),
            (["rouhgness", "did you mean roughness"], {"rouhgness": 0.5}),
            (["alpha_mode", "opaque, mask, blend"], {"alpha_mode": "glass"}),
            (["double_sided"], {"double_sided": 1}),
            (["attenuation_color", "nothing through"], {"attenuation_color": (0, 1, 1)}),
        ):
            with self.subTest(properties):
                self.refuses(says, scene.add_material, **properties)
        material = scene.add_material(roughness=0.5)
        self.refuses("metallic", material.set, roughness=0.1, metallic=-1)
        self.assertEqual(material.roughness, 0.5)  # all or none

    def test_textures_of_arrays_are_seen(self):
        scene = candela.Scene()
        checks = numpy.zeros((2, 2, 3), dtype="uint8")
        checks[0, 0] = checks[1, 1] = 255
        material = scene.add_material("checks", unlit=True,
                                      base_color_texture=scene.add_texture(checks, filter="nearest"))  # fmt: skip
        scene.add(quad(scene, "", material))
        self.assertEqual(material.base_color_texture.size, (2, 2))
        picture = draw(scene, camera=candela.look_at((0, 0, 4), (0, 0, 0), fov_deg=30), environment="none", size=(32, 32))
        beauty = picture["beauty"][..., 0]
        self.assertGreater(beauty[10, 10], 0.9)  # upper left is row 0, column 0
        self.assertLess(beauty[10, 22], 0.1)
        self.assertGreater(beauty[22, 22], 0.9)

    def test_float_and_wide_textures_hold_the_same_as_bytes(self):
        pictures = []
        for values in (numpy.full((4, 4, 3), 51, "uint8"), numpy.full((4, 4), 51 * 257, "uint16"),
                       numpy.full((4, 4, 4), 0.2)):  # fmt: skip
            scene = candela.Scene()
            scene.add(quad(scene, "", scene.add_material(base_color_texture=values, unlit=True)))
            pictures.append(draw(scene, environment="none")["beauty"][..., 0].max())
        numpy.testing.assert_allclose(pictures, pictures[0], rtol=1e-4)

    def test_textures_are_refused_by_name(self):
        scene = candela.Scene()
        for says, source in (
            (["base_color_texture", "(4,)"], numpy.zeros(4)),
            (["base_color_texture", "(4, 4, 2)"], numpy.zeros((4, 4, 2))),
            (["base_color_texture", "0 to 1"], numpy.full((4, 4), 2.0)),
            (["base_color_texture", "0 to 1"], numpy.full((4, 4), numpy.nan)),
            (["base_color_texture", "int64"], numpy.zeros((4, 4), dtype="int64")),
            ("no/such.png", "no/such.png"),
        ):
            with self.subTest(says):
                self.refuses(says, scene.add_material, base_color_texture=source)

    def test_normal_maps_and_brushed_metal_need_no_tangents_from_the_caller(self):
        for properties in ({"normal_texture": numpy.full((4, 4, 3), (204, 128, 230), "uint8")},
                           {"anisotropy": 0.8, "roughness": 0.4, "metallic": 1}):  # fmt: skip
            for engine in ENGINES:
                scene = small_scene()
                before = draw(scene, engine=engine)
                scene.materials["red"].set(**properties)
                self.differs(before, draw(scene, engine=engine))


class Light(Case):
    def test_panorama_of_ones_is_the_furnace(self):
        scene = candela.Scene()
        scene.add(quad(scene, "", scene.add_material(base_color=(0.5, 0.5, 0.5), specular=0.0)))
        ones = draw(scene, environment=numpy.ones((16, 32, 3)), spp=64)["beauty"]
        furnace = draw(scene, environment="furnace", spp=64)["beauty"]
        numpy.testing.assert_allclose(ones, furnace, atol=0.02)

    def test_panorama_is_seen_where_its_columns_are(self):
        panorama = numpy.zeros((16, 32, 3))
        panorama[:, 16] = panorama[:, 15] = (1, 0, 0)  # around +x
        east = candela.look_at((0, 0, 0), (1, 0, 0), fov_deg=60)
        west = candela.look_at((0, 0, 0), (-1, 0, 0), fov_deg=60)
        scene = candela.Scene()
        quad(scene)
        self.assertGreater(draw(scene, camera=east, environment=panorama)["beauty"][..., 0].mean(), 0.05)
        self.assertEqual(draw(scene, camera=west, environment=panorama)["beauty"][..., 0].max(), 0.0)

    def test_panoramas_are_refused(self):
        for says, source in ((["environment", "(8, 16)"], numpy.ones((8, 16))), (["environment"], numpy.ones((8, 8, 3))),
                             (["environment", "negative"], -numpy.ones((8, 16, 3))),
                             (["environment", "not finite"], numpy.full((8, 16, 3), numpy.nan))):  # fmt: skip
            with self.subTest(says):
                self.refuses(says, candela.environment, source)

    def test_lamps_obey_the_inverse_square(self):
        scene = small_scene()
        lamp = scene.nodes["lamp"]
        lamp.position = (0, 0, 10)
        camera = candela.look_at((0, 0, 5), (0, 0, 0), fov_deg=4)
        far = draw(scene, camera=camera, bounces=1)["beauty"][..., 0].mean()
        lamp.position = (0, 0, 5)
        near = draw(scene, camera=camera, bounces=1)["beauty"][..., 0].mean()
        self.assertAlmostEqual(float(near / far), 4.0, delta=0.1)

    def test_lights_are_refused_by_name(self):
        scene = candela.Scene()
        self.refuses(["kind", "point, spot, directional"], scene.add_light, "area")
        self.refuses(["intensity"], scene.add_light, intensity=float("nan"))
        self.refuses(["brightness"], scene.add_light, brightness=3)
        self.refuses(["cone"], scene.add_light, "spot", inner_cone_deg=50, outer_cone_deg=40)
        self.refuses(["position", "(2,)"], scene.add_light, position=(1, 2))
        self.assertEqual(len(scene.lights), 0)


def moved_square(scene):
    scene.nodes["square"].position = (0.5, 0.2, 0.3)


def moved_lamp(scene):
    scene.nodes["lamp"].position = (-2, 1, 1)


def dimmed_lamp(scene):
    scene.lights[0].intensity = 5.0


def second_lamp(scene):
    scene.add_light("spot", position=(0, 0, 3), target=(0.2, 0, 0), intensity=30)


def green_square(scene):
    scene.materials["red"].base_color = (0.1, 0.8, 0.1)


def glowing_square(scene):
    scene.materials["red"].emission = 3.0


def dark_square(scene):
    scene.materials["red"].emission = 0.0


def rough_square(scene):
    scene.materials["red"].set(roughness=0.05, metallic=1.0)


def veiled_square(scene):
    scene.materials["red"].set(alpha_mode="blend", opacity=0.4)


def sheet_of_glass(scene):
    scene.materials["red"].set(transmission=1.0, roughness=0.0, base_color=(0.9, 1.0, 0.9))


def body_of_glass(scene):
    scene.materials["red"].set(transmission=1.0, roughness=0.1, thickness=0.5, attenuation_color=(0.2, 0.9, 0.2))


def raised_square(scene):
    scene.materials["red"].normal_texture = numpy.full((4, 4, 3), (204, 128, 230), "uint8")


def material_that_nobody_has(scene):
    scene.add_material("spare", emission=9.0)
    scene.materials["red"].base_color = (0.3, 0.1, 0.7)


def other_material(scene):
    scene.meshes["square"].set_material(scene.add_material("blue", base_color=(0.1, 0.1, 0.9)))


def bent_square(scene):
    arrays = scene.meshes["square"].arrays()
    arrays["positions"][:, 2] += arrays["positions"][:, 0]
    scene.meshes["square"].set(arrays["positions"], arrays["triangles"], uvs=arrays["uvs"])


def another_square(scene):
    scene.add(scene.meshes["square"], position=(1.2, 0.8, 0.5))


def no_square(scene):
    scene.nodes["square"].mesh = None


def textured_square(scene):
    scene.materials["red"].base_color_texture = numpy.linspace(0, 255, 64).reshape(8, 8).astype("uint8")


def other_environment(scene):
    scene.environment = "studio"


class Changing(Case):
    """A picture after a change is the picture of a scene that was made so from the beginning."""

    CHANGES = (moved_square, moved_lamp, dimmed_lamp, second_lamp, green_square, rough_square, glowing_square, dark_square,
               raised_square, textured_square, veiled_square, sheet_of_glass, body_of_glass, material_that_nobody_has,
               other_material, bent_square, another_square, no_square, other_environment)  # fmt: skip
    NOTHING = (dark_square,)  # of a square that does not glow

    def test_changed_scene_is_as_good_as_new(self):
        for engine in ENGINES:
            used = small_scene()
            before = draw(used, engine=engine)
            for change in self.CHANGES:
                with self.subTest(engine=engine, change=change.__name__):
                    scene = used.copy()
                    self.same(draw(scene, engine=engine), before)
                    change(scene)
                    new = small_scene()
                    change(new)
                    after = draw(scene, engine=engine)
                    self.same(after, draw(new, engine=engine))
                    if change not in self.NOTHING:
                        self.differs(after, before)

    def test_lamp_that_becomes_a_sign_is_no_lamp(self):
        """What is unlit shows light and gives none, so that nothing may take its triangles for those of a lamp."""
        scene, new = small_scene(), small_scene()
        glowing_square(scene)
        draw(scene)
        for one in (scene, new):
            one.materials["red"].set(emission=0.0, unlit=True)
        self.same(draw(scene), draw(new))

    def test_all_changes_in_a_row(self):
        for engine in ENGINES:
            scene, new = small_scene(), small_scene()
            for change in self.CHANGES:
                if change is bent_square:  # on a ground, which needs light from far away to have shadows
                    draw(scene, engine=engine, ground="shadow", environment="studio")
                draw(scene, engine=engine)
                change(scene)
                change(new)
            self.same(draw(scene, engine=engine), draw(new, engine=engine))

    def test_unchanged_scene_is_not_prepared_again(self):
        scene = small_scene()
        self.assertGreater(draw(scene).statistics["build_seconds"], 0.0)
        self.assertEqual(draw(scene, camera=candela.fit("left")).statistics["build_seconds"], 0.0)
        scene.add_camera("eye", position=(0, 0, 4))
        self.assertEqual(draw(scene, camera="eye").statistics["build_seconds"], 0.0)
        moved_square(scene)
        self.assertGreater(draw(scene).statistics["build_seconds"], 0.0)

    def large_scene(self):
        """A quarter of a million triangles, and the square."""
        scene = small_scene()
        u, v = numpy.meshgrid(numpy.linspace(-4, 4, 360), numpy.linspace(-4, 4, 360))
        positions = numpy.stack([u, v, -3 + 0.1 * numpy.sin(9 * u) * numpy.sin(7 * v)], axis=-1).reshape(-1, 3)
        corner = (numpy.arange(359)[:, None] * 360 + numpy.arange(359)).reshape(-1, 1)
        triangles = numpy.concatenate([corner + [0, 1, 361], corner + [0, 361, 360]])
        scene.add(scene.add_mesh(positions, triangles, normals="smooth", name="hills"))
        return scene

    def test_tree_of_what_has_kept_its_shape_is_not_built_again(self):
        scene = self.large_scene()
        options = {"spp": 1, "size": (16, 16)}
        first = draw(scene, **options).statistics["build_seconds"]
        for change in (green_square, rough_square, glowing_square, textured_square, dimmed_lamp, moved_lamp):
            change(scene)
            self.assertLess(draw(scene, **options).statistics["build_seconds"], 0.5 * first, change.__name__)
        bent_square(scene)
        self.assertGreater(draw(scene, **options).statistics["build_seconds"], 0.5 * first)

    def test_picture_that_knows_its_objects_costs_a_copy_and_no_tree(self):
        scene = self.large_scene()
        options = {"spp": 1, "size": (16, 16)}
        first = draw(scene, **options)
        kept = draw(scene, objects=True, **options)
        dimmed_lamp(scene)
        self.assertLess(draw(scene, **options).statistics["build_seconds"], 0.5 * first.statistics["build_seconds"])
        green_square(scene)
        self.same(draw(scene, **options), draw(scene.copy(), **options))
        self.assertEqual([seen.name for seen in candela.seen_objects(kept)][:2], ["square", "wall"])

    @unittest.skipUnless("raster" in ENGINES, "no usable OpenGL")
    def test_unchanged_scene_is_not_uploaded_again(self):
        scene = small_scene()
        self.assertGreater(draw(scene, engine="raster").statistics["upload_seconds"], 0.0)
        self.assertEqual(draw(scene, engine="raster", camera=candela.fit("left")).statistics["upload_seconds"], 0.0)

    def test_picture_in_progress_shows_the_scene_as_it_was(self):
        scene = small_scene()
        options = {"size": (128, 96), "spp": 128}
        before = draw(scene, **options)
        begun, results = threading.Event(), []
        thread = threading.Thread(target=lambda: results.append(draw(scene, progress=lambda p: begun.set(), **options)))
        thread.start()
        begun.wait(30)
        for change in (moved_square, dimmed_lamp, bent_square, green_square):
            change(scene)
        thread.join()
        self.same(results[0], before)
        self.differs(draw(scene, **options), before)

    def test_node_carries_its_children(self):
        scene = small_scene()
        parent = scene.add_node(position=(1, 0, 0), name="parent")
        child = scene.add(scene.meshes["square"], parent=parent, position=(0, 1, 0))
        self.assertEqual(child.position, (1.0, 1.0, 0.0))
        parent.position = (3, 0, 0)
        self.assertEqual(child.position, (3.0, 1.0, 0.0))
        child.position = (0, 0, 0)
        numpy.testing.assert_allclose(child.transform[:3, 3], (-3, 0, 0))

    def test_look_at_points_minus_z(self):
        node = candela.Scene().add_node(position=(1, 2, 3))
        node.look_at((1, 2, -5))
        numpy.testing.assert_allclose(node.world_from_node[:3, 2], (0, 0, 1), atol=1e-6)
        self.refuses("target", node.look_at, (1, 2, 3))


if __name__ == "__main__":
    main()
