#pragma once

#include "isa/instruction_set.hpp"

#include <cstdint>
#include <span>

namespace frontlux::detail {

/// A box, by its centre and half its edges [voxels]; both are exact in float.
struct LocalBox {
  float center[3];
  float half[3];
};

/// The test of one box against a packet of `size` rays in Embree's layout: arrays of `size` floats after each
/// other, in the order of RTCRayN's and RTCHitN's fields. Lanes whose `valid` is 0 do not change.
struct BoxKernel {
  InstructionSet needs;

  /// A ray that surely passes through the box ends (t_far = -inf); one that comes within the tolerance of it
  /// without surely passing through gets `too_close[id] = 1`.
  void (*occluded)(const LocalBox& box, float tolerance, const int* valid, float* rays, unsigned size,
                   std::uint8_t* too_close);
  /// A ray that comes within the tolerance of the box takes it as its hit if it may enter it before its
  /// t_far. t_far then becomes the earliest time at which it may: no box that is truly entered first can lose
  /// to a later one by more than the tolerance.
  void (*intersect)(const LocalBox& box, float tolerance, const int* valid, float* ray_hits, unsigned size,
                    unsigned primitive, unsigned geometry);
};

/// Those that may run, the widest first.
[[nodiscard]] std::span<const BoxKernel> box_kernels();
/// The widest.
[[nodiscard]] const BoxKernel& box_kernel();

}  // namespace frontlux::detail
