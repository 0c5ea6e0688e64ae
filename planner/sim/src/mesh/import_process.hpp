#pragma once

#include <frontlux/io/ply.hpp>

#include <cstdint>
#include <functional>

namespace frontlux::sim {

/// Runs an import in a child process, so that a file that makes an importer crash, or take more time or
/// memory than its size accounts for, ends the child and not this process. What the child prints is lost.
/// @return what `import` returns
/// @throws std::runtime_error saying what `import` throws, that it crashed, or which limit it met
[[nodiscard]] io::RawMesh import_in_child(const std::function<io::RawMesh()>& import);

/// In the child: sets its limits for files of so many bytes in all. No limits hold before.
void limit_import(std::uint64_t bytes);

}  // namespace frontlux::sim
