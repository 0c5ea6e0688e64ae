#include "octomap/octomap_adapter.hpp"
#include "octomap/octree_file.hpp"

#include <frontlux/file.hpp>

#include <ostream>
#include <stdexcept>
#include <string>

namespace frontlux {
namespace {

// The headers are our own: OctoMap's functions for whole files report on stderr, and round the resolution.
template <class Tree>
void write(const Tree& tree, const std::filesystem::path& file) {
  const bool binary = file.extension() == ".bt";
  if (file.native().find('\0') != std::string::npos)
    throw std::invalid_argument("'" + std::string(file.c_str()) +
                                "...': a file name cannot hold a byte of 0");
  if (!binary && file.extension() != ".ot")
    throw std::invalid_argument("'" + file.string() + "': a map's file name ends in .bt or .ot");
  const double resolution = tree.getResolution();
  if (!(resolution >= detail::kMinResolution && resolution <= detail::kMaxResolution))
    throw std::invalid_argument(file.string() + ": the resolution, " + decimals_of(resolution) +
                                " m, is not from 1e-9 to 1e9 m");
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
  if (likely.size() == 1)
    throw std::invalid_argument(
        file.string() +
        ": the map is a root without children, of which a .bt cannot say whether it is "
        "free or occupied; write an .ot file");
  write_tree(likely);
}

}  // namespace

void write_octree(const octomap::OcTree& tree, const std::filesystem::path& file) { write(tree, file); }
void write_octree(const octomap::ColorOcTree& tree, const std::filesystem::path& file) { write(tree, file); }
void write_octree(const Octree& tree, const std::filesystem::path& file) {
  std::visit([&](const auto& t) { write(*detail::there(t), file); }, tree);
}

}  // namespace frontlux
