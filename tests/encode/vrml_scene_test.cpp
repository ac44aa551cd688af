// SPDX-License-Identifier: BSD-3-Clause
#include "encode/vrml_scene.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "encode/vrml_fields.h"

namespace lfm::testing {
namespace {

using vrml::Node;
using vrml::Scene;

const std::string kHeader = "#VRML V2.0 utf8\n";

Scene Parse(const std::string& body) { return vrml::ParseScene(kHeader + body, "scene.wrl"); }

std::string Message(const std::string& text) {
  try {
    vrml::ParseScene(text, "scene.wrl");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(VrmlScene, ReadsNodesAndValuesOfEveryKind) {
  const Scene scene = Parse(
      "Transform { # a comment with \" and }\n"
      "  translation 1, -2.5e1 +.5,\n"
      "  children [ Shape { geometry Box { size 0x10 2 3 } }, DEF A Group {} USE A ]\n"
      "}\n"
      "WorldInfo { title \"a \\\"b\\\" \\\\ # c\" info [ \"x\" \"y\" ] }\n"
      "IndexedFaceSet { ccw FALSE coord NULL }\n");
  ASSERT_EQ(scene.roots.size(), 3u);
  const Node& transform = scene.nodes[scene.roots[0]];
  EXPECT_EQ(transform.type, "Transform");
  EXPECT_EQ(transform.line, 2);
  EXPECT_EQ(transform.Find("translation")->numbers, (std::vector<double>{1, -25, 0.5}));
  const std::vector<int>& children = transform.Find("children")->nodes;
  ASSERT_EQ(children.size(), 3u);
  EXPECT_EQ(children[1], children[2]);
  const Node& shape = scene.nodes[children[0]];
  const Node& box = scene.nodes[shape.Find("geometry")->nodes.at(0)];
  EXPECT_EQ(box.Find("size")->numbers, (std::vector<double>{16, 2, 3}));
  const Node& info = scene.nodes[scene.roots[1]];
  EXPECT_EQ(info.Find("title")->strings.at(0), "a \"b\" \\ # c");
  EXPECT_EQ(info.Find("info")->strings.size(), 2u);
  EXPECT_EQ(scene.nodes[scene.roots[2]].Find("ccw")->flag, false);
  EXPECT_EQ(info.Find("nothing"), nullptr);
}

TEST(VrmlScene, ReadsPrototypesRoutesAndScripts) {
  const Scene scene = Parse(
      "EXTERNPROTO Far [ field SFInt32 n ] [ \"far.wrl#Far\" ]\n"
      "PROTO Lamp [ exposedField SFColor tint 1 0 0 eventIn SFBool on ] {\n"
      "  Appearance { material Material { emissiveColor IS tint } }\n"
      "  Group {}\n"
      "}\n"
      "DEF L Lamp { tint 0 1 0 }\n"
      "DEF S Script { eventIn SFBool go field SFTime t 0 directOutput TRUE url \"javascript:\" }\n"
      "Far { n 3 }\n"
      "ROUTE L.on TO S.go\n");
  ASSERT_EQ(scene.prototypes.size(), 2u);
  EXPECT_TRUE(scene.prototypes[0].nodes.empty());
  const vrml::Prototype& lamp = scene.prototypes[1];
  EXPECT_EQ(lamp.name, "Lamp");
  ASSERT_EQ(lamp.interface.size(), 2u);
  EXPECT_EQ(lamp.interface[0].type, "SFColor");
  EXPECT_EQ(lamp.interface[0].value.numbers.size(), 3u);
  ASSERT_EQ(lamp.nodes.size(), 2u);
  const Node& first = scene.nodes[lamp.nodes[0]];
  EXPECT_EQ(first.type, "Appearance");
  const Node& material = scene.nodes[first.Find("material")->nodes.at(0)];
  EXPECT_EQ(material.Find("emissiveColor")->is, "tint");
  EXPECT_EQ(scene.roots.size(), 3u);
}

TEST(VrmlScene, RefusesWhatIsNoVrml97) {
  const char* hostile[] = {
      "Group {",
      "Group { children [ }",
      "Group }",
      "Grup {}",                              // no such node
      "Lamp {}  PROTO Lamp [] { Group {} }",  // not declared before
      "PROTO Lamp [] { }  Lamp {}",           // nothing that it could be
      "PROTO Lamp [ field SFMatrix m 1 ] { Group {} }",
      "PROTO Lamp [ field SFBool a TRUE field SFBool a TRUE ] { Group {} }",
      "PROTO Lamp [] { Group { children IS lights } }",
      "Group { children IS lights }",
      "Group { children USE A }",
      "DEF A Group { children USE A }",       // a cycle
      "PROTO P [] { DEF A Group {} } USE A",  // of another scope
      "Group { children [] children [] }",
      "Box { size 1 2 nan }",
      "Box { size 1 2 -inf }",
      "Box { size 1 2 1e999 }",
      "Box { size 1 2 - }",
      "Box { size 1 2 3x }",
      "Box { size 1.2.3 }",
      "Box { size 0x }",
      "WorldInfo { title \"open }",
      "Group { children ] }",
      "Group 'x' {}",
      "ROUTE A TO B",
      "\x01",
  };
  for (const char* text : hostile) EXPECT_THROW(Parse(text), Error) << text;
  EXPECT_THROW(vrml::ParseScene("Group {}", "scene.wrl"), Error);
  EXPECT_THROW(vrml::ParseScene("", "scene.wrl"), Error);
  EXPECT_NO_THROW(Parse(""));
}

TEST(VrmlScene, NamesFileAndLineInOneLine) {
  const std::string message = Message(kHeader + "\nGroup {\n  children \"a\n\nb\" }\nGrup\n{}");
  EXPECT_NE(message.find("scene.wrl, line 7: \"Grup\""), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(VrmlScene, BoundsNesting) {
  const auto nested = [](int depth, const std::string& open, const std::string& close) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += open;
    for (int i = 0; i < depth; ++i) text += close;
    return text;
  };
  EXPECT_NO_THROW(Parse(nested(20, "Group { children [ ", "] }")));
  EXPECT_THROW(Parse(nested(100000, "Group { children [ ", "] }")), Error);
  EXPECT_THROW(Parse(nested(100000, "Group { children ", "}")), Error);
  EXPECT_THROW(Parse(nested(100000, "PROTO P [] { ", "Group {} }")), Error);
  EXPECT_THROW(Parse(nested(100000, "PROTO P [ field SFNode n Group { n ", "} ] { Group {} }")),
               Error);
}

TEST(VrmlFields, ChecksTypes) {
  const Scene scene = Parse(
      "Group { i [1 2 -3] f [0.5 1] big 3e9 huge 1e300 s [\"a\" \"b\"] flag TRUE node Box {} "
      "nodes [ Box {} Group {} ] none NULL mixed [1 \"a\"] }");
  const std::string name = "scene.wrl";
  const vrml::Fields fields(scene, name);
  const Node& node = scene.nodes[scene.roots[0]];
  EXPECT_EQ(fields.Integers(node, "i"), (std::vector<int>{1, 2, -3}));
  EXPECT_EQ(fields.Integers(node, "absent", {7}), std::vector<int>{7});
  EXPECT_EQ(fields.Floats(node, "f", 2), (std::vector<float>{0.5f, 1}));
  EXPECT_EQ(fields.String(node, "s", ""), "a");
  EXPECT_TRUE(fields.Flag(node, "flag", false));
  EXPECT_GE(fields.Child(node, "node", "Box"), 0);
  EXPECT_EQ(fields.Child(node, "none", "Box"), -1);
  EXPECT_THROW(fields.Integers(node, "f"), Error);
  EXPECT_THROW(fields.Integers(node, "big"), Error);
  EXPECT_THROW(fields.Integers(node, "s"), Error);
  EXPECT_THROW(fields.Integers(node, "mixed"), Error);
  EXPECT_THROW(fields.Floats(node, "i", 2), Error);
  EXPECT_THROW(fields.Floats(node, "huge", 1), Error);
  EXPECT_THROW(fields.String(node, "i", ""), Error);
  EXPECT_THROW(fields.Flag(node, "i", true), Error);
  EXPECT_THROW(fields.Child(node, "node", "Cone"), Error);
  EXPECT_THROW(fields.Child(node, "nodes"), Error);
  EXPECT_THROW(fields.Children(node, "nodes", "Box"), Error);
}

}  // namespace
}  // namespace lfm::testing
