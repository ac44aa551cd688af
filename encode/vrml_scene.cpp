// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vrml_scene.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "encode/vrml_tokens.h"

namespace lfm::vrml {
namespace {

constexpr int kMostDepth = 64;
constexpr size_t kMostNodes = size_t{1} << 20;

constexpr std::array<std::string_view, 61> kKnownNodes = {
    "Anchor", "Appearance", "AudioClip", "Background", "Billboard", "Box", "Collision", "Color",
    "ColorInterpolator", "Cone", "Coordinate", "CoordinateInterpolator", "Cylinder",
    "CylinderSensor", "DirectionalLight", "ElevationGrid", "Extrusion", "Fog", "FontStyle", "Group",
    "ImageTexture", "IndexedFaceSet", "IndexedLineSet", "Inline", "LOD", "Material", "MovieTexture",
    "NavigationInfo", "Normal", "NormalInterpolator", "OrientationInterpolator", "PixelTexture",
    "PlaneSensor", "PointLight", "PointSet", "PositionInterpolator", "ProximitySensor",
    "ScalarInterpolator", "Script", "Shape", "Sound", "Sphere", "SphereSensor", "SpotLight",
    "Switch", "Text", "TextureCoordinate", "TextureTransform", "TimeSensor", "TouchSensor",
    "Transform", "Viewpoint", "VisibilitySensor", "WorldInfo",
    // MPEG-4 AFX (ISO/IEC 14496-16)
    "LFM_Appearance", "LFM_BlendList", "LFM_FrameList", "LFM_LightMap", "LFM_SurfaceMapList",
    "LFM_ViewMapList", "LFM_blendList"};

constexpr std::array<std::string_view, 20> kFieldTypes = {
    "SFBool",  "SFColor", "MFColor", "SFFloat",    "MFFloat",    "SFImage",  "SFInt32",
    "MFInt32", "SFNode",  "MFNode",  "SFRotation", "MFRotation", "SFString", "MFString",
    "SFTime",  "MFTime",  "SFVec2f", "MFVec2f",    "SFVec3f",    "MFVec3f"};

template <typename List>
bool Holds(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

// Names that hold from their definition to the end of a file or of a prototype's body.
struct Scope {
  std::map<std::string, int> defined;
  std::set<std::string> types;
  const std::vector<InterfaceField>* interface = nullptr;  // where IS may be used
};

class Parser {
 public:
  Parser(std::string_view text, const std::string& name) : tokens_(text, name) {}

  Scene Parse() {
    scopes_.emplace_back();
    while (tokens_.Peek().kind != TokenKind::kEnd) ParseStatement(scene_.roots);
    return std::move(scene_);
  }

 private:
  // Levels of nesting, counted while it lives.
  class Level {
   public:
    explicit Level(Parser& parser) : depth_(parser.depth_) {
      if (++depth_ > kMostDepth) {
        parser.tokens_.Fail(parser.tokens_.Peek().line,
                            "more than " + std::to_string(kMostDepth) + " levels of nesting");
      }
    }
    ~Level() { --depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    int& depth_;
  };

  void ParseStatement(std::vector<int>& nodes) {
    if (!ParseDeclaration()) nodes.push_back(ParseNode());
  }

  // PROTO, EXTERNPROTO and ROUTE, which may stand among nodes and among fields.
  bool ParseDeclaration() {
    const int line = tokens_.Peek().line;
    if (tokens_.TakeIf("PROTO")) {
      ParsePrototype(line);
    } else if (tokens_.TakeIf("EXTERNPROTO")) {
      Prototype prototype{tokens_.TakeWord("the name of a prototype"), line, {}, {}};
      ParseInterface(prototype.interface, false);
      ParseValue();
      Declare(std::move(prototype));
    } else if (tokens_.TakeIf("ROUTE")) {
      ParseEndOfRoute();
      tokens_.Expect("TO");
      ParseEndOfRoute();
    } else {
      return false;
    }
    return true;
  }

  void ParseEndOfRoute() {
    tokens_.TakeWord("the node of a route");
    tokens_.Expect(".");
    tokens_.TakeWord("the event of a route");
  }

  void Declare(Prototype prototype) {
    scopes_.back().types.insert(prototype.name);
    scene_.prototypes.push_back(std::move(prototype));
  }

  void ParsePrototype(int line) {
    const Level level(*this);
    Prototype prototype{tokens_.TakeWord("the name of a prototype"), line, {}, {}};
    ParseInterface(prototype.interface, true);
    tokens_.Expect("{");
    Scope& scope = scopes_.emplace_back();
    scope.interface = &prototype.interface;
    while (!tokens_.TakeIf("}")) ParseStatement(prototype.nodes);
    scopes_.pop_back();
    if (prototype.nodes.empty()) tokens_.Fail(line, "a prototype has no node in its body");
    Declare(std::move(prototype));
  }

  void ParseInterface(std::vector<InterfaceField>& interface, bool with_defaults) {
    tokens_.Expect("[");
    while (!tokens_.TakeIf("]")) {
      const int line = tokens_.Peek().line;
      InterfaceField field = ParseInterfaceField();
      if (field.access == "field" || field.access == "exposedField") {
        if (with_defaults) field.value = ParseValue();
      }
      const bool twice = std::any_of(interface.begin(), interface.end(),
                                     [&](const auto& other) { return other.name == field.name; });
      if (twice) tokens_.Fail(line, Quoted(field.name) + " is declared twice");
      interface.push_back(std::move(field));
    }
  }

  InterfaceField ParseInterfaceField() {
    const int line = tokens_.Peek().line;
    InterfaceField field;
    field.access = tokens_.TakeWord("a field or event");
    constexpr std::array<std::string_view, 4> kAccess = {"field", "exposedField", "eventIn",
                                                         "eventOut"};
    if (!Holds(kAccess, field.access)) {
      tokens_.Fail(line, Quoted(field.access) + " is neither field nor event");
    }
    field.type = tokens_.TakeWord("the type of a field");
    if (!Holds(kFieldTypes, field.type)) {
      tokens_.Fail(line, Quoted(field.type) + " is no type of a field");
    }
    field.name = tokens_.TakeWord("the name of a field");
    return field;
  }

  bool IsKnown(const std::string& type) const {
    return Holds(kKnownNodes, type) ||
           std::any_of(scopes_.begin(), scopes_.end(),
                       [&](const Scope& scope) { return scope.types.contains(type); });
  }

  int ParseNode() {
    const Level level(*this);
    const int line = tokens_.Peek().line;
    if (tokens_.TakeIf("USE")) {
      const std::string name = tokens_.TakeWord("the name of a node");
      const auto found = scopes_.back().defined.find(name);
      if (found == scopes_.back().defined.end()) {
        tokens_.Fail(line, "USE " + name.substr(0, 60) + ": no complete node has this name");
      }
      return found->second;
    }
    std::string name;
    if (tokens_.TakeIf("DEF")) name = tokens_.TakeWord("the name of a node");
    const int node = ParseNodeBody(line);
    // Named when it is complete: it cannot contain itself.
    if (!name.empty()) scopes_.back().defined[name] = node;
    return node;
  }

  int ParseNodeBody(int line) {
    Node node;
    node.line = line;
    node.type = tokens_.TakeWord("a node");
    if (!IsKnown(node.type)) {
      tokens_.Fail(line, Quoted(node.type) + " is no node of VRML97, nor declared before");
    }
    tokens_.Expect("{");
    while (!tokens_.TakeIf("}")) {
      if (ParseDeclaration()) continue;
      const int field_line = tokens_.Peek().line;
      Field field = ParseField(node.type == "Script");
      if (node.Find(field.name) != nullptr) {
        tokens_.Fail(field_line, Quoted(field.name) + " is given twice");
      }
      node.fields.push_back(std::move(field));
    }
    if (scene_.nodes.size() >= kMostNodes) tokens_.Fail(line, "more than 2^20 nodes");
    scene_.nodes.push_back(std::move(node));
    return static_cast<int>(scene_.nodes.size()) - 1;
  }

  Field ParseField(bool of_script) {
    const std::string& word = tokens_.Peek().text;
    const bool declared = of_script && (word == "field" || word == "eventIn" || word == "eventOut");
    if (!declared) {
      std::string name = tokens_.TakeWord("the name of a field");
      return {std::move(name), ParseValue()};
    }
    InterfaceField field = ParseInterfaceField();
    const bool has_value = field.access == "field" || tokens_.Peek().text == "IS";
    return {std::move(field.name), has_value ? ParseValue() : Value{}};
  }

  Value ParseValue() {
    const Level level(*this);
    Value value;
    value.line = tokens_.Peek().line;
    if (tokens_.TakeIf("IS")) {
      value.is = tokens_.TakeWord("the name behind IS");
      const auto* interface = scopes_.back().interface;
      const bool known = interface != nullptr &&
                         std::any_of(interface->begin(), interface->end(),
                                     [&](const auto& field) { return field.name == value.is; });
      if (!known) tokens_.Fail(value.line, "IS " + value.is.substr(0, 60) + " is not declared");
    } else if (tokens_.TakeIf("[")) {
      while (!tokens_.TakeIf("]")) ParseElement(value);
    } else if (tokens_.Peek().kind == TokenKind::kNumber) {
      while (tokens_.Peek().kind == TokenKind::kNumber) ParseElement(value);
    } else if (!tokens_.TakeIf("NULL")) {
      ParseElement(value);
    }
    return value;
  }

  void ParseElement(Value& value) {
    const Token& token = tokens_.Peek();
    if (token.kind == TokenKind::kNumber) {
      value.numbers.push_back(tokens_.Take().number);
    } else if (token.kind == TokenKind::kString) {
      value.strings.push_back(tokens_.Take().text);
    } else if (token.kind == TokenKind::kWord && (token.text == "TRUE" || token.text == "FALSE")) {
      value.flag = tokens_.Take().text == "TRUE";
    } else if (token.kind == TokenKind::kWord) {
      value.nodes.push_back(ParseNode());
    } else {
      tokens_.Fail(token.line, "a value is missing");
    }
  }

  Tokens tokens_;
  Scene scene_;
  std::vector<Scope> scopes_;
  int depth_ = 0;
};

}  // namespace

const Value* Node::Find(std::string_view name) const {
  const auto found = std::find_if(fields.begin(), fields.end(),
                                  [&](const Field& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &found->value;
}

Scene ParseScene(std::string_view text, const std::string& name) {
  if (!text.starts_with(kHeader)) FailAt(name, 1, "it does not begin with \"#VRML V2.0 utf8\"");
  return Parser(text, name).Parse();
}

}  // namespace lfm::vrml
