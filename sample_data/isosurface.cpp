// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using Function = std::function<double(const V3&)>;

constexpr int kBlock = 8;
constexpr int kRelaxations = 3;

// Function values at the grid's corners; far from the surface only their sign is meant.
struct Samples {
  int nx = 0, ny = 0, nz = 0;
  V3 origin;
  double cell = 0;
  std::vector<float> values;

  size_t Index(int x, int y, int z) const { return (static_cast<size_t>(z) * ny + y) * nx + x; }
  V3 Corner(int x, int y, int z) const { return origin + cell * V3(x, y, z); }
};

Samples SampleFunction(const Function& function, const IsosurfaceGrid& grid, double max_gradient) {
  Samples s;
  s.cell = grid.cell_mm;
  s.origin = grid.min;
  const V3 cells = (grid.max - grid.min) / grid.cell_mm;
  s.nx = static_cast<int>(std::ceil(cells.x())) + 1;
  s.ny = static_cast<int>(std::ceil(cells.y())) + 1;
  s.nz = static_cast<int>(std::ceil(cells.z())) + 1;
  s.values.resize(static_cast<size_t>(s.nx) * s.ny * s.nz);
  const int bx = (s.nx + kBlock - 1) / kBlock, by = (s.ny + kBlock - 1) / kBlock;
  const int bz = (s.nz + kBlock - 1) / kBlock;
  const double reach = std::sqrt(3.0) * (kBlock / 2.0 + 1) * s.cell * max_gradient;
  ParallelFor(0, static_cast<int64_t>(bx) * by * bz, [&](int64_t block) {
    const int x0 = static_cast<int>(block % bx) * kBlock;
    const int y0 = static_cast<int>(block / bx % by) * kBlock;
    const int z0 = static_cast<int>(block / (static_cast<int64_t>(bx) * by)) * kBlock;
    const double half = kBlock / 2.0;
    const double center = function(s.origin + s.cell * V3(x0 + half, y0 + half, z0 + half));
    for (int z = z0; z < std::min(z0 + kBlock, s.nz); ++z) {
      for (int y = y0; y < std::min(y0 + kBlock, s.ny); ++y) {
        for (int x = x0; x < std::min(x0 + kBlock, s.nx); ++x) {
          s.values[s.Index(x, y, z)] =
              static_cast<float>(std::abs(center) > reach ? center : function(s.Corner(x, y, z)));
        }
      }
    }
  });
  return s;
}

V3 Gradient(const Function& function, const V3& p, double step) {
  return V3(function(p + V3(step, 0, 0)) - function(p - V3(step, 0, 0)),
            function(p + V3(0, step, 0)) - function(p - V3(0, step, 0)),
            function(p + V3(0, 0, step)) - function(p - V3(0, 0, step))) /
         (2 * step);
}

V3 ProjectOntoSurface(const Function& function, V3 p, double max_step) {
  for (int i = 0; i < 4; ++i) {
    const double value = function(p);
    const V3 gradient = Gradient(function, p, 1e-3);
    const double norm2 = gradient.squaredNorm();
    if (!(norm2 > 1e-12)) break;
    V3 step = -value / norm2 * gradient;
    if (step.norm() > max_step) step *= max_step / step.norm();
    p += step;
    if (step.norm() < 1e-6) break;
  }
  return p;
}

// The twelve edges of a cell, by their corners (bit 0 is x, bit 1 is y, bit 2 is z).
constexpr int kEdges[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                               {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
// The four corners of each face, in order round it.
constexpr int kFaces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                              {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

int EdgeBetween(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    if ((kEdges[e][0] == a && kEdges[e][1] == b) || (kEdges[e][0] == b && kEdges[e][1] == a)) {
      return e;
    }
  }
  return -1;
}

// Groups a cell's crossed edges into the sheets of surface that pass through it. On a face with
// four crossings, inside corners are kept apart, or joined where `joined_faces` has its bit; the
// neighbour decides alike, so sheets match.
std::array<int, 12> FindSheets(const std::array<float, 8>& v, unsigned joined_faces) {
  std::array<int, 12> sheet;
  for (int e = 0; e < 12; ++e) sheet[e] = (v[kEdges[e][0]] < 0) != (v[kEdges[e][1]] < 0) ? e : -1;
  const auto join = [&](int a, int b) {
    const int from = sheet[b], to = sheet[a];
    for (int& s : sheet) {
      if (s == from) s = to;
    }
  };
  for (int f = 0; f < 6; ++f) {
    const auto& face = kFaces[f];
    int crossed[4], count = 0;
    for (int i = 0; i < 4; ++i) {
      const int e = EdgeBetween(face[i], face[(i + 1) % 4]);
      if (sheet[e] >= 0) crossed[count++] = e;
    }
    if (count == 2) join(crossed[0], crossed[1]);
    if (count == 4) {
      // crossed[i] runs from corner i to i + 1; the two edges at an inside corner belong together.
      const int first = (v[face[0]] < 0) != (joined_faces >> f & 1) ? 0 : 1;
      join(crossed[first], crossed[(first + 3) % 4]);
      join(crossed[(first + 1) % 4], crossed[(first + 2) % 4]);
    }
  }
  return sheet;
}

// The faces (a bit each) with four crossings that all belong to one sheet of this cell. Where the
// cell beyond finds the same, four quads would share one edge: there the inside corners must be
// joined instead, which splits the sheet in both (manifold dual contouring, Wenger 2013).
unsigned FindPinchedFaces(const std::array<float, 8>& v) {
  const std::array<int, 12> sheets = FindSheets(v, 0);
  unsigned pinched = 0;
  for (int f = 0; f < 6; ++f) {
    bool one_sheet = true;
    const int first = sheets[EdgeBetween(kFaces[f][0], kFaces[f][1])];
    for (int i = 0; i < 4; ++i) {
      const int sheet = sheets[EdgeBetween(kFaces[f][i], kFaces[f][(i + 1) % 4])];
      one_sheet = one_sheet && sheet >= 0 && sheet == first;
    }
    if (one_sheet) pinched |= 1u << f;
  }
  return pinched;
}

// One vertex for every sheet in every cell, at the mean of its edge crossings.
struct Net {
  std::vector<int> active_of_cell;                  ///< -1 where the surface does not pass
  std::vector<std::array<int, 12>> vertex_of_edge;  ///< of each active cell
  TriangleMesh mesh;
};

struct ActiveCell {
  int x, y, z;
  std::array<float, 8> values;
  unsigned pinched;
};

std::vector<ActiveCell> FindActiveCells(const Samples& s, std::vector<int>& active_of_cell) {
  std::vector<ActiveCell> cells;
  active_of_cell.assign(s.values.size(), -1);
  for (int z = 0; z + 1 < s.nz; ++z) {
    for (int y = 0; y + 1 < s.ny; ++y) {
      for (int x = 0; x + 1 < s.nx; ++x) {
        std::array<float, 8> v;
        int inside = 0;
        for (int c = 0; c < 8; ++c) {
          v[c] = s.values[s.Index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
          inside += v[c] < 0;
        }
        if (inside == 0 || inside == 8) continue;
        active_of_cell[s.Index(x, y, z)] = static_cast<int>(cells.size());
        cells.push_back({x, y, z, v, FindPinchedFaces(v)});
      }
    }
  }
  return cells;
}

Net PlaceVertices(const Samples& s) {
  Net net;
  const std::vector<ActiveCell> cells = FindActiveCells(s, net.active_of_cell);
  for (const ActiveCell& cell : cells) {
    unsigned joined = 0;
    for (int f = 0; f < 6; ++f) {
      if (!(cell.pinched >> f & 1)) continue;
      // Faces come in pairs: below and above along x, y, z.
      Eigen::Vector3i beyond(cell.x, cell.y, cell.z);
      beyond[f / 2] += f % 2 ? 1 : -1;
      if (beyond.minCoeff() < 0) continue;
      const int other = net.active_of_cell[s.Index(beyond.x(), beyond.y(), beyond.z())];
      if (other >= 0 && (cells[other].pinched >> (f ^ 1) & 1)) joined |= 1u << f;
    }
    const std::array<int, 12> sheets = FindSheets(cell.values, joined);
    std::array<int, 12> vertices;
    vertices.fill(-1);
    for (int sheet = 0; sheet < 12; ++sheet) {
      V3 sum = V3::Zero();
      int count = 0;
      for (int e = 0; e < 12; ++e) {
        if (sheets[e] != sheet) continue;
        const int a = kEdges[e][0], b = kEdges[e][1];
        const double t = cell.values[a] / (cell.values[a] - cell.values[b]);
        const V3 ca(a & 1, a >> 1 & 1, a >> 2), cb(b & 1, b >> 1 & 1, b >> 2);
        sum += ca + t * (cb - ca);
        ++count;
        vertices[e] = static_cast<int>(net.mesh.vertices.size());
      }
      if (count > 0) {
        net.mesh.vertices.push_back(s.Corner(cell.x, cell.y, cell.z) + s.cell * sum / count);
      }
    }
    net.vertex_of_edge.push_back(vertices);
  }
  return net;
}

// Two triangles for each grid edge that the surface crosses, cut along the shorter diagonal.
void ConnectVertices(const Samples& s, Net& net) {
  const auto quad = [&](const std::array<int, 4>& q) {
    const auto& p = net.mesh.vertices;
    if ((p[q[0]] - p[q[2]]).squaredNorm() <= (p[q[1]] - p[q[3]]).squaredNorm()) {
      net.mesh.triangles.emplace_back(q[0], q[1], q[2]);
      net.mesh.triangles.emplace_back(q[0], q[2], q[3]);
    } else {
      net.mesh.triangles.emplace_back(q[0], q[1], q[3]);
      net.mesh.triangles.emplace_back(q[1], q[2], q[3]);
    }
  };
  for (int z = 1; z + 1 < s.nz; ++z) {
    for (int y = 1; y + 1 < s.ny; ++y) {
      for (int x = 1; x + 1 < s.nx; ++x) {
        const bool here = s.values[s.Index(x, y, z)] < 0;
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::Vector3i d = Eigen::Vector3i::Unit(axis);
          const bool there = s.values[s.Index(x + d.x(), y + d.y(), z + d.z())] < 0;
          if (here == there) continue;
          const int side1 = 1 << (axis + 1) % 3, side2 = 1 << (axis + 2) % 3;
          // The cells round this edge; in each, the edge starts at the corner `sides`.
          const auto vertex = [&](int sides) {
            const size_t cell = s.Index(x - (sides & 1), y - (sides >> 1 & 1), z - (sides >> 2));
            return net
                .vertex_of_edge[net.active_of_cell[cell]][EdgeBetween(sides, sides | 1 << axis)];
          };
          const int v0 = vertex(side1 | side2), v1 = vertex(side2), v2 = vertex(0);
          const int v3 = vertex(side1);
          quad(here ? std::array<int, 4>{v0, v1, v2, v3} : std::array<int, 4>{v3, v2, v1, v0});
        }
      }
    }
  }
}

// Moves every vertex towards the mean of its neighbours and back onto the surface, which evens
// out the triangles.
void Relax(const Function& function, double cell, TriangleMesh& mesh) {
  const VertexRings rings = ComputeVertexRings(mesh);
  std::vector<V3> moved(mesh.vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(mesh.vertices.size()),
      [&](int64_t v) {
        V3 mean = V3::Zero();
        int count = 0;
        for (int i = rings.offsets[v]; i < rings.offsets[v + 1]; ++i) {
          for (int corner : mesh.triangles[rings.triangles[i]]) {
            if (corner == v) continue;
            mean += mesh.vertices[corner];
            ++count;
          }
        }
        const V3 target = count > 0 ? V3(mean / count) : mesh.vertices[v];
        moved[v] = ProjectOntoSurface(function, 0.5 * (mesh.vertices[v] + target), 0.5 * cell);
      },
      256);
  mesh.vertices = std::move(moved);
}

}  // namespace

TriangleMesh PolygoniseIsosurface(const Function& function, const IsosurfaceGrid& grid,
                                  double max_gradient) {
  if (!(grid.cell_mm > 0) || !((grid.max - grid.min).minCoeff() > 2 * grid.cell_mm)) {
    throw Error("isosurface: the grid needs cells larger than 0 and a box of several cells");
  }
  const Samples samples = SampleFunction(function, grid, max_gradient);
  for (int z = 0; z < samples.nz; ++z) {
    for (int y = 0; y < samples.ny; ++y) {
      for (int x = 0; x < samples.nx; ++x) {
        const bool rim = x == 0 || y == 0 || z == 0 || x == samples.nx - 1 || y == samples.ny - 1 ||
                         z == samples.nz - 1;
        if (rim && samples.values[samples.Index(x, y, z)] < 0) {
          throw Error("isosurface: the surface leaves the grid's box; choose a larger box");
        }
      }
    }
  }
  Net net = PlaceVertices(samples);
  if (net.mesh.vertices.empty()) throw Error("isosurface: no surface inside the grid's box");
  ConnectVertices(samples, net);
  for (int i = 0; i < kRelaxations; ++i) Relax(function, grid.cell_mm, net.mesh);
  net.mesh.normals.resize(net.mesh.vertices.size());
  ParallelFor(
      0, static_cast<int64_t>(net.mesh.vertices.size()),
      [&](int64_t v) {
        net.mesh.normals[v] = Gradient(function, net.mesh.vertices[v], 0.02).normalized();
      },
      256);
  const MeshTopology topology = ExamineTopology(net.mesh);
  if (!topology.closed || !topology.manifold || topology.degenerate_triangles > 0) {
    throw Error("isosurface: the result is no closed 2-manifold; choose smaller cells");
  }
  return net.mesh;
}

}  // namespace lfm
