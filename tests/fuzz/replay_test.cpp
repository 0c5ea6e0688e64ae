// The seeds of the fuzzers, all past findings, and small damages of both.

#include "fuzz/formats.hpp"
#include "support/folder_test.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"

#include <chrono>

namespace frontlux::fuzz {
namespace {

std::vector<std::string> findings_of(const std::string& format) {
  std::vector<std::string> findings;
  const std::filesystem::path folder = std::filesystem::path(FRONTLUX_FINDINGS) / format;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      findings.push_back(test::content_of(entry.path()));
  return findings;
}

std::string damaged(std::string bytes, test::Random& random) {
  for (int times = random.below(4); times >= 0 && !bytes.empty(); --times) {
    const auto at = static_cast<std::size_t>(random.below(static_cast<int>(bytes.size())));
    switch (random.below(4)) {
      case 0:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        bytes.erase(at, static_cast<std::size_t>(1 + random.below(9)));
        break;
      case 2:
        bytes.insert(at, bytes.substr(at / 2, 20));
        break;
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

class Replay : public testing::TestWithParam<Format> {};

TEST_P(Replay, ReadsOrRefuses) {
  const Format& format = GetParam();
  const auto read = [&](const std::string& bytes) {
    const auto begin = std::chrono::steady_clock::now();
    const bool whole = format.read(bytes);  // a crash or another exception ends the test
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10)) << bytes.size() << " bytes";
    return whole;
  };
  std::vector<std::string> all = format.seeds();
  ASSERT_FALSE(all.empty());
  for (const std::string& seed : all) EXPECT_TRUE(read(seed)) << seed;
  for (std::string& finding : findings_of(format.name)) all.push_back(std::move(finding));
  test::Random random(7);
  const int times = (test::long_mode() ? 20000 : format.in_process ? 300 : 30);
  for (const std::string& bytes : all) {
    read(bytes);
    for (int i = 0; i < times; ++i) read(damaged(bytes, random));
  }
  read("");
}

INSTANTIATE_TEST_SUITE_P(Formats, Replay, testing::ValuesIn(formats()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace frontlux::fuzz
