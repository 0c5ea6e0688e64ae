#include <frontlux/file.hpp>
#include <frontlux/io/robot_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace frontlux::io {
namespace {

using nlohmann::json, planner::Motion, planner::RobotDescription, planner::TravelOptions;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 20;
constexpr std::size_t kMaxDepth = 2;  // the robot and, in it, the sensor or the box
constexpr std::size_t kMaxName = 40;
constexpr std::uint64_t kMaxRays = std::uint64_t{1} << 26;

struct Range {
  double low, high;
};
constexpr Range kBox{0.01, 100.0}, kHeight{0.0, 100.0}, kSensorRange{0.01, 1000.0}, kAngle{0.1, 179.0};

// One object of the file: takes its members one by one and complains about those that are left.
class Members {
 public:
  Members(const std::filesystem::path& file, const json& object, std::string prefix)
      : file_(file), object_(object), prefix_(std::move(prefix)) {}

  [[noreturn]] void refuse(const char* name, const std::string& what, const std::string& advice) const {
    fail(file_, prefix_ + name + " " + what, advice);
  }

  [[nodiscard]] const json* find(const char* name) {
    known_.emplace_back(name);
    const auto member = object_.find(name);
    return member == object_.end() ? nullptr : &*member;
  }
  [[nodiscard]] const json& get(const char* name, const std::string& what) {
    if (const json* member = find(name)) return *member;
    refuse(name, "is missing", "give " + what);
  }

  [[nodiscard]] std::string text(const char* name, const std::string& what) {
    const json& value = get(name, what);
    if (!value.is_string()) refuse(name, "is " + shown(value), "give " + what);
    return value.get<std::string>();
  }
  [[nodiscard]] double number(const char* name, const char* unit, const Range& range) {
    return number(name, get(name, wanted(unit, range)), unit, range);
  }
  [[nodiscard]] double number(const char* name, const char* unit, const Range& range, double otherwise) {
    const json* value = find(name);
    return value == nullptr ? otherwise : number(name, *value, unit, range);
  }
  [[nodiscard]] double number(const char* name, const json& value, const char* unit,
                              const Range& range) const {
    const bool fits =
        value.is_number() && value.get<double>() >= range.low && value.get<double>() <= range.high;
    if (!fits) refuse(name, "is " + shown(value), "give " + wanted(unit, range));
    return value.get<double>();
  }
  [[nodiscard]] std::size_t count(const char* name) {
    const std::string what = "a whole number from 1 to " + std::to_string(kMaxRays);
    const json& value = get(name, what);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() < 1 ||
        value.get<std::uint64_t>() > kMaxRays)
      refuse(name, "is " + shown(value), "give " + what);
    return value.get<std::size_t>();
  }
  [[nodiscard]] bool flag(const char* name, bool otherwise) {
    const json* value = find(name);
    if (value != nullptr && !value->is_boolean()) refuse(name, "is " + shown(*value), "give true or false");
    return value == nullptr ? otherwise : value->get<bool>();
  }

  // Members of another kind of robot or sensor.
  void not_here(std::initializer_list<const char*> names, const std::string& why) const {
    for (const char* name : names)
      if (object_.contains(name)) refuse(name, why, "leave it out");
  }
  void expect_no_more() const {
    for (const auto& [name, value] : object_.items()) {
      if (std::ranges::find(known_, name) != known_.end()) continue;
      std::string all;
      for (const std::string& one : known_) all += (all.empty() ? "" : ", ") + one;
      fail(file_, "the member " + quote(prefix_ + name) + " is not known", "known here: " + all);
    }
  }

  [[nodiscard]] static std::string shown(const json& value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return "an array of " + std::to_string(value.size());
    if (value.is_string()) return quote(value.get_ref<const std::string&>());
    return value.dump();
  }

 private:
  [[nodiscard]] static std::string wanted(const char* unit, const Range& range) {
    return "a number from " + decimals_of(range.low) + " to " + decimals_of(range.high) + " " + unit;
  }

  const std::filesystem::path& file_;
  const json& object_;
  std::string prefix_;
  std::vector<std::string> known_;
};

// "line 3, column 7"
std::string place_of(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte == 0 ? 0 : byte - 1);
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t begin = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - begin + 1);
}

json parsed(const std::filesystem::path& file, const std::string& text) {
  std::vector<std::set<std::string>> names;  // of the objects that are open
  std::string last = "the file";
  const auto look = [&](int depth, json::parse_event_t event, json& value) {
    const auto level = static_cast<std::size_t>(depth);
    switch (event) {
      case json::parse_event_t::object_start:
      case json::parse_event_t::array_start:
        if (level >= kMaxDepth)
          fail(file, last + " is nested too deeply", "see docs/robots.md for the members of a robot");
        names.resize(level + 1);
        names.back().clear();
        break;
      case json::parse_event_t::key: {
        const auto& name = value.get_ref<const std::string&>();
        last = quote(name);
        if (!names.back().insert(name).second)
          fail(file, "the member " + last + " is there twice", "keep one of them");
        break;
      }
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        names.resize(level);
        break;
      case json::parse_event_t::value:
        break;
    }
    return true;
  };
  try {
    return json::parse(text, look);
  } catch (const json::parse_error& error) {
    fail(file, place_of(text, error.byte) + ": this is not JSON (after " + last + ")",
         "look for a missing comma, quote or bracket; NaN, infinity and comments are not JSON");
  } catch (const json::out_of_range&) {
    fail(file, "a number is too large, in or after " + last, "give a smaller one");
  }
}

void read_sensor(const std::filesystem::path& file, const json& object, RobotDescription& robot) {
  using Shape = FieldOfView::Shape;
  Members members(file, object, "sensor.");
  FieldOfView& view = robot.robot.view;
  const std::string kinds = "\"spinning\", \"camera\" or \"cone\"";
  const std::string kind = members.text("kind", kinds);
  if (kind == "spinning") {
    members.not_here({"horizontal_deg"}, "is not for a spinning sensor, which sees all around");
    view.shape = Shape::kSpinning;
  } else if (kind == "camera") {
    view.shape = Shape::kPyramid;
  } else if (kind == "cone") {
    members.not_here({"vertical_deg"}, "is not for a cone, which is as high as it is wide");
    view.shape = Shape::kCone;
  } else {
    members.refuse("kind", "is " + quote(kind), "give " + kinds);
  }
  if (view.shape != Shape::kSpinning)
    view.horizontal = members.number("horizontal_deg", "degrees", kAngle) * kDegree;
  if (view.shape != Shape::kCone) view.vertical = members.number("vertical_deg", "degrees", kAngle) * kDegree;
  view.max_range = members.number("range_m", "m", kSensorRange);
  robot.columns = members.count("columns");
  robot.rows = members.count("rows");
  if (robot.columns > kMaxRays / robot.rows)
    members.refuse(
        "rows",
        "is " + std::to_string(robot.rows) + ", too many with " + std::to_string(robot.columns) + " columns",
        "give at most " + std::to_string(kMaxRays) + " rays in all");
  members.expect_no_more();
}

// Edges in metres, one along each axis.
template <int kAxes>
Eigen::Matrix<double, kAxes, 1> edges(const Members& members, const char* name, const json& value,
                                      const std::string& what) {
  if (!value.is_array() || value.size() != kAxes)
    members.refuse(name, "is " + Members::shown(value), "give " + what);
  Eigen::Matrix<double, kAxes, 1> edges;
  for (int i = 0; i < kAxes; ++i)
    edges[i] = members.number(name, value[static_cast<std::size_t>(i)], "m along each axis", kBox);
  return edges;
}

void read_travel(Members& members, TravelOptions& travel) {
  const std::string motions = "\"plane\" or \"space\"";
  const std::string motion = members.text("motion", motions);
  if (motion != "plane" && motion != "space")
    members.refuse("motion", "is " + quote(motion), "give " + motions);
  travel.motion = motion == "plane" ? Motion::kPlane : Motion::kSpace;

  const std::string three = "three numbers in metres, along x, y and z";
  travel.extents = edges<3>(members, "box_m", members.get("box_m", three), three);
  if (travel.motion == Motion::kPlane) {
    members.not_here({"min_height_m", "node_edge_m"}, "is for a robot with the motion \"space\"");
    travel.sensor_height = members.number("mount_height_m", "m", kHeight);
    travel.require_ground = members.flag("require_ground", travel.require_ground);
    if (const json* ground = members.find("ground_m"))
      travel.ground_extents = edges<2>(members, "ground_m", *ground, "two numbers in metres, along x and y");
  } else {
    members.not_here({"mount_height_m", "require_ground", "ground_m"},
                     "is for a robot with the motion \"plane\"");
    travel.min_height = members.number("min_height_m", "m", kHeight, travel.min_height);
    if (members.find("node_edge_m") != nullptr)
      travel.node_edge = members.number("node_edge_m", "m", {travel.extents.maxCoeff(), kBox.high});
  }
}

}  // namespace

RobotDescription read_robot(const std::filesystem::path& file) {
  std::error_code no_size;
  const std::uintmax_t size = std::filesystem::file_size(file, no_size);
  if (!no_size && size > kMaxBytes)
    fail(file, "has " + std::to_string(size) + " bytes, too many for a robot",
         "give a description of at most " + std::to_string(kMaxBytes) + " bytes");
  const json object = parsed(file, read_file(file));
  if (!object.is_object())
    fail(file, "holds " + Members::shown(object) + " and no object",
         "describe a robot between { and }, see docs/robots.md");

  RobotDescription robot;
  Members members(file, object, "");
  const std::string names = "1 to " + std::to_string(kMaxName) + " letters, digits, - and _";
  robot.robot.name = members.text("name", names);
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (robot.robot.name.empty() || robot.robot.name.size() > kMaxName ||
      !std::ranges::all_of(robot.robot.name, fits))
    members.refuse("name", "is " + quote(robot.robot.name), "give " + names);
  read_travel(members, robot.robot.travel);
  const json& sensor = members.get("sensor", "an object, see docs/robots.md");
  if (!sensor.is_object())
    members.refuse("sensor", "is " + Members::shown(sensor), "give an object, see docs/robots.md");
  read_sensor(file, sensor, robot);
  members.expect_no_more();
  return robot;
}

}  // namespace frontlux::io
