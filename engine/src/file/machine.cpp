#include <frontlux/machine.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
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

// What a file of control groups holds; none if there is no such file, or no number in it ("max").
std::optional<std::uint64_t> number_in(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::uint64_t number = 0;
  return stream >> number ? std::optional(number) : std::nullopt;
}

// Of a control group, what it may still take; what it keeps of files it would give back.
std::uint64_t free_in_group(const std::filesystem::path& group, const char* limit, const char* usage) {
  const auto most = number_in(group / limit), used = number_in(group / usage);
  if (!most || !used) return kNotKnown;
  const bool nested =
      std::string_view(limit) != "memory.max";  // of version 1: totals are those with its parts
  std::uint64_t files = 0;
  std::ifstream parts(group / "memory.stat");
  for (std::string name; parts >> name;) {
    std::uint64_t bytes = 0;
    parts >> bytes;
    if (name == (nested ? "total_inactive_file" : "inactive_file") ||
        name == (nested ? "total_active_file" : "active_file") || name == "slab_reclaimable")
      files += bytes;
  }
  return *most - std::min(*most, *used - std::min(*used, files));
}

// In the control groups of this process, as those of a container.
std::uint64_t free_in_groups() {
  const std::filesystem::path root = "/sys/fs/cgroup";
  std::uint64_t least = free_in_group(root / "memory", "memory.limit_in_bytes", "memory.usage_in_bytes");
  std::ifstream file("/proc/self/cgroup");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::filesystem::path group = line.substr(4); !group.empty(); group = group.parent_path())
      least = std::min(least, free_in_group(root / group, "memory.max", "memory.current"));
  }
  return std::min(least, free_in_group(root, "memory.max", "memory.current"));
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

std::uint64_t available_memory() { return std::min({free_memory(), free_addresses(), free_in_groups()}); }

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace frontlux
