#!/usr/bin/env python3
"""Check the direction of #include between the folders, and that third-party headers stay where they belong.

    tools/check_layers.py [ROOT]      exit 1 and one line per violation
    tools/check_layers.py --self-test plant violations in a copy and see them found
"""

import pathlib
import re
import sys
import tempfile

# What each folder of src/ may include beside itself. `app`, `tests`, `examples` and `bench` may include all of src.
ALLOWED = {
    "base": set(),
    "math": {"base"},
    "shade": set(),
    "image": {"math", "base", "shade"},
    "scene": {"image", "math", "base", "shade"},
    "foreign": {"image", "math", "base"},
    "io": {"foreign", "scene", "image", "math", "base"},
    "path": {"scene", "shade", "image", "math", "base"},
    "ibl": {"scene", "shade", "image", "math", "base"},
    "gl": {"math", "base"},
    "raster": {"gl", "ibl", "scene", "shade", "image", "math", "base"},
    "study": {"raster", "ibl", "path", "io", "scene", "shade", "image", "math", "base"},
    "candela": {"study", "raster", "ibl", "path", "io", "scene", "shade", "image", "math", "base"},
}

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
    "fmt/": {"app", "candela", "foreign", "ibl", "image", "io", "path", "raster", "scene", "study"},
    "glm/": set(ALLOWED) | {"app"},
    "jpeglib.h": {"image"},
    "nlohmann/": {"app", "foreign", "io"},
    "png.h": {"image"},
    "tbb/": {"base", "path"},
    "turbojpeg.h": {"image"},
    "webp/": {"image"},
    "zip.h": {"io"},
    "zlib.h": {"foreign", "image"},
    "zstd.h": {"image"},
}
PUBLIC = ("glm/", "GL")
FREE = {"tests", "examples", "bench"}  # may use GoogleTest and whatever else they need

SYSTEM = re.compile(r"^(sys/\w+|unistd|fcntl|immintrin|xmmintrin|pmmintrin)\.h$|^[a-z_]+$")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


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
    if folder == "app" and first == "cli":
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
    for top in ("src", "app", "tests", "examples", "bench"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in (".h", ".cpp") and path.is_file():
                yield path, path.relative_to(root / "src").parts[0] if top == "src" else top


def violations(root):
    public = public_headers(root)
    for path, folder in files(root):
        text = path.read_text(encoding="utf-8")
        name = path.relative_to(root)
        if folder not in ALLOWED and folder not in FREE and folder != "app":
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
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    found = list(violations(root))
    for line in found:
        print(line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
