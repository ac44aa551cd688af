// SPDX-License-Identifier: BSD-3-Clause
// Includes CGAL's mesh processing, which is under GPL-3.
#include "mesh/part_union.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "core/disjoint_sets.h"
#include "mesh/decimation.h"
#include "mesh/self_intersection.h"

namespace lfm {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Of the size of the whole: corners this near are one, which rounding pulled apart.
constexpr double kNoEdge_rel = 1e-9;
// Of the size of a part: how far a fold may be smoothed.
constexpr double kLargestMove_rel = 1e-3;

struct Parts {
  std::vector<TriangleMesh> meshes;
  std::vector<int> of_triangle;
};

Parts SplitIntoParts(const TriangleMesh& mesh) {
  Parts parts{{}, LabelParts(mesh)};
  std::vector<int> index(mesh.vertices.size(), -1);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto part = static_cast<size_t>(parts.of_triangle[t]);
    if (part == parts.meshes.size()) parts.meshes.emplace_back();
    TriangleMesh& own = parts.meshes[part];
    Eigen::Vector3i corners = mesh.triangles[t];
    for (int& corner : corners) {
      if (index[corner] < 0) {
        index[corner] = static_cast<int>(own.vertices.size());
        own.vertices.push_back(mesh.vertices[corner]);
      }
      corner = index[corner];
    }
    own.triangles.push_back(corners);
  }
  return parts;
}

/// Parts that meet each other, directly or through others; by their least one.
std::map<int, std::vector<int>> FindClusters(const TriangleMesh& mesh, const Parts& parts) {
  DisjointSets sets(parts.meshes.size());
  for (const auto& [a, b] : FindSelfIntersections(mesh)) {
    sets.Unite(parts.of_triangle[a], parts.of_triangle[b]);
  }
  std::map<int, std::vector<int>> clusters;
  for (int part = 0; part < static_cast<int>(parts.meshes.size()); ++part) {
    clusters[sets.Find(part)].push_back(part);
  }
  return clusters;
}

double SizeOf(const TriangleMesh& part) { return std::sqrt(TotalArea(part)); }

/// The part itself, or with its small folds smoothed, if it encloses a volume.
std::optional<TriangleMesh> AsSolid(const TriangleMesh& part) {
  const MeshTopology topology = ExamineTopology(part);
  const double volume = SignedVolume(part), size = SizeOf(part);
  if (!topology.closed || !topology.manifold || topology.degenerate_triangles > 0) return {};
  if (!(volume > 0) || !std::isfinite(volume) || !(size > 0) || !std::isfinite(size)) return {};
  Untangled untangled = RemoveSelfIntersections(part);
  if (untangled.left > 0) return {};
  for (size_t v = 0; v < part.vertices.size(); ++v) {
    const double moved = (untangled.mesh.vertices[v] - part.vertices[v]).norm();
    if (moved > kLargestMove_rel * size) return {};
  }
  return std::move(untangled.mesh);
}

SurfaceMesh MakeSurfaceMesh(const TriangleMesh& mesh) {
  SurfaceMesh surface;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    surface.add_vertex(Kernel::Point_3(v.x(), v.y(), v.z()));
  }
  for (const Eigen::Vector3i& t : mesh.triangles) {
    surface.add_face(SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[0])),
                     SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[1])),
                     SurfaceMesh::Vertex_index(static_cast<uint32_t>(t[2])));
  }
  return surface;
}

TriangleMesh MakeTriangleMesh(SurfaceMesh& surface) {
  surface.collect_garbage();
  TriangleMesh mesh;
  for (const auto v : surface.vertices()) {
    const Kernel::Point_3& p = surface.point(v);
    mesh.vertices.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()),
                               CGAL::to_double(p.z()));
  }
  for (const auto f : surface.faces()) {
    Eigen::Vector3i triangle;
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      if (k < 3) triangle[k++] = static_cast<int>(v.idx());
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

std::optional<TriangleMesh> Unite(const std::vector<TriangleMesh>& solids, Progress& progress) {
  const auto larger = [](const SurfaceMesh& a, const SurfaceMesh& b) {
    return a.number_of_faces() > b.number_of_faces();
  };
  std::vector<SurfaceMesh> left;
  for (const TriangleMesh& solid : solids) left.push_back(MakeSurfaceMesh(solid));
  try {
    // The two smallest become one each time.
    while (left.size() > 1) {
      std::stable_sort(left.begin(), left.end(), larger);
      SurfaceMesh& a = left[left.size() - 2];
      if (!pmp::corefine_and_compute_union(a, left.back(), a)) return {};
      a.collect_garbage();
      left.pop_back();
      progress.Advance();
    }
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const CGAL::Failure_exception&) {
    return {};
  } catch (const pmp::Corefinement::Self_intersection_exception&) {
    return {};
  }
  const TriangleMesh rounded = MakeTriangleMesh(left.front());
  TriangleMesh result = RemoveShortEdges(rounded, kNoEdge_rel * SizeOf(rounded));
  const MeshTopology topology = ExamineTopology(result);
  if (!topology.closed || !topology.manifold || !(SignedVolume(result) > 0)) return {};
  return result;
}

std::optional<TriangleMesh> UniteCluster(const std::vector<int>& cluster, const Parts& parts,
                                         Progress& progress) {
  std::vector<TriangleMesh> solids;
  for (const int part : cluster) {
    auto solid = AsSolid(parts.meshes[part]);
    if (!solid) return {};
    solids.push_back(std::move(*solid));
  }
  return Unite(solids, progress);
}

void Append(const TriangleMesh& part, TriangleMesh& whole) {
  const int first = static_cast<int>(whole.vertices.size());
  whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const Eigen::Vector3i& t : part.triangles) whole.triangles.push_back(t.array() + first);
}

}  // namespace

std::vector<int> LabelParts(const TriangleMesh& mesh) {
  DisjointSets sets(mesh.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    sets.Unite(t[0], t[1]);
    sets.Unite(t[0], t[2]);
  }
  std::vector<int> labels, label_of_set(mesh.vertices.size(), -1);
  int count = 0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    int& label = label_of_set[sets.Find(t[0])];
    if (label < 0) label = count++;
    labels.push_back(label);
  }
  return labels;
}

std::optional<PartUnion> UniteParts(const TriangleMesh& mesh, Progress& progress) {
  ValidateMesh(mesh, "union of parts");
  const Parts parts = SplitIntoParts(mesh);
  if (parts.meshes.size() < 2) return {};
  PartUnion result;
  progress.Start("uniting parts that cross", static_cast<int64_t>(parts.meshes.size()));
  for (const auto& [least, cluster] : FindClusters(mesh, parts)) {
    std::optional<TriangleMesh> united;
    if (cluster.size() > 1) united = UniteCluster(cluster, parts, progress);
    if (united) {
      Append(*united, result.mesh);
      result.united += static_cast<int>(cluster.size());
    } else {
      for (const int part : cluster) Append(parts.meshes[part], result.mesh);
    }
    progress.Advance();
  }
  if (result.united == 0) return {};
  return result;
}

}  // namespace lfm
