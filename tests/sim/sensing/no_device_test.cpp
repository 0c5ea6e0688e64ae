// Where Embree makes no device. In a program of its own, in which this is what Embree answers.

#include "support/test.hpp"

#include <frontlux/ray_caster.hpp>
#include <frontlux/sim/surface.hpp>
#include <frontlux/voxel_grid.hpp>

#include <new>

namespace {

int embree_error = 0;

}  // namespace

extern "C" {
[[gnu::visibility("default")]] void* rtcNewDevice(const char* config);
[[gnu::visibility("default")]] int rtcGetDeviceError(void* device);

void* rtcNewDevice(const char* /*config*/) { return nullptr; }
int rtcGetDeviceError(void* /*device*/) { return embree_error; }
}

namespace frontlux::test {
namespace {

constexpr int kUnknown = 1, kOutOfMemory = 4, kUnsupportedCpu = 5;  // as Embree 3 and 4 number them

template <class Make>
void expect_told_apart(const Make& make) {
  embree_error = kOutOfMemory;
  EXPECT_THROW(make(), std::bad_alloc);
  for (const int error : {kUnknown, kUnsupportedCpu}) {
    embree_error = error;
    EXPECT_THROW(make(), std::runtime_error) << error;
  }
}

TEST(NoDevice, OfARayCasterIsToldFromBeingOutOfMemory) {
  VoxelGrid grid(0.1);
  grid.set({1, 2, 3}, Occupancy::kOccupied);
  expect_told_apart([&] { static_cast<void>(make_embree_ray_caster(grid)); });
}

TEST(NoDevice, OfASurfaceIsToldFromBeingOutOfMemory) {
  const sim::TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  expect_told_apart([&] { const sim::Surface surface(mesh); });
}

}  // namespace
}  // namespace frontlux::test
