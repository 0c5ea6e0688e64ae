#include "explore/machine.hpp"

#include <frontlux/machine.hpp>

#include <sys/resource.h>

#include <thread>

namespace frontlux::app {

std::string machine_name() {
  return processor_name() + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr double kPerMegabyte = 1000.0 / 1.024;  // the kernel counts kibibytes
  return static_cast<double>(usage.ru_maxrss) / kPerMegabyte;
}

}  // namespace frontlux::app
