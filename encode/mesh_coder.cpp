// SPDX-License-Identifier: BSD-3-Clause
#include "encode/mesh_coder.h"

#include <draco/compression/expert_encode.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <map>

namespace lfm {
namespace {

// What a numbered mesh holds beside its coordinates: the writer learns from it which vertex is
// which.
enum class Content { kCoordinates, kCoordinatesAndNumbers };

int AddAttribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int components,
                 const std::vector<int32_t>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<int8_t>(components), draco::DT_INT32, false,
                 static_cast<int64_t>(sizeof(int32_t)) * components, 0);
  const auto count = static_cast<uint32_t>(values.size() / components);
  const int id = mesh.AddAttribute(attribute, true, count);
  for (uint32_t i = 0; i < count; ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                          values.data() + size_t{i} * components);
  }
  return id;
}

std::optional<std::string> Encode(const LatticeMesh& source, Content content) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<uint32_t>(source.vertices.size()));
  for (const Eigen::Vector3i& t : source.triangles) {
    mesh.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
  }
  std::vector<int32_t> coordinates, numbers;
  for (const Eigen::Vector3i& p : source.vertices) {
    coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
    numbers.push_back(static_cast<int32_t>(numbers.size()));
  }
  AddAttribute(mesh, draco::GeometryAttribute::POSITION, 3, coordinates);
  if (content == Content::kCoordinatesAndNumbers) {
    AddAttribute(mesh, draco::GeometryAttribute::GENERIC, 1, numbers);
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(0, 0);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) return std::nullopt;
  return std::string(buffer.data(), buffer.size());
}

// Draco's decoder, which refuses attributes that we never write before they take memory.
class Decoder : public draco::MeshEdgebreakerDecoder {
 public:
  explicit Decoder(Content content) : content_(content) {}

 protected:
  bool DecodeAllAttributes() override {
    const bool numbered = content_ == Content::kCoordinatesAndNumbers;
    if (point_cloud()->num_attributes() != (numbered ? 2 : 1)) return false;
    const auto fits = [this](int id, draco::GeometryAttribute::Type type, int components) {
      const draco::PointAttribute& attribute = *point_cloud()->attribute(id);
      return attribute.attribute_type() == type && attribute.data_type() == draco::DT_INT32 &&
             attribute.num_components() == components;
    };
    if (!fits(0, draco::GeometryAttribute::POSITION, 3)) return false;
    if (numbered && !fits(1, draco::GeometryAttribute::GENERIC, 1)) return false;
    return MeshEdgebreakerDecoder::DecodeAllAttributes();
  }

 private:
  Content content_;
};

// Takes Draco's variable-length number off the front.
std::optional<uint64_t> TakeNumber(std::string_view& bytes) {
  uint64_t value = 0;
  for (int shift = 0; shift < 35; shift += 7) {
    if (bytes.empty()) return std::nullopt;
    const auto byte = static_cast<uint8_t>(bytes.front());
    bytes.remove_prefix(1);
    value |= uint64_t{byte & 0x7fU} << shift;
    if ((byte & 0x80) == 0) return value;
  }
  return std::nullopt;
}

// The numbers at the head of the stream, from which Draco takes memory: the bitstream that Draco
// 1.5 writes (2.2), an edgebreaker mesh without metadata, of these sizes.
bool ClaimsFit(std::string_view bytes, uint64_t vertices, uint64_t triangles) {
  constexpr std::string_view kHead("DRACO\x02\x02\x01\x01\x00\x00", 11);
  if (!bytes.starts_with(kHead)) return false;
  bytes.remove_prefix(kHead.size());
  if (bytes.empty()) return false;
  bytes.remove_prefix(1);  // how the traversal is coded
  if (TakeNumber(bytes) != vertices || TakeNumber(bytes) != triangles) return false;
  if (bytes.empty() || bytes.front() != 0) return false;  // connectivity of other attributes
  bytes.remove_prefix(1);
  const auto symbols = TakeNumber(bytes), splits = TakeNumber(bytes);
  return symbols && splits && *symbols <= triangles && *splits <= *symbols;
}

struct NumberedMesh {
  LatticeMesh mesh;
  std::vector<int> numbers;
};

std::optional<NumberedMesh> Decode(std::string_view bytes, Content content) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Mesh mesh;
  Decoder decoder(content);
  if (!decoder.Decode(draco::DecoderOptions(), &buffer, &mesh).ok()) return std::nullopt;
  NumberedMesh result;
  for (uint32_t p = 0; p < mesh.num_points(); ++p) {
    for (int id = 0; id < mesh.num_attributes(); ++id) {
      const draco::PointAttribute& attribute = *mesh.attribute(id);
      const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(p));
      if (value.value() >= attribute.size()) return std::nullopt;
      std::array<int32_t, 3> numbers{};
      attribute.GetValue(value, numbers.data());
      if (id == 0) result.mesh.vertices.emplace_back(numbers[0], numbers[1], numbers[2]);
      if (id == 1) result.numbers.push_back(numbers[0]);
    }
  }
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    Eigen::Vector3i& triangle = result.mesh.triangles.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const uint32_t point = mesh.face(draco::FaceIndex(f))[c].value();
      if (point >= mesh.num_points()) return std::nullopt;
      triangle[c] = static_cast<int>(point);
    }
  }
  return result;
}

using Corners = std::array<int, 3>;

// A triangle from its lowest corner on, and which corner that is.
struct Turned {
  Corners corners{};
  int turn = 0;
};
Turned FromLowest(const Eigen::Vector3i& triangle) {
  Turned turned;
  triangle.minCoeff(&turned.turn);
  for (int c = 0; c < 3; ++c) turned.corners[c] = triangle[(turned.turn + c) % 3];
  return turned;
}

// Of each vertex of `decoded` the number that `numbered`, the same mesh, carries at the same
// corner.
std::optional<std::vector<int>> OldVertices(const LatticeMesh& decoded,
                                            const NumberedMesh& numbered) {
  if (decoded.triangles.size() != numbered.mesh.triangles.size()) return std::nullopt;
  std::vector<int> old(decoded.vertices.size(), -1);
  for (size_t t = 0; t < decoded.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      int& vertex = old[decoded.triangles[t][c]];
      const int number = numbered.numbers[numbered.mesh.triangles[t][c]];
      if (vertex >= 0 && vertex != number) return std::nullopt;
      vertex = number;
    }
  }
  return old;
}

// None unless `decoded` is `mesh` in another order, every vertex and triangle once.
std::optional<MeshOrder> OrderOf(const LatticeMesh& decoded, const std::vector<int>& old_vertices,
                                 const LatticeMesh& mesh) {
  if (decoded.vertices.size() != mesh.vertices.size() ||
      decoded.triangles.size() != mesh.triangles.size()) {
    return std::nullopt;
  }
  std::vector<uint8_t> taken(mesh.vertices.size(), 0);
  for (size_t v = 0; v < old_vertices.size(); ++v) {
    const int old = old_vertices[v];
    if (old < 0 || old >= static_cast<int>(taken.size()) || taken[old] != 0 ||
        mesh.vertices[old] != decoded.vertices[v]) {
      return std::nullopt;
    }
    taken[old] = 1;
  }
  std::map<Corners, std::vector<int>> by_corners;
  for (int t = static_cast<int>(mesh.triangles.size()) - 1; t >= 0; --t) {
    by_corners[FromLowest(mesh.triangles[t]).corners].push_back(t);
  }
  MeshOrder order{old_vertices, {}, {}};
  for (const Eigen::Vector3i& triangle : decoded.triangles) {
    const Turned turned = FromLowest(
        {old_vertices[triangle[0]], old_vertices[triangle[1]], old_vertices[triangle[2]]});
    const auto found = by_corners.find(turned.corners);
    if (found == by_corners.end() || found->second.empty()) return std::nullopt;
    const int old = found->second.back();
    found->second.pop_back();
    order.triangles.push_back(old);
    order.turns.push_back((FromLowest(mesh.triangles[old]).turn - turned.turn + 3) % 3);
  }
  return order;
}

bool RepeatsAVertex(const Eigen::Vector3i& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

}  // namespace

std::optional<CodedMesh> EncodeMesh(const LatticeMesh& mesh) {
  constexpr int kMost = 1 << 26;
  for (const Eigen::Vector3i& p : mesh.vertices) {
    if (p.minCoeff() <= -kMost || p.maxCoeff() >= kMost) return std::nullopt;
  }
  if (mesh.triangles.empty() ||
      std::any_of(mesh.triangles.begin(), mesh.triangles.end(), RepeatsAVertex)) {
    return std::nullopt;
  }
  try {
    auto bytes = Encode(mesh, Content::kCoordinates);
    const auto numbered_bytes = Encode(mesh, Content::kCoordinatesAndNumbers);
    if (!bytes || !numbered_bytes) return std::nullopt;
    auto decoded = DecodeMesh(*bytes, static_cast<int>(mesh.vertices.size()),
                              static_cast<int>(mesh.triangles.size()));
    const auto numbered = Decode(*numbered_bytes, Content::kCoordinatesAndNumbers);
    if (!decoded || !numbered) return std::nullopt;
    const auto old_vertices = OldVertices(*decoded, *numbered);
    if (!old_vertices) return std::nullopt;
    auto order = OrderOf(*decoded, *old_vertices, mesh);
    if (!order) return std::nullopt;
    return CodedMesh{std::move(*bytes), std::move(*decoded), std::move(*order)};
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::optional<LatticeMesh> DecodeMesh(std::string_view bytes, int vertices, int triangles) {
  if (!ClaimsFit(bytes, static_cast<uint64_t>(vertices), static_cast<uint64_t>(triangles))) {
    return std::nullopt;
  }
  try {
    auto decoded = Decode(bytes, Content::kCoordinates);
    if (!decoded || decoded->mesh.vertices.size() != static_cast<size_t>(vertices) ||
        decoded->mesh.triangles.size() != static_cast<size_t>(triangles)) {
      return std::nullopt;
    }
    return std::move(decoded->mesh);
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace lfm
