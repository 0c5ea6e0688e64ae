#include "explore/machine.hpp"

#include <sys/resource.h>

#include <fstream>
#include <thread>

namespace frontlux::app {

std::string machine_name() {
  std::string name = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
      name = line.substr(line.find(": ") + 2);
      break;
    }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " threads";
}

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr double kPerMegabyte = 1000.0 / 1.024;  // the kernel counts kibibytes
  return static_cast<double>(usage.ru_maxrss) / kPerMegabyte;
}

}  // namespace frontlux::app
