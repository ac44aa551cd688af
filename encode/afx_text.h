// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lfm::afx {

/// What stands before the scene: header, and prototypes of the LFM nodes for browsers that do not
/// know them. The field `texture` of LFM_Appearance, and `directionMap` of LFM_ViewMapList, are
/// additions of ours (docs/formats.md).
extern const std::string_view kPrologue;

/// Appends numbers as VRML writes them: floats with the fewest digits that bring the same float
/// back.
void Append(std::string& text, float value);
void Append(std::string& text, int value);

/// `[ 1 2 3\n ... ]`, a line each `values_per_line`.
std::string List(const std::vector<float>& values, int values_per_line);
std::string List(const std::vector<int>& values, int values_per_line);

/// Nodes that occur more than once are written once: `DEF NAME Type {...}` where they come first,
/// `USE NAME` later.
class NodeTexts {
 public:
  /// `node`: "TextureCoordinate { ... }". Names are `prefix` and a number.
  std::string Node(const std::string& prefix, const std::string& node);

 private:
  std::map<std::string, std::string> names_;  // by hash
};

}  // namespace lfm::afx
