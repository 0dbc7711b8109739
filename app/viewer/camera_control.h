#pragma once

#include "scene/framing.h"
#include "scene/view.h"

namespace candela::viewer {

/// A camera that a user moves about a point.
class CameraControl {
 public:
  /// From here on about the point of the view's axis that is nearest to `center`.
  void set(const View& view, vec3 center);
  const View& view() const { return view_; }
  /// The point that it turns about and comes nearer to.
  vec3 pivot() const { return pivot_; }

  /// The eye goes to the left and upwards by these angles, radians; never over the poles.
  void orbit(vec2 angles);
  /// Moves the picture by shares of its height, to the right and upwards: what is at the pivot's distance follows.
  void pan(vec2 shares);
  /// Nearer by `steps`, or farther.
  void zoom(float steps);
  /// From the same side, so that all of `extent` is seen.
  void fit(const Extent& extent, float aspect);
  /// Of an orthographic camera: for pictures of another shape.
  void set_aspect(float aspect);

 private:
  float distance() const;

  View view_;
  vec3 pivot_{0.0f};
};

}  // namespace candela::viewer
