#include "octomap/octomap_adapter.hpp"
#include "octomap/octree_file.hpp"

#include <frontlux/octomap.hpp>

#include <memory>
#include <sstream>

namespace frontlux {

Octree read_octree(const std::filesystem::path& file) {
  detail::OctreeFile checked = detail::read_checked_octree_file(file);
  std::istringstream nodes(checked.bytes.substr(checked.data_offset));
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
}

}  // namespace frontlux
