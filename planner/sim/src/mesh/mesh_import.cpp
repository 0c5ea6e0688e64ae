#include "mesh/mesh_import.hpp"

#include "mesh/import_process.hpp"

#include <frontlux/file.hpp>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace frontlux::sim {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << 28U;  // instances of one mesh can be many

void append(const aiMesh& part, const aiMatrix4x4& to_root, io::RawMesh& mesh) {
  const std::size_t first = mesh.vertices.size();
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D v = to_root * part.mVertices[i];
    mesh.vertices.emplace_back(v.x, v.y, v.z);
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;  // points and lines have no surface
    mesh.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
  if (mesh.triangles.size() > kMaxTriangles || mesh.vertices.size() > kMaxTriangles)
    throw std::length_error("holds more than " + std::to_string(kMaxTriangles) + " triangles");
}

// The files that an import may open: regular ones in the mesh's folder and below.
class MeshFolder : public Assimp::IOSystem {
 public:
  explicit MeshFolder(const std::filesystem::path& file)
      : file_(std::filesystem::canonical(file)),
        folder_(std::filesystem::canonical(std::filesystem::absolute(file).parent_path())) {}

  bool Exists(const char* file) const override { return reason_against(file).empty(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;  // of all of them
    std::string reason = reason_against(file);
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos)
      reason = "is not to be written";
    if (reason.empty()) {
      const bool is_new = !opened_.contains(std::filesystem::canonical(file));
      const std::uint64_t with_it = bytes_ + (is_new ? std::filesystem::file_size(file) : 0);
      if (with_it > kMostBytes) reason = "makes it more than 1 GiB";
      if (reason.empty()) {
        // Once each: what names itself again and again gets no more time by that.
        opened_.insert(std::filesystem::canonical(file));
        bytes_ = with_it;
      }
    }
    if (!reason.empty()) {
      refused_ = ", which names " + quote(file) + ", and that " + reason;
      return nullptr;
    }
    limit_import(bytes_);
    const std::string bytes = read_file(file);
    auto* const copy = new std::uint8_t[bytes.size() + 1];
    std::copy(bytes.begin(), bytes.end(), copy);
    return new Assimp::MemoryIOStream(copy, bytes.size(), true);
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

  // The last file that could not be opened, as the end of a message.
  [[nodiscard]] const std::string& refused() const { return refused_; }

 private:
  [[nodiscard]] std::string reason_against(const std::filesystem::path& file) const {
    std::error_code error;
    const auto real = std::filesystem::canonical(file, error);
    if (error) return "is not there";
    if (!std::filesystem::is_regular_file(real, error)) return "is not a regular file";
    const auto inside = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end()).first;
    return real == file_ || inside == folder_.end() ? "" : "lies outside of its folder";
  }

  std::filesystem::path file_, folder_;
  std::string refused_;
  std::set<std::filesystem::path> opened_;
  std::uint64_t bytes_ = 0;
};

// Notes the complaints about vertices that are not there, whose faces some importers drop.
class BadIndices : public Assimp::LogStream {
 public:
  void write(const char* message) override {
    const std::string_view text = message;
    for (const char* complaint : {"nvalid face index", "ertex index out of range", "out-of-range indices"})
      found_ = found_ || text.find(complaint) != std::string_view::npos;
  }
  [[nodiscard]] bool found() const { return found_; }

 private:
  bool found_ = false;
};

// Where what begins here ends that is no element, if it does: a comment or characters as they are.
std::optional<std::size_t> end_of_no_element(std::string_view xml, std::size_t at) {
  for (const auto& [begin, end] :
       {std::pair<std::string_view, std::string_view>("<!--", "-->"), {"<![CDATA[", "]]>"}})
    if (xml.substr(at).starts_with(begin))
      return std::min(xml.find(end, at + begin.size()), xml.size() - end.size()) + end.size();
  return std::nullopt;
}

void check_list(std::string_view list) {
  constexpr std::string_view kBlank = " \t\r\n";
  while (list.remove_prefix(std::min(list.find_first_not_of(kBlank), list.size())), !list.empty()) {
    const std::string_view word = list.substr(0, list.find_first_of(kBlank));
    if (const auto index = number_from<std::int32_t>(word); !index || *index < 0)
      throw std::invalid_argument("an index of a face is " + quote(word));
    list.remove_prefix(word.size());
  }
}

// A COLLADA file's lists of indices. Assimp takes for 0 what is no whole number below 2^31.
void check_indices(std::string_view collada) {
  constexpr std::string_view kBegin = "<p", kAfter = " \t\r\n>";
  for (std::size_t at = 0; (at = collada.find('<', at)) != std::string_view::npos;) {
    if (const auto end = end_of_no_element(collada, at)) {
      at = *end;
      continue;
    }
    const std::size_t after = at + kBegin.size();
    const bool is_list = collada.substr(at).starts_with(kBegin) && after < collada.size() &&
                         kAfter.find(collada[after]) != std::string_view::npos;
    at += 1;
    if (!is_list) continue;
    const std::size_t begin = collada.find('>', at);
    if (begin == std::string_view::npos) return;
    at = begin + 1;
    if (collada[begin - 1] == '/') continue;
    const std::size_t end = std::min(collada.find('<', at), collada.size());
    check_list(collada.substr(at, end - at));
    if (!collada.substr(end).starts_with("</"))
      throw std::invalid_argument("a list of indices holds more than numbers");
    at = end;
  }
}

// Leaves those that read this ending. Otherwise Assimp looks for signatures and reads what a file is not
// named after, with any of its fifty importers.
void keep_importers(Assimp::Importer& importer, const std::string& ending) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const std::string endings = std::string(" ") + importer.GetImporterInfo(i)->mFileExtensions + " ";
    if (endings.find(" " + ending + " ") != std::string::npos) continue;
    const std::unique_ptr<Assimp::BaseImporter> other(importer.GetImporter(i));
    importer.UnregisterLoader(other.get());
  }
}

// In a process of its own: Assimp's log is one for all.
io::RawMesh read_scene(const std::filesystem::path& file, const std::string& ending, bool keep_frame) {
  if (ending == "dae") {
    limit_import(std::filesystem::file_size(file));
    check_indices(read_file(file));
  }
  Assimp::Importer importer;
  keep_importers(importer, ending);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, keep_frame);
  auto* const folder = new MeshFolder(file);
  importer.SetIOHandler(folder);  // which deletes it
  BadIndices bad_indices;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0)
      ->attachStream(&bad_indices, Assimp::Logger::Warn | Assimp::Logger::Err);
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string error = importer.GetErrorString();
    if (error.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
    throw std::invalid_argument(error + folder->refused());
  }
  if (bad_indices.found()) throw std::invalid_argument("a face names a vertex that is not there");
  io::RawMesh mesh;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> open = {{scene->mRootNode, aiMatrix4x4()}};
  while (!open.empty()) {
    const auto [node, to_root] = open.back();
    open.pop_back();
    const aiMatrix4x4 here = to_root * node->mTransformation;
    for (unsigned i = 0; i < node->mNumMeshes; ++i) append(*scene->mMeshes[node->mMeshes[i]], here, mesh);
    for (unsigned i = 0; i < node->mNumChildren; ++i) open.emplace_back(node->mChildren[i], here);
  }
  return mesh;
}

}  // namespace

io::RawMesh import_mesh(const std::filesystem::path& file, const std::string& ending, bool keep_frame) {
  constexpr const char* kAdvice = "repair or simplify the mesh, or save it as .ply";
  try {
    return import_in_child([&] { return read_scene(file, ending, keep_frame); });
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail(file, error.what(), kAdvice);
  }
}

}  // namespace frontlux::sim
