#pragma once

#include <frontlux/ray.hpp>

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::app {

/// Builds one JSON object, member by member, in the order of the calls. Names are written as they are.
class JsonObject {
 public:
  JsonObject& add(std::string_view name, std::string_view text);
  JsonObject& add(std::string_view name, const char* text) { return add(name, std::string_view(text)); }
  JsonObject& add(std::string_view name, double number);
  JsonObject& add(std::string_view name, float number);
  JsonObject& add(std::string_view name, std::uint64_t number);
  JsonObject& add(std::string_view name, bool yes);
  JsonObject& add(std::string_view name, const VoxelKey& key);
  JsonObject& add(std::string_view name, const Eigen::Vector3f& point);
  JsonObject& add(std::string_view name, const Eigen::Vector3d& point);
  JsonObject& add(std::string_view name, const JsonObject& object);
  JsonObject& add(std::string_view name, std::span<const std::string> texts);
  /// @param value  that is JSON itself
  JsonObject& add_raw(std::string_view name, std::string_view value);
  JsonObject& add_null(std::string_view name);

  /// The object on one line.
  [[nodiscard]] std::string text() const { return std::string("{").append(members_) += "}"; }

 private:
  std::string members_;
};

}  // namespace frontlux::app
