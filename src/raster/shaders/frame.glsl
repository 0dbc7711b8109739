// What is the same for every draw of a picture. Mirrors raster/blocks.h, which says what each member is.
layout(std140) uniform Frame {
  mat4 clip_from_world;
  vec3 eye;
  float is_perspective;
  vec3 back;
  float light_levels;
  float least_roughness;
  float sample_area;
  float picture_height;
  float picture_levels;
  float light_radius;
  float noise_turn;
  float shadow_share;
  int light_count;
  int shown_parts;
  int shown_light;
  int area_count;
  vec3 light_turn;
};
