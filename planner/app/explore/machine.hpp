#pragma once

#include <string>

namespace frontlux::app {

/// The processor's name and the number of its threads, for people.
[[nodiscard]] std::string machine_name();

/// Most memory that this process has held so far [MB].
[[nodiscard]] double peak_memory_mb();

}  // namespace frontlux::app
