// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relightable_layout.h"

#include "fields/half_floats.h"

namespace lfm {
namespace {

constexpr uint64_t kMostPoints = uint64_t{1} << 36, kMostEntries = uint64_t{1} << 40;
constexpr uint32_t kMostColumns = 1 << 16, kMostDirections = 1 << 24, kMostNameBytes = 4096;

bool IsExponent(int32_t exponent) {
  return exponent >= kLeastHalfExponent && exponent <= kLargestHalfExponent;
}

}  // namespace

std::string HeaderProblem(const RelightableHeader& h) {
  if (h.kind > 2) return "columns of an unknown kind";
  if (h.channels != 1 && h.channels != 3) {
    return std::to_string(h.channels) + " channels; it must be 1 or 3";
  }
  if (h.points < 1 || h.points > kMostPoints) {
    return std::to_string(h.points) + " points; it must be 1 to 2^36";
  }
  if (h.columns < 1 || h.columns > kMostColumns) {
    return std::to_string(h.columns) + " columns; it must be 1 to 65536";
  }
  if (h.directions < 1 || h.directions > kMostDirections) {
    return std::to_string(h.directions) + " directions; it must be 1 to 2^24";
  }
  if (h.clusters < 1 || h.clusters > 1 << 16) {
    return std::to_string(h.clusters) + " clusters; it must be 1 to 65536";
  }
  if (h.functions > kMostEntries || h.weights > kMostEntries || h.residuals > kMostEntries ||
      h.basis_entries > kMostEntries || h.triangles > kMostEntries) {
    return "a table of more than 2^40 entries";
  }
  if (h.positions != 0 && h.positions != h.points) return "positions of some of its points only";
  if (h.name_bytes > kMostNameBytes) return "a name of more than 4096 bytes";
  if (!IsExponent(h.weight_exponent) || !IsExponent(h.residual_exponent)) {
    return "a scale out of range";
  }
  if (h.has_column_basis > 1 || h.count_bytes > 2 || h.zero != 0 ||
      (h.count_bytes == 0 && h.residuals > 0) || (h.has_column_basis == 0 && h.basis_entries > 0)) {
    return "marks that contradict each other";
  }
  return "";
}

RelightableLayout MakeRelightableLayout(const RelightableHeader& h) {
  RelightableLayout layout;
  const auto rows = static_cast<int64_t>(h.points * h.channels);
  const auto set = [&](RelightableSection section, uint64_t entries, int64_t entry_bytes) {
    layout.bytes[section] = static_cast<int64_t>(entries) * entry_bytes;
  };
  set(kNameSection, h.name_bytes, 1);
  set(kDirectionSection, h.directions, 24);
  set(kBasisFirstSection, h.has_column_basis ? uint64_t{h.columns} + 1 : 0, 8);
  set(kBasisDirectionSection, h.basis_entries, 4);
  set(kBasisValueSection, h.basis_entries, 4);
  set(kPositionSection, h.positions, 12);
  set(kTriangleSection, h.triangles, 12);
  set(kTermSection, h.clusters, 4);
  set(kExponentSection, h.functions, 2);
  set(kFunctionSection, h.functions, int64_t{2} * h.columns);
  set(kClusterSection, rows, h.clusters <= 256 ? 1 : 2);
  set(kWeightSection, h.weights, 2);
  set(kCountSection, rows, h.count_bytes);
  set(kColumnSection, h.residuals, h.columns <= 256 ? 1 : 2);
  set(kValueSection, h.residuals, 2);
  int64_t offset = sizeof(RelightableHeader);
  for (int section = 0; section < kSections; ++section) {
    layout.offset[section] = offset;
    offset += layout.Padded(static_cast<RelightableSection>(section));
  }
  layout.file_bytes = offset;
  return layout;
}

}  // namespace lfm
