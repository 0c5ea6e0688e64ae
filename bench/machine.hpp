#pragma once

#include <string>

namespace frontlux::bench {

/// The processor's name as the system tells it, or "unknown processor".
[[nodiscard]] std::string cpu_name();

/// Adds to Google Benchmark's context what a reader of the numbers must know: processor, compiler, flags and
/// versions. Machine load, number of cores and date are there already.
void add_context();

}  // namespace frontlux::bench
