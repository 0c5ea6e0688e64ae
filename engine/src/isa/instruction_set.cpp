#include "isa/instruction_set.hpp"

#include "isa/targets.hpp"

#include <frontlux/machine.hpp>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace detail {
namespace {

constexpr std::array kNames = {"avx512", "avx2", "vector", "none"};  // by InstructionSet

InstructionSet widest() {
#ifdef FRONTLUX_X86_SETS
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return InstructionSet::kAvx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return InstructionSet::kAvx2;
#endif
#ifdef __GNUC__
  return InstructionSet::kVector;
#else
  return InstructionSet::kNone;
#endif
}

InstructionSet choose() {
  const InstructionSet has = widest();
  const char* asked = std::getenv("FRONTLUX_ISA");
  if (asked == nullptr || *asked == '\0') return has;
  const auto name = std::find(kNames.begin(), kNames.end(), std::string(asked));
  const auto set = static_cast<InstructionSet>(name - kNames.begin());
  if (name == kNames.end() || set < has)
    throw std::runtime_error(
        std::string("FRONTLUX_ISA is '").append(asked).append("', but ") +
        (name == kNames.end() ? "has to be avx512, avx2, vector or none"
                              : std::string("the widest this machine and build have is ") + name_of(has)));
  return set;
}

}  // namespace

const char* name_of(InstructionSet set) { return kNames[static_cast<std::size_t>(set)]; }

InstructionSet instruction_set() {
  static const InstructionSet set = choose();
  return set;
}

}  // namespace detail

std::string instruction_set_name() { return detail::name_of(detail::instruction_set()); }

}  // namespace frontlux
