#pragma once

#include <nanobind/nanobind.h>

#include <functional>

#include "image/job.h"

namespace candela::python {

namespace nb = nanobind;

/// Does `work` on a thread of its own, without Python's lock, and returns when it is done. `progress`, unless None, is
/// called on the caller's thread, a few times per second; if it returns False, the work is stopped. What it raises, and
/// Ctrl-C, stop the work and arrive here; so does what `work` throws. Throws as refuse_after_the_end(), and Error
/// in a process that was forked from one which has worked already. Does not return where Python ends meanwhile: it does
/// so only while daemon threads work.
void run_in_background(const nb::object& progress, const std::function<void(const Job& job)>& work);

/// Does `work`, which takes no longer than a moment, here and without Python's lock; Python does not end before. Throws
/// as run_in_background().
void run_without_lock(const std::function<void()>& work);

/// Throws Error when this thread is ending Python; does not return when another one is.
void refuse_after_the_end();

/// Stops whatever runs, and waits for it. Nothing is begun after that.
void stop_all_background();

/// Tells warnings as Python's warnings of `candela.Warning`, on behalf of the caller of the package's function.
void tell_warnings(const Diagnostics& diagnostics);

/// The category of these warnings, once the module has set it.
void set_warning_category(nb::handle category);

void bind_background(nb::module_& module);

}  // namespace candela::python
