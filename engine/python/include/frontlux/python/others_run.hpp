#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

namespace frontlux::python {

namespace py = pybind11;

[[noreturn]] inline void rest_for_ever() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// What `call()` returns, which may take Python's lock. A daemon thread that takes it while Python exits is
/// ended by unwinding its stack: without the lock, through objects of Python's, destructors and TBB. It
/// rests here instead, until the process is gone.
template <class Call>
auto rest_if_python_exits(const Call& call) {
  try {
    return call();
  } catch (const abi::__forced_unwind&) {
    rest_for_ever();
  }
}

/// The threads of this module that compute without Python's lock. What they use, of the libraries as well, is
/// destroyed when the process exits, so that Python waits for them, and those that begin then rest.
class Computing {
 public:
  static void begin() {
    go_on();
    if (!exits_ || exiting_ == std::this_thread::get_id()) return;
    end();
    rest_for_ever();
  }
  static void end() { --threads_; }
  /// After an end() within a call, which may hold locks of ours: it must come to its own end.
  static void go_on() { ++threads_; }

  /// Once for a module.
  static void end_before_python_exits() {
    py::module_::import("atexit").attr("register")(py::cpp_function(&await));
    // A child of fork() has none of its parent's other threads.
    py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") =
                                                           py::cpp_function([] { threads_ = 0; }));
  }

 private:
  static void await() {
    exiting_ = std::this_thread::get_id();
    exits_ = true;
    const py::gil_scoped_release others_run;
    const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (threads_ > 0 && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  static inline std::atomic<int> threads_ = 0;
  static inline std::atomic<bool> exits_ = false;
  static inline std::thread::id exiting_;
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
    Computing::go_on();
  }
  PythonRuns(const PythonRuns&) = delete;
  PythonRuns& operator=(const PythonRuns&) = delete;

 private:
  std::optional<py::gil_scoped_acquire> lock_;
};

}  // namespace frontlux::python
