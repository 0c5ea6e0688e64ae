#include "rays/generated_map.hpp"

#include <frontlux/synthetic/maps.hpp>

#include <iostream>
#include <string_view>

namespace frontlux::bench {

std::filesystem::path generate_map(const std::string& name, const std::filesystem::path& cache) {
  bool told = false;
  const auto file = synthetic::ensure_map(name, cache, [&](std::string_view text) {
    std::cerr << '\r' << text << std::flush;
    told = true;
  });
  if (told) std::cerr << std::endl;
  return file;
}

}  // namespace frontlux::bench
