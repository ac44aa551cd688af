// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_picture.h"

#include <epoxy/gl.h>

#include <algorithm>

#include "core/error.h"
#include "viewer/gl_view.h"

namespace lfm {
namespace {

// Two triangles without any buffer: corners by their numbers.
constexpr const char* kVertex = R"(#version 330 core
uniform vec4 place;  // left, top, width, height in the window, from -1 to 1
out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  gl_Position = vec4(place.x + at.x * place.z, place.y - at.y * place.w, 0.0, 1.0);
}
)";
constexpr const char* kFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D picture;
out vec4 color;
void main() { color = vec4(texture(picture, at).rgb, 1.0); }
)";

}  // namespace

PixelRectangle FitInto(const PixelRectangle& frame, int width, int height) {
  const double scale = std::min(frame.width / width, frame.height / height);
  const double w = scale * width, h = scale * height;
  return {frame.x + (frame.width - w) / 2, frame.y + (frame.height - h) / 2, w, h};
}

GlPicture::GlPicture(const Image& image)
    : width_(image.width()),
      height_(image.height()),
      program_(MakeProgram(kVertex, kFragment, {})),
      array_(GlObject::Kind::kVertexArray),
      texture_(GlObject::Kind::kTexture) {
  if (image.channels() != 3) throw Error("a picture to show has to be RGB", ErrorKind::kSystem);
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width_, height_, 0, GL_RGB, GL_UNSIGNED_BYTE,
               image.Data<uint8_t>());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  CheckGl("upload a picture of " + std::to_string(width_) + "x" + std::to_string(height_));
}

void GlPicture::DrawInto(const PixelRectangle& place, int width, int height) const {
  ResetGlState();
  glDisable(GL_DEPTH_TEST);
  glUseProgram(program_.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_.name());
  glUniform1i(glGetUniformLocation(program_.name(), "picture"), 0);
  glUniform4f(
      glGetUniformLocation(program_.name(), "place"), static_cast<float>(2 * place.x / width - 1),
      static_cast<float>(1 - 2 * place.y / height), static_cast<float>(2 * place.width / width),
      static_cast<float>(2 * place.height / height));
  glBindVertexArray(array_.name());
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  glBindVertexArray(0);
  glUseProgram(0);
  ResetGlState();
  CheckGl("draw a picture");
}

}  // namespace lfm
