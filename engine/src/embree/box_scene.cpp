#include "embree/box_scene.hpp"

#include "embree/box_kernel.hpp"
#include "embree/probe_order.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>
#include <xmmintrin.h>

namespace frontlux::detail {
namespace {

// Embree wants denormals flushed to zero while it works. The caller's mode comes back afterwards: castRay's
// arithmetic needs it, and it is not ours to change.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned saved_;
};

struct QueryContext {
  RTCIntersectContext embree;  // first: callbacks get a pointer to it
  std::uint8_t* too_close = nullptr;
};

// A group of boxes as the callbacks see it.
struct View {
  std::shared_ptr<const BoxGroup> group;
  std::array<float, 3> corner;  // in the scene's frame
  float cell, tolerance;

  [[nodiscard]] LocalBox box(unsigned index) const {
    const PackedBox packed = group->boxes[index];
    LocalBox box{};
    for (unsigned i = 0; i < 3; ++i) {
      const int first = first_cell(packed, i), end = last_cell(packed, i) + 1;
      box.center[i] = corner[i] + 0.5F * cell * static_cast<float>(first + end);
      box.half[i] = 0.5F * cell * static_cast<float>(end - first);
    }
    return box;
  }
};

void bounds_callback(const RTCBoundsFunctionArguments* args) {
  const auto& view = *static_cast<const View*>(args->geometryUserPtr);
  const LocalBox box = view.box(args->primID);
  // Padded beyond the tolerance, since the traversal rounds too: what the box test would call too close must
  // be reached.
  const float pad = 2.0F * view.tolerance;
  RTCBounds& bounds = *args->bounds_o;
  bounds.lower_x = box.center[0] - box.half[0] - pad;
  bounds.lower_y = box.center[1] - box.half[1] - pad;
  bounds.lower_z = box.center[2] - box.half[2] - pad;
  bounds.upper_x = box.center[0] + box.half[0] + pad;
  bounds.upper_y = box.center[1] + box.half[1] + pad;
  bounds.upper_z = box.center[2] + box.half[2] + pad;
}

void occluded_callback(const RTCOccludedFunctionNArguments* args) {
  const auto& view = *static_cast<const View*>(args->geometryUserPtr);
  const auto* context = reinterpret_cast<const QueryContext*>(args->context);
  box_kernel().occluded(view.box(args->primID), view.tolerance, args->valid,
                        reinterpret_cast<float*>(args->ray), args->N, context->too_close);
}

void intersect_callback(const RTCIntersectFunctionNArguments* args) {
  const auto& view = *static_cast<const View*>(args->geometryUserPtr);
  box_kernel().intersect(view.box(args->primID), view.tolerance, args->valid,
                         reinterpret_cast<float*>(args->rayhit), args->N, args->primID, args->geomID);
}

RTCRay make_ray(const Probe& probe, std::size_t id) {
  RTCRay ray;
  ray.org_x = probe.origin[0];
  ray.org_y = probe.origin[1];
  ray.org_z = probe.origin[2];
  ray.tnear = probe.t_near;
  ray.dir_x = probe.direction[0];
  ray.dir_y = probe.direction[1];
  ray.dir_z = probe.direction[2];
  ray.time = 0.0F;
  ray.tfar = probe.t_far;
  ray.mask = ~0U;
  ray.id = static_cast<unsigned>(id);
  ray.flags = 0;
  return ray;
}

}  // namespace

class BoxSceneDevice {
 public:
  BoxSceneDevice() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr) throw std::runtime_error("Embree cannot make a device on this machine");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* counter, ssize_t more, bool) {
          static_cast<std::atomic<std::ptrdiff_t>*>(counter)->fetch_add(more, std::memory_order_relaxed);
          return true;
        },
        &bytes_);
  }
  ~BoxSceneDevice() { rtcReleaseDevice(device_); }
  BoxSceneDevice(const BoxSceneDevice&) = delete;
  BoxSceneDevice& operator=(const BoxSceneDevice&) = delete;

  [[nodiscard]] RTCDevice get() const { return device_; }
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(bytes_, 0));
  }

 private:
  std::atomic<std::ptrdiff_t> bytes_{0};  // outlives the device, which counts down to the end
  RTCDevice device_;
};

std::shared_ptr<BoxSceneDevice> make_box_scene_device() { return std::make_shared<BoxSceneDevice>(); }
std::size_t memory_bytes(const BoxSceneDevice& device) { return device.bytes(); }

struct BoxScene::Embree {
  std::shared_ptr<BoxSceneDevice> device;
  RTCScene scene;
  float mean_edge = 0.0F;                    // of the boxes' largest faces, in voxels
  std::vector<std::unique_ptr<View>> views;  // by Embree's number of the geometry; null where there is none

  explicit Embree(std::shared_ptr<BoxSceneDevice> shared)
      : device(std::move(shared)), scene(rtcNewScene(device->get())) {
    // Only this pair makes Embree rebuild no more than the geometries that changed.
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  }
  ~Embree() { rtcReleaseScene(scene); }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  void attach(std::unique_ptr<View> view) {
    RTCGeometry geometry = rtcNewGeometry(device->get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(view->group->boxes.size()));
    rtcSetGeometryUserData(geometry, view.get());
    rtcSetGeometryBoundsFunction(geometry, &bounds_callback, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &occluded_callback);
    rtcSetGeometryIntersectFunction(geometry, &intersect_callback);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_LOW);
    rtcCommitGeometry(geometry);
    const unsigned id = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    if (id == RTC_INVALID_GEOMETRY_ID) throw std::runtime_error("Embree cannot take another geometry");
    if (id >= views.size()) views.resize(id + 1);
    views[id] = std::move(view);
  }
  // Embree's packets of sixteen neighbouring rays are faster while such rays mostly meet the same boxes;
  // where they diverge, single rays are. Rays from one place diverge with their length, and large boxes keep
  // them together. The factor was measured (docs/benchmarking.md). The answers are the same in both modes.
  [[nodiscard]] QueryContext make_context(const ProbeOrder& order) const {
    constexpr float kTogether = 8.0F;
    QueryContext context;
    rtcInitIntersectContext(&context.embree);
    if (order.mean_length() < kTogether * mean_edge)
      context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
  }

  void detach(std::size_t id) {
    rtcDetachGeometry(scene, static_cast<unsigned>(id));
    views[id].reset();
  }
};

BoxScene::BoxScene(std::shared_ptr<BoxSceneDevice> device)
    : embree_(std::make_unique<Embree>(std::move(device))) {}
BoxScene::~BoxScene() = default;

void BoxScene::update(const Blockers& blockers) {
  Eigen::AlignedBox3d keys;  // bounds, in keys
  std::unordered_map<const BoxGroup*, bool> wanted;
  for (const auto& group : blockers.groups) {
    if (group->boxes.empty()) continue;
    wanted.emplace(group.get(), true);
    keys.extend(Eigen::Vector3d(group->bounds.min.x, group->bounds.min.y, group->bounds.min.z));
    keys.extend(Eigen::Vector3d(group->bounds.max.x + 1, group->bounds.max.y + 1, group->bounds.max.z + 1));
  }
  const auto in_frame = [&] {
    const Eigen::Vector3d origin(origin_.x, origin_.y, origin_.z);
    return Eigen::AlignedBox3d(keys.min() - origin, keys.max() - origin);
  };
  const auto fits = [&] {
    return std::max(-in_frame().min().minCoeff(), in_frame().max().maxCoeff()) <= reach_;
  };
  bounds_.setEmpty();
  if (!wanted.empty()) {
    if (!fits()) {
      // A new frame, in the middle, where coordinates and with them rounding errors are smallest, and with
      // room to grow.
      for (std::size_t id = 0; id < embree_->views.size(); ++id)
        if (embree_->views[id]) embree_->detach(id);
      const Eigen::Vector3i middle = keys.center().cast<int>();
      origin_ = make_key(middle.x(), middle.y(), middle.z());
      reach_ = std::exp2(std::ceil(std::log2(keys.sizes().maxCoeff() * 0.5 + 2.0)));
      // A coordinate of at most `reach` voxels is off by reach * 2^-24. The dozen operations between a probe
      // and its answer each add a few of those; 2^-19 leaves room for 32. The constant covers castRay's own
      // rounding.
      tolerance_ = std::max(1e-4, std::ldexp(reach_, -19));
    }
    bounds_ = in_frame();
  }
  for (std::size_t id = 0; id < embree_->views.size(); ++id) {
    const auto& view = embree_->views[id];
    if (view && wanted.erase(view->group.get()) == 0) embree_->detach(id);
  }
  for (const auto& group : blockers.groups) {
    if (!wanted.contains(group.get())) continue;
    const auto local = [](std::uint16_t corner, std::uint16_t origin) {
      return static_cast<float>(corner - origin);
    };
    embree_->attach(
        std::make_unique<View>(View{group,
                                    {local(group->corner.x, origin_.x), local(group->corner.y, origin_.y),
                                     local(group->corner.z, origin_.z)},
                                    static_cast<float>(1 << group->log2_cell),
                                    static_cast<float>(tolerance_)}));
  }
  double face_area = 0.0, count = 0.0;
  for (const auto& group : blockers.groups) {
    if (group->log2_cell > 0) continue;  // whole nodes, few and huge, lie around the map
    face_area += static_cast<double>(group->face_area);
    count += static_cast<double>(group->boxes.size());
  }
  embree_->mean_edge = static_cast<float>(std::sqrt(face_area / std::max(count, 1.0)));
  rtcCommitScene(embree_->scene);
  const RTCError error = rtcGetDeviceError(embree_->device->get());
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error("Embree cannot build a scene of " + std::to_string(blockers.box_count()) +
                             " boxes (error " + std::to_string(error) + ")");
}

void BoxScene::occluded(std::span<const Probe> probes, std::span<Sight> sights) const {
  std::array<RTCRay, kMaxBatch> rays;
  std::array<std::uint8_t, kMaxBatch> too_close;
  const std::size_t size = probes.size();
  const ProbeOrder order(probes);
  std::fill_n(too_close.begin(), size, std::uint8_t{0});
  for (std::size_t i = 0; i < size; ++i) rays[i] = make_ray(probes[order[i]], order[i]);
  QueryContext context = embree_->make_context(order);
  context.too_close = too_close.data();
  {
    const FlushDenormals scope;
    rtcOccluded1M(embree_->scene, &context.embree, rays.data(), static_cast<unsigned>(size), sizeof(RTCRay));
  }
  for (std::size_t i = 0; i < size; ++i) {
    const bool hit = rays[i].tfar == -std::numeric_limits<float>::infinity();
    sights[order[i]] = hit ? Sight::kBlocked : too_close[order[i]] != 0 ? Sight::kTooClose : Sight::kClear;
  }
}

void BoxScene::first(std::span<const Probe> probes, std::span<std::optional<KeyBox>> boxes) const {
  std::array<RTCRayHit, kMaxBatch> rays;
  const std::size_t size = probes.size();
  const ProbeOrder order(probes);
  for (std::size_t i = 0; i < size; ++i) {
    rays[i].ray = make_ray(probes[order[i]], order[i]);
    rays[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rays[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  QueryContext context = embree_->make_context(order);
  {
    const FlushDenormals scope;
    rtcIntersect1M(embree_->scene, &context.embree, rays.data(), static_cast<unsigned>(size),
                   sizeof(RTCRayHit));
  }
  for (std::size_t i = 0; i < size; ++i) {
    const RTCHit& hit = rays[i].hit;
    boxes[order[i]] = hit.geomID == RTC_INVALID_GEOMETRY_ID
                          ? std::nullopt
                          : std::optional(embree_->views[hit.geomID]->group->box(hit.primID));
  }
}

}  // namespace frontlux::detail
