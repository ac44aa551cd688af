// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lfm {

/// The two chunks of a binary glTF file (glTF 2.0 specification, section 4.4).
struct GlbContainer {
  nlohmann::json json;
  std::string binary;
};

/// Lays the chunks out, padded to four bytes.
std::string BuildGlb(const GlbContainer& container);
/// Takes them apart. Throws Error, naming `file`, when magic, version, lengths or JSON are wrong;
/// never reads outside `bytes`.
GlbContainer ParseGlb(std::string_view bytes, const std::string& file);

/// Component types and shapes of accessors that our files use.
enum class GltfComponent { kUint8 = 5121, kUint16 = 5123, kUint32 = 5125, kFloat32 = 5126 };
enum class GltfShape { kScalar = 1, kVec2 = 2, kVec3 = 3, kVec4 = 4 };
int ComponentBytes(GltfComponent component);
const char* ShapeName(GltfShape shape);

/// Collects buffer views and accessors of one binary chunk.
class GlbBuilder {
 public:
  /// Appends bytes on a four-byte boundary; returns the buffer view's index. `target` as in glTF
  /// (34962 vertices, 34963 indices), 0 for none.
  int AddView(const void* data, size_t size, int target = 0);
  /// An accessor over all of `values`.
  template <typename T>
  int AddAccessor(const std::vector<T>& values, GltfComponent component, GltfShape shape,
                  int target = 0) {
    return AddAccessor(values.data(), values.size() * sizeof(T), component, shape, target);
  }
  /// An image of PNG bytes.
  int AddPng(std::span<const std::byte> png, const std::string& name);
  nlohmann::json& accessor(int index) { return json["accessors"][index]; }
  /// The finished container; `json` holds what the caller set besides.
  GlbContainer Finish();

  nlohmann::json json;  ///< the glTF document

 private:
  int AddAccessor(const void* data, size_t size, GltfComponent component, GltfShape shape,
                  int target);
  std::string binary_;
};

}  // namespace lfm
