#include "embree/box_scene.hpp"

#include "embree/box_kernel.hpp"
#include "embree/embree_query.hpp"
#include "embree/probe_order.hpp"

#include <frontlux/floating_point_mode.hpp>
#include <frontlux/thread_sanitizer.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace frontlux::detail {
namespace {

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
  take_over(&view);
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
  hand_over(&view.cell);  // another address: callbacks are in no order among themselves
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

}  // namespace

class BoxSceneDevice {
 public:
  BoxSceneDevice() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr && rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (device_ == nullptr) throw std::runtime_error("Embree cannot make a device on this machine");
    hand_over(&bytes_);
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* counter, ssize_t more, bool) {
          take_over(counter);
          static_cast<std::atomic<std::ptrdiff_t>*>(counter)->fetch_add(more, std::memory_order_relaxed);
          return true;
        },
        &bytes_);
    const auto native = [this](RTCDeviceProperty size) { return rtcGetDeviceProperty(device_, size) != 0; };
    packet_size_ = native(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)  ? 16
                   : native(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) ? 8
                   : native(RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED) ? 4
                                                                       : 1;
  }
  ~BoxSceneDevice() { rtcReleaseDevice(device_); }
  BoxSceneDevice(const BoxSceneDevice&) = delete;
  BoxSceneDevice& operator=(const BoxSceneDevice&) = delete;

  [[nodiscard]] RTCDevice get() const { return device_; }
  /// The widest packets that Embree traverses as such here; it takes wider ones apart, and loses their ids.
  [[nodiscard]] unsigned packet_size() const { return packet_size_; }
  [[nodiscard]] std::size_t bytes() const {
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(bytes_, 0));
  }

 private:
  std::atomic<std::ptrdiff_t> bytes_{0};  // outlives the device, which counts down to the end
  RTCDevice device_;
  unsigned packet_size_ = 1;
};

std::shared_ptr<BoxSceneDevice> make_box_scene_device() {
  (void)box_kernel();  // throws here, if it has to, and not in a callback from Embree
  return std::make_shared<BoxSceneDevice>();
}
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
    hand_over(view.get());
    const unsigned id = rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    if (id == RTC_INVALID_GEOMETRY_ID) {
      check("take another geometry");
      throw std::runtime_error("Embree cannot take another geometry");
    }
    if (id >= views.size()) views.resize(id + 1);
    views[id] = std::move(view);
  }
  // Rays that mostly meet the same boxes: rays from one place diverge with their length, and large boxes keep
  // them together. The factor was measured (docs/benchmarking.md); the answers are the same.
  [[nodiscard]] bool coherent(const ProbeOrder& order) const {
    constexpr float kTogether = 8.0F;
    return order.mean_length() < kTogether * mean_edge;
  }
  // Calls visit<size>() with the size of packets, or 1.
  template <class Visit>
  void visit_size(bool in_packets, const Visit& visit) const {
    switch (in_packets ? device->packet_size() : 1) {
      case 16:
        return visit.template operator()<16>();
      case 8:
        return visit.template operator()<8>();
      case 4:
        return visit.template operator()<4>();
      default:
        return visit.template operator()<1>();
    }
  }
  /// @throws std::bad_alloc or std::runtime_error if Embree has failed at something
  void check(const std::string& what) const {
    const RTCError error = rtcGetDeviceError(device->get());
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree cannot " + what + " (error " + std::to_string(error) + ")");
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
  std::unordered_set<const BoxGroup*> wanted;
  for (const auto& group : blockers.groups) {
    if (group->boxes.empty()) continue;
    wanted.insert(group.get());
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
      // and its answer each add a few of those; 2^-19 leaves room for 32.
      tolerance_ = std::max(kLeastTolerance, std::ldexp(reach_, -19));
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
  for (const auto& view : embree_->views)
    if (view) take_over(&view->cell);
  embree_->check("build a scene of " + std::to_string(blockers.box_count()) + " boxes");
}

void BoxScene::occluded(std::span<const Probe> probes, std::span<Sight> sights) const {
  std::array<std::uint8_t, kMaxBatch> too_close;
  std::fill_n(too_close.begin(), probes.size(), std::uint8_t{0});
  const ProbeOrder order(probes);
  const bool coherent = embree_->coherent(order);
  EmbreeQuery query(embree_->scene, coherent, too_close.data());
  const auto sight = [&](std::size_t id, float t_far) {
    sights[id] = t_far == -std::numeric_limits<float>::infinity() ? Sight::kBlocked
                 : too_close[id] != 0                             ? Sight::kTooClose
                                                                  : Sight::kClear;
  };
  const FloatingPointMode flushed(FloatingPointMode::kFlushed);
  // A ray that is blocked early leaves a packet with idle lanes, unless its neighbours are too.
  embree_->visit_size(coherent && order.share_origins(), [&]<unsigned kSize>() {
    if constexpr (kSize == 1) {
      for (std::size_t id = 0; id < probes.size(); ++id) {
        RTCRay ray = make_ray(probes[id], id);
        query.occluded(ray);
        sight(id, ray.tfar);
      }
    } else {
      typename Packet<kSize>::Rays rays;
      for_each_packet<kSize>(probes.size(), [&](std::size_t first, unsigned count, const int* valid) {
        for (unsigned lane = 0; lane < count; ++lane)
          set_ray(rays, lane, probes[order[first + lane]], order[first + lane]);
        query.occluded<kSize>(valid, rays);
        for (unsigned lane = 0; lane < count; ++lane) sight(order[first + lane], rays.tfar[lane]);
      });
    }
  });
}

void BoxScene::first(std::span<const Probe> probes, std::span<std::optional<KeyBox>> boxes) const {
  const ProbeOrder order(probes);
  EmbreeQuery query(embree_->scene, embree_->coherent(order), nullptr);
  const auto box = [&](unsigned geometry, unsigned primitive) {
    return geometry == RTC_INVALID_GEOMETRY_ID
               ? std::nullopt
               : std::optional(embree_->views[geometry]->group->box(primitive));
  };
  const FloatingPointMode flushed(FloatingPointMode::kFlushed);
  embree_->visit_size(order.share_origins(), [&]<unsigned kSize>() {
    if constexpr (kSize == 1) {
      for (std::size_t id = 0; id < probes.size(); ++id) {
        RTCRayHit ray;
        ray.ray = make_ray(probes[id], id);
        ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        query.intersect(ray);
        boxes[id] = box(ray.hit.geomID, ray.hit.primID);
      }
    } else {
      typename Packet<kSize>::RayHits rays;
      for_each_packet<kSize>(probes.size(), [&](std::size_t first, unsigned count, const int* valid) {
        for (unsigned lane = 0; lane < count; ++lane) {
          set_ray(rays.ray, lane, probes[order[first + lane]], order[first + lane]);
          rays.hit.geomID[lane] = rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        query.intersect<kSize>(valid, rays);
        for (unsigned lane = 0; lane < count; ++lane)
          boxes[order[first + lane]] = box(rays.hit.geomID[lane], rays.hit.primID[lane]);
      });
    }
  });
}

}  // namespace frontlux::detail
