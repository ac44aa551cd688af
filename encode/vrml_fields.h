// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "encode/vrml_scene.h"

namespace lfm::vrml {

/// Reads fields of nodes by type. Fields that are not given have their default; anything else than
/// the type throws Error with file and line.
class Fields {
 public:
  /// Both must outlive this.
  Fields(const Scene& scene, const std::string& name) : scene_(scene), name_(name) {}

  /// MFInt32.
  std::vector<int> Integers(const Node& node, std::string_view field,
                            const std::vector<int>& fallback = {}) const;
  /// MFFloat, MFVec2f, MFVec3f: a multiple of `dimensions`; values fit float32.
  std::vector<float> Floats(const Node& node, std::string_view field, int dimensions,
                            const std::vector<float>& fallback = {}) const;
  /// SFBool.
  bool Flag(const Node& node, std::string_view field, bool fallback) const;
  /// SFString, or the first of MFString.
  std::string String(const Node& node, std::string_view field, const std::string& fallback) const;
  /// SFNode: its index, -1 for NULL. Throws where it is not of `type` (empty: of any).
  int Child(const Node& node, std::string_view field, std::string_view type = {}) const;
  /// MFNode, all of `type`.
  std::vector<int> Children(const Node& node, std::string_view field, std::string_view type) const;
  const Node& At(int node) const { return scene_.nodes[static_cast<size_t>(node)]; }

  [[noreturn]] void Fail(int line, const std::string& problem) const;
  void Require(bool condition, int line, const std::string& problem) const {
    if (!condition) Fail(line, problem);
  }

 private:
  const Scene& scene_;
  const std::string& name_;
};

}  // namespace lfm::vrml
