// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_objects.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>

#include "core/error.h"

namespace lfm {
namespace {

std::string FirstLine(const char* log) {
  const std::string text(log);
  return text.substr(0, text.find('\n'));
}

void AttachShader(const GlObject& program, GLenum stage, const std::string& source) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) {
    glAttachShader(program.name(), shader);
    glDeleteShader(shader);  // lives on as long as the program needs it
    return;
  }
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  throw Error("the graphics driver refused a shader: " + FirstLine(log.data()) +
                  "; update the driver, or render with lfm-render",
              ErrorKind::kSystem);
}

}  // namespace

GlObject::GlObject(Kind kind) : kind_(kind) {
  switch (kind) {
    case Kind::kTexture:
      glGenTextures(1, &name_);
      break;
    case Kind::kBuffer:
      glGenBuffers(1, &name_);
      break;
    case Kind::kVertexArray:
      glGenVertexArrays(1, &name_);
      break;
    case Kind::kFramebuffer:
      glGenFramebuffers(1, &name_);
      break;
    case Kind::kRenderbuffer:
      glGenRenderbuffers(1, &name_);
      break;
    case Kind::kProgram:
      name_ = glCreateProgram();
      break;
  }
}

GlObject::~GlObject() {
  if (name_ == 0) return;
  switch (kind_) {
    case Kind::kTexture:
      glDeleteTextures(1, &name_);
      break;
    case Kind::kBuffer:
      glDeleteBuffers(1, &name_);
      break;
    case Kind::kVertexArray:
      glDeleteVertexArrays(1, &name_);
      break;
    case Kind::kFramebuffer:
      glDeleteFramebuffers(1, &name_);
      break;
    case Kind::kRenderbuffer:
      glDeleteRenderbuffers(1, &name_);
      break;
    case Kind::kProgram:
      glDeleteProgram(name_);
      break;
  }
}

GlObject MakeProgram(const std::string& vertex_source, const std::string& fragment_source,
                     std::initializer_list<const char*> attributes) {
  GlObject program(GlObject::Kind::kProgram);
  AttachShader(program, GL_VERTEX_SHADER, vertex_source);
  AttachShader(program, GL_FRAGMENT_SHADER, fragment_source);
  GLuint location = 0;
  for (const char* attribute : attributes) {
    glBindAttribLocation(program.name(), location++, attribute);
  }
  glLinkProgram(program.name());
  GLint linked = GL_FALSE;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  if (!linked) {
    std::array<char, 1024> log{};
    glGetProgramInfoLog(program.name(), static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw Error("the graphics driver did not link the shaders: " + FirstLine(log.data()) +
                    "; update the driver, or render with lfm-render",
                ErrorKind::kSystem);
  }
  return program;
}

void CheckGl(const std::string& what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) {
    throw Error("the graphics card ran out of memory when it had to " + what +
                    "; encode the model with fewer terms or larger triangles",
                ErrorKind::kSystem);
  }
  throw Error("OpenGL error " + std::to_string(error) + " when it had to " + what,
              ErrorKind::kSystem);
}

void RequireGl33() {
  if (epoxy_is_desktop_gl() && epoxy_gl_version() >= 33) return;
  throw Error(
      "this machine's OpenGL is older than 3.3; update the driver, or use lfm-render --renderer "
      "cpu",
      ErrorKind::kSystem);
}

}  // namespace lfm
