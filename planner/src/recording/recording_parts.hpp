#pragma once

#include "recording/recording_bytes.hpp"

#include <frontlux/planner/pose.hpp>

#include <cmath>
#include <cstddef>

namespace frontlux::planner::detail {

/// What head and steps have in common. `Bytes` is a `RecordWriter`, and the values are constant, or a
/// `RecordReader`.

template <class Bytes, class Number>
void code_finite(Bytes& bytes, Number& value, const char* what) {
  bytes.number(value);
  bytes.require(std::isfinite(value), what);
}

template <class Bytes, class Number>
void code_length(Bytes& bytes, Number& value, const char* what) {
  bytes.number(value);
  bytes.require(std::isfinite(value) && value >= 0.0, what);
}

template <class Bytes, class AnyPose>
void code_pose(Bytes& bytes, AnyPose& pose) {
  constexpr const char* kWhat = "a pose is not finite";
  for (int axis = 0; axis < 3; ++axis) code_finite(bytes, pose.position[axis], kWhat);
  code_finite(bytes, pose.yaw, kWhat);
}

inline constexpr std::size_t kKeyBytes = 3;  // at least

template <class Bytes, class Keys>
void code_keys(Bytes& bytes, Keys& keys) {
  bytes.length(keys, kKeyBytes);
  bytes.keys(keys);
}

/// Why a run ended: a word of small letters and _, so that newer words need no newer format.
template <class Bytes, class Text>
void code_end(Bytes& bytes, Text& reason) {
  constexpr std::size_t kLongest = 40;
  bytes.text(reason);
  bytes.require(!reason.empty() && reason.size() <= kLongest &&
                    reason.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == reason.npos,
                "the reason of the end is not one word of small letters");
}

}  // namespace frontlux::planner::detail
