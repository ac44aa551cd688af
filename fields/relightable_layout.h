// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace lfm {

/// The head of a .lfr file, little-endian, byte for byte (docs/formats.md).
struct RelightableHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t kind;
  uint32_t channels;
  uint32_t width;
  uint32_t height;
  uint32_t columns;
  uint64_t points;
  uint32_t directions;
  uint32_t clusters;
  uint64_t functions;      ///< of all clusters' bases together
  uint64_t weights;        ///< of all rows together
  uint64_t residuals;      ///< of all rows together
  uint64_t basis_entries;  ///< of the column basis
  uint64_t positions;      ///< 0 or points
  uint64_t triangles;
  int32_t weight_exponent;
  int32_t residual_exponent;
  uint32_t name_bytes;
  uint8_t has_column_basis;
  uint8_t count_bytes;  ///< of a row's number of residuals: 1 or 2; 0: no residual
  uint16_t zero;
  uint64_t file_bytes;
  uint64_t content_checksum;  ///< of everything after the header
  uint64_t header_checksum;   ///< of everything before it
};
static_assert(sizeof(RelightableHeader) == 136);

constexpr std::array<char, 8> kRelightableMagic = {'L', 'F', 'M', 'R', 'F', 'L', '\r', '\n'};
constexpr uint32_t kRelightableVersion = 1;

/// What follows the head, in this order.
enum RelightableSection {
  kNameSection,
  kDirectionSection,
  kBasisFirstSection,
  kBasisDirectionSection,
  kBasisValueSection,
  kPositionSection,
  kTriangleSection,
  kTermSection,
  kExponentSection,
  kFunctionSection,
  kClusterSection,
  kWeightSection,
  kCountSection,
  kColumnSection,
  kValueSection,
  kSections
};

/// Where the sections begin and how long they are; each is padded with zeros to a multiple of 8.
struct RelightableLayout {
  std::array<int64_t, kSections> offset = {}, bytes = {};
  int64_t file_bytes = 0;

  /// With padding.
  int64_t Padded(RelightableSection section) const { return (bytes[section] + 7) / 8 * 8; }
};

/// Why a header's counts are out of range; empty when they are not.
std::string HeaderProblem(const RelightableHeader& header);
/// Of a header without a problem.
RelightableLayout MakeRelightableLayout(const RelightableHeader& header);

}  // namespace lfm
