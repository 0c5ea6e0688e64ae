// The ROS side of Explorer: converts messages, and nothing else.

#include "explorer.hpp"

#include <frontlux/io/robot_file.hpp>

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <nav_msgs/msg/path.hpp>
#include <octomap/OcTree.h>
#include <octomap_msgs/conversions.h>
#include <octomap_msgs/msg/octomap.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>
#include <std_msgs/msg/empty.hpp>
#include <tf2_eigen/tf2_eigen.hpp>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <chrono>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

class ExplorerNode : public rclcpp::Node {
 public:
  ExplorerNode()
      : Node("frontlux_explorer"),
        map_frame_(declare_parameter("map_frame", std::string("map"))),
        sensor_frame_(declare_parameter("sensor_frame", std::string("sensor"))),
        explorer_(options()),
        buffer_(get_clock()),
        listener_(buffer_),
        path_(create_publisher<nav_msgs::msg::Path>("trajectory", rclcpp::QoS(1).transient_local())),
        octomap_(create_publisher<octomap_msgs::msg::Octomap>("octomap", rclcpp::QoS(1).transient_local())) {
    cloud_ = create_subscription<sensor_msgs::msg::PointCloud2>(
        "cloud", rclcpp::SensorDataQoS(),
        [this](const sensor_msgs::msg::PointCloud2& cloud) { take(cloud); });
    stopped_ = told_at_rest("stopped", &Explorer::stopped);
    displaced_ = told_at_rest("displaced", &Explorer::displaced);
    timer_ = create_wall_timer(std::chrono::seconds(1), [this] { publish_map(); });
  }

 private:
  Explorer::Options options() {
    Explorer::Options options;
    options.robot = frontlux::io::read_robot(declare_parameter<std::string>("robot_file")).robot;
    options.resolution = declare_parameter("resolution", options.resolution);
    options.free_radius = declare_parameter("free_radius", options.free_radius);
    options.latency = declare_parameter("latency", options.latency);
    const auto reach = declare_parameter("reach", std::vector<double>{20.0, 20.0, 5.0});
    if (reach.size() != 3) throw std::invalid_argument("reach: three numbers [m]");
    options.reach = {reach[0], reach[1], reach[2]};
    return options;
  }

  // That the robot rests, where tf2 has it now.
  rclcpp::Subscription<std_msgs::msg::Empty>::SharedPtr told_at_rest(
      const char* topic, void (Explorer::*tell)(double, const Eigen::Isometry3d&)) {
    return create_subscription<std_msgs::msg::Empty>(
        topic, rclcpp::QoS(1), [this, topic, tell](const std_msgs::msg::Empty&) {
          try {
            (explorer_.*tell)(now().seconds(), pose_of(sensor_frame_, tf2::TimePointZero));
          } catch (const std::exception& error) {
            RCLCPP_WARN(get_logger(), "%s: %s", topic, error.what());
          }
        });
  }

  Eigen::Isometry3d pose_of(const std::string& frame, const tf2::TimePoint& time) {
    return tf2::transformToEigen(
        buffer_.lookupTransform(map_frame_, frame, time, tf2::durationFromSec(0.05)));
  }

  void take(const sensor_msgs::msg::PointCloud2& cloud) {
    try {
      const tf2::TimePoint taken = tf2_ros::fromMsg(cloud.header.stamp);
      const Eigen::Isometry3d T_map_sensor = pose_of(sensor_frame_, taken),
                              T_map_cloud = pose_of(cloud.header.frame_id, taken);
      std::vector<Eigen::Vector3f> points;
      for (sensor_msgs::PointCloud2ConstIterator<float> x(cloud, "x"), y(cloud, "y"), z(cloud, "z");
           x != x.end(); ++x, ++y, ++z)
        points.emplace_back(*x, *y, *z);
      const auto waypoints =
          explorer_.insert(rclcpp::Time(cloud.header.stamp).seconds(), T_map_sensor, T_map_cloud, points);
      if (waypoints) publish(*waypoints);
      if (const auto end = explorer_.end())
        RCLCPP_INFO_ONCE(get_logger(), "the exploration is over: %s", end->c_str());
    } catch (const std::exception& error) {  // no transform yet, or a wrong cloud: the next one may do
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "cloud left out: %s", error.what());
    }
  }

  void publish(const std::vector<Explorer::Waypoint>& waypoints) {
    nav_msgs::msg::Path path;
    path.header.frame_id = map_frame_;
    path.header.stamp = now();
    for (const Explorer::Waypoint& waypoint : waypoints) {
      geometry_msgs::msg::PoseStamped pose;
      pose.header.frame_id = map_frame_;
      pose.header.stamp =
          rclcpp::Time(static_cast<int64_t>(waypoint.time * 1e9), get_clock()->get_clock_type());
      const Eigen::AngleAxisd turn(waypoint.pose.yaw, Eigen::Vector3d::UnitZ());
      pose.pose = tf2::toMsg(Eigen::Isometry3d(Eigen::Translation3d(waypoint.pose.position) * turn));
      path.poses.push_back(pose);
    }
    path_->publish(path);
  }

  void publish_map() {
    if (explorer_.tree() == nullptr || octomap_->get_subscription_count() == 0) return;
    octomap_msgs::msg::Octomap message;
    if (!octomap_msgs::fullMapToMsg(*explorer_.tree(), message)) return;
    message.header.frame_id = map_frame_;
    message.header.stamp = now();
    octomap_->publish(message);
  }

  std::string map_frame_, sensor_frame_;
  Explorer explorer_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  rclcpp::Publisher<nav_msgs::msg::Path>::SharedPtr path_;
  rclcpp::Publisher<octomap_msgs::msg::Octomap>::SharedPtr octomap_;
  rclcpp::Subscription<sensor_msgs::msg::PointCloud2>::SharedPtr cloud_;
  rclcpp::Subscription<std_msgs::msg::Empty>::SharedPtr stopped_, displaced_;
  rclcpp::TimerBase::SharedPtr timer_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  try {
    rclcpp::spin(std::make_shared<ExplorerNode>());
  } catch (const std::exception& error) {
    RCLCPP_FATAL(rclcpp::get_logger("frontlux_explorer"), "%s", error.what());
    return 1;
  }
  rclcpp::shutdown();
}
