#include "support/maps.hpp"

#include "support/random.hpp"

#include <algorithm>
#include <cstdlib>

namespace frontlux::test {
namespace {

octomap::OcTreeKey key_at(int x, int y, int z) {
  return {static_cast<octomap::key_type>(x), static_cast<octomap::key_type>(y),
          static_cast<octomap::key_type>(z)};
}

std::vector<NamedMap> read_folder(const std::filesystem::path& folder) {
  std::vector<NamedMap> maps;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto extension = entry.path().extension();
    if (extension != ".bt" && extension != ".ot") continue;
    const Octree tree = read_octree(entry.path());
    if (const auto* occupancy = std::get_if<std::shared_ptr<octomap::OcTree>>(&tree))
      maps.push_back({entry.path().stem().string(), *occupancy});
  }
  std::sort(maps.begin(), maps.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return maps;
}

}  // namespace

std::shared_ptr<octomap::OcTree> make_random_tree(std::uint64_t seed, double resolution) {
  auto tree = std::make_shared<octomap::OcTree>(resolution);
  Random random(seed);
  // Free space first, as whole aligned cubes that prune to leaves of many sizes; then walls and specks in it.
  for (int i = 0; i < 60; ++i) {
    const int edge = 1 << random.below(5);
    const auto corner = [&] { return 32768 + (random.below(96) - 48) / edge * edge; };
    const int x0 = corner(), y0 = corner(), z0 = corner();
    const bool occupied = random.one_in(4);
    for (int x = 0; x < edge; ++x)
      for (int y = 0; y < edge; ++y)
        for (int z = 0; z < edge; ++z)
          tree->setNodeValue(key_at(x0 + x, y0 + y, z0 + z), occupied ? 3.5F : -2.0F, true);
  }
  for (int i = 0; i < 400; ++i) {
    const auto at = [&] { return 32768 + random.below(96) - 48; };
    tree->setNodeValue(key_at(at(), at(), at()), random.one_in(2) ? 0.0F : -0.4F,
                       true);  // 0 counts as occupied
  }
  for (const int far : {3, 33100, 65533}) tree->setNodeValue(key_at(far, far, 32768), 1.0F, true);
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

std::shared_ptr<octomap::OcTree> make_noise_tree(std::uint64_t seed, double resolution, int edge) {
  auto tree = std::make_shared<octomap::OcTree>(resolution);
  Random random(seed);
  for (int x = 0; x < edge; ++x)
    for (int y = 0; y < edge; ++y)
      for (int z = 0; z < edge; ++z) {
        const int state = random.below(3);
        const int low = 32768 - edge / 2;
        if (state != 0)
          tree->setNodeValue(key_at(low + x, low + y, low + z), state == 1 ? -1.0F : 1.0F, true);
      }
  tree->updateInnerOccupancy();
  return tree;
}

std::vector<NamedMap> small_maps() {
  std::vector<NamedMap> maps = read_folder(std::filesystem::path(FRONTLUX_DATA_DIR) / "maps");
  maps.push_back({"random_0.1m", make_random_tree(1, 0.1)});
  maps.push_back({"random_0.37m", make_random_tree(2, 0.37)});
  maps.push_back({"random_2m", make_random_tree(3, 2.0)});
  maps.push_back({"noise_0.3m", make_noise_tree(4, 0.3, 24)});
  return maps;
}

std::vector<NamedMap> extra_maps() {
  const char* folder = std::getenv("FRONTLUX_EXTRA_MAPS");
  return folder == nullptr ? std::vector<NamedMap>{} : read_folder(folder);
}

bool long_mode() {
  const char* value = std::getenv("FRONTLUX_LONG");
  return value != nullptr && std::string(value) == "1";
}

}  // namespace frontlux::test
