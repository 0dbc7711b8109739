#!/usr/bin/env bash
# Mesa's llvmpipe offers a maximum anisotropy of 16 for textures. Two things are not as on other drivers:
# - It takes every number above 1 as 16: 2 costs as much as 16 and gives the same bytes, where others trade one for the other.
# - With any of them it also filters what is magnified, where EXT_texture_filter_anisotropic's own formula (as many reads as the
#   footprint is longer than wide) reads once: a checker of 8 texels over 128 pixels, seen straight on, loses two fifths of its contrast.
# Seen with Mesa 22.3.6 (Debian 12, libgl1-mesa-dri) by moderngl 5.12.0 (PyPI): of a floor of noise seen from the side, the
# pictures with 2, 4, 8 and 16 are equal, that with 1 is another; of the checker, codes reach from 15 to 240 with 1, and from
# 60 to 195 with 2. Mesa is the system's own.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install -q moderngl==5.12.0 numpy==2.2.6
cat >try.py <<'TEXT'
import moderngl
import numpy as np

context = moderngl.create_context(standalone=True, backend="egl", libgl="libGL.so.1", libegl="libEGL.so.1")
print(context.info["GL_RENDERER"], context.info["GL_VERSION"], "most:", context.max_anisotropy)
corners = context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], "f4").tobytes())
frame = context.simple_framebuffer((128, 128))
frame.use()


def pictures(texels, vertex, anisotropies):
    program = context.program(
        vertex_shader=f"#version 330\nin vec2 at; out vec2 uv; void main() {{ {vertex} }}",
        fragment_shader="#version 330\nuniform sampler2D map; in vec2 uv; out vec4 c; void main() { c = texture(map, uv); }")
    texture = context.texture(texels.shape[1::-1], 3, texels.tobytes())
    texture.build_mipmaps()
    texture.use()
    for most in anisotropies:
        texture.anisotropy = most
        frame.clear()
        context.vertex_array(program, [(corners, "2f", "at")]).render(moderngl.TRIANGLE_STRIP)
        yield np.frombuffer(frame.read(), "u1").astype(int)


noise = np.random.default_rng(1).integers(0, 256, (64, 64, 3), "u1")
floor = "uv = at * vec2(8.0, 48.0); float w = 1.0 + 0.97 * at.y; gl_Position = vec4(at * w, 0.0, w);"
seen = list(pictures(noise, floor, (1, 2, 4, 8, 16)))
print("noise, differ from 16:", [int(np.count_nonzero(p != seen[-1])) for p in seen])
checker = np.repeat((np.indices((8, 8)).sum(0) % 2 * 255).astype("u1")[..., None], 3, 2)
straight = "uv = 0.5 + 0.5 * at; gl_Position = vec4(at, 0.0, 1.0);"
print("checker, codes:", [(int(p.min()), int(p.max())) for p in pictures(checker, straight, (1, 2))])
TEXT
printed=$(LIBGL_ALWAYS_SOFTWARE=1 venv/bin/python try.py)
echo "$printed"
if ! grep -q llvmpipe <<<"$printed" || ! grep -Eq '\[[1-9][0-9]*, 0, 0, 0, 0\]' <<<"$printed" ||
  ! grep -Fq 'codes: [(15, 240), (60, 195)]' <<<"$printed"; then
  echo "no longer so" >&2
  exit 1
fi
