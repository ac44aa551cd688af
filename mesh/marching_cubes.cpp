// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/marching_cubes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace lfm {
namespace {

// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2). Edge 4 * axis + i runs along `axis` from
// the i-th of the corners that are low on that axis.
struct CellEdge {
  int from = 0, axis = 0;
};

constexpr std::array<CellEdge, 12> MakeEdges() {
  std::array<CellEdge, 12> edges{};
  for (int axis = 0, e = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 8; ++corner) {
      if ((corner >> axis & 1) == 0) edges[e++] = {corner, axis};
    }
  }
  return edges;
}
constexpr std::array<CellEdge, 12> kEdges = MakeEdges();

int EdgeBetween(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const int low = kEdges[e].from, high = low | 1 << kEdges[e].axis;
    if ((a == low && b == high) || (a == high && b == low)) return e;
  }
  return -1;
}

// The corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> FaceCorners(int axis, int side) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  std::array<int, 4> corners = {base, base | u, base | u | v, base | v};
  if (side == 0) std::swap(corners[1], corners[3]);
  return corners;
}

bool ShareFace(int e, int f) {
  for (int axis = 0; axis < 3; ++axis) {
    if (kEdges[e].axis == axis || kEdges[f].axis == axis) continue;
    if ((kEdges[e].from >> axis & 1) == (kEdges[f].from >> axis & 1)) return true;
  }
  return false;
}

// A diagonal in a face of the cell may meet the neighbour's: begin the fan where there are fewest.
std::vector<std::array<int, 3>> Fan(const std::vector<int>& loop) {
  const int n = static_cast<int>(loop.size());
  int best = 0, fewest = n;
  for (int start = 0; start < n; ++start) {
    int in_faces = 0;
    for (int k = 2; k < n - 1; ++k) in_faces += ShareFace(loop[start], loop[(start + k) % n]);
    if (in_faces < fewest) {
      fewest = in_faces;
      best = start;
    }
  }
  std::vector<std::array<int, 3>> triangles;
  for (int k = 2; k < n; ++k) {
    triangles.push_back({loop[best], loop[(best + k - 1) % n], loop[(best + k) % n]});
  }
  return triangles;
}

// Triangles between cell edges for a pattern of inside corners. On each face a line leads from
// where its border leaves the inside to where it enters again; the lines of all faces close to
// loops.
std::vector<std::array<int, 3>> TrianglesOf(int inside) {
  std::array<int, 12> next;
  next.fill(-1);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const std::array<int, 4> corners = FaceCorners(axis, side);
      const auto is_inside = [&](int i) { return (inside >> corners[i % 4] & 1) != 0; };
      for (int i = 0; i < 4; ++i) {
        if (!is_inside(i) || is_inside(i + 1)) continue;
        int j = i + 1;
        while (!is_inside(j + 1)) ++j;
        next[EdgeBetween(corners[i], corners[(i + 1) % 4])] =
            EdgeBetween(corners[j % 4], corners[(j + 1) % 4]);
      }
    }
  }
  std::vector<std::array<int, 3>> triangles;
  std::array<bool, 12> done{};
  for (int e = 0; e < 12; ++e) {
    if (next[e] < 0 || done[e]) continue;
    std::vector<int> loop;
    for (int at = e; !done[at]; at = next[at]) {
      done[at] = true;
      loop.push_back(at);
    }
    for (const auto& triangle : Fan(loop)) triangles.push_back(triangle);
  }
  return triangles;
}

const std::array<std::vector<std::array<int, 3>>, 256>& Table() {
  static const auto table = [] {
    std::array<std::vector<std::array<int, 3>>, 256> all;
    for (int inside = 0; inside < 256; ++inside) all[inside] = TrianglesOf(inside);
    return all;
  }();
  return table;
}

// Where the cubic through values at -1, 0, 1, 2 vanishes between 0 and 1; those at 0 and 1 have
// unlike signs. Bisection: it cannot leave the edge.
double RootOnEdge(double before, double a, double b, double after) {
  double low = 0, high = 1;
  for (int i = 0; i < 24; ++i) {
    const double t = 0.5 * (low + high);
    const double value =
        a + 0.5 * t *
                (b - before +
                 t * (2 * before - 5 * a + 4 * b - after + t * (3 * (a - b) + after - before)));
    ((value > 0) == (a > 0) ? low : high) = t;
  }
  // Not on the corner itself: another edge's vertex may lie there.
  return std::clamp(0.5 * (low + high), 1e-4, 1 - 1e-4);
}

// Four layers of values in a row and the vertices on edges of the current cells.
class March {
 public:
  March(int cells, const LayerSource& layers) : n_(cells), source_(layers) {
    for (int axis = 0; axis < 3; ++axis) {
      for (auto& ids : vertex_ids_[axis]) ids.assign(static_cast<size_t>(n_ + 1) * (n_ + 1), -1);
    }
  }

  TriangleMesh Run() {
    // layers_[1] is the lower one of the current cells, layers_[2] the upper.
    layers_[1] = Load(0);
    layers_[0] = layers_[1];
    layers_[2] = Load(1);
    for (int k = 0; k < n_; ++k) {
      layers_[3] = k + 2 <= n_ ? Load(k + 2) : layers_[2];
      MarchLayer(k);
      for (int i = 0; i < 3; ++i) std::swap(layers_[i], layers_[i + 1]);
      for (int axis = 0; axis < 2; ++axis) {
        std::swap(vertex_ids_[axis][0], vertex_ids_[axis][1]);
        std::fill(vertex_ids_[axis][1].begin(), vertex_ids_[axis][1].end(), -1);
      }
      std::fill(vertex_ids_[2][0].begin(), vertex_ids_[2][0].end(), -1);
    }
    return std::move(mesh_);
  }

 private:
  std::vector<float> Load(int k) {
    std::vector<float> layer = source_(k);
    for (float& value : layer) {
      if (!std::isfinite(value)) value = -1;
    }
    return layer;
  }

  size_t At(int x, int y) const { return static_cast<size_t>(y) * (n_ + 1) + x; }

  // The value `steps` corners along `axis` from a corner of the lower (0) or upper (1) layer; at
  // the cube's border the last one again.
  double Value(int x, int y, int upper, int axis, int steps) const {
    if (axis == 0) x = std::clamp(x + steps, 0, n_);
    if (axis == 1) y = std::clamp(y + steps, 0, n_);
    const int layer = 1 + upper + (axis == 2 ? steps : 0);
    return layers_[layer][At(x, y)];
  }

  int VertexOn(int x, int y, int k, const CellEdge& edge) {
    x += edge.from & 1;
    y += edge.from >> 1 & 1;
    const int upper = edge.from >> 2, axis = edge.axis;
    int& id = vertex_ids_[axis][upper][At(x, y)];
    if (id >= 0) return id;
    Eigen::Vector3d point(x, y, k + upper);
    point[axis] += RootOnEdge(Value(x, y, upper, axis, -1), Value(x, y, upper, axis, 0),
                              Value(x, y, upper, axis, 1), Value(x, y, upper, axis, 2));
    id = static_cast<int>(mesh_.vertices.size());
    mesh_.vertices.push_back(point);
    return id;
  }

  void MarchLayer(int k) {
    for (int y = 0; y < n_; ++y) {
      for (int x = 0; x < n_; ++x) {
        int inside = 0;
        for (int c = 0; c < 8; ++c) {
          inside |= (layers_[1 + (c >> 2)][At(x + (c & 1), y + (c >> 1 & 1))] > 0) << c;
        }
        if (inside == 0 || inside == 255) continue;
        for (const auto& edges : Table()[inside]) {
          Eigen::Vector3i triangle;
          for (int corner = 0; corner < 3; ++corner) {
            triangle[2 - corner] = VertexOn(x, y, k, kEdges[edges[corner]]);
          }
          mesh_.triangles.push_back(triangle);
        }
      }
    }
  }

  int n_;
  const LayerSource& source_;
  std::array<std::vector<float>, 4> layers_;
  // By axis; for x and y of the lower and the upper layer.
  std::array<std::array<std::vector<int>, 2>, 3> vertex_ids_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh MarchCubes(int cells, const LayerSource& layers) {
  if (cells < 1) return {};
  return March(cells, layers).Run();
}

}  // namespace lfm
