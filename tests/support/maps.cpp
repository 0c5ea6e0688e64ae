#include "support/maps.hpp"

#include "support/random.hpp"
#include "support/tree_state.hpp"

namespace frontlux::test {
namespace {

void fill(octomap::OcTree& tree, const KeyBox& box, float log_odds) {
  for_each_key(box, [&](const VoxelKey& key) { tree.setNodeValue(tree_key(key), log_odds, true); });
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
    fill(*tree, cube(make_key(x0, y0, z0), edge), occupied ? 3.5F : -2.0F);
  }
  for (int i = 0; i < 400; ++i) {
    const VoxelKey key = random.key_in(cube({32720, 32720, 32720}, 96));
    fill(*tree, {key, key}, random.one_in(2) ? 0.0F : -0.4F);  // 0 counts as occupied
  }
  for (const int far : {3, 33100, 65533}) fill(*tree, cube(make_key(far, far, 32768), 1), 1.0F);
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

std::shared_ptr<octomap::OcTree> make_noise_tree(std::uint64_t seed, double resolution, int edge) {
  auto tree = std::make_shared<octomap::OcTree>(resolution);
  Random random(seed);
  const int low = 32768 - edge / 2;
  for_each_key(cube(make_key(low, low, low), edge), [&](const VoxelKey& key) {
    const int state = random.below(3);
    if (state != 0) fill(*tree, {key, key}, state == 1 ? -1.0F : 1.0F);
  });
  tree->updateInnerOccupancy();
  return tree;
}

std::shared_ptr<octomap::OcTree> make_sparse_tree(int edge) {
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  const auto along = [&](int i) { return static_cast<octomap::key_type>(32768 + 512 * (i - edge / 2)); };
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        tree->updateNode(octomap::OcTreeKey(along(x), along(y), along(z)), true, true);
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
