#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#if defined(__x86_64__) && defined(__GNUC__)  // clang as well
#define FRONTLUX_X86_SETS
#endif

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

// What stands between FRONTLUX_BEGIN_... and FRONTLUX_END_TARGET is compiled for that set, templates and
// lambdas included, which an attribute on a function does not reach.
#ifdef FRONTLUX_X86_SETS
#ifdef __clang__
#define FRONTLUX_BEGIN_AVX512 \
  _Pragma(                    \
      "clang attribute push(__attribute__((target(\"avx512f,avx512vl,avx512dq,avx512bw\"))), \
apply_to = function)")
#define FRONTLUX_BEGIN_AVX2 \
  _Pragma("clang attribute push(__attribute__((target(\"avx2,fma\"))), apply_to = function)")
#define FRONTLUX_END_TARGET _Pragma("clang attribute pop")
#else
#define FRONTLUX_BEGIN_AVX512 \
  _Pragma("GCC push_options") \
      _Pragma("GCC target(\"avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512\")")
#define FRONTLUX_BEGIN_AVX2 _Pragma("GCC push_options") _Pragma("GCC target(\"avx2,fma\")")
#define FRONTLUX_END_TARGET _Pragma("GCC pop_options")
#endif
#endif
