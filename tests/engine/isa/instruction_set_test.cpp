#include "isa/instruction_set.hpp"

#include "embree/box_kernel.hpp"
#include "packet/packet_walk.hpp"
#include "view/exact/trie_walk.hpp"

#include <frontlux/machine.hpp>
#include <frontlux/ray_caster.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <unordered_set>

namespace frontlux::test {
namespace {

using detail::InstructionSet;

// What the system says that the processor has, independently of the compiler's question.
bool system_has(const std::string& flag) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line);
    const std::unordered_set<std::string> flags(std::istream_iterator<std::string>(words), {});
    return flags.contains(flag);
  }
  return false;
}

InstructionSet expected() {
  if (system_has("avx512f") && system_has("avx512vl") && system_has("avx512dq") && system_has("avx512bw"))
    return InstructionSet::kAvx512;
  return system_has("avx2") && system_has("fma") ? InstructionSet::kAvx2 : InstructionSet::kVector;
}

// In a process of its own, since the variable is read once. GoogleTest runs suites named so before all
// others, so that it has not been read yet; a forked process is one that an emulator of another processor can
// make as well.
constexpr int kRefused = 3;  // exit code
void with_variable(const char* value) {
  setenv("FRONTLUX_ISA", value, 1);
  try {
    std::cerr << frontlux::instruction_set_name();
  } catch (const std::runtime_error& error) {
    std::cerr << error.what();
    std::exit(kRefused);
  }
  std::exit(0);
}

class InstructionSetDeathTest : public testing::Test {
 protected:
  static void expect(const char* variable, InstructionSet set) {
    EXPECT_EXIT(with_variable(variable), testing::ExitedWithCode(0), std::string("^") + name_of(set) + "$")
        << variable;
  }
  static void expect_refused(const char* variable, const std::string& complaint) {
    EXPECT_EXIT(with_variable(variable), testing::ExitedWithCode(kRefused), "^" + complaint) << variable;
  }
};

TEST_F(InstructionSetDeathTest, IsTheWidestThatTheProcessorHas) { expect("", expected()); }

TEST_F(InstructionSetDeathTest, IsWhatTheVariableAsksFor) {
  for (int set = static_cast<int>(expected()); set <= static_cast<int>(InstructionSet::kNone); ++set) {
    const auto asked = static_cast<InstructionSet>(set);
    expect(name_of(asked), asked);
  }
}

TEST_F(InstructionSetDeathTest, RefusesWhatIsNotThere) {
  expect_refused("sse9", "FRONTLUX_ISA is 'sse9', but has to be avx512, avx2, vector or none");
  expect_refused("AVX2", "FRONTLUX_ISA is 'AVX2', but has to be avx512, avx2, vector or none");
  if (expected() != InstructionSet::kAvx512)
    expect_refused("avx512", "FRONTLUX_ISA is 'avx512', but the widest this machine and build have is");
}

TEST_F(InstructionSetDeathTest, AVariableThatIsWrongIsToldWhenACasterIsMade) {
  const auto make = [](auto factory) {
    setenv("FRONTLUX_ISA", "wrong", 1);
    try {
      (void)factory(VoxelGrid(0.1));
    } catch (const std::runtime_error&) {
      std::exit(kRefused);
    }
    std::exit(0);
  };
  EXPECT_EXIT(make([](const VoxelGrid& grid) { return make_ray_caster(grid); }),
              testing::ExitedWithCode(kRefused), "");
  EXPECT_EXIT(make(make_embree_ray_caster), testing::ExitedWithCode(kRefused), "");
}

// A build that lost its vector code would still answer, and only be slow.
TEST(InstructionSet, EachPartHasTheVariantThatItShould) {
  const InstructionSet set = detail::instruction_set();
  EXPECT_EQ(detail::packet_walk().needs, set);
  const InstructionSet without_vectors = set == InstructionSet::kVector ? InstructionSet::kNone : set;
  EXPECT_EQ(detail::box_kernel().needs, without_vectors);
  EXPECT_EQ(detail::trie_walks().front().needs, without_vectors);
}

}  // namespace
}  // namespace frontlux::test
