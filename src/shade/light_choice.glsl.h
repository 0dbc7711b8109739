#ifndef CANDELA_SHADE_LIGHT_CHOICE_GLSL_H
#define CANDELA_SHADE_LIGHT_CHOICE_GLSL_H

#include "shade/shim.glsl.h"

SHADE_BEGIN

// Which lamp a point asks for light, among many: estimates of what a group of lamps gives it, the walk through a tree
// of groups, and the probabilities. Nodes and lamps are in the memory of whoever walks. docs/theory/path-tracing.md has
// the formulas.

// ----- the point that is lit

// From which side it takes light.
SHADE_CONST int kReceiverFront = 0;
SHADE_CONST int kReceiverBoth = 1;   // of a surface that lets light through
SHADE_CONST int kReceiverSpace = 2;  // there is no surface

/// Where light is wanted.
struct LightReceiver {
  vec3 position;
  vec3 normal;  ///< of the shading, unit
  int side;     ///< kReceiver…
};

SHADE_CONST float kLightLeastCosine = 1e-4f;  // what rounding can make of a horizon, with room
SHADE_CONST float kLightMost = 1e35f;         // of an importance; 32 of them are finite
SHADE_CONST float kLightAlmostOne = 0.99999994f;
SHADE_CONST float kLightFurthest = 3.4028235e38f;  // a range beyond it is endless

/// Of an angle within 0 … π by its cosine, or the other way round up to π/2.
SHADE_FN float light_sine(float cosine) { return sqrt(max(1.0f - cosine * cosine, 0.0f)); }

/// What a cosine with the normal is worth, if another may be larger by rounding. 0 only where no light can count.
SHADE_FN float light_facing(int side, float cosine) {
  if (side == kReceiverSpace) return 1.0f;
  if (side == kReceiverBoth) return max(abs(cosine), kLightLeastCosine);
  return cosine > -kLightLeastCosine ? max(cosine, kLightLeastCosine) : 0.0f;
}

/// Mean of the heights of a ball's points above the plane of the receiver, or of their distances from it: of points
/// evenly spread along the normal. `height` is that of the middle.
SHADE_FN float light_mean_height(int side, float height, float radius) {
  if (side == kReceiverBoth) {
    float away = abs(height);
    return away >= radius ? away : 0.5f * (height * height + radius * radius) / radius;
  }
  if (height >= radius) return height;
  float above = height + radius;
  return above > 0.0f ? 0.25f * above * above / radius : 0.0f;
}

// ----- a group of lamps

/// A node of the tree: a ball about its lamps and the cone of their directions. `axis` and `cos_spread` bound the
/// directions in which they shine with full strength, `cos_emission` the angle beyond those at which the last ends;
/// between the two it falls like a cosine.
struct LightNode {
  vec3 center;
  float radius;
  vec3 axis;
  float cos_spread;
  float cos_emission;
  float strength;     ///< candela along the axis
  float range;        ///< beyond it there is no light; may be infinite
  int first;          ///< lamps are numbered as the leaves stand: those from here …
  int end;            ///< … to before here are its own
  int children;       ///< two, side by side; 0 = a leaf
  bool is_two_sided;  ///< the same to -axis
  bool is_exact;      ///< a leaf of one lamp: whether its estimate is all there is to say
};

struct LightEstimate {
  float importance;
  float error;  ///< how far the lamps within differ from it; 0 of a leaf
};

/// What is left of the strength in a direction at an angle to the axis, by its cosine; below 0 where nothing arrives.
/// `cos_axis` is that of the middle, `sin_ball` of half the angle under which the node is seen.
SHADE_FN float light_emission(SHADE_IN(LightNode) node, float cos_axis, float sin_ball) {
  float cos_way = node.is_two_sided ? abs(cos_axis) : cos_axis;
  if (cos_way >= node.cos_spread) return 1.0f;
  // ----- the least angle beyond the spread, seen from anywhere in the node
  float cos_ball = light_sine(sin_ball);
  float sin_way = light_sine(cos_way);
  float sin_spread = light_sine(node.cos_spread);
  float cos_beyond = cos_way * node.cos_spread + sin_way * sin_spread;
  if (cos_beyond >= cos_ball) return 1.0f;
  float sin_beyond = sin_way * node.cos_spread - cos_way * sin_spread;
  float cosine = cos_beyond * cos_ball + sin_beyond * sin_ball;
  return cosine < node.cos_emission ? -1.0f : max(cosine, kLightLeastCosine);
}

/// Illuminance by the middle of the node's bounds. 0 only where none of its lamps gives any.
SHADE_FN LightEstimate light_estimate(SHADE_IN(LightNode) node, SHADE_IN(LightReceiver) receiver) {
  vec3 to_lamp = node.center - receiver.position;
  float d2 = dot(to_lamp, to_lamp);
  float radius2 = node.radius * node.radius;
  // Inside a group its light comes from all around: nearer than half its size does not count as nearer.
  float counted_d2 = max(d2, max(0.25f * radius2, 1e-12f));
  float inverse = 1.0f / sqrt(counted_d2);
  float importance = min(node.strength * inverse * inverse, kLightMost);
  // ----- the cosine at the receiver
  if (receiver.side != kReceiverSpace) {
    float height = dot(receiver.normal, to_lamp);
    float cosine = inverse * light_mean_height(receiver.side, height, node.radius);
    if (cosine >= kLightLeastCosine) {
      importance *= cosine;
    } else {
      float highest = inverse * (height + node.radius);
      importance *= light_facing(receiver.side, highest) > 0.0f ? kLightLeastCosine : 0.0f;
    }
  }
  // ----- the cone of the lamps
  bool is_inside = d2 <= radius2;
  if (node.cos_spread > -1.0f && !is_inside) {
    importance *= max(light_emission(node, -inverse * dot(to_lamp, node.axis), node.radius * inverse), 0.0f);
  }
  // ----- the window of their range, from the nearest point
  if (node.range <= kLightFurthest) {
    float q = max(sqrt(d2) - node.radius, 0.0f) / node.range;
    importance *= q <= 1.0f + 1e-4f ? max(1.0f - q * q * q * q, 1e-4f) : 0.0f;
  }
  LightEstimate e;
  e.importance = importance;
  e.error = 0.0f;
  if (node.children != 0) e.error = is_inside ? importance : importance * radius2 * inverse * inverse;
  return e;
}

/// Of a leaf that is not exact, whose lamp was asked for its own illuminance: 0 only where it gives nothing.
SHADE_FN LightEstimate light_estimate_asked(float illuminance) {
  LightEstimate e;
  e.importance = min(illuminance, kLightMost);
  e.error = 0.0f;
  return e;
}

// ----- the cut: nodes that together hold every lamp which can reach the receiver. It begins with the root; the node
// with the largest error is split into its children until there are enough, or only leaves.

SHADE_CONST int kLightCut = 8;  // the lowest three bits of an error say whose it is

struct LightCut {
  int size;
  int nodes[kLightCut];
  float shares[kLightCut];  ///< importance, or what is made of it
  int errors[kLightCut];    ///< see light_cut_error
};

/// The bits of a float that is not negative are in its order; the lowest are given to its place in the cut.
SHADE_FN int light_cut_error(float error, int place) { return (floatBitsToInt(error) & ~7) | place; }

SHADE_FN void light_cut_begin(SHADE_INOUT(LightCut) cut, int root, SHADE_IN(LightEstimate) e) {
  cut.size = e.importance > 0.0f ? 1 : 0;
  cut.nodes[0] = root;
  cut.shares[0] = e.importance;
  for (int i = 1; i < kLightCut; ++i) cut.errors[i] = 0;
  cut.errors[0] = light_cut_error(e.error, 0);
}

/// The place of the node to be split; -1 where there are only leaves.
SHADE_FN int light_cut_worst(SHADE_IN(LightCut) cut) {
  int largest = cut.errors[0];
  for (int i = 1; i < kLightCut; ++i) largest = max(largest, cut.errors[i]);
  return largest < 8 ? -1 : largest & 7;
}

SHADE_FN void light_cut_put(SHADE_INOUT(LightCut) cut, int place, int node, SHADE_IN(LightEstimate) e) {
  cut.nodes[place] = node;
  cut.shares[place] = e.importance;
  cut.errors[place] = light_cut_error(e.error, place);
}

/// Two nodes for the one at a place; those that do not reach the receiver are left out. There must be room for one.
SHADE_FN void light_cut_split(SHADE_INOUT(LightCut) cut, int place, int children, SHADE_IN(LightEstimate) left,
                              SHADE_IN(LightEstimate) right) {
  bool has_left = left.importance > 0.0f;
  bool has_right = right.importance > 0.0f;
  if (has_left) light_cut_put(cut, place, children, left);
  if (has_right) light_cut_put(cut, has_left ? cut.size : place, children + 1, right);
  if (has_left && has_right) ++cut.size;
  if (has_left || has_right) return;
  --cut.size;
  cut.nodes[place] = cut.nodes[cut.size];
  cut.shares[place] = cut.shares[cut.size];
  cut.errors[place] = (cut.errors[cut.size] & ~7) | place;
  cut.errors[cut.size] = 0;
}

// ----- the way down from a node of the cut

struct LightTurn {
  bool is_left;
  float pmf;  ///< 0: neither side gives light
  float u;    ///< what is left of the random number
};

/// The probability of one of two sides of these importances.
SHADE_FN float light_turn_pmf(float left, float right, bool is_left) {
  float sum = left + right;
  return sum > 0.0f ? (is_left ? left : right) / sum : 0.0f;
}

SHADE_FN LightTurn light_turn(float left, float right, float u) {
  LightTurn turn;
  float sum = left + right;
  float place = u * sum;
  turn.is_left = place < left;
  float taken = turn.is_left ? left : right;
  turn.pmf = sum > 0.0f ? taken / sum : 0.0f;
  turn.u = sum > 0.0f ? clamp((place - (turn.is_left ? 0.0f : left)) / taken, 0.0f, kLightAlmostOne) : 0.0f;
  return turn;
}

// ----- sources beside the tree

/// What the cosine with a sun's middle is worth: some of the disc may be above the horizon where that is not, cos(θ -
/// r) ≤ cos θ + sin r + (1 - cos r).
SHADE_FN float light_sun_facing(int side, float cosine, float sin2_radius, float solid_angle) {
  float reach = sqrt(sin2_radius) + solid_angle / (2.0f * kShadePi);
  return light_facing(side, min(cosine + reach, 1.0f));
}

// ----- several lamps for one receiver

/// How many samples a receiver that is seen takes: 1 to 4, by the share of the tree in its light.
SHADE_FN int light_samples(float share_of_tree) { return 1 + int(3.0f * share_of_tree + 0.5f); }

/// What sample `i` of `samples` chooses by: `u`, the same for all, gives each its stratum of the lights.
SHADE_FN float light_stratum(int i, int samples, float u) { return samples == 1 ? u : (float(i) + u) / float(samples); }

/// Its point on the lamp: an additive recurrence by the powers of 1 / 1.3247…, the real root of x³ = x + 1.
SHADE_FN vec2 light_place(int i, vec2 u) {
  if (i == 0) return u;
  vec2 moved = u + float(i) * vec2(0.7548777f, 0.5698403f);
  return min(moved - floor(moved), vec2(kLightAlmostOne));
}

// ----- points on lamps

/// Evenly over a triangle. Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
SHADE_FN vec3 light_barycentric(vec2 u) {
  vec2 b = u;
  if (u.y > u.x) {
    b.x = 0.5f * u.x;
    b.y = u.y - b.x;
  } else {
    b.y = 0.5f * u.y;
    b.x = u.x - b.y;
  }
  return vec3(b.x, b.y, 1.0f - b.x - b.y);
}

/// Evenly within a cone about +z. 1 - cos is kept as it is, because 1 - (1 - x) would lose half the digits of a sun's
/// width.
SHADE_FN vec3 light_in_cone(float solid_angle, vec2 u) {
  float one_minus_cos = u.x * solid_angle / (2.0f * kShadePi);
  float cos_theta = 1.0f - one_minus_cos;
  float sin_theta = sqrt(one_minus_cos * (1.0f + cos_theta));
  float phi = 2.0f * kShadePi * u.y;
  return vec3(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
}

/// Weight of a technique with density `a` against one with density `b`; power 1 (balance) or 2 (Veach 1997, §9.2).
SHADE_FN float mis_weight(float a, float b, float power) {
  if (power == 1.0f) return a / (a + b);
  float r = b / a;
  return 1.0f / (1.0f + r * r);
}

SHADE_END

#endif
