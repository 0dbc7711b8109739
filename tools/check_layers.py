#!/usr/bin/env python3
"""Check the direction of #include between the folders, that third-party headers stay where they belong, and that who calls
an algorithm of the standard library includes its header: some releases of the library bring it along, others do not.

    tools/check_layers.py [ROOT]      exit 1 and one line per violation
    tools/check_layers.py --table     the table of docs/architecture.md, which must stand there as it is printed
    tools/check_layers.py --self-test plant violations in a copy and see them found
"""

import pathlib
import re
import sys
import tempfile

# What each folder of src/ holds, and what it may include beside itself, the lowest first. `app`, `python`, `tests`,
# `examples` and `bench` may include all of src.
FOLDERS = {
    "base": ("`Error`, `Diagnostics`, `parallel_for`, files that appear whole or not at all", ""),
    "math": ("vectors, hashes, Sobol' points, distributions to sample from, spectra and the observer", "base"),
    "shade": ("the material: Fresnel, microfacets, diffuse, thin films, dispersion, sky, tone curves; headers that are C++ and "
              "GLSL ES 3.00", ""),
    "image": ("`Image`, `Film`, `Cubemap`, image and texture files, exposure and tone curves, metrics", "math base shade"),
    "scene": ("`Scene` as plain data, `View` and lens, `Environment`, names of shading models", "image math base shade"),
    "content": ("the built-in scenes, shapes, patterns, studio and sky, made by code",
                "scene image math base shade"),
    "foreign": ("OBJ, FBX, STL, PLY, COLLADA, 3DS, 3MF to a glTF in memory; file formats, recognised by content",
                "image math base"),
    "io": ("glTF and IES profiles to `Scene`", "content foreign scene image math base"),
    "ibl": ("image-based light: cubes, irradiance, prefiltered lobes, tables, their measured errors, the formats that "
            "engines read", "scene image math base shade"),
    "path": ("the path tracer", "scene image math base shade"),
    "denoise": ("noise taken out of a film: regression on its features, or Open Image Denoise where it is installed",
                "image math base"),
    "gl": ("OpenGL ES 3.0: a context without a window, a window, object names that delete themselves, programs, "
           "shader source with its includes", "math base"),
    "raster": ("the real-time renderer", "gl ibl scene image math base shade"),
    "laws": ("the table of surfaces, the laws of every BSDF measured, the furnace sheet",
             "scene image math base shade"),
    "check": ("checks of assets against what is physically plausible", "path ibl scene image math base shade"),
    "figures": ("the figures of the field and their pages", "laws raster path ibl content scene image math base shade"),
    "candela": ("the front door of the library: `load`, `render`, `default_view`; recipes: shots, light to bake, verdicts",
                "check denoise raster path ibl io content scene image math base shade"),
}
ALLOWED = {folder: set(below.split()) for folder, (_, below) in FOLDERS.items()}

# Third-party headers by prefix, and the folders that wrap them. Only what is in PUBLIC may stand in a header of src/
# that other folders see.
THIRD_PARTY = {
    "CLI/": {"app"},
    "avif/": {"image"},
    "EGL/": {"gl"},
    "GL": {"gl"},
    "GLFW/": {"gl"},
    "Imath": {"image"},
    "Imf": {"image"},
    "OpenEXR/": {"image"},
    "assimp/": {"foreign"},
    "astcenc.h": {"image"},
    "draco/": {"io"},
    "embree": {"path"},
    "fmt/": {"app", "candela", "check", "content", "denoise", "figures", "foreign", "ibl", "image", "io", "laws", "path", "python", "raster", "scene"},
    "ft2build.h": {"image"},
    "glm/": set(ALLOWED) | {"app"},
    "imgui.h": {"app"},
    "jpeglib.h": {"image"},
    "nlohmann/": {"app", "candela", "foreign", "io"},
    "nanobind/": {"python"},
    "png.h": {"image"},
    "tbb/": {"base", "path"},
    "turbojpeg.h": {"image"},
    "webp/": {"image"},
    "zip.h": {"io"},
    "zlib.h": {"foreign", "image"},
    "zstd.h": {"image"},
}
# What people call them, where more than the header's own name helps.
LIBRARIES = {
    "CLI/": "CLI11", "avif/": "libavif", "EGL/": "EGL", "GL": "OpenGL ES", "GLFW/": "GLFW", "Imath": "OpenEXR", "Imf": "OpenEXR",
    "OpenEXR/": "OpenEXR", "assimp/": "Assimp", "astcenc.h": "libastcenc", "draco/": "libdraco", "embree": "Embree", "fmt/": "",
    "ft2build.h": "FreeType", "imgui.h": "Dear ImGui",
    "glm/": "glm", "jpeglib.h": "libjpeg-turbo", "nlohmann/": "nlohmann-json", "png.h": "libpng", "tbb/": "oneTBB",
    "turbojpeg.h": "libjpeg-turbo", "webp/": "libwebp", "zip.h": "libzip", "zlib.h": "zlib", "zstd.h": "Zstandard",
}
PUBLIC = ("glm/", "GL")
ROOT = pathlib.Path(__file__).resolve().parent.parent
FREE = {"tests", "examples", "bench"}  # may use GoogleTest and whatever else they need

SYSTEM = re.compile(r"^(sys/\w+|unistd|fcntl|spawn|immintrin|xmmintrin|pmmintrin|tmmintrin|dlfcn)\.h$|^[a-z_]+$")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)

ALGORITHM = re.compile(
    r"std::(ranges::\w+|(min|max)\(\{|(all_of|any_of|binary_search|clamp|copy(_if|_n)?|count(_if)?|equal|fill(_n)?|"
    r"find(_if)?(_not)?|for_each|generate(_n)?|is_sorted|lower_bound|(min|max)_element|minmax|mismatch|none_of|nth_element|"
    r"partition|remove(_if)?|replace(_if)?|reverse|rotate|search|shuffle|sort|stable_sort|transform|unique|upper_bound)"
    r"[(<])")


def third_party_of(header):
    return next((prefix for prefix in THIRD_PARTY if header.startswith(prefix)), None)


def judge(folder, name, header):
    """What is wrong with `#include header` in file `name` of `folder`, or None."""
    first = header.split("/")[0]
    if first in ALLOWED and "/" in header:
        if folder in ALLOWED and first != folder and first not in ALLOWED[folder]:
            return f"{folder} must not depend on {first}"
        return None
    if folder in FREE or SYSTEM.match(header):
        return None
    if folder in ("app", "python") and first == "cli":
        return None
    if folder == "app" and first == "viewer":
        return None
    if header == "imgui.h" and name.parts[:2] != ("app", "viewer"):
        return f"{header} does not belong outside of app/viewer"
    if folder == "python" and "/" not in header and (ROOT / "python" / "src" / header).is_file():
        return None
    prefix = third_party_of(header)
    if prefix is None:
        return f"unknown header {header}: write it as folder/file.h, or name it in tools/check_layers.py"
    if folder not in THIRD_PARTY[prefix]:
        return f"{header} does not belong in {folder}"
    return None


def public_headers(root):
    """Headers of src/ that some other folder includes, directly or through another such header."""
    seen = set()

    def visit(header):
        path = root / "src" / header
        if header in seen or not path.is_file():
            return
        seen.add(header)
        for inner in INCLUDE.findall(path.read_text(encoding="utf-8")):
            visit(inner)

    for path, folder in files(root):
        for header in INCLUDE.findall(path.read_text(encoding="utf-8")):
            if header.split("/")[0] in ALLOWED and header.split("/")[0] != folder and folder not in FREE:
                visit(header)
    return seen


def files(root):
    for top in ("src", "app", "python", "tests", "examples", "bench"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp") and path.is_file():
                yield path, path.relative_to(root / "src").parts[0] if top == "src" else top


def violations(root):
    public = public_headers(root)
    for path, folder in files(root):
        text = path.read_text(encoding="utf-8")
        name = path.relative_to(root)
        if folder not in ALLOWED and folder not in FREE and folder not in ("app", "python"):
            yield f"{name}:1: the folder {folder} is not in tools/check_layers.py"
            continue
        is_public = str(path.relative_to(root / "src")) in public if folder in ALLOWED else False
        for match in INCLUDE.finditer(text):
            header = match.group(1)
            problem = judge(folder, name, header)
            prefix = third_party_of(header)
            if not problem and is_public and prefix and header.split("/")[0] not in ALLOWED and prefix not in PUBLIC:
                problem = f"{header} leaks out of {folder} through a header that other folders include"
            if problem:
                line = text.count("\n", 0, match.start(1)) + 1
                yield f"{name}:{line}: {problem}"
        call = ALGORITHM.search(text)
        if call and "<algorithm>" not in text:
            line = text.count("\n", 0, call.start()) + 1
            yield f"{name}:{line}: {call.group(0)[:-1].rstrip('(')} is of <algorithm>, which is not included"


def table():
    """The rows for docs/architecture.md."""
    rows = ["| folder | what | may use | wraps |", "|---|---|---|---|"]
    for folder, (what, below) in FOLDERS.items():
        # Every folder may use glm; it is told of where it is brought in.
        wraps = {LIBRARIES[prefix] for prefix, where in THIRD_PARTY.items() if folder in where and prefix != "glm/"}
        if folder in ("math", "shade"):
            wraps.add("glm")
        rows.append(f"| `{folder}` | {what} | {', '.join(below.split())} | {', '.join(sorted(wraps - {''}, key=str.lower))} |")
    return "\n".join(rows) + "\n"


PLANTED = {
    "src/base/a.h": ('#include "math/types.h"', "base must not depend on math"),
    "src/shade/a.glsl.h": ('#include "math/types.h"', "shade must not depend on math"),
    "src/scene/a.cpp": ("#include <embree3/rtcore.h>", "does not belong in scene"),
    "src/path/a.cpp": ('#  include "png.h"', "does not belong in path"),
    "src/image/a.cpp": ("#include <nlohmann/json.hpp>", "does not belong in image"),
    "src/io/a.cpp": ('#include "path/render.h"', "io must not depend on path"),
    "src/io/b.cpp": ("#include <boost/any.hpp>", "unknown header"),
    "src/gl/a.h": ("#include <GLES3/gl3.h>", None),
    "src/scene/b.cpp": ("#include <GLES3/gl3.h>", "does not belong in scene"),
    "src/path/wrapped.h": ("#include <embree3/rtcore.h>", "leaks out of path"),
    "src/candela/b.cpp": ('#include "path/wrapped.h"', None),
    "src/extra/a.cpp": ("#include <vector>", "the folder extra is not in"),
    "app/viewer/a.cpp": ('#include <imgui.h>\n#include "viewer/b.h"', None),
    "app/cli/a.cpp": ("#include <imgui.h>", "does not belong outside of app/viewer"),
    "src/base/b.cpp": ("int m = std::max({1, 2});", "std::max is of <algorithm>"),
    "src/base/c.cpp": ("#include <algorithm>\nint m = std::max({1, 2});", None),
    "tests/a.cpp": ("#include <vector>\nvoid f(std::vector<int>& v) { std::sort(v.begin(), v.end()); }", "std::sort is of"),
    "src/path/good.cpp": ('#include <embree3/rtcore.h>\n#include <tbb/task.h>\n#include "shade/x.h"\n#include <vector>', None),
}


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, (text, _) in PLANTED.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text + "\n", encoding="utf-8")
        found = list(violations(root))
        for name, (_, expected) in PLANTED.items():
            mine = [line for line in found if line.startswith(name + ":")]
            good = not mine if expected is None else len(mine) == 1 and expected in mine[0]
            if not good:
                sys.exit(f"self-test: {name}: expected {expected!r}, found {mine}")
    print(f"{len(PLANTED)} planted files judged as they should be")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if sys.argv[1:] == ["--table"]:
        return print(table(), end="")
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    found = list(violations(root))
    page = root / "docs" / "architecture.md"
    if page.is_file() and table() not in page.read_text(encoding="utf-8"):
        found.append("docs/architecture.md:1: its table of folders is not that of tools/check_layers.py --table")
    for line in found:
        print(line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
