#include "mesh/mesh_import.hpp"

#include <frontlux/file.hpp>

#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
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

}  // namespace

io::RawMesh import_mesh(const std::filesystem::path& file, const std::string& ending, bool keep_frame) {
  constexpr const char* kAdvice = "repair or simplify the mesh, or save it as .ply";
  try {
    Assimp::Importer importer;
    keep_importers(importer, ending);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, keep_frame);
    const aiScene* scene =
        importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_ValidateDataStructure);
    if (scene == nullptr || scene->mRootNode == nullptr)
      throw std::invalid_argument(importer.GetErrorString());
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
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    fail(file, error.what(), kAdvice);
  }
}

}  // namespace frontlux::sim
