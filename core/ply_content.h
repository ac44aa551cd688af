// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// The syntax of PLY files, without any meaning. Private to core.

namespace lfm {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyScalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::kFloat32;
  std::optional<PlyScalar> count_type;  ///< set for lists
  /// One value an element; for lists all items in a row, and `ends[i]` is one past element i's.
  std::vector<double> values;
  std::vector<size_t> ends;
};

struct PlyElement {
  std::string name;
  int64_t count = 0;
  std::vector<PlyProperty> properties;

  const PlyProperty* Find(std::string_view property_name) const;
};

struct PlyContent {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;

  const PlyElement* Find(std::string_view element_name) const;
};

/// Parses a PLY file in memory. No memory is taken for counts that the file is too short for.
/// Throws Error, naming `file`, when it is truncated, malformed, or longer than its header says.
PlyContent ParsePly(std::string_view bytes, const std::string& file);

}  // namespace lfm
