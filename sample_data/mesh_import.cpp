// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/mesh_import.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <unordered_map>

#include "core/error.h"
#include "core/image.h"
#include "core/ply.h"
#include "sample_data/obj_file.h"
#include "sample_data/texture.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr size_t kMaxTriangles = 4'000'000;
constexpr double kMaxCoordinate = 1e9, kMinExtent = 1e-9, kMinHeight_rel = 1e-12;

bool BeginsAsPly(const std::filesystem::path& file) {
  char magic[3] = {};
  std::ifstream stream(file, std::ios::binary);
  stream.read(magic, sizeof magic);
  return stream.gcount() == 3 && std::equal(magic, magic + 3, "ply");
}

TexturedMesh Read(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".ply" || BeginsAsPly(file)) {
    return {ReadPlyMesh(file), ReadPlyTextureCoordinates(file), {}, {}, {}};
  }
  if (ending != ".obj") {
    throw Error(file.string() + ": is no mesh that can be read; give a PLY or OBJ file");
  }
  return ReadObj(file);
}

std::string Count(size_t count, const char* what) {
  std::string text = std::to_string(count);
  text += ' ';
  text += what;
  if (count != 1) text += 's';
  return text;
}

double CheckedExtent(const TriangleMesh& mesh, const std::string& file) {
  Eigen::AlignedBox3d box;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const V3& p = mesh.vertices[v];
    if (!(p.cwiseAbs().maxCoeff() <= kMaxCoordinate)) {
      throw Error(file + ": vertex " + std::to_string(v) +
                  " lies farther than 1e9 from the origin; scale the mesh to millimetres");
    }
    box.extend(p);
  }
  const double extent = box.sizes().maxCoeff();
  if (!(extent >= kMinExtent)) {
    throw Error(file + ": the mesh has no extent; scale it to millimetres");
  }
  return extent;
}

// Keeps the triangles that have an area; returns how many were dropped.
size_t DropFlatTriangles(TriangleMesh& mesh, double extent) {
  const size_t before = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {
    const V3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return !((b - a).cross(c - a).norm() > kMinHeight_rel * extent * longest);
  });
  return before - mesh.triangles.size();
}

template <typename T>
void Keep(std::vector<T>& values, const std::vector<int>& kept) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(kept.size());
  for (int v : kept) result.push_back(values[v]);
  values = std::move(result);
}

size_t DropUnusedVertices(TexturedMesh& textured) {
  TriangleMesh& mesh = textured.mesh;
  std::vector<int> index(mesh.vertices.size(), -1), kept;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) index[t[c]] = 0;
  }
  for (size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(v));
  }
  const size_t dropped = index.size() - kept.size();
  if (dropped == 0) return 0;
  for (Eigen::Vector3i& t : mesh.triangles) t = {index[t[0]], index[t[1]], index[t[2]]};
  Keep(mesh.vertices, kept);
  Keep(mesh.normals, kept);
  Keep(mesh.colors, kept);
  Keep(mesh.confidence, kept);
  Keep(textured.uv, kept);
  Keep(textured.material, kept);
  return dropped;
}

// The mesh with vertices of the same position joined: seams of uv and normals close.
TriangleMesh Welded(const TriangleMesh& mesh) {
  struct Hash {
    size_t operator()(const std::array<double, 3>& p) const {
      size_t h = 0;
      for (double x : p) h = h * 0x9e3779b97f4a7c15ull + std::hash<double>()(x);
      return h;
    }
  };
  std::unordered_map<std::array<double, 3>, int, Hash> known;
  std::vector<int> index;
  TriangleMesh welded;
  for (const V3& p : mesh.vertices) {
    const auto [entry, is_new] =
        known.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(welded.vertices.size()));
    if (is_new) welded.vertices.push_back(p);
    index.push_back(entry->second);
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    welded.triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  }
  return welded;
}

void RepairNormals(ImportedMesh& imported) {
  TriangleMesh& mesh = imported.mesh;
  if (mesh.normals.empty()) {
    mesh.normals = ComputeVertexNormals(mesh);
    return;
  }
  size_t bad = 0;
  std::vector<V3> computed;
  for (size_t v = 0; v < mesh.normals.size(); ++v) {
    const double length = mesh.normals[v].norm();
    if (length > 1e-6 && std::isfinite(length)) {
      mesh.normals[v] /= length;
      continue;
    }
    if (computed.empty()) computed = ComputeVertexNormals(mesh);
    mesh.normals[v] = computed[v];
    ++bad;
  }
  if (bad > 0) imported.warnings.push_back(Count(bad, "normal") + " of no length computed anew");
}

}  // namespace

ImportedMesh ImportMesh(const std::filesystem::path& file) {
  TexturedMesh textured = Read(file);
  const std::string name = file.string();
  if (textured.mesh.triangles.size() > kMaxTriangles) {
    throw Error(name + ": " + std::to_string(textured.mesh.triangles.size()) +
                " triangles are more than 4 million; decimate it first");
  }
  const double extent = CheckedExtent(textured.mesh, name);
  ImportedMesh imported;
  imported.warnings = std::move(textured.warnings);
  if (const size_t flat = DropFlatTriangles(textured.mesh, extent); flat > 0) {
    imported.warnings.push_back(Count(flat, "triangle") + " of no area dropped");
  }
  if (textured.mesh.triangles.empty()) {
    throw Error(name + ": the mesh has no triangle of any area");
  }
  if (const size_t unused = DropUnusedVertices(textured); unused > 0) {
    imported.warnings.push_back(std::string("dropped points of no triangle: ") +
                                std::to_string(unused));
  }
  const MeshTopology topology = ExamineTopology(Welded(textured.mesh));
  if (topology.boundary_edges > 0) {
    imported.warnings.push_back(
        "the mesh has holes: " + Count(static_cast<size_t>(topology.boundary_edges), "open edge") +
        "; it is rendered as it is");
  }
  if (!topology.manifold) {
    imported.warnings.emplace_back(
        "the mesh is no clean surface: edges of more than two triangles, or neighbours that face "
        "opposite ways");
  }
  imported.mesh = std::move(textured.mesh);
  imported.uv = std::move(textured.uv);
  imported.material = std::move(textured.material);
  imported.materials = std::move(textured.materials);
  RepairNormals(imported);
  return imported;
}

std::vector<Eigen::Vector3f> MaterialColors(const ImportedMesh& imported) {
  if (!imported.mesh.colors.empty() || imported.material.empty()) return imported.mesh.colors;
  std::vector<Texture> pictures(imported.materials.size());
  for (const int used : imported.material) {
    if (used < 0 || imported.uv.empty() || imported.materials[used].picture.empty()) continue;
    Texture& texture = pictures[used];
    if (texture.image) continue;
    texture.kind = TextureKind::kImage;
    texture.mapping = TextureMapping::kUv;
    texture.image = std::make_shared<Image>(ReadTextureImage(imported.materials[used].picture));
  }
  std::vector<Eigen::Vector3f> colors(imported.mesh.vertices.size());
  for (size_t v = 0; v < colors.size(); ++v) {
    const int used = imported.material[v];
    Eigen::Vector3f linear = used < 0 ? ObjMaterial().diffuse : imported.materials[used].diffuse;
    if (used >= 0 && pictures[used].image) {
      linear = linear.cwiseProduct(
          TextureValue(pictures[used], {}, V3::Zero(), imported.uv[v].cast<double>()));
    }
    for (int c = 0; c < 3; ++c) colors[v][c] = SrgbFromLinear(linear[c]);
  }
  return colors;
}

}  // namespace lfm
