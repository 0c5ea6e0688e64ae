#include "octomap/octomap_adapter.hpp"

#include <frontlux/file.hpp>
#include <frontlux/live_map.hpp>

#include <stdexcept>
#include <utility>
#include <vector>

namespace frontlux {
namespace {

// Makes a tree report changes. One that did not do so before does not do so afterwards.
class ChangeDetection {
 public:
  explicit ChangeDetection(const Octree& tree) : tree_(tree) {
    std::visit([this](const auto& t) { was_on_ = detail::there(t)->isChangeDetectionEnabled(); }, tree_);
    restart();
  }
  ChangeDetection(const ChangeDetection&) = delete;
  ChangeDetection& operator=(const ChangeDetection&) = delete;
  ~ChangeDetection() { set(was_on_); }

  // What has changed so far is not reported any more.
  void restart() { set(true); }

 private:
  void set(bool on) {
    std::visit(
        [on](const auto& t) {
          t->enableChangeDetection(on);
          t->resetChangeDetection();
        },
        tree_);
  }

  Octree tree_;
  bool was_on_ = false;
};

}  // namespace

struct LiveMap::State {
  Octree tree;
  ChangeDetection detection;
  OctreeMirror mirror;
  VoxelGrid told;  // the map of the last account: what throws before the next one loses no change
  std::unique_ptr<RayCaster> caster;
  std::vector<VoxelKey> keys{};

  explicit State(Octree map)
      : tree(std::move(map)),
        detection(tree),
        mirror(tree),
        told(mirror.grid()),
        caster(make_ray_caster(mirror.grid())) {}

  // Before the mirror is another one than the caster's.
  void check_resolution() const {
    const double now = std::visit([](const auto& t) { return t->getResolution(); }, tree);
    if (now != caster->lattice().resolution())
      throw std::invalid_argument("a map of resolution " + decimals_of(caster->lattice().resolution()) +
                                  " m cannot follow a tree of " + decimals_of(now) + " m");
  }

  MapChange take_in() {
    detection.restart();
    caster->update(mirror.grid());
    keys.clear();
    try {
      keys = changed_keys(told, mirror.grid());
    } catch (const std::length_error&) {  // more than can be told, ever
      told = mirror.grid();
      throw;
    }
    told = mirror.grid();
    return {mirror.grid(), keys};
  }
};

LiveMap::LiveMap(octomap::OcTree& tree) : LiveMap(Octree(detail::borrowed(tree))) {}
LiveMap::LiveMap(octomap::ColorOcTree& tree) : LiveMap(Octree(detail::borrowed(tree))) {}
LiveMap::LiveMap(Octree tree) : state_(std::make_unique<State>(std::move(tree))) {}
LiveMap::~LiveMap() = default;
LiveMap::LiveMap(LiveMap&&) noexcept = default;
LiveMap& LiveMap::operator=(LiveMap&&) noexcept = default;

MapChange LiveMap::update() {
  state_->check_resolution();
  state_->mirror.update();
  return state_->take_in();
}

MapChange LiveMap::rebuild() {
  state_->check_resolution();
  state_->mirror.rebuild();
  return state_->take_in();
}

const VoxelGrid& LiveMap::grid() const { return state_->mirror.grid(); }
const RayCaster& LiveMap::caster() const { return *state_->caster; }

}  // namespace frontlux
