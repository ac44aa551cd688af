// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "encode/glb_container.h"

namespace lfm::glb {

/// A parsed file and what is read of it, for the readers of our extension: every index, count and
/// offset is checked before it is used; each throws Error, naming the file.
///
/// The document with its file's name, for messages.
struct Document {
  const GlbContainer& container;
  std::string file;

  [[noreturn]] void Fail(const std::string& problem) const {
    throw Error(file + ": " + problem + "; run lfm-encode again");
  }
  void Require(bool condition, const std::string& problem) const {
    if (!condition) Fail(problem);
  }
};

/// `object[key]`, which must be there.
inline const nlohmann::json& Member(const Document& doc, const nlohmann::json& object,
                                    const char* key) {
  if (!object.is_object() || !object.contains(key)) {
    doc.Fail(std::string("\"") + key + "\" is missing");
  }
  return object[key];
}

/// An integer in [min, max].
inline int64_t Integer(const Document& doc, const nlohmann::json& object, const char* key,
                       int64_t min, int64_t max) {
  const nlohmann::json& value = Member(doc, object, key);
  const bool fits = value.is_number_unsigned() ? value.get<uint64_t>() <= uint64_t(INT64_MAX)
                                               : value.is_number_integer();
  const int64_t number = fits ? value.get<int64_t>() : 0;
  if (!fits || number < min || number > max) {
    doc.Fail(std::string("\"") + key + "\" must be an integer in [" + std::to_string(min) + ", " +
             std::to_string(max) + "]");
  }
  return number;
}

/// An element of one of the document's lists.
inline const nlohmann::json& Element(const Document& doc, const char* list, int64_t index) {
  const nlohmann::json& array = Member(doc, doc.container.json, list);
  doc.Require(array.is_array() && index < static_cast<int64_t>(array.size()),
              std::string("an index into \"") + list + "\" is out of range");
  return array[static_cast<size_t>(index)];
}

inline constexpr int64_t kAnyIndex = std::numeric_limits<int32_t>::max();

/// The bytes of the buffer view that `owner` names.
inline std::string_view BufferView(const Document& doc, const nlohmann::json& owner) {
  const nlohmann::json& view =
      Element(doc, "bufferViews", Integer(doc, owner, "bufferView", 0, kAnyIndex));
  const auto size = static_cast<int64_t>(doc.container.binary.size());
  const int64_t offset =
      view.contains("byteOffset") ? Integer(doc, view, "byteOffset", 0, size) : 0;
  const int64_t length = Integer(doc, view, "byteLength", 1, size);
  Integer(doc, view, "buffer", 0, 0);
  doc.Require(offset <= size - length, "a buffer view reaches beyond the binary chunk");
  doc.Require(!view.contains("byteStride"), "strided buffer views are not used here");
  return std::string_view(doc.container.binary).substr(offset, length);
}

/// All values of an accessor of `count` elements (-1: any number).
template <typename T>
std::vector<T> Accessor(const Document& doc, const nlohmann::json& extension, const char* key,
                        GltfComponent component, GltfShape shape, int64_t count) {
  const nlohmann::json& accessor =
      Element(doc, "accessors", Integer(doc, extension, key, 0, kAnyIndex));
  const std::string name = std::string("accessor \"") + key + "\"";
  doc.Require(Integer(doc, accessor, "componentType", 0, 65535) == static_cast<int>(component) &&
                  Member(doc, accessor, "type") == ShapeName(shape) &&
                  !accessor.contains("byteOffset") && !accessor.contains("sparse"),
              name + " has another type");
  const int64_t stated = Integer(doc, accessor, "count", 1, kAnyIndex);
  doc.Require(count < 0 || stated == count, name + " has another length");
  const std::string_view bytes = BufferView(doc, accessor);
  const size_t values = static_cast<size_t>(stated) * static_cast<int>(shape);
  doc.Require(bytes.size() == values * sizeof(T), name + " does not fill its buffer view");
  std::vector<T> result(values);
  std::memcpy(result.data(), bytes.data(), bytes.size());
  return result;
}

/// The same, finite.
inline std::vector<float> Floats(const Document& doc, const nlohmann::json& extension,
                                 const char* key, GltfShape shape, int64_t count) {
  std::vector<float> values =
      Accessor<float>(doc, extension, key, GltfComponent::kFloat32, shape, count);
  for (const float value : values) {
    doc.Require(std::isfinite(value), std::string("accessor \"") + key + "\" is not finite");
  }
  return values;
}

}  // namespace lfm::glb
