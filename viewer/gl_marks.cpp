// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_marks.h"

#include <epoxy/gl.h>

#include "core/error.h"

namespace lfm {
namespace {

constexpr float kBehindAlpha = 0.25f;

constexpr const char* kColorsVertex = R"(#version 330 core
in vec3 position;
in vec3 color;
uniform mat4 clip_from_model;
uniform vec3 eye;
centroid out vec3 shown, to_eye, weights;
void main() {
  gl_Position = clip_from_model * vec4(position, 1.0);
  shown = color;
  to_eye = eye - position;
  int corner = gl_VertexID % 3;
  weights = vec3(corner == 0, corner == 1, corner == 2);
}
)";
constexpr const char* kColorsFragment = R"(#version 330 core
centroid in vec3 shown, to_eye, weights;
uniform int with_edges;
out vec4 color;
void main() {
  vec3 across = cross(dFdx(to_eye), dFdy(to_eye));
  float size = length(across);
  float facing = size > 0.0 ? abs(dot(across / size, normalize(to_eye))) : 1.0;
  vec3 sum = shown * (0.4 + 0.6 * facing);
  if (with_edges != 0) {
    vec3 pixels = weights / max(fwidth(weights), vec3(1e-9));
    float share = 1.0 - smoothstep(0.25, 1.25, min(pixels.x, min(pixels.y, pixels.z)));
    sum = mix(sum, vec3(0.05), 0.7 * share);
  }
  color = vec4(sum, 1.0);
}
)";
constexpr const char* kLinesVertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_model;
void main() { gl_Position = clip_from_model * vec4(position, 1.0); }
)";
constexpr const char* kLinesFragment = R"(#version 330 core
uniform vec4 line_color;
out vec4 color;
void main() { color = line_color; }
)";

void UploadVectors(uint32_t buffer, const std::vector<Eigen::Vector3f>& vectors, GLenum usage) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vectors.size() * sizeof(Eigen::Vector3f)),
               vectors.data(), usage);
}

void PointAttribute(GLuint location) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, 3, GL_FLOAT, GL_FALSE, sizeof(Eigen::Vector3f), nullptr);
}

void SetMatrix(const GlObject& program, const Eigen::Matrix4f& clip_from_model) {
  glUseProgram(program.name());
  glUniformMatrix4fv(glGetUniformLocation(program.name(), "clip_from_model"), 1, GL_FALSE,
                     clip_from_model.data());
}

}  // namespace

GlCornerColors::GlCornerColors(const TriangleMesh& mesh)
    : bounds_(SphereOf(mesh.vertices)),
      corner_count_(static_cast<int>(3 * mesh.triangles.size())),
      program_(MakeProgram(kColorsVertex, kColorsFragment, {"position", "color"})),
      array_(GlObject::Kind::kVertexArray),
      positions_(GlObject::Kind::kBuffer),
      colors_(GlObject::Kind::kBuffer) {
  std::vector<Eigen::Vector3f> corners;
  corners.reserve(corner_count_);
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (const int v : triangle) {
      corners.push_back((mesh.vertices[v] - bounds_.center).cast<float>());
    }
  }
  glBindVertexArray(array_.name());
  UploadVectors(positions_.name(), corners, GL_STATIC_DRAW);
  PointAttribute(0);
  UploadVectors(colors_.name(), std::vector<Eigen::Vector3f>(corner_count_), GL_DYNAMIC_DRAW);
  PointAttribute(1);
  glBindVertexArray(0);
  CheckGl("upload the corners' colours");
}

void GlCornerColors::SetColors(std::span<const Eigen::Vector3f> corners) {
  if (corners.size() != static_cast<size_t>(corner_count_)) {
    throw Error("a colour a corner is needed", ErrorKind::kSystem);
  }
  UploadVectors(colors_.name(), {corners.begin(), corners.end()}, GL_DYNAMIC_DRAW);
  CheckGl("upload the corners' colours");
}

void GlCornerColors::DrawInto(const GlView& view, const Placement& placement,
                              EdgeOverlay edges) const {
  ResetGlState();
  SetMatrix(program_, ClipFromModel(view, placement, bounds_.center));
  const Eigen::Vector3f eye = EyeInModel(view, placement, bounds_.center);
  glUniform3fv(glGetUniformLocation(program_.name(), "eye"), 1, eye.data());
  glUniform1i(glGetUniformLocation(program_.name(), "with_edges"),
              edges == EdgeOverlay::kNone ? 0 : 1);
  glBindVertexArray(array_.name());
  glDrawArrays(GL_TRIANGLES, 0, corner_count_);
  glBindVertexArray(0);
  glUseProgram(0);
  CheckGl("draw the corners' colours");
}

GlLines::GlLines()
    : program_(MakeProgram(kLinesVertex, kLinesFragment, {"position"})),
      array_(GlObject::Kind::kVertexArray),
      buffer_(GlObject::Kind::kBuffer) {}

void GlLines::DrawInto(const GlView& view, std::span<const Eigen::Vector3d> points,
                       const Eigen::Vector3f& color, LineDepth depth) const {
  if (points.empty()) return;
  ResetGlState();
  const Eigen::Vector3d origin = points.front();
  std::vector<Eigen::Vector3f> ends;
  ends.reserve(points.size());
  for (const Eigen::Vector3d& point : points) ends.push_back((point - origin).cast<float>());
  SetMatrix(program_, ClipFromModel(view, {}, origin));
  glBindVertexArray(array_.name());
  UploadVectors(buffer_.name(), ends, GL_STREAM_DRAW);
  PointAttribute(0);
  const GLint color_at = glGetUniformLocation(program_.name(), "line_color");
  const auto count = static_cast<GLsizei>(ends.size());
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_LEQUAL);
  glUniform4f(color_at, color.x(), color.y(), color.z(), 1);
  glDrawArrays(GL_LINES, 0, count);
  if (depth == LineDepth::kFaintBehind) {
    glDepthFunc(GL_GREATER);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glUniform4f(color_at, color.x(), color.y(), color.z(), kBehindAlpha);
    glDrawArrays(GL_LINES, 0, count);
  }
  glBindVertexArray(0);
  glUseProgram(0);
  ResetGlState();
  CheckGl("draw lines");
}

}  // namespace lfm
