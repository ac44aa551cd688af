// SPDX-License-Identifier: BSD-3-Clause
#include "core/ply.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/ply_content.h"

namespace lfm {
namespace {

static_assert(std::endian::native == std::endian::little, "the writer copies numbers as they are");

void RequireFinite(double value, const char* what, size_t index, const std::string& file) {
  if (!std::isfinite(value)) {
    throw Error(file + ": the " + what + " of vertex " + std::to_string(index) +
                " is not finite; clean the data first");
  }
}

/// Three scalar properties as vectors; empty unless all three are there.
std::vector<Eigen::Vector3d> Vectors(const PlyElement& element,
                                     const std::array<const char*, 3>& names, const char* what,
                                     const std::string& file) {
  const PlyProperty* columns[3];
  for (int c = 0; c < 3; ++c) {
    columns[c] = element.Find(names[c]);
    if (!columns[c] || columns[c]->count_type) return {};
  }
  std::vector<Eigen::Vector3d> vectors(element.count);
  for (size_t i = 0; i < vectors.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      vectors[i][c] = columns[c]->values[i];
      RequireFinite(vectors[i][c], what, i, file);
    }
  }
  return vectors;
}

/// Largest value of an integer colour; floats are in [0, 1] already.
double ColorScale(PlyScalar type) {
  if (type == PlyScalar::kUint8) return 255;
  if (type == PlyScalar::kUint16) return 65535;
  return 1;
}

std::vector<Eigen::Vector3f> Colors(const PlyElement& vertices, const std::string& file) {
  const std::vector<Eigen::Vector3d> raw =
      Vectors(vertices, {"red", "green", "blue"}, "colour", file);
  if (raw.empty()) return {};
  const double scale = ColorScale(vertices.Find("red")->type);
  std::vector<Eigen::Vector3f> colors(raw.size());
  for (size_t i = 0; i < raw.size(); ++i) colors[i] = (raw[i] / scale).cast<float>();
  return colors;
}

std::vector<float> Confidence(const PlyElement& vertices, const std::string& file) {
  const PlyProperty* column = vertices.Find("confidence");
  if (!column) column = vertices.Find("quality");
  if (!column || column->count_type) return {};
  std::vector<float> confidence(column->values.begin(), column->values.end());
  for (size_t i = 0; i < confidence.size(); ++i) {
    RequireFinite(confidence[i], "confidence", i, file);
  }
  return confidence;
}

std::vector<float> Sigmas(const PlyElement& vertices, const std::string& file) {
  const PlyProperty* column = vertices.Find("sigma_mm");
  if (!column || column->count_type) return {};
  std::vector<float> sigmas(column->values.begin(), column->values.end());
  for (size_t i = 0; i < sigmas.size(); ++i) {
    RequireFinite(sigmas[i], "sigma_mm", i, file);
    if (!(sigmas[i] > 0)) {
      throw Error(file + ": the sigma_mm of vertex " + std::to_string(i) +
                  " is not positive; clean the data first");
    }
  }
  return sigmas;
}

const PlyElement& Vertices(const PlyContent& content, const std::string& file) {
  const PlyElement* vertices = content.Find("vertex");
  if (!vertices) throw Error(file + ": the PLY file has no element 'vertex'");
  for (const char* name : {"x", "y", "z"}) {
    const PlyProperty* column = vertices->Find(name);
    if (!column || column->count_type) {
      throw Error(file + ": the vertices have no coordinate '" + name + "'");
    }
  }
  if (vertices->count > std::numeric_limits<int>::max()) {
    throw Error(file + ": more than 2^31 - 1 vertices");
  }
  return *vertices;
}

int VertexIndex(double value, size_t vertex_count, size_t face, const std::string& file) {
  if (!(value >= 0 && value < static_cast<double>(vertex_count)) || value != std::floor(value)) {
    throw Error(file + ": face " + std::to_string(face) + " names a vertex that does not exist");
  }
  return static_cast<int>(value);
}

std::vector<Eigen::Vector3i> Triangles(const PlyContent& content, size_t vertex_count,
                                       const std::string& file) {
  const PlyElement* faces = content.Find("face");
  const PlyProperty* list = faces ? faces->Find("vertex_indices") : nullptr;
  if (faces && !list) list = faces->Find("vertex_index");
  if (!list || !list->count_type) {
    throw Error(file + ": the PLY file has no faces; a mesh is needed here, not a cloud");
  }
  std::vector<Eigen::Vector3i> triangles;
  triangles.reserve(list->ends.size());
  size_t begin = 0;
  for (size_t face = 0; face < list->ends.size(); ++face) {
    const size_t end = list->ends[face];
    if (end - begin < 3) {
      throw Error(file + ": face " + std::to_string(face) + " has fewer than three corners");
    }
    const auto corner = [&](size_t i) {
      return VertexIndex(list->values[i], vertex_count, face, file);
    };
    for (size_t i = begin + 1; i + 1 < end; ++i) {
      triangles.emplace_back(corner(begin), corner(i), corner(i + 1));
    }
    begin = end;
  }
  if (triangles.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
    throw Error(file + ": more than 2^31 - 1 triangles");
  }
  return triangles;
}

/// Appends numbers to a file in memory.
class ByteWriter {
 public:
  explicit ByteWriter(size_t expected) { bytes_.reserve(expected); }
  void Text(const std::string& text) { bytes_ += text; }
  template <typename T>
  void Put(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  template <typename T, typename Vector>
  void PutVector(const Vector& v) {
    for (int c = 0; c < 3; ++c) Put(static_cast<T>(v[c]));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

void RequireLength(size_t length, size_t vertices, const char* what,
                   const std::filesystem::path& file) {
  if (length != 0 && length != vertices) {
    throw Error(file.string() + ": " + std::to_string(length) + " " + what + " for " +
                    std::to_string(vertices) + " vertices",
                ErrorKind::kSystem);
  }
}

/// Which optional properties a file's vertices have.
struct Properties {
  bool normals = false, confidence = false, sigma = false, colors = false;
};

std::string Header(const char* coordinate, size_t vertices, const Properties& has) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  text += std::to_string(vertices) + "\n";
  for (const char* axis : {"x", "y", "z"}) {
    text += std::string("property ") + coordinate + " " + axis + "\n";
  }
  if (has.normals) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (has.confidence) text += "property float confidence\n";
  if (has.sigma) text += "property float sigma_mm\n";
  if (has.colors) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text;
}

uint8_t ColorByte(float value) {
  if (!(value > 0)) return 0;
  return static_cast<uint8_t>(std::min(value, 1.0f) * 255 + 0.5f);
}

}  // namespace

TriangleMesh ReadPlyMesh(const std::filesystem::path& path) {
  const std::string file = path.string();
  const PlyContent content = ParsePly(ReadFile(path), file);
  const PlyElement& vertices = Vertices(content, file);
  TriangleMesh mesh;
  mesh.vertices = Vectors(vertices, {"x", "y", "z"}, "position", file);
  mesh.normals = Vectors(vertices, {"nx", "ny", "nz"}, "normal", file);
  mesh.confidence = Confidence(vertices, file);
  mesh.colors = Colors(vertices, file);
  mesh.triangles = Triangles(content, mesh.vertices.size(), file);
  ValidateMesh(mesh, file.c_str());
  return mesh;
}

std::vector<Eigen::Vector2f> ReadPlyTextureCoordinates(const std::filesystem::path& path) {
  const std::string file = path.string();
  const PlyContent content = ParsePly(ReadFile(path), file);
  const PlyElement& vertices = Vertices(content, file);
  for (const auto& [s, t] : {std::pair("s", "t"), {"u", "v"}, {"texture_u", "texture_v"}}) {
    const PlyProperty *u = vertices.Find(s), *v = vertices.Find(t);
    if (!u || !v || u->count_type || v->count_type) continue;
    std::vector<Eigen::Vector2f> uv(vertices.count);
    for (size_t i = 0; i < uv.size(); ++i) {
      RequireFinite(static_cast<float>(u->values[i]), "texture coordinate", i, file);
      RequireFinite(static_cast<float>(v->values[i]), "texture coordinate", i, file);
      uv[i] = {static_cast<float>(u->values[i]), static_cast<float>(v->values[i])};
    }
    return uv;
  }
  return {};
}

PointCloud ReadPlyCloud(const std::filesystem::path& path) {
  const std::string file = path.string();
  const PlyContent content = ParsePly(ReadFile(path), file);
  const PlyElement& vertices = Vertices(content, file);
  PointCloud cloud;
  cloud.points = Vectors(vertices, {"x", "y", "z"}, "position", file);
  cloud.normals = Vectors(vertices, {"nx", "ny", "nz"}, "normal", file);
  cloud.confidence = Confidence(vertices, file);
  cloud.sigma_mm = Sigmas(vertices, file);
  return cloud;
}

void WritePly(const TriangleMesh& mesh, const std::filesystem::path& file) {
  const size_t count = mesh.vertices.size();
  RequireLength(mesh.normals.size(), count, "normals", file);
  RequireLength(mesh.confidence.size(), count, "confidences", file);
  RequireLength(mesh.colors.size(), count, "colours", file);
  const Properties has = {.normals = !mesh.normals.empty(),
                          .confidence = !mesh.confidence.empty(),
                          .colors = !mesh.colors.empty()};
  ByteWriter out(512 + count * 43 + mesh.triangles.size() * 13);
  out.Text(Header("double", count, has));
  out.Text("element face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n");
  for (size_t i = 0; i < count; ++i) {
    out.PutVector<double>(mesh.vertices[i]);
    if (has.normals) out.PutVector<float>(mesh.normals[i]);
    if (has.confidence) out.Put(mesh.confidence[i]);
    if (has.colors) {
      for (int c = 0; c < 3; ++c) out.Put(ColorByte(mesh.colors[i][c]));
    }
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    out.Put(uint8_t{3});
    out.PutVector<int32_t>(triangle);
  }
  WriteFileAtomically(file, out.bytes());
}

void WritePly(const PointCloud& cloud, const std::filesystem::path& file) {
  const size_t count = cloud.points.size();
  RequireLength(cloud.normals.size(), count, "normals", file);
  RequireLength(cloud.confidence.size(), count, "confidences", file);
  RequireLength(cloud.sigma_mm.size(), count, "sigmas", file);
  const Properties has = {.normals = !cloud.normals.empty(),
                          .confidence = !cloud.confidence.empty(),
                          .sigma = !cloud.sigma_mm.empty()};
  ByteWriter out(512 + count * 32);
  out.Text(Header("float", count, has));
  out.Text("end_header\n");
  for (size_t i = 0; i < count; ++i) {
    out.PutVector<float>(cloud.points[i]);
    if (has.normals) out.PutVector<float>(cloud.normals[i]);
    if (has.confidence) out.Put(cloud.confidence[i]);
    if (has.sigma) out.Put(cloud.sigma_mm[i]);
  }
  WriteFileAtomically(file, out.bytes());
}

}  // namespace lfm
