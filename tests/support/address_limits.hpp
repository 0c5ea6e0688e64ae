#pragma once

namespace frontlux::test {

/// Whether limits of address space (`ulimit -v`) can be tested: the sanitizers reserve far more addresses than
/// a program uses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kLimitsAddresses = false;
#else
inline constexpr bool kLimitsAddresses = true;
#endif

}  // namespace frontlux::test
