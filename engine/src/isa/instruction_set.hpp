#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace frontlux::detail {

/// The sets of vector instructions that parts of the engine are written for, the widest first.
enum class InstructionSet : std::uint8_t {
  kAvx512,
  kAvx2,
  kVector,  ///< 16 bytes, by the compiler's vector extensions: any processor
  kNone     ///< no vectors
};

/// As `FRONTLUX_ISA` calls it.
[[nodiscard]] const char* name_of(InstructionSet set);

/// What `FRONTLUX_ISA` asks for, or else the widest that this processor has. Read once.
/// @throws std::runtime_error if FRONTLUX_ISA names no set, or one that this processor or this build lacks
[[nodiscard]] InstructionSet instruction_set();

/// Of variants of one function, the widest first, those that may run: `front()` is the one to use.
/// @tparam Variant  has a member `needs`; the last one runs everywhere
template <class Variant>
[[nodiscard]] std::span<const Variant> runnable(std::span<const Variant> variants) {
  const InstructionSet widest = instruction_set();
  const auto first = std::find_if(variants.begin(), variants.end() - 1,
                                  [&](const Variant& variant) { return variant.needs >= widest; });
  return {first, variants.end()};
}

}  // namespace frontlux::detail
