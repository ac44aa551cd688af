// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/decimation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

#include "core/error.h"
#include "mesh/half_edge_mesh.h"

namespace lfm {
namespace {

constexpr double kPullToMiddle = 1e-3;
// Price of an edge of length L: that of lying L / 1000 off over an area L^2.
constexpr double kPriceOfLength = 1e-6;
constexpr double kBoundaryWeight = 10;

// sum_i w_i (n_i . x - d_i)^2 = x^T a x - 2 b^T x + c
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0;

  void AddPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight) {
    const double d = normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  double At(const Eigen::Vector3d& x) const {
    return std::max(0.0, x.dot(a * x) - 2 * b.dot(x) + c);
  }
};

struct Candidate {
  double cost;
  int edge;
  uint32_t version;
  bool operator>(const Candidate& other) const {
    return cost != other.cost ? cost > other.cost : edge > other.edge;
  }
};
using Queue = std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>;

struct Placement {
  Eigen::Vector3d position;
  double cost;
};

Placement PlaceBest(const Quadric& quadric, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const Eigen::Vector3d middle = 0.5 * (p + q);
  const double pull = kPullToMiddle * quadric.a.trace();
  const double square = (p - q).squaredNorm();
  Placement best{middle, 0};
  if (pull > 0) {
    const Eigen::Matrix3d a = quadric.a + pull * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d x = a.inverse() * (quadric.b + pull * middle);
    if (x.allFinite() && (x - middle).squaredNorm() <= square) best.position = x;
  }
  best.cost = quadric.At(best.position) + kPriceOfLength * square * square;
  return best;
}

}  // namespace

struct Decimation::State {
  HalfEdgeMesh mesh;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< taken off, for the digits of quadrics
  std::vector<Quadric> quadrics;
  std::vector<double> prices;      ///< of vertices; or empty
  std::vector<uint32_t> versions;  ///< of edges: a queued candidate with an older one is void
  int64_t triangles = 0;
  double area = 0;

  Placement Place(OpenMesh::EdgeHandle edge) const {
    const auto half_edge = mesh.topology.halfedge_handle(edge, 0);
    const auto v0 = mesh.topology.from_vertex_handle(half_edge);
    const auto v1 = mesh.topology.to_vertex_handle(half_edge);
    Quadric sum = quadrics[v0.idx()];
    sum += quadrics[v1.idx()];
    Placement best = PlaceBest(sum, mesh.Position(v0), mesh.Position(v1));
    if (!prices.empty()) best.cost *= std::max(prices[v0.idx()], prices[v1.idx()]);
    return best;
  }

  void Enqueue(OpenMesh::EdgeHandle edge, Queue& queue) {
    queue.push({Place(edge).cost, edge.idx(), ++versions[edge.idx()]});
  }

  void AddQuadrics(const TriangleMesh& original);
  bool CollapseFrom(Queue& queue, int64_t count, const CollapseLimits& limits);
};

void Decimation::State::AddQuadrics(const TriangleMesh& original) {
  quadrics.assign(original.vertices.size(), {});
  const auto neighbors = ComputeTriangleNeighbors(original);
  for (size_t t = 0; t < original.triangles.size(); ++t) {
    const Eigen::Vector3i& corners = original.triangles[t];
    const Eigen::Vector3d doubled = AreaNormal(
        mesh.positions[corners[0]], mesh.positions[corners[1]], mesh.positions[corners[2]]);
    if (!(doubled.norm() > 0)) continue;
    const Eigen::Vector3d normal = doubled.normalized();
    area += 0.5 * doubled.norm();
    for (int k = 0; k < 3; ++k) {
      quadrics[corners[k]].AddPlane(normal, mesh.positions[corners[k]], doubled.norm() / 6);
      if (neighbors[t][k] >= 0) continue;
      const int a = corners[k], b = corners[(k + 1) % 3];
      const Eigen::Vector3d edge = mesh.positions[b] - mesh.positions[a];
      const Eigen::Vector3d upright = edge.cross(normal).normalized();
      for (const int v : {a, b}) {
        quadrics[v].AddPlane(upright, mesh.positions[a], kBoundaryWeight * edge.squaredNorm());
      }
    }
  }
}

bool Decimation::State::CollapseFrom(Queue& queue, int64_t count, const CollapseLimits& limits) {
  HalfEdges& topology = mesh.topology;
  bool collapsed = false;
  while (triangles > count && !queue.empty()) {
    const Candidate candidate = queue.top();
    queue.pop();
    const OpenMesh::EdgeHandle edge(candidate.edge);
    if (topology.status(edge).deleted() || versions[candidate.edge] != candidate.version) continue;
    const auto half_edge = topology.halfedge_handle(edge, 0);
    const Eigen::Vector3d position = Place(edge).position;
    if (!MayCollapse(mesh, half_edge, position, limits)) continue;
    const auto from = topology.from_vertex_handle(half_edge);
    const auto to = topology.to_vertex_handle(half_edge);
    triangles -= topology.is_boundary(edge) ? 1 : 2;
    topology.collapse(half_edge);
    mesh.positions[to.idx()] = position;
    quadrics[to.idx()] += quadrics[from.idx()];
    if (!prices.empty()) prices[to.idx()] = std::max(prices[from.idx()], prices[to.idx()]);
    collapsed = true;
    for (auto it = topology.cve_iter(to); it.is_valid(); ++it) Enqueue(*it, queue);
  }
  return collapsed;
}

Decimation::Decimation(const TriangleMesh& mesh, const std::vector<double>& prices)
    : state_(std::make_unique<State>()) {
  ValidateMesh(mesh, "decimation");
  if (!prices.empty() && prices.size() != mesh.vertices.size()) {
    throw Error("decimation: expected a price for each vertex");
  }
  for (const double price : prices) {
    if (!(price > 0) || !std::isfinite(price)) {
      throw Error("decimation: prices must be positive");
    }
  }
  state_->prices = prices;
  state_->mesh = MakeHalfEdgeMesh(mesh);
  for (const Eigen::Vector3d& v : mesh.vertices) state_->center += v;
  state_->center /= static_cast<double>(mesh.vertices.size());
  for (Eigen::Vector3d& v : state_->mesh.positions) v -= state_->center;
  state_->triangles = static_cast<int64_t>(mesh.triangles.size());
  state_->versions.assign(state_->mesh.topology.n_edges(), 0);
  state_->AddQuadrics(mesh);
}
Decimation::Decimation(const Decimation& other) : state_(std::make_unique<State>(*other.state_)) {}
Decimation& Decimation::operator=(const Decimation& other) {
  *state_ = *other.state_;
  return *this;
}
Decimation::~Decimation() = default;

void Decimation::ReduceTo(int64_t count) {
  count = std::max<int64_t>(count, 4);
  if (state_->triangles <= count) return;
  // Edge of the equilateral triangle of mean area at the target.
  const double usual_edge =
      std::sqrt(4 / std::sqrt(3.0) * state_->area / static_cast<double>(count));
  CollapseLimits limits{0.35, 0.05, 0.5, 2.5 * usual_edge, 0.1 * usual_edge, 9};
  // Strict first; where that does not reach the target, looser.
  for (int round = 0; round < 5 && state_->triangles > count; ++round) {
    bool collapsed = true;
    while (collapsed && state_->triangles > count) {
      Queue queue;
      for (size_t e = 0; e < state_->mesh.topology.n_edges(); ++e) {
        const OpenMesh::EdgeHandle edge(static_cast<int>(e));
        if (!state_->mesh.topology.status(edge).deleted()) state_->Enqueue(edge, queue);
      }
      collapsed = state_->CollapseFrom(queue, count, limits);
    }
    limits.min_quality *= 0.5;
    limits.min_normal_cosine *= 0.6;
    limits.max_edge_mm *= 2;
    limits.max_valence += 3;
  }
}

int64_t Decimation::triangles() const { return state_->triangles; }

TriangleMesh Decimation::Mesh() const {
  TriangleMesh mesh = MakeTriangleMesh(state_->mesh);
  for (Eigen::Vector3d& v : mesh.vertices) v += state_->center;
  return mesh;
}

TriangleMesh RemoveShortEdges(const TriangleMesh& mesh, double length_mm) {
  HalfEdgeMesh work = MakeHalfEdgeMesh(mesh);
  const CollapseLimits limits{0, 0, 0.5, std::numeric_limits<double>::infinity(), length_mm, 14};
  // Shortest first, in doubling steps: the tiniest triangles point anywhere, and would stand in the
  // way of others.
  for (double length = length_mm / 1024; length <= length_mm; length *= 2) {
    for (size_t e = 0; e < work.topology.n_edges(); ++e) {
      const OpenMesh::EdgeHandle edge(static_cast<int>(e));
      if (work.topology.status(edge).deleted()) continue;
      const auto half_edge = work.topology.halfedge_handle(edge, 0);
      const auto from = work.topology.from_vertex_handle(half_edge);
      const auto to = work.topology.to_vertex_handle(half_edge);
      const Eigen::Vector3d p = work.Position(from), q = work.Position(to);
      if ((p - q).norm() >= length) continue;
      Eigen::Vector3d position = 0.5 * (p + q);
      if ((p.z() == 0) != (q.z() == 0)) position = p.z() == 0 ? p : q;
      if (!MayCollapse(work, half_edge, position, limits)) continue;
      work.topology.collapse(half_edge);
      work.positions[to.idx()] = position;
    }
  }
  return MakeTriangleMesh(work);
}

}  // namespace lfm
