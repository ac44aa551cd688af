// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/edge_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mesh/half_edge_mesh.h"
#include "mesh/surface_fit.h"

namespace lfm {
namespace {

constexpr double kCreaseCosine = std::numbers::sqrt2 / 2;
constexpr double kSliverQuality = 0.05;
constexpr double kFoldCosine = 0.85;  // a flip must not make a fold sharper than this

double SmallestAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const auto angle = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return std::min({angle(b - a, c - a), angle(c - b, a - b), angle(a - c, b - c)});
}

double Cosine(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const double lengths = u.norm() * v.norm();
  return lengths > 0 ? u.dot(v) / lengths : -1;
}

// The two triangles at an inner edge: (a, b, left) and (b, a, right).
struct Diamond {
  OpenMesh::VertexHandle a, b, left, right;
};

Diamond DiamondOf(const HalfEdges& topology, OpenMesh::EdgeHandle edge) {
  const auto h = topology.halfedge_handle(edge, 0), o = topology.halfedge_handle(edge, 1);
  return {topology.from_vertex_handle(h), topology.to_vertex_handle(h),
          topology.to_vertex_handle(topology.next_halfedge_handle(h)),
          topology.to_vertex_handle(topology.next_halfedge_handle(o))};
}

bool IsCrease(const HalfEdgeMesh& mesh, OpenMesh::EdgeHandle edge) {
  const Diamond d = DiamondOf(mesh.topology, edge);
  const Eigen::Vector3d &a = mesh.Position(d.a), &b = mesh.Position(d.b);
  // A sliver's normal says nothing about the surface.
  if (TriangleQuality(a, b, mesh.Position(d.left)) < kSliverQuality ||
      TriangleQuality(b, a, mesh.Position(d.right)) < kSliverQuality) {
    return false;
  }
  return Cosine(AreaNormal(a, b, mesh.Position(d.left)), AreaNormal(b, a, mesh.Position(d.right))) <
         kCreaseCosine;
}

std::vector<char> FindFixed(const HalfEdgeMesh& mesh) {
  std::vector<char> fixed(mesh.positions.size(), 0);
  for (size_t e = 0; e < mesh.topology.n_edges(); ++e) {
    const OpenMesh::EdgeHandle edge(static_cast<int>(e));
    if (!mesh.topology.is_boundary(edge) && !IsCrease(mesh, edge)) continue;
    const auto h = mesh.topology.halfedge_handle(edge, 0);
    fixed[mesh.topology.from_vertex_handle(h).idx()] = 1;
    fixed[mesh.topology.to_vertex_handle(h).idx()] = 1;
  }
  return fixed;
}

bool FlipImproves(const HalfEdgeMesh& mesh, OpenMesh::EdgeHandle edge) {
  const Diamond d = DiamondOf(mesh.topology, edge);
  const Eigen::Vector3d &a = mesh.Position(d.a), &b = mesh.Position(d.b),
                        &l = mesh.Position(d.left), &r = mesh.Position(d.right);
  const double before = std::min(SmallestAngle(a, b, l), SmallestAngle(b, a, r));
  const double after = std::min(SmallestAngle(l, r, b), SmallestAngle(r, l, a));
  // A margin, so that equal angles do not flip back and forth.
  if (!(after > before + 1e-9)) return false;
  const Eigen::Vector3d old_1 = AreaNormal(a, b, l), old_2 = AreaNormal(b, a, r);
  const Eigen::Vector3d new_1 = AreaNormal(l, r, b), new_2 = AreaNormal(r, l, a);
  const double fold = std::min(kFoldCosine, Cosine(old_1, old_2));
  const Eigen::Vector3d mean = old_1 + old_2;
  return Cosine(new_1, new_2) >= fold && Cosine(new_1, mean) > 0.5 && Cosine(new_2, mean) > 0.5;
}

void FlipEdges(HalfEdgeMesh& mesh) {
  HalfEdges& topology = mesh.topology;
  for (int pass = 0; pass < 8; ++pass) {
    bool flipped = false;
    for (size_t e = 0; e < topology.n_edges(); ++e) {
      const OpenMesh::EdgeHandle edge(static_cast<int>(e));
      if (topology.is_boundary(edge) || IsCrease(mesh, edge)) continue;
      if (!topology.is_flip_ok(edge) || !FlipImproves(mesh, edge)) continue;
      topology.flip(edge);
      flipped = true;
    }
    if (!flipped) return;
  }
}

struct RingShape {
  double smallest_angle = std::numbers::pi;
  double smallest_turn = 1;  ///< cosine between old and new normals
};

RingShape ExamineRing(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle v,
                      const Eigen::Vector3d& position) {
  RingShape shape;
  for (auto it = mesh.topology.cvoh_iter(v); it.is_valid(); ++it) {
    const Eigen::Vector3d& b = mesh.Position(mesh.topology.to_vertex_handle(*it));
    const Eigen::Vector3d& c =
        mesh.Position(mesh.topology.to_vertex_handle(mesh.topology.next_halfedge_handle(*it)));
    shape.smallest_angle = std::min(shape.smallest_angle, SmallestAngle(position, b, c));
    shape.smallest_turn = std::min(shape.smallest_turn, Cosine(AreaNormal(mesh.Position(v), b, c),
                                                               AreaNormal(position, b, c)));
  }
  return shape;
}

void SmoothTangentially(HalfEdgeMesh& mesh, const RayScene& surface,
                        const std::vector<char>& fixed) {
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const OpenMesh::VertexHandle v(static_cast<int>(i));
    if (fixed[i] || mesh.topology.is_isolated(v)) continue;
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    double area = 0;
    for (auto it = mesh.topology.cvoh_iter(v); it.is_valid(); ++it) {
      const Eigen::Vector3d& b = mesh.Position(mesh.topology.to_vertex_handle(*it));
      const Eigen::Vector3d& c =
          mesh.Position(mesh.topology.to_vertex_handle(mesh.topology.next_halfedge_handle(*it)));
      const Eigen::Vector3d doubled = AreaNormal(mesh.positions[i], b, c);
      centroid += doubled.norm() * (mesh.positions[i] + b + c) / 3;
      area += doubled.norm();
      normal += doubled;
    }
    if (!(area > 0) || !(normal.norm() > 0)) continue;
    Eigen::Vector3d step = 0.5 * (centroid / area - mesh.positions[i]);
    step -= step.dot(normal.normalized()) * normal.normalized();
    const auto closest = surface.Closest(mesh.positions[i] + step);
    if (!closest) continue;
    // The closest point may lie on another sheet of something thin.
    if ((closest->point - mesh.positions[i]).norm() > 3 * step.norm() + closest->distance) continue;
    const RingShape before = ExamineRing(mesh, v, mesh.positions[i]);
    const RingShape after = ExamineRing(mesh, v, closest->point);
    if (after.smallest_angle > before.smallest_angle && after.smallest_turn > 0.7) {
      mesh.positions[i] = closest->point;
    }
  }
}

}  // namespace

TriangleMesh FlipTowardsDelaunay(const TriangleMesh& mesh) {
  HalfEdgeMesh work = MakeHalfEdgeMesh(mesh);
  FlipEdges(work);
  return MakeTriangleMesh(work);
}

TriangleMesh ImproveTriangles(const TriangleMesh& mesh, const RayScene& surface,
                              const SurfaceSamples& samples) {
  constexpr int kTurns = 3;
  TriangleMesh improved = mesh;
  for (int turn = 0; turn < kTurns; ++turn) {
    HalfEdgeMesh work = MakeHalfEdgeMesh(improved);
    FlipEdges(work);
    const std::vector<char> fixed = FindFixed(work);
    SmoothTangentially(work, surface, fixed);
    FlipEdges(work);
    improved = FitToSurface(MakeTriangleMesh(work), samples, fixed);
  }
  return improved;
}

}  // namespace lfm
