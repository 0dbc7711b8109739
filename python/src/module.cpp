#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <exception>
#include <string>
#include <vector>

#include "background.h"
#include "base/error.h"
#include "candela/candela.h"
#include "cli/program.h"
#include "cli/values.h"
#include "picture.h"
#include "recipes.h"
#include "render.h"
#include "scene.h"

namespace candela::python {

namespace {

/// "--f-number: …" names an option of the program, which in Python is the keyword f_number.
std::string with_keywords(std::string text) {
  std::size_t at = 0;
  while ((at = text.find("--", at)) != std::string::npos) {
    const bool is_begin = at == 0 || std::string_view(" ('").find(text[at - 1]) != std::string_view::npos;
    if (!is_begin || at + 2 >= text.size() || text[at + 2] < 'a' || text[at + 2] > 'z') {
      at += 2;
      continue;
    }
    text.erase(at, 2);
    for (; at < text.size() && ((text[at] >= 'a' && text[at] <= 'z') || text[at] == '-'); ++at) {
      if (text[at] == '-') text[at] = '_';
    }
  }
  return text;
}

/// Whatever went wrong is one exception of one line.
void translate(const std::exception_ptr& pointer, void* type) {
  const auto raise = [type](const std::string& text) {
    PyErr_SetString(static_cast<PyObject*>(type), with_keywords(text).c_str());
  };
  try {
    std::rethrow_exception(pointer);
  } catch (const Error& error) {
    raise(error.what());
  } catch (const Interrupted& stop) {
    raise(std::string("stopped: ") + stop.what());
  } catch (const cli::UsageError& error) {
    raise(error.what());
  }
}

}  // namespace

NB_MODULE(_candela, module) {
  module.doc() = "What the package candela is made of.";
  const nb::object error = nb::steal(PyErr_NewExceptionWithDoc(
      "candela.Error", "What candela cannot do, in one line that says what and where.", PyExc_Exception, nullptr));
  const nb::object warning = nb::steal(PyErr_NewExceptionWithDoc(
      "candela.Warning", "An oddity that did not stop the work.", PyExc_UserWarning, nullptr));
  module.attr("Error") = error;
  module.attr("Warning") = warning;
  set_warning_category(warning);
  nb::register_exception_translator(&translate, error.ptr());

  bind_background(module);
  bind_picture(module);
  bind_scene(module);
  bind_render(module);
  bind_recipes(module);
  module.attr("__version__") = version();
  module.def("run_program", &cli::run_program, nb::arg("arguments"), nb::call_guard<nb::gil_scoped_release>());
  // Threads that render cannot outlive Python, nor can what they draw with.
  nb::module_::import_("atexit").attr("register")(nb::cpp_function([] {
    stop_all_background();
    const nb::gil_scoped_release released;
    forget_stage();
  }));
}

}  // namespace candela::python
