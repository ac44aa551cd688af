// SPDX-License-Identifier: BSD-3-Clause
#include "encode/transport_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "encode/mesh_coder.h"
#include "resample/vertex_frame.h"

namespace lfm::transport {
namespace {

struct GeometryModels {
  NumberModels index, coordinate, first_edge;
  std::array<NumberModels, 3> turn;                 // about x, y and z of the predicted frame
  std::array<NumberModels, kSizeClasses + 1> size;  // by the size class predicted; last: none
};

// The patch of a neighbour of lower index, if any, tells most of a patch's size.
int PredictedSizeClass(const Eigen::Vector3i& neighbors, int triangle,
                       const std::vector<int>& edge_samples) {
  int nearest = -1;
  for (const int neighbor : neighbors) {
    if (neighbor < triangle) nearest = std::max(nearest, neighbor);
  }
  return nearest < 0 ? kSizeClasses : SizeClass(edge_samples[nearest]);
}

// The frame of a vertex whose x axis follows the edge to the corner after it in one of its
// triangles: those of a light field follow the first (ComputeVertexFrames).
Eigen::Matrix3d PredictedFrame(const TriangleMesh& mesh, const Eigen::Vector3d& normal, int vertex,
                               int triangle) {
  const Eigen::Vector3i& corners = mesh.triangles[triangle];
  const int next = corners[(CornerOf(corners, vertex) + 1) % 3];
  return VertexFrame(normal, mesh.vertices[next] - mesh.vertices[vertex]);
}

Eigen::Vector3d RotationBetween(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  const Eigen::AngleAxisd rotation(Eigen::Matrix3d(from.transpose() * to));
  return rotation.angle() * rotation.axis();
}

// The triangles of a vertex, as places in VertexRings::triangles.
struct RingRange {
  int begin = 0, end = 0;
};

struct ChosenFrame {
  int edge = 0;  // of the ring
  Eigen::Matrix3d predicted;
};

// The edge of the ring that the frame follows best; the first among equals.
ChosenFrame NearestFrame(const TriangleMesh& mesh, const VertexRings& rings, const RingRange& range,
                         const Eigen::Vector3d& normal, int vertex, const Eigen::Matrix3d& frame) {
  ChosenFrame best{0, VertexFrame(normal, Eigen::Vector3d::Zero())};
  double least = HUGE_VAL;
  for (int e = range.begin; e < range.end; ++e) {
    const Eigen::Matrix3d predicted = PredictedFrame(mesh, normal, vertex, rings.triangles[e]);
    const double angle = RotationBetween(predicted, frame).norm();
    if (!(angle < least)) continue;
    least = angle;
    best = {e - range.begin, predicted};
  }
  return best;
}

void EncodeFrames(const TriangleMesh& mesh, const std::vector<Eigen::Matrix3d>& frames,
                  RangeEncoder& coder, GeometryModels& models) {
  const VertexRings rings = ComputeVertexRings(mesh);
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(mesh);
  for (size_t v = 0; v < frames.size(); ++v) {
    const ChosenFrame chosen = NearestFrame(mesh, rings, {rings.offsets[v], rings.offsets[v + 1]},
                                            normals[v], static_cast<int>(v), frames[v]);
    models.first_edge.Encode(coder, static_cast<uint32_t>(chosen.edge));
    const Eigen::Vector3d turn = RotationBetween(chosen.predicted, frames[v]);
    for (int a = 0; a < 3; ++a) {
      models.turn[a].Encode(coder, Zigzag(std::lround(turn[a] / kFrameStep)));
    }
  }
}

std::vector<Eigen::Matrix3d> DecodeFrames(const Stream& stream, const TriangleMesh& mesh,
                                          RangeDecoder& coder, GeometryModels& models) {
  const VertexRings rings = ComputeVertexRings(mesh);
  const std::vector<Eigen::Vector3d> normals = ComputeVertexNormals(mesh);
  std::vector<Eigen::Matrix3d> frames(normals.size());
  for (size_t v = 0; v < frames.size(); ++v) {
    const uint32_t edge = models.first_edge.Decode(coder);
    const auto ring = static_cast<uint32_t>(rings.offsets[v + 1] - rings.offsets[v]);
    stream.Require(edge < std::max(ring, 1U), "a vertex frame follows an edge that is not there");
    frames[v] = ring == 0 ? VertexFrame(normals[v], Eigen::Vector3d::Zero())
                          : PredictedFrame(mesh, normals[v], static_cast<int>(v),
                                           rings.triangles[rings.offsets[v] + edge]);
    Eigen::Vector3d turn;
    for (int a = 0; a < 3; ++a) {
      turn[a] = kFrameStep * static_cast<double>(Unzigzag(models.turn[a].Decode(coder)));
    }
    if (turn.norm() > 0) {
      frames[v] *= Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    }
    stream.Require(!coder.overrun(), "its geometry is too short");
  }
  return frames;
}

void EncodeDifferences(const LatticeMesh& mesh, RangeEncoder& coder, GeometryModels& models) {
  int before = 0;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      models.index.Encode(coder, Zigzag(triangle[c] - (c == 0 ? before : triangle[c - 1])));
    }
    before = triangle[0];
  }
  Eigen::Vector3i last = Eigen::Vector3i::Zero();
  for (const Eigen::Vector3i& p : mesh.vertices) {
    for (int a = 0; a < 3; ++a) models.coordinate.Encode(coder, Zigzag(p[a] - last[a]));
    last = p;
  }
}

LatticeMesh DecodeDifferences(const Stream& stream, const GeometryHeader& header,
                              RangeDecoder& coder, GeometryModels& models) {
  LatticeMesh mesh;
  int64_t before = 0;
  for (uint32_t t = 0; t < header.triangles; ++t) {
    for (int c = 0; c < 3; ++c) {
      before += Unzigzag(models.index.Decode(coder));
      stream.Require(before >= 0 && before < header.vertices,
                     "a triangle names a vertex that is not there");
      if (c == 0) mesh.triangles.emplace_back();
      mesh.triangles.back()[c] = static_cast<int>(before);
    }
    before = mesh.triangles.back()[0];
    stream.Require(!coder.overrun(), "its geometry is too short");
  }
  Eigen::Matrix<int64_t, 3, 1> last = Eigen::Matrix<int64_t, 3, 1>::Zero();
  for (uint32_t v = 0; v < header.vertices; ++v) {
    for (int a = 0; a < 3; ++a) last[a] += Unzigzag(models.coordinate.Decode(coder));
    stream.Require(!coder.overrun() && last.cwiseAbs().maxCoeff() < kMostLattice,
                   "its geometry is too short, or its coordinates too large");
    mesh.vertices.emplace_back(last.cast<int>());
  }
  return mesh;
}

TriangleMesh FromLattice(const LatticeMesh& lattice, const GeometryHeader& header) {
  const Eigen::Vector3d origin = Eigen::Map<const Eigen::Vector3d>(header.origin.data());
  TriangleMesh mesh;
  mesh.triangles = lattice.triangles;
  for (const Eigen::Vector3i& p : lattice.vertices) {
    mesh.vertices.emplace_back(origin + header.step * p.cast<double>());
  }
  return mesh;
}

GeometryHeader MakeHeader(const LightFieldModel& model, double error_in_samples) {
  Eigen::Vector3d low = model.mesh.vertices.front(), high = low;
  for (const Eigen::Vector3d& p : model.mesh.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  GeometryHeader header;
  header.vertices = static_cast<uint32_t>(model.mesh.vertices.size());
  header.triangles = static_cast<uint32_t>(model.mesh.triangles.size());
  header.terms = static_cast<uint32_t>(model.terms);
  header.grid = static_cast<uint32_t>(model.grid);
  header.direction_map = static_cast<uint32_t>(model.direction_map);
  header.mean_in_terms = model.mean_in_terms ? 1 : 0;
  header.max_texture = static_cast<uint32_t>(LargestPageSide(model));
  std::copy_n(low.data(), 3, header.origin.begin());
  // A cell's corner is half its diagonal from its middle.
  const double wanted = error_in_samples * MedianSampleSpacing(model) * 2 / std::sqrt(3.0);
  const double least = std::max((high - low).maxCoeff(), 1e-30) / (kMostLattice - 2);
  header.step = std::max(wanted, least);
  return header;
}

// Claims are bounded by bytes (kTrianglesAByte): what codes better than that is filled up.
void FillUp(const GeometryHeader& header, std::string& bytes) {
  const size_t least =
      (std::max(header.vertices, header.triangles) + kTrianglesAByte - 1) / kTrianglesAByte;
  if (bytes.size() < least) bytes.resize(least, '\0');
}

void CheckHeader(const Stream& stream, const GeometryHeader& header, size_t bytes) {
  const bool counts = header.vertices >= 3 && header.vertices <= kMostVertices &&
                      header.triangles >= 1 && header.triangles <= kMostTriangles;
  stream.Require(counts, "it has no triangles, or more than a model may have");
  stream.Require(std::max(header.vertices, header.triangles) <= bytes * kTrianglesAByte,
                 "its geometry is too short for its triangles");
  stream.Require(header.terms <= 16 && header.grid >= 2 && header.grid <= 256 &&
                     header.direction_map <= 2 && header.mean_in_terms <= 1 &&
                     header.max_texture >= 256 && header.max_texture <= 16384,
                 "its terms, view grid or pages are out of range");
  bool finite = std::isfinite(header.step) && header.step > 0 && header.step < 1e9;
  for (const double value : header.origin) finite = finite && std::abs(value) < kMostCoordinate;
  stream.Require(finite, "its coordinates are not finite");
}

std::vector<int> DecodeSizes(const Stream& stream, const GeometryHeader& header,
                             const TriangleMesh& mesh, RangeDecoder& coder,
                             GeometryModels& models) {
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(mesh);
  std::vector<int> sizes;
  Work work(header.terms, header.vertices, header.grid);
  for (int t = 0; t < static_cast<int>(header.triangles); ++t) {
    const int64_t n =
        int64_t{models.size[PredictedSizeClass(neighbors[t], t, sizes)].Decode(coder)} + 2;
    stream.Require(n + 4 <= header.max_texture, "a patch is larger than a page");
    work.AddPatch(static_cast<int>(n));
    stream.Require(work.IsBounded(), "its maps hold more texels than a model may have");
    stream.Require(!coder.overrun(), "its geometry is too short");
    sizes.push_back(static_cast<int>(n));
  }
  return sizes;
}

}  // namespace

double MedianSampleSpacing(const LightFieldModel& model) {
  std::vector<double> spacings;
  for (size_t t = 0; t < model.placements.size(); ++t) {
    const Eigen::Vector3i& corners = model.mesh.triangles[t];
    double length = 0;
    for (int c = 0; c < 3; ++c) {
      length +=
          (model.mesh.vertices[corners[c]] - model.mesh.vertices[corners[(c + 1) % 3]]).norm();
    }
    spacings.push_back(length / 3 / (model.placements[t].edge_samples - 1));
  }
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

EncodedGeometry EncodeGeometry(const LightFieldModel& model, double error_in_samples) {
  GeometryHeader header = MakeHeader(model, error_in_samples);
  const Eigen::Vector3d low = Eigen::Map<const Eigen::Vector3d>(header.origin.data());
  LatticeMesh lattice{{}, model.mesh.triangles};
  for (const Eigen::Vector3d& p : model.mesh.vertices) {
    lattice.vertices.emplace_back(((p - low) / header.step).array().round().matrix().cast<int>());
  }
  RangeEncoder coder;
  GeometryModels models;
  EncodedGeometry encoded;
  std::string mesh_bytes;
  if (auto coded = EncodeMesh(lattice)) {
    header.mesh_form = static_cast<uint32_t>(MeshForm::kEdgebreaker);
    header.mesh_bytes = static_cast<uint32_t>(coded->bytes.size());
    mesh_bytes = std::move(coded->bytes);
    lattice = std::move(coded->mesh);
    encoded.order = std::move(coded->order);
  } else {
    EncodeDifferences(lattice, coder, models);
    encoded.order = KeptOrder(model.mesh);
  }
  const TriangleMesh mesh = FromLattice(lattice, header);
  const std::vector<Eigen::Vector3i> neighbors = ComputeTriangleNeighbors(mesh);
  std::vector<int> sizes;
  for (const int old : encoded.order.triangles) {
    const int n = model.placements[old].edge_samples, t = static_cast<int>(sizes.size());
    models.size[PredictedSizeClass(neighbors[t], t, sizes)].Encode(coder,
                                                                   static_cast<uint32_t>(n - 2));
    sizes.push_back(n);
  }
  std::vector<Eigen::Matrix3d> frames;
  for (const int old : encoded.order.vertices) frames.push_back(model.vertex_frames[old]);
  EncodeFrames(mesh, frames, coder, models);
  Append(encoded.bytes, header);
  encoded.bytes += mesh_bytes;
  encoded.bytes += coder.Finish();
  FillUp(header, encoded.bytes);
  return encoded;
}

Geometry DecodeGeometry(Stream stream) {
  const size_t bytes = stream.bytes.size();
  GeometryHeader header;
  stream.Require(stream.Take(header), "its geometry is too short");
  CheckHeader(stream, header, bytes);
  Geometry geometry;
  geometry.grid = static_cast<int>(header.grid);
  geometry.terms = static_cast<int>(header.terms);
  geometry.max_texture = static_cast<int>(header.max_texture);
  geometry.mean_in_terms = header.mean_in_terms != 0;
  geometry.direction_map = static_cast<DirectionMap>(header.direction_map);
  stream.Require(header.mesh_bytes <= stream.bytes.size(), "its geometry is too short");
  RangeDecoder coder(stream.bytes.substr(header.mesh_bytes));
  GeometryModels models;
  if (header.mesh_form == static_cast<uint32_t>(MeshForm::kEdgebreaker)) {
    const auto lattice =
        DecodeMesh(stream.bytes.substr(0, header.mesh_bytes), static_cast<int>(header.vertices),
                   static_cast<int>(header.triangles));
    stream.Require(lattice.has_value(), "its mesh is damaged");
    geometry.mesh = FromLattice(*lattice, header);
  } else {
    stream.Require(
        header.mesh_form == static_cast<uint32_t>(MeshForm::kDifferences) && header.mesh_bytes == 0,
        "its mesh has a form that is not known");
    geometry.mesh = FromLattice(DecodeDifferences(stream, header, coder, models), header);
  }
  geometry.edge_samples = DecodeSizes(stream, header, geometry.mesh, coder, models);
  geometry.vertex_frames = DecodeFrames(stream, geometry.mesh, coder, models);
  for (const Eigen::Matrix3d& axes : geometry.vertex_frames) {
    geometry.mesh.normals.push_back(axes.col(2));
  }
  return geometry;
}

}  // namespace lfm::transport
