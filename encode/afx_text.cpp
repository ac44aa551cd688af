// SPDX-License-Identifier: BSD-3-Clause
#include "encode/afx_text.h"

#include <array>
#include <charconv>

#include "core/hash.h"

namespace lfm::afx {
namespace {

template <typename T>
void AppendNumber(std::string& text, T value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), result.ptr);
}

template <typename T>
std::string ListOf(const std::vector<T>& values, int values_per_line) {
  std::string text = "[";
  for (size_t i = 0; i < values.size(); ++i) {
    text += i % static_cast<size_t>(values_per_line) == 0 ? '\n' : ' ';
    AppendNumber(text, values[i]);
  }
  return text + "\n]";
}

}  // namespace

const std::string_view kPrologue = R"(#VRML V2.0 utf8
# A surface light field in the form of MPEG-4 AFX (ISO/IEC 14496-16), written by lfm.
# Browsers that do not know its nodes show the mean view: the plain Appearance of LFM_Appearance.

PROTO LFM_Appearance [
  exposedField MFNode tileList []
  exposedField MFNode lightMapList []
  exposedField SFNode blendList NULL
  exposedField SFNode vertexFrameList NULL
  exposedField SFNode texture NULL # not of AFX: the mean view
] {
  Appearance { texture IS texture }
}
PROTO LFM_FrameList [
  exposedField MFInt32 index [-1]
  exposedField MFVec3f frame [1 0 0, 0 1 0, 0 0 1]
] {
  Group {}
}
PROTO LFM_LightMap [
  exposedField SFNode surfaceMapList NULL
  exposedField SFNode viewMapList NULL
  exposedField SFVec3f scaleRGB 1 1 1
  exposedField SFVec3f biasRGB 0 0 0
  exposedField SFInt32 priorityLevel 0
] {
  Group {}
}
PROTO LFM_SurfaceMapList [
  exposedField MFInt32 triangleIndex []
  exposedField MFInt32 tileIndex []
  exposedField MFInt32 viewMapIndex []
  exposedField SFNode triangleCoordinate NULL
] {
  Group {}
}
PROTO LFM_ViewMapList [
  exposedField MFInt32 vertexIndex []
  exposedField MFInt32 tileIndex []
  exposedField SFNode textureOrigin NULL
  exposedField SFNode textureSize NULL
  exposedField SFString directionMap "orthographic" # not of AFX, which has this one alone
] {
  Group {}
}
PROTO LFM_BlendList [
  exposedField MFInt32 lightMapIndex []
  exposedField MFInt32 blendMode []
] {
  Group {}
}
)";

void Append(std::string& text, float value) { AppendNumber(text, value); }
void Append(std::string& text, int value) { AppendNumber(text, value); }

std::string List(const std::vector<float>& values, int values_per_line) {
  return ListOf(values, values_per_line);
}
std::string List(const std::vector<int>& values, int values_per_line) {
  return ListOf(values, values_per_line);
}

std::string NodeTexts::Node(const std::string& prefix, const std::string& node) {
  const auto [place, is_new] = names_.try_emplace(Hasher().Add(node).HexDigest());
  if (!is_new) return "USE " + place->second;
  place->second = prefix + std::to_string(names_.size());
  return "DEF " + place->second + " " + node;
}

}  // namespace lfm::afx
