#include <frontlux/python/others_run.hpp>

#include <atomic>
#include <pthread.h>
#include <unistd.h>

namespace frontlux::python {
namespace {

std::atomic<int> threads = 0;   // that compute
std::atomic<pid_t> ending = 0;  // the thread that ends Python; 0, the first one, until it begins to
thread_local bool is_counted = false;

void wait() {
  const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (threads > 0 && std::chrono::steady_clock::now() < latest)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

bool python_ends_elsewhere() {
#if PY_VERSION_HEX >= 0x030D0000
  const bool ends = Py_IsFinalizing() != 0;
#else
  const bool ends = _Py_IsFinalizing() != 0;
#endif
  const pid_t thread = ending;
  return (ends || Py_IsInitialized() == 0) && ::gettid() != (thread != 0 ? thread : ::getpid());
}

void Computing::begin() {
  is_counted = true;
  ++threads;
}

void Computing::end() {
  --threads;
  is_counted = false;
}

void Computing::end_before_the_process() {
  // A program that embeds Python may end it in any of its threads.
  py::module_::import("atexit").attr("register")(py::cpp_function([] { ending = ::gettid(); }));
  Py_AtExit(&wait);
  // A child of fork() has none of its parent's other threads.
  ::pthread_atfork(nullptr, nullptr, [] { threads = is_counted ? 1 : 0; });
}

}  // namespace frontlux::python
