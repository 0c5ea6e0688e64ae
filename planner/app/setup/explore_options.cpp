#include "setup/explore_options.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace frontlux::app {
namespace {

using Json = nlohmann::ordered_json;

// Every member with its name, and of a number what it may be, in one place for both directions.
template <class Options, class Visit>
void for_each_member(Options& options, const Visit& visit) {
  visit("name", options.name);
  visit("world", options.source.world);
  visit("world_uri", options.world_path);
  visit("world_seed", options.source.seed, kSeeds);
  visit("box_m", options.source.box);
  visit("scale", options.source.scale, kAboveZero);
  visit("up", options.source.up);
  visit("start", options.source.start);
  visit("ground", options.source.ground);
  visit("team", options.team);
  visit("task_robots", options.robots);
  visit("robot_files", options.robot_files);
  visit("robot_uris", options.robot_paths);
  visit("poses", options.poses);
  visit("mode", options.mode);
  visit("goal", options.goal);
  visit("planner", options.search);
  visit("renderer", options.renderer);
  visit("assign", options.assign);
  visit("optimize", options.optimize);
  visit("tours_without", options.tours_without);
  visit("caster", options.caster);
  visit("sensor_model", options.sensor_model);
  visit("seed", options.seed, kSeeds);
  visit("max_steps", options.max_steps, kStepLimits);
  visit("epsilon", options.epsilon, kFromZero);
  visit("lambda", options.lambda, kFromZero);
  visit("advance", options.advance, kFromZero);
  visit("min_distance", options.min_distance, kFromZero);
  visit("samples", options.samples, kSampleCounts);
  visit("lockstep", options.lockstep);
  visit("latency", options.latency, kLatencies);
  visit("bumper", options.bumper);
  visit("stop_coverage", options.stop_coverage, kProbability);
  visit("stop_time", options.stop_time, kFromZero);
  visit("resolution", options.source.resolution, kVoxelEdges);
  visit("noise", options.errors.sigma, kRangeNoise);
  visit("noise_growth", options.errors.growth, kNoiseGrowth);
  visit("dropout", options.errors.dropout, kProbability);
  visit("stray", options.errors.stray, kProbability);
  visit("drift", options.pose_errors.drift, kProbability);
  visit("fix_every", options.pose_errors.fix_every, kFromZero);
  visit("tracking_error", options.pose_errors.tracking, kTrackingErrors);
  visit("scan_delay", options.message_errors.delay, kScanDelays);
  visit("scan_loss", options.message_errors.loss, kProbability);
  visit("fail", options.failures);
  visit("join", options.joins);
}

// A file's name is bytes, and JSON is Unicode: what is not plain in a URI is written as %41.
Json json_of(const AbsolutePath& path) {
  if (path.text.empty()) return {};
  constexpr std::string_view kPlain = "-._~/", kDigits = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : path.text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && (std::isalnum(byte) != 0 || kPlain.find(c) != std::string_view::npos))
      uri += c;
    else
      uri.append({'%', kDigits[byte >> 4U], kDigits[byte & 0xFU]});
  }
  return uri;
}

// Enumerations and starts as the words of the command line, the rest as JSON's own types.
template <class Value>
Json json_of(const Value& value) {
  if constexpr (Chosen<Value> && !std::is_same_v<Value, bool>)
    return choice_name(value);
  else
    return value;
}
Json json_of(const StartPose& start) { return start.word; }
Json json_of(const RobotTimes& times) { return times.each.empty() ? Json() : Json(times.word); }
Json json_of(const Eigen::Vector3f& point) {
  return {as_written(point.x()), as_written(point.y()), as_written(point.z())};
}
Json json_of(const GroundAlignment& ground) {
  if (ground.height) return *ground.height;
  return ground.align ? "auto" : "off";
}
Json json_of(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d &low = box.min(), &high = box.max();
  return {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
}
Json json_of(const std::vector<io::TaskRobot>& robots) {
  return robots.empty() ? Json() : Json::parse(io::robots_text(robots));
}
Json json_of(const std::vector<AbsolutePath>& paths) {
  Json list = Json::array();
  for (const AbsolutePath& path : paths) list.push_back(json_of(path));
  return paths.empty() ? Json() : list;
}
template <class Value>
Json json_of(const std::vector<Value>& values) {
  Json list = Json::array();
  for (const Value& value : values) list.push_back(json_of(value));
  return list;
}
template <class Value>
Json json_of(const std::optional<Value>& value) {
  return value ? json_of(*value) : Json();
}

// As a word of the command line, with which it has to agree.
std::string word_of(const Json& json) {
  if (!json.is_array()) return json.is_string() ? json.get<std::string>() : json.dump();
  std::string words;
  for (const Json& item : json) words.append(words.empty() ? "" : ",").append(word_of(item));
  return words;
}

template <class Value, class... Limits>
void take(const Json& json, Value& value, const Limits&... limits) {
  if constexpr (std::is_same_v<Value, bool>)
    json.get_to(value);
  else
    read(word_of(json), value, limits...);
}
void take(const Json& json, AbsolutePath& path) {
  const auto uri = json.get<std::string>();
  constexpr std::string_view kScheme = "file://";
  if (!uri.starts_with(kScheme)) throw std::runtime_error(quote(uri) + " is not the URI of a file");
  for (std::size_t i = kScheme.size(); i < uri.size(); ++i) {
    unsigned byte = static_cast<unsigned char>(uri[i]);
    if (uri[i] == '%') {
      const auto end = std::min(i + 3, uri.size());
      if (std::from_chars(uri.data() + i + 1, uri.data() + end, byte, 16).ptr != uri.data() + i + 3)
        throw std::runtime_error(quote(uri) + " is not the URI of a file");
      i += 2;
    }
    path.text += static_cast<char>(byte);
  }
}
void take(const Json& json, std::vector<io::TaskRobot>& robots) { robots = io::robots_of(json.dump()); }
template <class Value>
void take(const Json& json, std::vector<Value>& values) {
  for (const Json& item : json) take(item, values.emplace_back());
}
template <class Value, class... Limits>
void take(const Json& json, std::optional<Value>& value, const Limits&... limits) {
  take(json, value.emplace(), limits...);
}

}  // namespace

void read(std::string_view word, StartPose& start) {
  const std::size_t equals = word.find('=');
  const auto numbers = equals == std::string_view::npos ? std::nullopt : numbers_in(word.substr(equals + 1));
  if (!numbers || numbers->size() != 4)
    throw BadInput(quote(word) +
                   " is not a start; give NAME=x,y,z,yaw in metres and radians, as in ugv=1.5,-2,0.75,0");
  start.pose = {{(*numbers)[0], (*numbers)[1], (*numbers)[2]}, (*numbers)[3]};
  check_yaw(word, start.pose.yaw);
  start.word = word;
  start.robot = word.substr(0, equals);
}

void read(std::string_view word, RobotTimes& times) {
  times = {std::string(word), {}};
  for (std::string_view rest = word;; rest.remove_prefix(rest.find(',') + 1)) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t equals = part.find('=');
    RobotTimes::Time& time =
        times.each.emplace_back(RobotTimes::Time{std::string(part.substr(0, equals)), 0.0});
    try {
      if (equals == std::string_view::npos || equals == 0) throw BadInput("");
      read(part.substr(equals + 1), time.seconds, kRobotTimes);
    } catch (const BadInput&) {
      throw BadInput(quote(word) +
                     " does not name robots and times; give NAME=SECONDS, 0 to 100000, as in uav2=120, with "
                     "commas between");
    }
    if (rest.find(',') == std::string_view::npos) return;
  }
}

bool makes_tours(const ExploreOptions& options) {
  return !options.lockstep && options.mode == planner::Method::kDefault &&
         options.goal.value_or(planner::GoalSearch::kTour) == planner::GoalSearch::kTour;
}

std::vector<std::string_view> errors_in_motion(const ExploreOptions& options) {
  const auto& [drift, fix_every, tracking] = options.pose_errors;
  const auto& [delay, loss] = options.message_errors;
  std::vector<std::string_view> names;
  for (const auto& [given, name] : {std::pair(drift > 0.0, "drift"),
                                    {fix_every > 0.0, "fix-every"},
                                    {tracking > 0.0, "tracking-error"},
                                    {delay > 0.0, "scan-delay"},
                                    {loss > 0.0, "scan-loss"},
                                    {!options.failures.each.empty(), "fail"},
                                    {!options.joins.each.empty(), "join"}})
    if (given) names.emplace_back(name);
  return names;
}

std::vector<std::string_view> ignored_by_goals(const ExploreOptions& options) {
  const bool tours = makes_tours(options);
  const bool by_distance = tours || options.goal == planner::GoalSearch::kNearest;
  const bool exact = options.renderer == ViewQualityOptions::Renderer::kExact;
  std::vector<std::string_view> names;
  for (const auto& [given, name] : {std::pair(tours && !options.assign, "assign"),
                                    {tours && options.lambda, "lambda"},
                                    {tours && options.min_distance, "min-distance"},
                                    {by_distance && options.advance, "advance"},
                                    {by_distance && options.renderer, "renderer"},
                                    {(by_distance || exact) && options.samples, "samples"}})
    if (given) names.emplace_back(name);
  return names;
}

void note_paths(ExploreOptions& options) {
  const auto absolute = [](const std::string& file) {
    return AbsolutePath{std::filesystem::absolute(file).lexically_normal().string()};
  };
  if (!is_built_in_world(options.source.world)) options.world_path = absolute(options.source.world);
  for (const std::string& file : options.robot_files) options.robot_paths.push_back(absolute(file));
}

std::string json_text(const ExploreOptions& options) {
  Json json = Json::object();
  for_each_member(options, [&](const char* name, const auto& value, const auto&...) {
    Json member = json_of(value);
    if (!member.is_null()) json[name] = std::move(member);
  });
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ExploreOptions explore_options_of(const std::string& text) {
  constexpr int kDepth = 8;  // a box in the list of robots has five
  const auto not_too_deep = [](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDepth) throw std::runtime_error("they are nested too deeply");
    return true;
  };
  try {
    const Json json = Json::parse(text, not_too_deep);
    if (!json.is_object()) throw std::runtime_error("they are not a JSON object");
    ExploreOptions options;
    for_each_member(options, [&](const std::string& name, auto& value, const auto&... limits) {
      const auto found = json.find(name);
      if (found == json.end()) return;
      try {
        take(*found, value, limits...);
      } catch (const BadInput& error) {
        throw std::runtime_error(name + ": " + error.what());
      }
    });
    return options;
  } catch (const Json::exception& error) {
    throw std::runtime_error(error.what());
  }
}

}  // namespace frontlux::app
