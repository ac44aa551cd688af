// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace lfm {

/// The name of one OpenGL object, deleted with the handle. Made, used and destroyed while the same
/// context is current. Names are GLuint; this header does not need OpenGL's.
class GlObject {
 public:
  enum class Kind { kTexture, kBuffer, kVertexArray, kFramebuffer, kRenderbuffer, kProgram };

  GlObject() = default;
  /// Generates an object (kProgram: an empty program).
  explicit GlObject(Kind kind);
  ~GlObject();
  GlObject(GlObject&& other) noexcept : kind_(other.kind_), name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(kind_, other.kind_);
    std::swap(name_, other.name_);
    return *this;
  }
  uint32_t name() const { return name_; }

 private:
  Kind kind_ = Kind::kTexture;
  uint32_t name_ = 0;
};

/// Compiles and links a program. `attributes` is bound to locations 0, 1, ... in order. Throws
/// Error (kSystem) with the driver's first line of complaint.
GlObject MakeProgram(const std::string& vertex_source, const std::string& fragment_source,
                     std::initializer_list<const char*> attributes);

/// Throws Error (kSystem) when the current context has recorded an error; `what` says what was
/// being done.
void CheckGl(const std::string& what);

/// Throws Error (kSystem) unless the current context is OpenGL 3.3 or later.
void RequireGl33();

}  // namespace lfm
