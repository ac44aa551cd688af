// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/triangle_mesh.h"
#include "encode/coefficient_coder.h"
#include "encode/map_transform.h"
#include "encode/shared_samples.h"
#include "resample/light_field.h"

/// What writer and reader of the transport form share (docs/formats.md).
namespace lfm::transport {

static_assert(std::endian::native == std::endian::little, "headers are copied as they lie");

inline constexpr std::array<char, 8> kMagic = {'L', 'F', 'M', 'Z', '\r', '\n', '\x1a', '\n'};
inline constexpr uint32_t kVersion = 2;
inline constexpr int kChunk = 1024;             // vertices whose maps of one term are one part
inline constexpr double kFrameStep = 1.0 / 32;  // rad
inline constexpr double kSigmasAnOctave = 8;    // of the scale of a term
inline constexpr int kMostSigma = 240;          // in those steps: 2^30
inline constexpr int kMostMagnitude = 1 << 20;  // of a quantised coefficient
inline constexpr int kSizeClasses = 8;

// What a file may claim; the writer keeps to it.
inline constexpr uint32_t kMostVertices = 1U << 22, kMostTriangles = 1U << 23;
inline constexpr float kMostStep = 1e3F;
inline constexpr double kMostCoordinate = 1e12;   // mm
inline constexpr int64_t kMostLattice = 1 << 20;  // of a coordinate in steps
// And against its bytes: a small file must not ask for much memory. Parts that code better than
// this are filled up with zeros.
inline constexpr uint32_t kTrianglesAByte = 4;  // of geometry; or vertices
inline constexpr int64_t kTexelsAByte = 1024;   // of the mean view, of a term

/// What decoding takes, as far as headers and patch sizes say it.
class Work {
 public:
  Work(int64_t terms, int64_t vertices, int64_t grid)
      : terms_(terms), texels_(terms * vertices * grid * grid) {}
  void AddPatch(int edge_samples) {
    const int64_t n = edge_samples;
    largest_ = std::max(largest_, n);
    texels_ += (n + 4) * (n + 3) / 2 * (1 + terms_);
    products_ += n * n * n;
  }
  bool IsBounded() const {
    return largest_ <= kMaxEdgeSamples && texels_ <= int64_t{1} << 28 &&
           products_ <= int64_t{1} << 36;
  }

 private:
  int64_t terms_, texels_, products_ = 0, largest_ = 0;
};

enum class Part : uint32_t { kGeometry = 1, kMean = 2, kTerm = 3 };

/// Before each part; little-endian.
struct PartHeader {
  uint32_t part = 0;
  uint32_t term = 0, first_vertex = 0, count = 0;  // of kTerm; else 0
  uint64_t bytes = 0, checksum = 0;                // of what follows
};

struct FileHeader {
  std::array<char, 8> magic = kMagic;
  uint32_t version = kVersion;
  uint32_t parts = 0;
};

/// How the geometry holds the mesh.
enum class MeshForm : uint32_t {
  kDifferences = 0,  ///< indices and coordinates, each against the one before
  kEdgebreaker = 1,  ///< mesh_coder.h
};

/// At the head of the geometry.
struct GeometryHeader {
  uint32_t vertices = 0, triangles = 0, terms = 0, grid = 0, direction_map = 0, max_texture = 0;
  uint32_t mean_in_terms = 0, mesh_form = 0, mesh_bytes = 0, reserved = 0;
  std::array<double, 3> origin{};
  double step = 0;  // mm
};

template <typename T>
void Append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Bytes of a file that are read from the front.
struct Stream {
  std::string_view bytes;
  const std::string& name;  ///< of the file

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(name + ": " + problem + "; get the file again, or run lfm-encode again");
  }
  void Require(bool condition, const char* problem) const {
    if (!condition) Fail(problem);
  }
  /// Takes a value off the front; false where it has ended.
  template <typename T>
  bool Take(T& value) {
    if (bytes.size() < sizeof value) return false;
    std::memcpy(&value, bytes.data(), sizeof value);
    bytes.remove_prefix(sizeof value);
    return true;
  }
};

inline uint32_t Zigzag(int64_t value) {
  return static_cast<uint32_t>(value < 0 ? -2 * value - 1 : 2 * value);
}
inline int64_t Unzigzag(uint32_t value) {
  return (value & 1) != 0 ? -(int64_t{value} + 1) / 2 : int64_t{value} / 2;
}

inline int SizeClass(int edge_samples) {
  const auto width = static_cast<int>(std::bit_width(static_cast<unsigned>(edge_samples - 1)));
  return std::min(width, kSizeClasses - 1);
}

inline double SigmaOf(int exponent) { return std::exp2(exponent / kSigmasAnOctave); }

/// The ring of a vertex as its maps know it.
struct Ring {
  std::vector<int> triangles, edge_samples;
  std::vector<int> corners;  // which corner of each triangle the vertex is
  int samples = 0;
  SharedSamples shared;
};
Ring MakeRing(const TriangleMesh& mesh, const VertexRings& rings,
              const std::vector<int>& edge_samples, int vertex);

/// The sides that maps of these sizes need.
MapTransform MakeTransform(const std::vector<int>& edge_samples, int grid);

/// The models of one part with terms.
struct TermModels {
  std::array<BitModel, 2> has;  // whether a vertex has the term; by whether the one before had
  NumberModels sigma;
  std::array<CoefficientModels, kSizeClasses> surface;
  CoefficientModels view;
};

/// What the mean view of a triangle is predicted from: the colours of those before it.
Eigen::Vector3f PredictMean(const Eigen::Vector3i& neighbors, int triangle,
                            const std::vector<Eigen::Vector3f>& colors);

/// How far a mean view's colour lies from what it was predicted from: its constant coefficients.
Eigen::Vector3f MeanOffset(const CoefficientBlock& block, float step);

}  // namespace lfm::transport
