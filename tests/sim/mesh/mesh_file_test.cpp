#include "support/address_limits.hpp"
#include "support/input_test.hpp"
#include "support/maps.hpp"
#include "support/random.hpp"

#include <frontlux/sim/built_in_worlds.hpp>
#include <frontlux/sim/mesh_file.hpp>

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <unistd.h>

namespace frontlux::sim {
namespace {

using test::content_of;

class MeshFile : public test::InputTest {
 protected:
  MeshFile() : InputTest([](const auto& file) { static_cast<void>(read_mesh_world(file)); }) {}

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }
};

// The corners of every triangle, which the order of vertices does not change.
std::vector<std::array<float, 9>> corners_of(const TriangleMesh& mesh) {
  std::vector<std::array<float, 9>> all;
  for (const auto& t : mesh.triangles) {
    all.emplace_back();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) all.back()[3 * i + k] = mesh.vertices[t[i]][static_cast<int>(k)];
  }
  return all;
}

// A house of 2 x 3 x 5 m with its lowest corner at the origin: no two axes look the same.
const std::vector<Eigen::Vector3f> kHouse = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0},
                                             {0, 0, 5}, {2, 0, 5}, {2, 3, 5}, {0, 3, 5}};
const std::vector<std::array<int, 4>> kSides = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

// The numbers, with blanks behind or between them.
template <class Numbers>
std::string text_of(const Numbers& numbers) {
  std::string text;
  for (const auto number : numbers) text += std::to_string(number) + " ";
  return text;
}

std::string house_ply(const std::string& newline = "\n") {
  std::string text;
  const auto line = [&](const std::string& words) { text += words + newline; };
  for (const char* words :
       {"ply", "format ascii 1.0", "comment a house", "element vertex 8", "property float x",
        "property double y", "property uchar red", "property float32 z", "element face 6",
        "property list uint8 int32 vertex_index", "end_header"})
    line(words);
  for (const auto& v : kHouse) line(text_of(v.head<2>()) + "7 " + text_of(v.tail<1>()));
  for (const auto& s : kSides) line(std::string("4 ").append(text_of(s)));
  return text;
}

std::string house_obj() {
  std::string text;
  for (const auto& v : kHouse) text.append("v ").append(text_of(v)).append("\n");
  for (const auto& s : kSides) {
    text += "f";
    for (const int i : s) text.append(" ").append(std::to_string(i + 1));
    text += "\n";
  }
  return text;
}

std::string house_stl() {
  std::string text = "solid house\n";
  for (const auto& s : kSides)
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int corner : {a, b, c}) {
        const auto& v = kHouse[static_cast<std::size_t>(s[static_cast<std::size_t>(corner)])];
        text.append("vertex ").append(text_of(v)).append("\n");
      }
      text += "endloop\nendfacet\n";
    }
  return text + "endsolid house\n";
}

std::string house_dae(const std::string& up, const std::string& unit) {
  std::string positions, indices, counts;
  for (const auto& v : kHouse) positions += text_of(v);
  for (const auto& s : kSides) {
    indices += text_of(s);
    counts += "4 ";
  }
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter=")" +
         unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="24">)" +
         positions + R"(</float_array><technique_common><accessor source="#pa" count="8" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><vcount>)" +
         counts + "</vcount><p>" + indices + R"(</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k > bytes.size() ? '=' : kDigits[(word >> (18 - 6 * k)) & 63U];
  }
  return out;
}

// A node shifts the house by 10 along the file's x axis.
std::string house_gltf() {
  std::string bytes;
  for (const auto& v : kHouse) bytes.append(reinterpret_cast<const char*>(v.data()), 12);
  for (const auto& s : kSides)
    for (const std::size_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
      const auto index = static_cast<std::uint16_t>(s[corner]);
      bytes.append(reinterpret_cast<const char*>(&index), 2);
    }
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[10,0,0]}],)"
         R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],)"
         R"("accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[2,3,5]},)"
         R"({"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],)"
         R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],)"
         R"("buffers":[{"byteLength":168,"uri":"data:application/octet-stream;base64,)" +
         base64(bytes) + R"("}]})";
}

void expect_house(const World& world, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  EXPECT_EQ(world.mesh.triangles.size(), 12U);
  EXPECT_EQ(world.mesh.vertices.size(), 8U);
  EXPECT_LT((world.bounds.min() - min).norm(), 1e-5) << world.bounds.min().transpose();
  EXPECT_LT((world.bounds.max() - max).norm(), 1e-5) << world.bounds.max().transpose();
  const auto volume = solid_volume(world.mesh);
  ASSERT_TRUE(volume.has_value());
  EXPECT_NEAR(*volume, (max - min).prod(), 1e-4) << "mirrored?";
}

TEST_F(MeshFile, RoundTripIsExact) {
  for (const auto& [name, description] : built_in_worlds()) {
    const World world = make_world(name, 4);
    write_ply(file("world.ply"), world.mesh);
    const World read = read_mesh_world(file("world.ply"));
    EXPECT_EQ(read.name, "world.ply");
    EXPECT_EQ(corners_of(read.mesh), corners_of(world.mesh));
    EXPECT_EQ(read.mesh.vertices.size(), world.mesh.vertices.size());
    EXPECT_EQ(read.bounds.min(), world.bounds.min());
    EXPECT_EQ(read.bounds.max(), world.bounds.max());
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // nothing unfinished
  }
}

TEST_F(MeshFile, EveryFormatGivesTheSameHouse) {
  for (const auto& path :
       {save("h.ply", house_ply()), save("crlf.PLY", house_ply("\r\n")), save("h.obj", house_obj()),
        save("h.stl", house_stl()), save("h.dae", house_dae("Z_UP", "1"))}) {
    SCOPED_TRACE(path.string());
    expect_house(read_mesh_world(path), {0, 0, 0}, {2, 3, 5});
  }
  // y up in the file: its z comes towards us.
  expect_house(read_mesh_world(save("h.gltf", house_gltf())), {10, -5, 0}, {12, 0, 3});
  expect_house(read_mesh_world(save("y.dae", house_dae("Y_UP", "1"))), {0, -5, 0}, {2, 0, 3});
}

TEST_F(MeshFile, ScaleUnitAndAxisAreTaken) {
  const auto ply = save("h.ply", house_ply());
  expect_house(read_mesh_world(ply, {.scale = 0.5}), {0, 0, 0}, {1, 1.5, 2.5});
  expect_house(read_mesh_world(ply, {.scale = 1, .up = UpAxis::kY}), {0, -5, 0}, {2, 0, 3});
  expect_house(read_mesh_world(ply, {.scale = 1, .up = UpAxis::kX}), {0, 0, 0}, {3, 5, 2});
  const auto inches = save("inch.dae", house_dae("Z_UP", "0.0254"));
  expect_house(read_mesh_world(inches), {0, 0, 0}, {0.0508, 0.0762, 0.127});
  expect_house(read_mesh_world(inches, {.scale = 10}), {0, 0, 0}, {0.508, 0.762, 1.27});
  expect_house(read_mesh_world(save("y.dae", house_dae("Y_UP", "1")), {.scale = 1, .up = UpAxis::kZ}),
               {0, 0, 0}, {2, 3, 5});
  expect_house(read_mesh_world(save("h.gltf", house_gltf()), {.scale = 1, .up = UpAxis::kZ}), {10, 0, 0},
               {12, 3, 5});
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_REFUSED(read_mesh_world(ply, {.scale = scale}));
}

// The header and the rows of a PLY of triangles.
std::string triangles_ply(int vertices, int faces, const std::string& rows) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n" + rows;
}

TEST_F(MeshFile, TrianglesWithoutAreaAreLeftOut) {
  const auto path = save("h.ply", triangles_ply(5, 4,
                                                "0 0 0\n1 0 0\n2 0 0\n0 1 0\n0 0 0\n"
                                                "3 0 1 2\n3 0 1 3\n3 0 4 3\n3 1 1 1\n"));
  const World world = read_mesh_world(path);
  EXPECT_EQ(world.mesh.triangles.size(), 1U);
  EXPECT_EQ(world.mesh.vertices.size(), 3U);
  EXPECT_EQ(surface_area(world.mesh), 0.5);
}

TEST_F(MeshFile, BadFilesAreRefusedByName) {
  const std::string house = house_ply();
  expect_refused(file("none.ply"), "no such file");
  expect_refused(file("none.obj"), "no such file");
  std::filesystem::create_directories(file("folder.ply"));
  expect_refused(file("folder.ply"), "is a directory");
  expect_refused("house.step", house, ".gltf");
  for (const char* name : {"empty.ply", "empty.obj", "empty.stl", "empty.dae", "empty.gltf", "empty.glb"})
    expect_refused(save(name, ""));
  for (const char* name : {"foreign.stl", "foreign.dae", "foreign.gltf", "foreign.glb"})
    expect_refused(save(name, house));
  const auto ply = [&](const std::string& from, const std::string& to, const std::string& part) {
    expect_refused("bad.ply", test::replaced(house, from, to), part);
  };
  ply("element face 6", "element face 0", "no triangles");
  ply("4 0 3 2 1", "4 0 3 8 1", "vertex 8, but there are only 8");
  for (const char* bad : {"nan", "-inf", "1e39"}) ply("2.000000", bad, "vertex 1 is not finite");
  expect_refused("flat.ply", triangles_ply(3, 1, "0 0 0\n1 1 1\n2 2 2\n3 0 1 2\n"),
                 "none of its 1 triangles has an area");
  expect_refused(save("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"));
}

// Reads it, or refuses it as a runtime_error that names it; a world that is read is sound.
void expect_calm(const std::filesystem::path& path) {
  const std::string said = test::complaint_of<std::runtime_error>([&] {
    const World world = read_mesh_world(path);
    ASSERT_FALSE(world.mesh.triangles.empty());
    for (const auto& t : world.mesh.triangles)
      for (const auto i : t) ASSERT_LT(i, world.mesh.vertices.size());
    for (const auto& v : world.mesh.vertices) ASSERT_TRUE(v.allFinite());
    ASSERT_GT(surface_area(world.mesh), 0.0);
  });
  ASSERT_TRUE(said.empty() || said.starts_with(path.string() + ": ")) << said;
}

TEST_F(MeshFile, TruncatedPlyIsRefused) {
  write_ply(file("whole.ply"), make_world("room", 1).mesh);
  for (const std::string& bytes : {content_of(file("whole.ply")), house_ply()}) {
    // The ASCII file is complete without its last blank and line break.
    for (std::size_t size = 0; size + 2 < bytes.size(); size += size < 400 ? 1 : 37)
      expect_refused(save("cut.ply", bytes.substr(0, size)));
  }
}

TEST_F(MeshFile, DamagedPlyDoesNoHarm) {
  write_ply(file("whole.ply"), make_world("room", 1).mesh);
  test::Random random(5);
  for (const std::string& whole : {content_of(file("whole.ply")), house_ply()})
    for (int i = 0; i < (test::long_mode() ? 20000 : 500); ++i) {
      std::string bytes = whole;
      const int header = static_cast<int>(bytes.find("end_header"));
      for (int damage = random.below(4); damage >= 0; --damage) {
        const int range = random.one_in(2) ? header : static_cast<int>(bytes.size());
        bytes[static_cast<std::size_t>(random.below(range))] = static_cast<char>(random.below(256));
      }
      expect_calm(save("damaged.ply", bytes));
      if (HasFatalFailure()) return;
    }
}

TEST_F(MeshFile, OtherFormatsSurviveTruncation) {
  const std::string whole = house_stl();
  ASSERT_TRUE(whole.starts_with("solid"));
  for (const std::size_t part : {whole.size() / 2, whole.find("endsolid")})
    expect_refused(save("cut.stl", whole.substr(0, part)), "ends before its last line");
  for (const char* end : {"ENDSOLID", "end solid", "endsolid facets"})
    static_cast<void>(read_mesh_world(save("whole.stl", test::replaced(whole, "endsolid", end))));
  for (const auto& [name, bytes] :
       {std::pair("cut.obj", house_obj()), std::pair("cut.stl", whole),
        std::pair("cut.dae", house_dae("Z_UP", "1")), std::pair("cut.gltf", house_gltf())})
    for (std::size_t size = 0; size < bytes.size(); size += 11) {
      SCOPED_TRACE(size);
      expect_calm(save(name, bytes.substr(0, size)));
      if (HasFatalFailure()) return;
    }
}

// What makes an importer crash or run away costs the import and not this process.
TEST_F(MeshFile, ImportersFallAlone) {
  const std::string dae = house_dae("Z_UP", "1");
  for (const char* count : {"0", "nan", "99999999", "-1"}) {
    SCOPED_TRACE(count);
    expect_calm(save("accessor.dae",
                     test::replaced(dae, "<accessor source=\"#pa\" count=\"8\"",
                                    "<accessor source=\"#pa\" count=\"" + std::string(count) + "\"")));
    expect_calm(
        save("array.dae", test::replaced(dae, "count=\"24\"", "count=\"" + std::string(count) + "\"")));
  }
  expect_refused(save("crash.dae", test::replaced(dae, "count=\"8\"", "count=\"0\"")));
  if (!test::kLimitsAddresses) return;
  // Nodes that hold the next one twice: 2^40 houses.
  std::string nodes;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(i + 1) + "\"/>";
    nodes += "<node id=\"n" + std::to_string(i) + "\">" + next + next + "</node>";
  }
  nodes += "<node id=\"n40\"><instance_geometry url=\"#g\"/></node>";
  const std::string many =
      test::replaced(test::replaced(dae, "<library_visual_scenes>",
                                    "<library_nodes>" + nodes + "</library_nodes><library_visual_scenes>"),
                     "<instance_geometry url=\"#g\"/></node></visual_scene>",
                     "<instance_node url=\"#n0\"/></node></visual_scene>");
  expect_refused(save("many.dae", many), "to import");
}

// Who ignores how children end gets meshes, and is told if one cannot be had.
TEST_F(MeshFile, IsImportedWhoeverWaitsForChildren) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const std::string dae = house_dae("Z_UP", "1");
  expect_house(read_mesh_world(save("good.dae", dae)), {0, 0, 0}, {2, 3, 5});
  expect_refused(save("crash.dae", test::replaced(dae, "count=\"8\"", "count=\"0\"")));
  std::signal(SIGCHLD, before);
}

// A file whose materials are in itself, again and again: reading it once more is no new file, so that the
// time is up although reading terabytes would take hours.
TEST_F(MeshFile, LongWhatNamesItselfGetsNoMoreTime) {
  std::string self = house_obj();
  for (int i = 0; i < 400'000; ++i) self += "mtllib self.obj\n";
  expect_refused(save("self.obj", self), "takes longer to import");
}

TEST_F(MeshFile, OtherFilesAreReadOnlyInItsFolder) {
  const std::string obj = house_obj(), gltf = house_gltf();
  const std::string outside = path("secret.bin"), folder = path("meshes");
  std::filesystem::create_directory(folder);
  ASSERT_EQ(mkfifo(path("meshes/pipe").c_str(), 0600), 0);
  for (const char* library : {"pipe", "../secret.bin", "/dev/zero", "none.mtl"})
    expect_house(read_mesh_world(save("meshes/h.obj", "mtllib " + std::string(library) + "\n" + obj)),
                 {0, 0, 0}, {2, 3, 5});
  // The buffer of a glTF file, beside it and elsewhere.
  const auto with_buffer = [&](const std::string& uri) {
    const auto begin = gltf.find("data:"), end = gltf.find('"', begin);
    return save("meshes/h.gltf", gltf.substr(0, begin) + uri + gltf.substr(end));
  };
  std::string bytes;
  for (const auto& v : kHouse) bytes.append(reinterpret_cast<const char*>(v.data()), 12);
  for (const auto& s : kSides)
    for (const std::size_t corner : {0U, 1U, 2U, 0U, 2U, 3U})
      bytes += test::bytes_of(static_cast<std::uint16_t>(s[corner]));
  for (const char* name : {"meshes/h.bin", "secret.bin"}) static_cast<void>(save(name, bytes));
  expect_house(read_mesh_world(with_buffer("h.bin")), {10, -5, 0}, {12, 0, 3});
  expect_refused(with_buffer("../secret.bin"), "lies outside of its folder");
  expect_refused(with_buffer("pipe"), "is not a regular file");
  std::filesystem::create_symlink(outside, path("meshes/link.bin"));
  expect_refused(with_buffer("link.bin"), "lies outside of its folder");
}

TEST_F(MeshFile, BadIndicesAreRefused) {
  expect_refused("ok.ply", test::replaced(house_ply(), "4 0 3 2 1", "4 0 3 2 9"), "vertex 9");
  for (const char* face : {"f 1 2 99", "f 1 2 0", "f 1 2 -99", "f 1 2 99999999999"})
    expect_refused(save("bad.obj", house_obj() + face + "\n"));
  for (const char* index : {"9", "-1", "4294967295", "x"})
    expect_refused(
        save("bad.dae", test::replaced(house_dae("Z_UP", "1"), "<p>0 ", "<p>" + std::string(index) + " ")));
  for (const char* begin : {"<p >", "<p\n>", "<p a='1'>"})
    expect_refused(
        save("bad.dae", test::replaced(house_dae("Z_UP", "1"), "<p>0 ", begin + std::string("x "))),
        "an index of a face is 'x'");
  for (const char* within : {"<![CDATA[x]]>", "0 <!-- --> x"})
    expect_refused(
        save("bad.dae", test::replaced(house_dae("Z_UP", "1"), "<p>0 ", "<p>" + std::string(within))),
        "a list of indices holds more than numbers");
  // In time that grows with the file, and no faster.
  for (const char* begin : {"<", "<p ", "<p/", "<!--", "<p>"}) {
    std::string many;
    while (many.size() < 4'000'000) many += begin;
    expect_refused(save("many.dae", many));
  }
  // What is no list of indices, though it begins as one does.
  for (const char* other : {"<!-- <p>made by me</p> -->", "<param>x</param>", "<p/>", "<![CDATA[<p>x</p>]]>"})
    expect_house(
        read_mesh_world(save("good.dae", test::replaced(house_dae("Z_UP", "1"), "<library_geometries>",
                                                        other + std::string("<library_geometries>")))),
        {0, 0, 0}, {2, 3, 5});
  std::string bytes;
  for (const auto& v : kHouse) bytes.append(reinterpret_cast<const char*>(v.data()), 12);
  for (std::uint16_t i = 0; i < 36; ++i) bytes += test::bytes_of(std::uint16_t(i < 33 ? i % 8 : 700));
  const std::string gltf = house_gltf();
  const auto begin = gltf.find("base64,") + 7, end = gltf.find('"', begin);
  expect_refused(save("bad.gltf", gltf.substr(0, begin) + base64(bytes) + gltf.substr(end)));
}

TEST_F(MeshFile, WritesWholeOrNotAtAll) {
  const World room = make_world("room", 1), maze = make_world("maze", 1);
  write_ply(file("world.ply"), room.mesh);
  write_ply(file("world.ply"), maze.mesh);
  EXPECT_EQ(corners_of(read_mesh_world(file("world.ply")).mesh), corners_of(maze.mesh));
  EXPECT_THROW(write_ply(file("no") / "folder.ply", room.mesh), std::runtime_error);
  EXPECT_THROW(write_ply(folder_, room.mesh), std::runtime_error);
  EXPECT_THROW(write_ply("", room.mesh), std::runtime_error);
}

TEST_F(MeshFile, KeepsWhatIsThereOnAFullDisk) {
  static_cast<void>(save("full.ply", "as it was"));
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit full = before;
  full.rlim_cur = 1000;  // bytes
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
  EXPECT_THROW(write_ply(file("full.ply"), make_world("room", 1).mesh), std::runtime_error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(content_of(file("full.ply")), "as it was");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace frontlux::sim
