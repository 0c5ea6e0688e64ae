#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>
#include <thread>

namespace frontlux::python {

namespace py = pybind11;

[[noreturn]] inline void rest_for_ever() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Whether Python ends, or has, and this is not the thread that ends it.
bool python_ends_elsewhere();

/// What `call()` returns, which may take Python's lock. A daemon thread that takes it while Python exits is
/// ended by unwinding its stack: without the lock, through objects of Python's, destructors and TBB; after
/// that it ends the process. It rests here instead, until the process is gone.
template <class Call>
auto rest_if_python_exits(const Call& call) {
  if (python_ends_elsewhere()) rest_for_ever();
  try {
    return call();
  } catch (const abi::__forced_unwind&) {
    rest_for_ever();
  }
}

/// The threads of this module that compute without Python's lock. When the process exits, what they use is
/// destroyed, that of the libraries as well. So Python waits for them when nobody can take its lock any more.
class Computing {
 public:
  static void begin();
  static void end();
  /// Once for a module.
  static void end_before_the_process();
};

/// Lets Python's other threads run as long as this lasts.
class OthersRun {
 public:
  OthersRun() : thread_(PyEval_SaveThread()) { Computing::begin(); }
  ~OthersRun() {
    Computing::end();
    rest_if_python_exits([this] { PyEval_RestoreThread(thread_); });
  }
  OthersRun(const OthersRun&) = delete;
  OthersRun& operator=(const OthersRun&) = delete;

 private:
  PyThreadState* thread_;
};

/// Takes Python's lock back within an `OthersRun`, as long as this lasts.
class PythonRuns {
 public:
  PythonRuns() {
    Computing::end();
    rest_if_python_exits([this] { lock_.emplace(); });
  }
  ~PythonRuns() {
    lock_.reset();
    Computing::begin();
  }
  PythonRuns(const PythonRuns&) = delete;
  PythonRuns& operator=(const PythonRuns&) = delete;

 private:
  std::optional<py::gil_scoped_acquire> lock_;
};

}  // namespace frontlux::python
