#pragma once

#include <cfenv>
#include <cstdint>

namespace frontlux::test {

/// The processor's register that says how floating-point numbers are rounded, which exceptions trap and what
/// becomes of denormals, without the sticky flags.
inline std::uint64_t floating_point_control() {
  std::fenv_t environment;
  std::fegetenv(&environment);
#ifdef __x86_64__
  return environment.__mxcsr & ~0x3FU;
#else
  return environment.__fpcr;
#endif
}

}  // namespace frontlux::test
