#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace frontlux::detail {

/// [m] Beyond these, float coordinates end.
inline constexpr double kMinResolution = 1e-9, kMaxResolution = 1e9;

/// How the nodes of an OctoMap file are written.
enum class OctreeFormat {
  kBinary,  ///< `.bt`: two bits a child, free or occupied
  kFull,    ///< `.ot`: the log-odds (and colour) of every node
};

/// An OctoMap file that is safe to hand to OctoMap's readers.
struct OctreeFile {
  OctreeFormat format = OctreeFormat::kBinary;
  std::string tree_type;         ///< "OcTree" or "ColorOcTree"
  double resolution = 0.0;       ///< [m]
  std::size_t node_count = 0;    ///< nodes in the stream, the root included; 0 if the tree is empty, which
                                 ///< `readData` and `readBinaryData` cannot read
  std::size_t parent_count = 0;  ///< of these, those with children
  std::size_t data_offset = 0;   ///< where the node stream begins in `bytes`
  std::string bytes;             ///< the whole file
};

/// Reads a file into memory and checks it from end to end, because OctoMap's readers recurse as deep as the
/// file goes and take missing bytes for nodes.
///
/// Accepted, as OctoMap does: bytes after the last node; an `.ot` whose `size` is wrong but whose nodes end
/// exactly where the file ends; log-odds of NaN in an `.ot`, which OctoMap holds for free.
/// Refused, although OctoMap reads them: a node that claims children and has none, which becomes a free leaf
/// of log-odds -3.4e38; a `.bt` of nothing but a root, which is read as occupied whatever was saved; a
/// resolution outside `kMinResolution` to `kMaxResolution`.
/// @throws std::runtime_error naming the file, what is wrong, the byte where it was found, and what to do
[[nodiscard]] OctreeFile read_checked_octree_file(const std::filesystem::path& file);

/// The same for bytes that are in memory already; `file` only names them in messages.
[[nodiscard]] OctreeFile check_octree_bytes(const std::filesystem::path& file, std::string bytes);

}  // namespace frontlux::detail
