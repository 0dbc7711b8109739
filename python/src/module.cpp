#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "background.h"
#include "base/error.h"
#include "candela/candela.h"
#include "cli/program.h"
#include "cli/values.h"
#include "files.h"
#include "picture.h"
#include "recipes.h"
#include "render.h"
#include "scene.h"

namespace candela::python {

namespace {

/// "--f-number: …" names an option of the program, which in Python is the keyword f_number.
std::string with_keywords(const std::string& text) {
  constexpr std::string_view kBefore = " ('\"";
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz-";
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const bool is_begin = at == 0 || kBefore.find(text[at - 1]) != std::string_view::npos;
    const std::size_t end = std::min(text.find_first_not_of(kLetters, at), text.size());
    if (!is_begin || !text.substr(at).starts_with("--") || end < at + 3) {
      result += text[at++];
      continue;
    }
    const std::string option = text.substr(at + 2, end - at - 2);
    const auto* const row =
        std::find_if(kSpellings.begin(), kSpellings.end(), [&](const Spelling& s) { return s.option == option; });
    std::string keyword = row != kSpellings.end() ? std::string(row->keyword) : option;
    std::replace(keyword.begin(), keyword.end(), '-', '_');
    result += keyword;
    at = end;
  }
  return result;
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
  nb::set_leak_warnings(false);  // what is alive when Python ends is no concern of its users
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
  bind_files(module);
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
