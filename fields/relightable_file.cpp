// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relightable_file.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/mapped_file.h"
#include "fields/half_floats.h"
#include "fields/relightable_layout.h"

namespace lfm {
namespace {

static_assert(std::endian::native == std::endian::little, ".lfr files are little-endian");
static_assert(sizeof(Eigen::Vector3d) == 24 && sizeof(Eigen::Vector3f) == 12 &&
              sizeof(Eigen::Vector3i) == 12);

uint64_t ResidualsOf(const ClusteredModel& model, int64_t row) {
  if (model.first_residual.empty()) return 0;
  return static_cast<uint64_t>(model.first_residual[row + 1] - model.first_residual[row]);
}

RelightableHeader MakeHeader(const RelightableModel& r, const HalfFloats& weights,
                             const HalfFloats& residuals) {
  const ClusteredModel& m = r.model;
  RelightableHeader h = {};
  h.magic = kRelightableMagic;
  h.version = kRelightableVersion;
  h.kind = static_cast<uint32_t>(r.kind);
  h.channels = static_cast<uint32_t>(r.channels);
  h.width = static_cast<uint32_t>(r.width);
  h.height = static_cast<uint32_t>(r.height);
  h.columns = static_cast<uint32_t>(m.columns);
  h.points = static_cast<uint64_t>(r.points);
  h.directions = static_cast<uint32_t>(r.directions.size());
  h.clusters = static_cast<uint32_t>(m.bases.size());
  for (const FunctionRows& basis : m.bases) h.functions += static_cast<uint64_t>(basis.rows);
  h.weights = weights.bits.size();
  h.residuals = residuals.bits.size();
  h.basis_entries = r.column_basis.value.size();
  h.positions = r.positions.size();
  h.triangles = r.triangles.size();
  h.weight_exponent = weights.exponent;
  h.residual_exponent = residuals.exponent;
  h.name_bytes = static_cast<uint32_t>(r.name.size());
  h.has_column_basis = r.column_basis.IsIdentity() ? 0 : 1;
  if (!m.first_residual.empty()) {
    uint64_t most = 0;
    for (int64_t row = 0; row < m.rows; ++row) most = std::max(most, ResidualsOf(m, row));
    if (most > 0xffff) throw Error("relightable model: a row has more than 65535 residuals");
    h.count_bytes = most > 255 ? 2 : 1;
  }
  const std::string problem = HeaderProblem(h);
  if (!problem.empty()) throw Error("relightable model: " + problem);
  h.file_bytes = static_cast<uint64_t>(MakeRelightableLayout(h).file_bytes);
  return h;
}

// The weights of all rows, and the residuals, in the order of rows.
std::vector<float> OrderedWeights(const ClusteredModel& m) {
  std::vector<float> ordered;
  for (int64_t row = 0; row < m.rows; ++row) {
    const float* weights = m.weights.data() + m.first_weight[row];
    ordered.insert(ordered.end(), weights, weights + m.Terms(row));
  }
  return ordered;
}

template <typename Value>
std::vector<Value> OrderedResiduals(const ClusteredModel& m, const std::vector<Value>& values) {
  if (m.first_residual.empty()) return {};
  return {values.begin() + m.first_residual.front(), values.begin() + m.first_residual.back()};
}

// Sections of a file in the making.
class Sections {
 public:
  Sections(const RelightableLayout& layout, std::string& bytes) : layout_(layout), bytes_(bytes) {}

  template <typename Value>
  void Put(RelightableSection section, const std::vector<Value>& values) {
    static_assert(std::is_trivially_copyable_v<Value> || sizeof(Value) % 4 == 0);
    if (!values.empty()) {
      std::memcpy(bytes_.data() + layout_.offset[section], values.data(),
                  static_cast<size_t>(layout_.bytes[section]));
    }
  }
  /// One number of `width` bytes.
  void PutNumber(RelightableSection section, int64_t index, int width, uint32_t value) {
    std::memcpy(bytes_.data() + layout_.offset[section] + index * width, &value,
                static_cast<size_t>(width));
  }

 private:
  const RelightableLayout& layout_;
  std::string& bytes_;
};

void PutBases(const ClusteredModel& m, Sections& out) {
  std::vector<uint16_t> functions;
  std::vector<int16_t> exponents;
  std::vector<uint32_t> terms;
  for (const FunctionRows& basis : m.bases) {
    terms.push_back(static_cast<uint32_t>(basis.rows));
    for (int64_t t = 0; t < basis.rows; ++t) {
      const HalfFloats half = ToHalf({basis.Row(t), static_cast<size_t>(m.columns)});
      exponents.push_back(static_cast<int16_t>(half.exponent));
      functions.insert(functions.end(), half.bits.begin(), half.bits.end());
    }
  }
  out.Put(kTermSection, terms);
  out.Put(kExponentSection, exponents);
  out.Put(kFunctionSection, functions);
}

void PutRows(const ClusteredModel& m, const RelightableHeader& h, Sections& out) {
  const int cluster_bytes = h.clusters <= 256 ? 1 : 2, column_bytes = h.columns <= 256 ? 1 : 2;
  for (int64_t row = 0; row < m.rows; ++row) {
    out.PutNumber(kClusterSection, row, cluster_bytes, m.cluster[row]);
    if (h.count_bytes > 0) {
      out.PutNumber(kCountSection, row, h.count_bytes, static_cast<uint32_t>(ResidualsOf(m, row)));
    }
  }
  const std::vector<uint16_t> columns = OrderedResiduals(m, m.residual_column);
  for (size_t i = 0; i < columns.size(); ++i) {
    out.PutNumber(kColumnSection, static_cast<int64_t>(i), column_bytes, columns[i]);
  }
}

// A file's bytes, whose head says nothing that contradicts itself.
class SectionReader {
 public:
  SectionReader(std::span<const std::byte> bytes, const RelightableLayout& layout)
      : bytes_(bytes), layout_(layout) {}

  template <typename Value>
  std::vector<Value> All(RelightableSection section) const {
    std::vector<Value> values(static_cast<size_t>(layout_.bytes[section]) / sizeof(Value));
    if (!values.empty()) {
      std::memcpy(static_cast<void*>(values.data()), bytes_.data() + layout_.offset[section],
                  values.size() * sizeof(Value));
    }
    return values;
  }
  uint32_t Number(RelightableSection section, int64_t index, int width) const {
    uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + layout_.offset[section] + index * width,
                static_cast<size_t>(width));
    return value;
  }
  float Half(RelightableSection section, int64_t index, int exponent) const {
    return HalfValue(static_cast<uint16_t>(Number(section, index, 2)), exponent);
  }

 private:
  std::span<const std::byte> bytes_;
  const RelightableLayout& layout_;
};

void ReadBases(const SectionReader& in, const RelightableHeader& h, ClusteredModel& m) {
  uint64_t functions = 0;
  for (uint32_t cluster = 0; cluster < h.clusters; ++cluster) {
    functions += in.Number(kTermSection, cluster, 4);
  }
  if (functions != h.functions) throw Error("its clusters have not the terms that there are");
  int64_t function = 0;
  for (uint32_t cluster = 0; cluster < h.clusters; ++cluster) {
    FunctionRows basis =
        MakeFunctionRows(in.Number(kTermSection, cluster, 4), static_cast<int>(h.columns));
    for (int64_t t = 0; t < basis.rows; ++t, ++function) {
      const auto exponent = static_cast<int16_t>(in.Number(kExponentSection, function, 2));
      if (exponent < kLeastHalfExponent || exponent > kLargestHalfExponent) {
        throw Error("a basis function's scale is out of range");
      }
      for (int i = 0; i < basis.columns; ++i) {
        basis.Row(t)[i] = in.Half(kFunctionSection, function * basis.columns + i, exponent);
      }
    }
    m.bases.push_back(std::move(basis));
  }
}

void ReadRows(const SectionReader& in, const RelightableHeader& h, ClusteredModel& m) {
  const int cluster_bytes = h.clusters <= 256 ? 1 : 2, column_bytes = h.columns <= 256 ? 1 : 2;
  uint64_t weights = 0, residuals = 0;
  if (h.count_bytes > 0) m.first_residual.push_back(0);
  for (int64_t row = 0; row < m.rows; ++row) {
    const uint32_t cluster = in.Number(kClusterSection, row, cluster_bytes);
    if (cluster >= h.clusters) throw Error("a row belongs to a cluster that is not there");
    m.cluster.push_back(static_cast<uint16_t>(cluster));
    m.first_weight.push_back(static_cast<int64_t>(weights));
    weights += static_cast<uint64_t>(m.Terms(row));
    if (h.count_bytes == 0) continue;
    residuals += in.Number(kCountSection, row, h.count_bytes);
    m.first_residual.push_back(static_cast<int64_t>(residuals));
  }
  if (weights != h.weights) throw Error("its rows have not the weights that there are");
  if (residuals != h.residuals) throw Error("its rows have not the residuals that there are");
  for (int64_t i = 0; i < static_cast<int64_t>(weights); ++i) {
    m.weights.push_back(in.Half(kWeightSection, i, h.weight_exponent));
  }
  for (int64_t i = 0; i < static_cast<int64_t>(residuals); ++i) {
    m.residual_column.push_back(static_cast<uint16_t>(in.Number(kColumnSection, i, column_bytes)));
    m.residual_value.push_back(in.Half(kValueSection, i, h.residual_exponent));
  }
}

RelightableHeader ReadHeader(std::span<const std::byte> bytes) {
  RelightableHeader h = {};
  if (bytes.size() < h.magic.size() ||
      std::memcmp(bytes.data(), kRelightableMagic.data(), h.magic.size()) != 0) {
    throw Error("is not a model for relighting (.lfr)");
  }
  if (bytes.size() < sizeof(h)) throw Error("the file is cut short; copy or encode it again");
  std::memcpy(&h, bytes.data(), sizeof(h));
  if (h.version != kRelightableVersion) {
    throw Error("is a model for relighting of version " + std::to_string(h.version) +
                "; this program reads version " + std::to_string(kRelightableVersion));
  }
  if (h.header_checksum != Checksum(&h, offsetof(RelightableHeader, header_checksum))) {
    throw Error("the header is damaged; copy or encode the file again");
  }
  const std::string problem = HeaderProblem(h);
  if (!problem.empty()) throw Error("the header says " + problem);
  if (h.file_bytes != static_cast<uint64_t>(MakeRelightableLayout(h).file_bytes)) {
    throw Error("the header's sizes contradict each other");
  }
  if (h.file_bytes != bytes.size()) {
    throw Error("the file has " + std::to_string(bytes.size()) + " bytes but should have " +
                std::to_string(h.file_bytes) + "; copy or encode it again");
  }
  const std::span<const std::byte> content = bytes.subspan(sizeof(h));
  if (h.content_checksum != Checksum(content.data(), content.size())) {
    throw Error("the content is damaged; copy or encode the file again");
  }
  return h;
}

RelightableModel Decode(std::span<const std::byte> bytes) {
  const RelightableHeader h = ReadHeader(bytes);
  const RelightableLayout layout = MakeRelightableLayout(h);
  const SectionReader in(bytes, layout);
  RelightableModel r;
  const std::vector<char> name = in.All<char>(kNameSection);
  r.name.assign(name.begin(), name.end());
  r.kind = static_cast<FieldColumns>(h.kind);
  r.points = static_cast<int64_t>(h.points);
  r.channels = static_cast<int>(h.channels);
  r.width = static_cast<int>(std::min(h.width, 1u << 20));
  r.height = static_cast<int>(std::min(h.height, 1u << 20));
  r.directions = in.All<Eigen::Vector3d>(kDirectionSection);
  r.positions = in.All<Eigen::Vector3f>(kPositionSection);
  r.triangles = in.All<Eigen::Vector3i>(kTriangleSection);
  if (h.has_column_basis == 1) {
    r.column_basis.first = in.All<int64_t>(kBasisFirstSection);
    r.column_basis.direction = in.All<uint32_t>(kBasisDirectionSection);
    r.column_basis.value = in.All<float>(kBasisValueSection);
  }
  r.model.rows = r.points * r.channels;
  r.model.columns = static_cast<int>(h.columns);
  ReadBases(in, h, r.model);
  ReadRows(in, h, r.model);
  CheckRelightable(r);
  return r;
}

}  // namespace

RelightableBytes CountBytes(const RelightableModel& r) {
  CheckRelightable(r);
  const RelightableHeader h = MakeHeader(r, ToHalf(OrderedWeights(r.model)),
                                         ToHalf(OrderedResiduals(r.model, r.model.residual_value)));
  const RelightableLayout layout = MakeRelightableLayout(h);
  RelightableBytes bytes;
  bytes.header = static_cast<int64_t>(sizeof(h)) + layout.Padded(kNameSection);
  bytes.directions = layout.Padded(kDirectionSection) + layout.Padded(kBasisFirstSection) +
                     layout.Padded(kBasisDirectionSection) + layout.Padded(kBasisValueSection);
  bytes.geometry = layout.Padded(kPositionSection) + layout.Padded(kTriangleSection);
  bytes.bases = layout.Padded(kTermSection) + layout.Padded(kExponentSection) +
                layout.Padded(kFunctionSection);
  bytes.clusters = layout.Padded(kClusterSection);
  bytes.weights = layout.Padded(kWeightSection);
  bytes.residual_indices = layout.Padded(kCountSection) + layout.Padded(kColumnSection);
  bytes.residual_values = layout.Padded(kValueSection);
  return bytes;
}

std::string EncodeRelightable(const RelightableModel& r) {
  CheckRelightable(r);
  const HalfFloats weights = ToHalf(OrderedWeights(r.model));
  const HalfFloats residuals = ToHalf(OrderedResiduals(r.model, r.model.residual_value));
  RelightableHeader h = MakeHeader(r, weights, residuals);
  const RelightableLayout layout = MakeRelightableLayout(h);
  std::string bytes(static_cast<size_t>(layout.file_bytes), '\0');
  Sections out(layout, bytes);
  out.Put(kNameSection, std::vector<char>(r.name.begin(), r.name.end()));
  out.Put(kDirectionSection, r.directions);
  out.Put(kBasisFirstSection, r.column_basis.first);
  out.Put(kBasisDirectionSection, r.column_basis.direction);
  out.Put(kBasisValueSection, r.column_basis.value);
  out.Put(kPositionSection, r.positions);
  out.Put(kTriangleSection, r.triangles);
  PutBases(r.model, out);
  PutRows(r.model, h, out);
  out.Put(kWeightSection, weights.bits);
  out.Put(kValueSection, residuals.bits);
  h.content_checksum = Checksum(bytes.data() + sizeof(h), bytes.size() - sizeof(h));
  h.header_checksum = Checksum(&h, offsetof(RelightableHeader, header_checksum));
  std::memcpy(bytes.data(), &h, sizeof(h));
  return bytes;
}

RelightableModel DecodeRelightable(std::span<const std::byte> bytes, const std::string& name) {
  try {
    return Decode(bytes);
  } catch (const Error& error) {
    throw Error(name + ": " + error.what(), error.kind());
  }
}

RelightableModel AsStored(const RelightableModel& relightable) {
  const std::string bytes = EncodeRelightable(relightable);
  return DecodeRelightable(std::as_bytes(std::span(bytes)), relightable.name);
}

void WriteRelightable(const RelightableModel& relightable, const std::filesystem::path& file) {
  WriteFileAtomically(file, EncodeRelightable(relightable));
}

RelightableModel ReadRelightable(const std::filesystem::path& file) {
  const MappedFile mapped(file);
  return DecodeRelightable(mapped.bytes(), file.string());
}

}  // namespace lfm
