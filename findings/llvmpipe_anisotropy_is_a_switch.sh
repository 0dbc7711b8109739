#!/usr/bin/env bash
# Mesa's llvmpipe offers a maximum anisotropy of 16 for textures, and takes every number above 1 as that: 2 costs as much as 16
# and gives the same bytes, where other drivers trade one for the other. Seen with Mesa 22.3.6 (Debian 12, libgl1-mesa-dri) by
# moderngl 5.12.0 (PyPI): of a floor of noise seen from the side, the pictures with 2, 4, 8 and 16 are equal, that with 1 is
# another. Mesa is the system's own.
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
program = context.program(
    vertex_shader="""#version 330
        in vec2 at; out vec2 uv;
        void main() { uv = at * 8.0; float w = 1.0 + 0.97 * at.y; gl_Position = vec4(at * w, 0.0, w); }""",
    fragment_shader="""#version 330
        uniform sampler2D noise; in vec2 uv; out vec4 color;
        void main() { color = vec4(texture(noise, uv * vec2(1.0, 6.0)).rgb, 1.0); }""")
corners = context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], "f4").tobytes())
floor = context.vertex_array(program, [(corners, "2f", "at")])
noise = context.texture((64, 64), 3, np.random.default_rng(1).integers(0, 256, (64, 64, 3), "u1").tobytes())
noise.build_mipmaps()
noise.use()
frame = context.simple_framebuffer((128, 128))
frame.use()
pictures = []
for most in (1, 2, 4, 8, 16):
    noise.anisotropy = most
    frame.clear()
    floor.render(moderngl.TRIANGLE_STRIP)
    pictures.append(np.frombuffer(frame.read(), "u1").astype(int))
print("differ from 16:", [int(np.count_nonzero(p != pictures[-1])) for p in pictures])
TEXT
printed=$(LIBGL_ALWAYS_SOFTWARE=1 venv/bin/python try.py)
echo "$printed"
if ! grep -q llvmpipe <<<"$printed" || ! grep -Eq '\[[1-9][0-9]*, 0, 0, 0, 0\]' <<<"$printed"; then
  echo "no longer so" >&2
  exit 1
fi
