#include "base/error.h"
#include "gl/gl.h"

// In a browser a context belongs to a canvas, and whoever has the canvas makes it.
namespace candela::gl {

std::unique_ptr<Context> Context::open() { throw Error("a browser has no OpenGL without a canvas"); }

Context::~Context() = default;

bool Context::make_current() { return display_ == context_; }

}  // namespace candela::gl
