#include <frontlux/machine.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <unistd.h>

namespace frontlux {
namespace {

constexpr std::uint64_t kNotKnown = std::numeric_limits<std::uint64_t>::max();

std::uint64_t free_memory() {
  std::ifstream file("/proc/meminfo");
  std::uint64_t kilobytes = 0;
  bool known = false;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("MemAvailable:") || line.starts_with("SwapFree:")) {
      kilobytes += std::stoull(line.substr(line.find(':') + 1));
      known = known || line.starts_with("MemAvailable:");
    }
  return known ? kilobytes * 1024 : kNotKnown;
}

std::uint64_t free_addresses() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNotKnown;
  return limit.rlim_cur - std::min<std::uint64_t>(address_space(), limit.rlim_cur);
}

}  // namespace

std::uint64_t address_space() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0;
  file >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t available_memory() { return std::min(free_memory(), free_addresses()); }

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace frontlux
