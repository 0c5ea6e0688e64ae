#include "explore/explore_options.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <stdexcept>
#include <utility>

namespace frontlux::app {
namespace {

using Json = nlohmann::ordered_json;

// Every member with its name, in one place for both ways.
template <class Options, class Visit>
void for_each_member(Options& options, const Visit& visit) {
  visit("world", options.source.world);
  visit("scale", options.source.scale);
  visit("up", options.source.up);
  visit("start", options.source.start);
  visit("ground", options.source.ground);
  visit("team", options.team);
  visit("robot_files", options.robot_files);
  visit("poses", options.poses);
  visit("mode", options.mode);
  visit("goal", options.goal);
  visit("planner", options.search);
  visit("renderer", options.renderer);
  visit("distribute", options.distribute);
  visit("optimize", options.optimize);
  visit("caster", options.caster);
  visit("seed", options.seed);
  visit("max_steps", options.max_steps);
  visit("epsilon", options.epsilon);
  visit("lambda", options.lambda);
  visit("advance", options.advance);
  visit("min_distance", options.min_distance);
  visit("samples", options.samples);
  visit("resolution", options.resolution);
  visit("noise", options.noise);
  visit("dropout", options.dropout);
}

}  // namespace

std::string to_json(const ExploreOptions& options) {
  Json json = Json::object();
  for_each_member(options, [&](const char* name, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, std::optional<std::string>>) {
      if (value) json[name] = *value;
    } else {
      json[name] = value;
    }
  });
  // File names are bytes, JSON is Unicode.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ExploreOptions explore_options_of(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    if (!json.is_object()) throw std::runtime_error("they are no JSON object");
    ExploreOptions options;
    for_each_member(options, [&](const char* name, auto& value) {
      const auto found = json.find(name);
      if (found == json.end()) return;
      using Value = std::decay_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, std::optional<std::string>>)
        value = found->template get<std::string>();
      else
        value = found->template get<Value>();
    });
    return options;
  } catch (const Json::exception& error) {
    throw std::runtime_error(error.what());
  }
}

}  // namespace frontlux::app
