in vec2 v_ndc;

uniform highp vec4 middle;  // of the inverse of the projection: what is at depth 0 in the middle of the picture,
uniform highp vec4 across;  // what its right edge adds to that,
uniform highp vec4 upward;  // its upper one,
uniform highp vec4 along;   // and a step in depth; all homogeneous
uniform highp float height;

/// The depth of a level plane, which hides what is below it. Nearer than the near plane it hides all.
void main() {
  highp vec4 at = middle + across * v_ndc.x + upward * v_ndc.y;
  highp float depth = (height * at.w - at.y) / (along.y - height * along.w);
  if (!(at.w + depth * along.w > 0.0)) discard;  // above the horizon it is behind the eye
  gl_FragDepth = clamp(0.5 * depth + 0.5, 0.0, 1.0);
}
