#pragma once

#include <frontlux/export.hpp>

#include <cstdint>
#include <string>

namespace frontlux {

/// The processor's name as the system reports it, or "unknown processor".
[[nodiscard]] FRONTLUX_EXPORT std::string processor_name();

/// Addresses that this process has taken, whatever it uses them for [bytes]; 0 where that is not known.
[[nodiscard]] FRONTLUX_EXPORT std::uint64_t address_space();

/// Memory that this process can still take [bytes]: what the system says is available, swap included, within
/// the process's limit on addresses (`ulimit -v`) and those of its control groups, as a container's. The
/// largest number if the system does not say.
[[nodiscard]] FRONTLUX_EXPORT std::uint64_t available_memory();

/// The vector instructions that the engine uses: "avx512", "avx2", "vector" (16 bytes, any processor) or
/// "none". It takes the widest that the processor has; the environment variable FRONTLUX_ISA, read once,
/// asks for a narrower one.
/// @throws std::runtime_error if FRONTLUX_ISA names none of them, or one that is not there; the fast
///         and the Embree caster throw the same when they are made
[[nodiscard]] FRONTLUX_EXPORT std::string instruction_set_name();

}  // namespace frontlux
