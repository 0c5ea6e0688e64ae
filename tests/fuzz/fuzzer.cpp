// libFuzzer's entry, for the format that FRONTLUX_FORMAT names. With FRONTLUX_SEEDS it writes the seeds of
// that format into a folder and ends.

#include "fuzz/formats.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace {

const frontlux::fuzz::Format& chosen() {
  const char* name = std::getenv("FRONTLUX_FORMAT");
  const auto& all = frontlux::fuzz::formats();
  const auto found =
      std::ranges::find(all, std::string_view(name == nullptr ? "" : name), &frontlux::fuzz::Format::name);
  if (found != all.end()) return *found;
  std::fputs("FRONTLUX_FORMAT is none of:", stderr);
  for (const auto& format : all) std::fprintf(stderr, " %s", format.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const auto& format = chosen();
  const char* folder = std::getenv("FRONTLUX_SEEDS");
  if (folder == nullptr) return 0;
  int number = 0;
  for (const std::string& seed : format.seeds())
    std::ofstream(std::filesystem::path(folder) / ("seed" + std::to_string(number++)), std::ios::binary)
        << seed;
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto& format = chosen();
  format.read({reinterpret_cast<const char*>(data), size});
  return 0;
}
