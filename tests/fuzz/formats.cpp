#include "fuzz/formats.hpp"

#include "parts.hpp"
#include "planner/recording/random_recording.hpp"
#include "recording/record_bytes.hpp"
#include "recording/recording_format.hpp"
#include "setup/explore_options.hpp"
#include "support/input_test.hpp"

#include <frontlux/file.hpp>
#include <frontlux/io/point_cloud.hpp>
#include <frontlux/io/pose_file.hpp>
#include <frontlux/io/robot_file.hpp>
#include <frontlux/io/scan_graph.hpp>
#include <frontlux/io/task_file.hpp>
#include <frontlux/octomap.hpp>
#include <frontlux/planner/recording.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>
#include <octomap/ScanGraph.h>

#include <unistd.h>

namespace frontlux::fuzz {
namespace {

namespace fs = std::filesystem;
using planner::RecordingHead;

// Where the bytes lie while they are read.
fs::path place(const std::string& ending) {
  return fs::temp_directory_path() / ("frontlux_fuzz_" + std::to_string(::getpid()) + ending);
}

template <class Read>
bool read_as(const std::string& ending, const std::string& bytes, const Read& read) {
  struct File {
    fs::path path;
    ~File() {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
  } const file{place(ending)};
  std::ofstream(file.path, std::ios::binary) << bytes;
  try {
    read(file.path);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

template <class Write>
std::string written(const std::string& ending, const Write& write) {
  const fs::path file = place(ending);
  write(file);
  std::string bytes = read_file(file);
  fs::remove(file);
  return bytes;
}

// ---- maps

bool read_map(const std::string& bytes) {
  return read_as(".ot", bytes, [](const fs::path& file) {
    static_cast<void>(make_voxel_grid(read_octree(file)).known_bounds());
  });
}

template <class Tree>
std::vector<std::string> maps_of() {
  Tree tree(0.1);
  for (int i = 0; i < 40; ++i)
    tree.updateNode(octomap::point3d(0.1F * static_cast<float>(i % 7), 0.3F, 0.1F * static_cast<float>(i)),
                    i % 3 == 0);
  tree.updateInnerOccupancy();
  std::ostringstream full, binary;
  tree.write(full);
  tree.writeBinary(binary);
  return {full.str(), binary.str()};
}

std::vector<std::string> map_seeds() {
  std::vector<std::string> seeds = maps_of<octomap::OcTree>();
  seeds.push_back(maps_of<octomap::ColorOcTree>().front());
  return seeds;
}

// ---- meshes and clouds

template <const char* kEnding>
bool read_mesh(const std::string& bytes) {
  return read_as(kEnding, bytes, [](const fs::path& file) { static_cast<void>(sim::read_mesh_world(file)); });
}
constexpr char kPly[] = ".ply", kObj[] = ".obj", kStl[] = ".stl", kDae[] = ".dae", kGltf[] = ".gltf",
               kGlb[] = ".glb", kPcd[] = ".pcd";

sim::TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

std::vector<std::string> ply_seeds() {
  return {written(kPly, [](const fs::path& file) { sim::write_ply(file, tetrahedron()); }),
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty uchar red\n"
          "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 9 0\n1 0 9 0\n0 1 9 0\n3 0 1 2\n",
          "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
          "property uchar z\nelement face 1\nproperty list uchar uchar vertex_index\nend_header\n" +
              std::string("\0\0\0\1\0\0\0\1\0\3\0\1\2", 13)};
}

std::vector<std::string> obj_seeds() {
  return {"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2 3\nf -1 -2 -3\n"};
}

std::vector<std::string> stl_seeds() {
  return {
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
      "endsolid a\n"};
}

std::vector<std::string> dae_seeds() {
  return {
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="m" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)"};
}

std::vector<std::string> gltf_seeds() {
  return {R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
          R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":4}]}],)"
          R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
          R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":)"
          R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})"};
}

// Its header, then chunks: the scene, and the buffer that has no URI then.
std::vector<std::string> glb_seeds() {
  using test::bytes_of;
  const auto chunk = [&](const char* type, const std::string& bytes) {
    return bytes_of(static_cast<std::uint32_t>(bytes.size())) + std::string(type, 4) + bytes;
  };
  std::string json = gltf_seeds().front();
  json.replace(json.find(",\"uri\""), std::string::npos, "}]}");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string corners;
  for (const float number : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) corners += bytes_of(number);
  const std::string chunks = chunk("JSON", json) + chunk("BIN\0", corners);
  return {"glTF" + bytes_of(2U) + bytes_of(static_cast<std::uint32_t>(12 + chunks.size())) + chunks};
}

template <const char* kEnding>
bool read_cloud(const std::string& bytes) {
  return read_as(kEnding, bytes, [](const fs::path& file) { static_cast<void>(io::read_point_cloud(file)); });
}

std::vector<std::string> ply_cloud_seeds() {
  const std::string vertices =
      "element vertex 2\nproperty float x\nproperty uchar red\nproperty double z\nproperty short y\n";
  return {"ply\nformat ascii 1.0\ncomment a scan\n" + vertices + "end_header\n1.5 9 nan -2\n0 9 -7e2 1\n",
          "ply\nformat binary_little_endian 1.0\n" + vertices + "end_header\n" + std::string(30, '\1'),
          "ply\nformat binary_big_endian 1.0\nelement tag 1\nproperty list uchar short names\n" + vertices +
              "end_header\n" + std::string("\1\0\7", 3) + std::string(30, '\2')};
}

std::vector<std::string> pcd_seeds() {
  const std::string header =
      "VERSION 0.7\nFIELDS x y rgb z\nSIZE 4 8 1 4\nTYPE F F U F\nCOUNT 1 1 3 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  return {header + "ascii\n1 2 3 3 3 4\n-1 1e3 0 0 0 nan\n", header + "binary\n" + std::string(38, '\1')};
}

// ---- scans and poses

bool read_graph(const std::string& bytes) {
  return read_as(".graph", bytes, [](const fs::path& file) {
    for (const io::RecordedScan& scan : io::read_scan_graph(file))
      static_cast<void>(io::points_in_world(scan));
  });
}

std::vector<std::string> graph_seeds() {
  octomap::ScanGraph graph;
  for (int node = 0; node < 2; ++node) {
    auto* scan = new octomap::Pointcloud;  // the graph deletes it
    scan->push_back(1.F, 2.F, 3.F);
    graph.addNode(scan, octomap::pose6d(1, 2, 3, 0.1, 0.2, 0.3));
  }
  graph.addEdge(0, 1);
  std::ostringstream stream;
  graph.writeBinary(stream);
  return {stream.str()};
}

bool read_poses(const std::string& bytes) {
  const bool file =
      read_as(".csv", bytes, [](const fs::path& path) { static_cast<void>(io::read_pose_file(path)); });
  const bool list =
      read_as(".csv", bytes, [](const fs::path& path) { static_cast<void>(io::read_pose_list(path)); });
  return file || list;
}

std::vector<std::string> pose_seeds() {
  return {
      "file,x,y,z,qx,qy,qz,qw\n# a comment\na.pcd,1,-2.5,3e0,0,0,0.70710678,0.70710678\nb.ply,0,0,0.5,1.5\n",
      "x,y,z,yaw\n1,2,3,0.5\r\n4,5,6,-1\n"};
}

// ---- descriptions

std::vector<std::string> files_in(const char* folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(fs::path(FRONTLUX_DATA_DIR) / folder))
    if (entry.path().extension() == ".json") files.push_back(read_file(entry.path()));
  std::ranges::sort(files);
  return files;
}

bool read_robot(const std::string& bytes) {
  return read_as(".json", bytes, [](const fs::path& file) { static_cast<void>(io::read_robot(file)); });
}
std::vector<std::string> robot_seeds() { return files_in("robots"); }

bool read_task(const std::string& bytes) {
  return read_as(".json", bytes,
                 [](const fs::path& file) { static_cast<void>(io::task_text(io::read_task(file))); });
}
std::vector<std::string> task_seeds() { return files_in("tasks"); }

// ---- recordings

RecordingHead small_head() {
  test::Random random(1);
  return test::random_head(random, 2);
}

bool read_run(const std::string& bytes) {
  return read_as(".frontlux", bytes,
                 [](const fs::path& file) { static_cast<void>(planner::read_recording(file)); });
}

std::vector<std::string> run_seeds() {
  return {written(".frontlux", [](const fs::path& file) {
    test::Random random(2);
    const RecordingHead head = small_head();
    planner::RecordingWriter writer(file, head);
    for (std::uint64_t step = 0; step < 2; ++step) writer.write(test::random_step(random, head, step, 5));
    writer.write_end("stopped");
  })};
}

// A record without its checksums, which no mutation gets past, behind a byte that tells its kind: a head, a
// step of a format, or an end.
bool read_record(const std::string& bytes) {
  if (bytes.empty()) return false;
  const std::string_view record = std::string_view(bytes).substr(1);
  try {
    switch (bytes[0]) {
      case 'h':
        static_cast<void>(planner::detail::head_from(record));
        break;
      case '3':
      case '4':
      case '5':
        static_cast<void>(planner::detail::step_from(record, small_head(), 0, bytes[0] - '0'));
        break;
      default:
        static_cast<void>(planner::detail::end_from(record));
    }
    return true;
  } catch (const planner::detail::BadRecord&) {
    return false;
  }
}

std::vector<std::string> record_seeds() {
  test::Random random(3);
  const RecordingHead head = small_head();
  std::vector<std::string> seeds = {"h" + planner::detail::head_bytes(head),
                                    "e" + planner::detail::end_bytes("stopped")};
  for (int format = planner::detail::kOldestRecordingFormat; format <= planner::kRecordingFormat; ++format) {
    const planner::RecordedStep step = test::random_step(random, head, 0, format);
    seeds.push_back(std::to_string(format) + planner::detail::step_bytes(step, head, 0, format));
  }
  return seeds;
}

// ---- what lies beside a recording

planner::Recording small_recording() {
  test::Random random(4);
  planner::Recording recording;
  recording.head = small_head();
  recording.steps = {test::random_step(random, recording.head, 0, 5)};
  recording.end = "stopped";
  return recording;
}

bool read_run_json(const std::string& bytes) {
  static const planner::Recording recording = small_recording();
  static_cast<void>(report::detail::run_facts({"run", &recording, bytes}, "0"));
  return report::misfit(bytes, recording).empty();
}

std::vector<std::string> run_json_seeds() {
  return {R"({"world": "station \"\u00e9\"", "robots": ["ugv0", "uav"], "end": "stopped", "steps": 0,
    "clearance_min_m": 0.1, "separation_min_m": null, "by_robot": {"ugv0": {"idle_s": 1.5, "held_back": 2}}})"};
}

// The options of a run, in its recording and in run.json.
bool read_options(const std::string& bytes) {
  std::string written, again;
  try {
    written = app::json_text(app::explore_options_of(bytes));
    again = app::json_text(app::explore_options_of(written));
  } catch (const std::runtime_error&) {
    if (written.empty()) return false;
  }
  if (written != again) throw std::logic_error("options are written as " + written + ", then as " + again);
  return true;
}

std::vector<std::string> options_seeds() {
  app::ExploreOptions given;
  given.name = "night";
  given.source.world = "office.ply";
  given.source.box = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -2, 0), Eigen::Vector3d(8, 9.5, 3));
  given.source.scale = 0.001;
  given.source.start = Eigen::Vector3f(0.1F, 1, 1);
  given.world_path = {"/home/\xff/office.ply"};
  given.team.clear();
  given.robots = io::read_task(fs::path(FRONTLUX_DATA_DIR) / "tasks" / "room.json").robots;
  given.max_steps = 7;
  given.epsilon = 0.5;
  given.lockstep = true;
  app::read("uav=1,2,1.5,-0.5", given.poses.emplace_back());
  app::read("uav=120,ugv=3.5", given.failures);
  return {app::json_text({}), app::json_text(given)};
}

}  // namespace

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {"map", read_map, map_seeds},
      {"ply", read_mesh<kPly>, ply_seeds},
      {"pcd", read_cloud<kPcd>, pcd_seeds},
      {"ply_cloud", read_cloud<kPly>, ply_cloud_seeds},
      {"graph", read_graph, graph_seeds},
      {"poses", read_poses, pose_seeds},
      {"robot", read_robot, robot_seeds},
      {"task", read_task, task_seeds},
      {"recording", read_run, run_seeds},
      {"record", read_record, record_seeds},
      {"run_json", read_run_json, run_json_seeds},
      {"options", read_options, options_seeds},
      {"obj", read_mesh<kObj>, obj_seeds, false},
      {"stl", read_mesh<kStl>, stl_seeds, false},
      {"dae", read_mesh<kDae>, dae_seeds, false},
      {"gltf", read_mesh<kGltf>, gltf_seeds, false},
      {"glb", read_mesh<kGlb>, glb_seeds, false},
  };
  return all;
}

}  // namespace frontlux::fuzz
