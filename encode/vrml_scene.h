// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lfm::vrml {

/// What a field holds. One value and a list of one look alike.
struct Value {
  int line = 0;
  std::vector<double> numbers;
  std::vector<std::string> strings;
  std::vector<int> nodes;  ///< indices into Scene::nodes
  std::optional<bool> flag;
  std::string is;  ///< of fields in prototypes: the interface's name that stands for the value
};

struct Field {
  std::string name;
  Value value;
};

struct Node {
  std::string type;
  int line = 0;
  std::vector<Field> fields;  ///< none twice
  /// The field's value; nullptr where it is not given.
  const Value* Find(std::string_view name) const;
};

/// A line of a prototype's interface.
struct InterfaceField {
  std::string access;  ///< field, exposedField, eventIn or eventOut
  std::string type;    ///< SFFloat, MFNode, ...
  std::string name;
  Value value;  ///< the default; empty for events
};

struct Prototype {
  std::string name;
  int line = 0;
  std::vector<InterfaceField> interface;
  std::vector<int> nodes;  ///< the body; the first one says what an instance is. External: none
};

struct Scene {
  std::vector<Node> nodes;
  std::vector<int> roots;
  std::vector<Prototype> prototypes;  ///< in the order of their names' appearance
};

inline constexpr std::string_view kHeader = "#VRML V2.0 utf8";

/// Reads a VRML97 file (ISO/IEC 14772-1): nodes, DEF and USE, PROTO with IS, EXTERNPROTO (not
/// fetched), ROUTE (skipped), the interfaces of Script nodes. Fields of nodes are not checked
/// against their types: whoever uses one does.
///
/// A node's type must be one of VRML97's, declared before, or one of the nodes of light field maps
/// (MPEG-4 knows them without declaration). USE names a node that is complete, so that no cycle can
/// arise; the same node may be used in many places, so walk a scene by marking what was seen.
/// Throws Error with file and line for anything else, for more than 64 levels of nesting and more
/// than 2^20 nodes. Memory: at most some 100 times the text.
Scene ParseScene(std::string_view text, const std::string& name);

}  // namespace lfm::vrml
