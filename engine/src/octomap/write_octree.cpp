#include "octomap/octomap_adapter.hpp"

#include <frontlux/file.hpp>

#include <ostream>
#include <stdexcept>

namespace frontlux {
namespace {

// The headers are our own: OctoMap's functions for whole files report on stderr, and round the resolution.
template <class Tree>
void write(const Tree& tree, const std::filesystem::path& file) {
  const bool binary = file.extension() == ".bt";
  if (!binary && file.extension() != ".ot")
    throw std::invalid_argument(file.string() + ": a map's file name ends in .bt or .ot");
  const auto write_tree = [&](const Tree& map) {
    write_file(file, [&](std::ostream& out) {
      out << (binary ? "# Octomap OcTree binary file" : "# Octomap OcTree file") << "\nid "
          << map.getTreeType() << "\nsize " << map.size() << "\nres " << decimals_of(map.getResolution())
          << "\ndata\n";
      if (map.size() == 0) return;
      binary ? map.writeBinaryNode(out, map.getRoot()) : map.writeData(out);
    });
  };
  if (!binary) return write_tree(tree);
  // Voxels that differ in their probability only are one leaf in such a file.
  Tree likely(tree);
  likely.toMaxLikelihood();
  likely.prune();
  write_tree(likely);
}

}  // namespace

void write_octree(const octomap::OcTree& tree, const std::filesystem::path& file) { write(tree, file); }
void write_octree(const octomap::ColorOcTree& tree, const std::filesystem::path& file) { write(tree, file); }
void write_octree(const Octree& tree, const std::filesystem::path& file) {
  std::visit([&](const auto& t) { write(*t, file); }, tree);
}

}  // namespace frontlux
