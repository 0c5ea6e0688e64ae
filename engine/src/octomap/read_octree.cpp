#include "octomap/octomap_adapter.hpp"
#include "octomap/octree_file.hpp"

#include <frontlux/file.hpp>
#include <frontlux/machine.hpp>
#include <frontlux/octomap.hpp>

#include <cstdint>
#include <memory>
#include <new>
#include <sstream>
#include <utility>

namespace frontlux {
namespace {

// What OctoMap allocates for a node and for the pointers to its children, with the allocator's part.
constexpr std::uint64_t kNodeBytes = 32, kPointersBytes = 80;

void check_memory(const std::filesystem::path& file, const detail::OctreeFile& checked) {
  const std::uint64_t need = checked.node_count * kNodeBytes + checked.parent_count * kPointersBytes,
                      available = available_memory();
  if (need > available)
    fail(file,
         "holds " + std::to_string(checked.node_count) + " nodes, which would take " +
             std::to_string(need >> 20U) + " MiB of memory where " + std::to_string(available >> 20U) +
             " MiB are available",
         "give a map of a coarser resolution");
}

}  // namespace

Octree read_octree(const std::filesystem::path& file) try {
  detail::OctreeFile checked = detail::read_checked_octree_file(file);
  check_memory(file, checked);
  checked.bytes.erase(0, checked.data_offset);
  std::istringstream nodes(std::move(checked.bytes));
  const auto read = [&](auto tree) -> Octree {
    if (checked.node_count == 0) return tree;
    if (checked.format == detail::OctreeFormat::kBinary)
      tree->readBinaryData(nodes);
    else
      tree->readData(nodes);
    return tree;
  };
  if (checked.tree_type == "ColorOcTree")
    return read(std::make_shared<octomap::ColorOcTree>(checked.resolution));
  return read(std::make_shared<octomap::OcTree>(checked.resolution));
} catch (const std::bad_alloc&) {
  fail(file, "takes more memory than there is", "give a smaller file");
}

}  // namespace frontlux
