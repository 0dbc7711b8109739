// Which of several surfaces at a pixel a draw shows, and what a body that the eye is in leaves of them.
#include "layer_slack.glsl"

// Depths of this picture: of the nearest glass, of the boundary of the body that the eye is in, then of blended
// surfaces from near to far.
uniform highp sampler2DArray depth_layers;
#if defined(BLENDED_PART) && !defined(SHOW)
uniform ivec4 depth_slice;  // the layers between which a draw shows what is there, or -1; that of glass, or -1; 1: what
                            // is before it, 0: all else
#endif
#ifdef IN_BODY
uniform vec3 body_extinction;
uniform vec3 body_low;  // its box
uniform vec3 body_high;
uniform float near_plane;  // depth along the view, from where on light is absorbed
uniform float rays_start;  // as much more as tells on which side of a face there the rays begin
#ifndef LOBE_transmission
uniform float body_share;  // of radiance in it that is left outside, where the lens is: 1 over the square of its index
#endif
#endif

#if defined(BLENDED_PART) && !defined(SHOW)
/// Whether another draw shows what is here.
bool is_elsewhere() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = gl_FragCoord.z - layer_slack();
  if (depth_slice.x >= 0 && depth <= texelFetch(depth_layers, ivec3(at, depth_slice.x), 0).x) return true;
  if (depth_slice.y >= 0 && depth > texelFetch(depth_layers, ivec3(at, depth_slice.y), 0).x) return true;
  if (depth_slice.z < 0) return false;
  float glass = texelFetch(depth_layers, ivec3(at, depth_slice.z), 0).x;
  bool is_before_glass = glass < 1.0 && depth <= glass;
  return is_before_glass != (depth_slice.w == 1);
}
#endif

#ifdef IN_BODY
/// Where the eye's ray to here is at a depth along the view.
vec3 ray_at(float depth) {
  vec3 to_eye = eye - v_position;
  if (is_perspective > 0.5) return v_position + to_eye * (1.0 - depth * gl_FragCoord.w);
  return v_position + back * (dot(to_eye, back) - depth);
}

/// What is left of light on its way to the eye in a body, from here or from where it enters the body.
vec3 passing_body() {
  vec3 start = ray_at(rays_start);
  // A near plane and an orthographic picture may be wider than the body.
  if (any(lessThan(start, body_low)) || any(greaterThan(start, body_high))) return vec3(1.0);
  float boundary = texelFetch(depth_layers, ivec3(ivec2(gl_FragCoord.xy), 1), 0).x;
  if (gl_FragCoord.z - layer_slack() > boundary) return vec3(1.0);
  vec3 passing = exp(-body_extinction * distance(ray_at(near_plane), v_position));
#ifndef LOBE_transmission
  // What enters through the boundary has risen by as much as falls at the lens; what is seen through glass has fallen.
  passing *= body_share;
#endif
  return passing;
}
#endif
