#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>
#include <thread>

namespace frontlux::python {

namespace py = pybind11;

/// What `call()` returns, which may take Python's lock. A daemon thread that takes it while Python exits is
/// ended by unwinding its stack: without the lock, through objects of Python's, destructors and TBB. It
/// rests here instead, until the process is gone.
template <class Call>
auto rest_if_python_exits(const Call& call) {
  try {
    return call();
  } catch (const abi::__forced_unwind&) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

/// Lets Python's other threads run as long as this lasts.
class OthersRun {
 public:
  OthersRun() : thread_(PyEval_SaveThread()) {}
  ~OthersRun() {
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
    rest_if_python_exits([this] { lock_.emplace(); });
  }

 private:
  std::optional<py::gil_scoped_acquire> lock_;
};

}  // namespace frontlux::python
