#pragma once

#include <frontlux/io/ply.hpp>

#include <filesystem>
#include <string>

namespace frontlux::sim {

/// Reads a mesh through Assimp, with node transformations and COLLADA's unit applied.
/// @param ending      of the format to read, whatever the file holds: "obj"
/// @param keep_frame  if false, a COLLADA file's frame is turned to have y up
/// @throws std::runtime_error naming the file and what is wrong; std::bad_alloc
[[nodiscard]] io::RawMesh import_mesh(const std::filesystem::path& file, const std::string& ending,
                                      bool keep_frame);

}  // namespace frontlux::sim
