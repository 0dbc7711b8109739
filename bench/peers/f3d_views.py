"""Pictures of a model by F3D (`pip install f3d`), from evenly spaced azimuths: f3d_views.py MODEL SIZE AZIMUTHS ENV|- OUT

AZIMUTHS are degrees, separated by commas; OUT has a {} for the number of each. ENV lights it; without it F3D's own headlight does.
"""

import sys

import f3d


def main():
    model, size, azimuths, environment, out = sys.argv[1:]
    engine = f3d.Engine.create(offscreen=True)
    engine.options.update({"ui.loader_progress": False, "render.background.color": [1.0, 1.0, 1.0]})
    if environment != "-":
        engine.options.update({"render.hdri.file": environment, "render.hdri.ambient": True})
    engine.window.size = int(size), int(size)
    engine.scene.add(model)
    engine.window.camera.reset_to_bounds(0.9)
    before = 0.0
    for index, azimuth in enumerate(map(float, azimuths.split(","))):
        engine.window.camera.azimuth(azimuth - before)
        before = azimuth
        engine.window.render_to_image(False).save(out.format(index))


if __name__ == "__main__":
    main()
