// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/subject.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "core/error.h"
#include "core/image.h"
#include "core/parallel.h"
#include "sample_data/bust_shape.h"
#include "sample_data/isosurface.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kMaxWidthMm = 130;
constexpr size_t kMaxTriangles = 4'000'000;
constexpr double kBustMaxGradient = 2;

Eigen::AlignedBox3d Bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const V3& p : mesh.vertices) box.extend(p);
  return box;
}

// One round of splitting: marked edges get a midpoint, triangles are cut by how many of their
// edges are marked.
class EdgeSplitter {
 public:
  EdgeSplitter(ImportedMesh& imported, double edge_mm)
      : imported_(imported), mesh_(imported.mesh), limit2_(edge_mm * edge_mm) {}

  bool Round() {
    midpoints_.clear();
    std::vector<Eigen::Vector3i> result;
    result.reserve(mesh_.triangles.size() * 2);
    const std::vector<Eigen::Vector3i> old = std::move(mesh_.triangles);
    bool any = false;
    for (const Eigen::Vector3i& t : old) any |= Cut(t, result);
    mesh_.triangles = std::move(result);
    if (mesh_.triangles.size() > kMaxTriangles) {
      throw Error(
          "the mesh is too coarse and too large: splitting its edges needs more than 4 "
          "million triangles; use a finer mesh or a smaller --mesh-height");
    }
    return any;
  }

 private:
  int Midpoint(int a, int b) {
    if ((mesh_.vertices[a] - mesh_.vertices[b]).squaredNorm() <= limit2_) return -1;
    const uint64_t key =
        static_cast<uint64_t>(std::min(a, b)) << 32 | static_cast<uint32_t>(std::max(a, b));
    const auto [entry, is_new] =
        midpoints_.try_emplace(key, static_cast<int>(mesh_.vertices.size()));
    if (is_new) {
      const V3 middle = 0.5 * (mesh_.vertices[a] + mesh_.vertices[b]);
      mesh_.vertices.push_back(middle);
      if (!mesh_.normals.empty()) {
        const V3 normal = mesh_.normals[a] + mesh_.normals[b];
        mesh_.normals.push_back(normal.norm() > 1e-9 ? V3(normal.normalized()) : mesh_.normals[a]);
      }
      if (!mesh_.colors.empty()) {
        const Eigen::Vector3f color = 0.5f * (mesh_.colors[a] + mesh_.colors[b]);
        mesh_.colors.push_back(color);
      }
      if (!mesh_.confidence.empty()) {
        const float confidence = 0.5f * (mesh_.confidence[a] + mesh_.confidence[b]);
        mesh_.confidence.push_back(confidence);
      }
      if (!imported_.uv.empty()) {
        const Eigen::Vector2f uv = 0.5f * (imported_.uv[a] + imported_.uv[b]);
        imported_.uv.push_back(uv);
      }
      if (!imported_.material.empty()) {
        const int material = imported_.material[a];
        imported_.material.push_back(material);
      }
    }
    return entry->second;
  }

  bool Cut(const Eigen::Vector3i& t, std::vector<Eigen::Vector3i>& result) {
    std::array<int, 3> m;
    int marked = 0;
    for (int e = 0; e < 3; ++e) {
      m[e] = Midpoint(t[e], t[(e + 1) % 3]);
      marked += m[e] >= 0;
    }
    if (marked == 0) {
      result.push_back(t);
      return false;
    }
    if (marked == 3) {
      for (int e = 0; e < 3; ++e) result.emplace_back(t[e], m[e], m[(e + 2) % 3]);
      result.emplace_back(m[0], m[1], m[2]);
      return true;
    }
    // Turn the triangle so that the odd edge comes first.
    int e = 0;
    while ((m[e] >= 0) != (marked == 1)) ++e;
    const int a = t[e], b = t[(e + 1) % 3], c = t[(e + 2) % 3];
    if (marked == 1) {
      result.emplace_back(a, m[e], c);
      result.emplace_back(m[e], b, c);
    } else {
      const int bc = m[(e + 1) % 3], ca = m[(e + 2) % 3];
      result.emplace_back(c, ca, bc);
      result.emplace_back(a, b, bc);
      result.emplace_back(a, bc, ca);
    }
    return true;
  }

  ImportedMesh& imported_;
  TriangleMesh& mesh_;
  double limit2_;
  std::unordered_map<uint64_t, int> midpoints_;
};

void PaintVertices(Subject& subject, const std::function<Paint(int64_t)>& paint_of_vertex) {
  subject.paint.resize(subject.mesh.vertices.size());
  subject.mesh.colors.resize(subject.mesh.vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(subject.paint.size()),
      [&](int64_t v) {
        const Paint paint = paint_of_vertex(v);
        subject.paint[v] = paint;
        for (int c = 0; c < 3; ++c) subject.mesh.colors[v][c] = SrgbFromLinear(paint.diffuse[c]);
      },
      256);
}

}  // namespace

Subject MakeBust(double edge_mm, uint64_t seed) {
  IsosurfaceGrid grid;
  grid.cell_mm = edge_mm;
  grid.min = V3(-kBustHalfWidthMm, -kBustHalfWidthMm, -2 * edge_mm - 0.37 * edge_mm);
  grid.max = V3(kBustHalfWidthMm, kBustHalfWidthMm, kBustHeightMm + 4);
  Subject subject;
  subject.mesh = PolygoniseIsosurface(BustDistance, grid, kBustMaxGradient);
  // The blend's top is only known once polygonised: scale to the exact height.
  const double scale = kBustHeightMm / Bounds(subject.mesh).max().z();
  for (V3& p : subject.mesh.vertices) p *= scale;
  PaintVertices(subject,
                [&](int64_t v) { return PaintBust(subject.mesh.vertices[v] / scale, seed); });
  return subject;
}

Subject MakeSubject(ImportedMesh imported, double height_mm, double edge_mm, uint64_t seed) {
  TriangleMesh& mesh = imported.mesh;
  ValidateMesh(mesh, "the subject's mesh");
  const Eigen::AlignedBox3d box = Bounds(mesh);
  const V3 size = box.sizes();
  if (!(size.z() > 1e-6 * size.norm())) {
    throw Error("the subject's mesh is flat (no height along z); give a solid that stands on z");
  }
  const double width = std::hypot(size.x(), size.y());
  const double scale = std::min(height_mm / size.z(), kMaxWidthMm / std::max(width, 1e-12));
  const V3 foot(box.center().x(), box.center().y(), box.min().z());
  for (V3& p : mesh.vertices) p = scale * (p - foot);
  if (mesh.normals.empty()) mesh.normals = ComputeVertexNormals(mesh);
  mesh.confidence.clear();  // what was measured elsewhere says nothing here
  Subject subject;
  imported = SplitLongEdges(std::move(imported), edge_mm);
  const std::vector<Eigen::Vector3f> base = MaterialColors(imported);
  subject.mesh = std::move(imported.mesh);
  PaintVertices(subject, [&](int64_t v) {
    Eigen::Vector3f color(0.35f, 0.22f, 0.14f);
    if (!base.empty()) {
      for (int c = 0; c < 3; ++c) color[c] = LinearFromSrgb(base[v][c]);
    }
    return PaintMesh(subject.mesh.vertices[v], color, seed);
  });
  return subject;
}

ImportedMesh SplitLongEdges(ImportedMesh imported, double edge_mm) {
  if (!(edge_mm > 0)) throw Error("splitting edges: the longest edge must be above 0");
  EdgeSplitter splitter(imported, edge_mm);
  while (splitter.Round()) {
  }
  return imported;
}

}  // namespace lfm
