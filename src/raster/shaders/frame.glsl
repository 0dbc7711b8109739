// What is the same for every draw of a picture. Mirrors raster/blocks.h.
layout(std140) uniform Frame {
  mat4 clip_from_world;
  vec4 eye;           // world; w = 1 perspective, 0 orthographic
  vec4 back;          // unit, from the scene towards an orthographic viewer
  vec4 light;         // x: levels of the prefiltered cube, y: least roughness, z: how much of a pixel's area one sample
                      // stands for
  vec4 target;        // width, height, levels of the opaque picture, 1 where it is there
  vec4 soft;          // x: radius of points and spots, metres, y: a turn that changes from frame to frame,
                      // z: share of a light's radius that this frame's shadows have
  ivec4 counts;       // lights; bits of raster/quantity.h's Part; the only light that is shown, or -1; areas
};
