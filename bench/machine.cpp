#include "machine.hpp"

#include <benchmark/benchmark.h>

#include <fstream>

// What only the build knows.
#ifndef FRONTLUX_BENCH_FLAGS
#define FRONTLUX_BENCH_FLAGS "unknown"
#endif
#ifndef FRONTLUX_BENCH_VERSIONS
#define FRONTLUX_BENCH_VERSIONS "unknown"
#endif

namespace frontlux::bench {

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

void add_context() {
  benchmark::AddCustomContext("cpu_name", cpu_name());
#if defined(__clang__)
  benchmark::AddCustomContext("compiler", "clang " __clang_version__);
#elif defined(__GNUC__)
  benchmark::AddCustomContext("compiler", "gcc " __VERSION__);
#endif
  benchmark::AddCustomContext("compiler_flags", FRONTLUX_BENCH_FLAGS);
  benchmark::AddCustomContext("versions", FRONTLUX_BENCH_VERSIONS);
}

}  // namespace frontlux::bench
