// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_framebuffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

void AllocateRenderbuffer(const GlObject& buffer, GLenum format, int samples, int width,
                          int height) {
  glBindRenderbuffer(GL_RENDERBUFFER, buffer.name());
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples > 1 ? samples : 0, format, width,
                                   height);
}

void Blit(GLuint from, GLuint to, int width, int height) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace

GlFramebuffer::GlFramebuffer(int width, int height, int samples)
    : width_(width), height_(height), samples_(std::max(samples, 1)) {
  GLint max_size = 0, max_samples = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &max_size);
  glGetIntegerv(GL_MAX_SAMPLES, &max_samples);
  if (width < 1 || height < 1 || width > max_size || height > max_size) {
    throw Error("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                " pixels cannot be drawn here; choose sides of 1 to " + std::to_string(max_size));
  }
  samples_ = std::min(samples_, std::max(max_samples, 1));
  framebuffer_ = GlObject(GlObject::Kind::kFramebuffer);
  color_ = GlObject(GlObject::Kind::kRenderbuffer);
  depth_ = GlObject(GlObject::Kind::kRenderbuffer);
  AllocateRenderbuffer(color_, GL_RGBA8, samples_, width, height);
  AllocateRenderbuffer(depth_, GL_DEPTH_COMPONENT24, samples_, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.name());
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  CheckGl("make room for a picture");
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Error("the graphics driver offers no off-screen picture; use lfm-render --renderer cpu",
                ErrorKind::kSystem);
  }
}

void GlFramebuffer::Bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, width_, height_);
}

void GlFramebuffer::ResolveInto(const GlFramebuffer& target) const {
  Blit(framebuffer_.name(), target.framebuffer_.name(), width_, height_);
}

void GlFramebuffer::CopyToWindow() const { Blit(framebuffer_.name(), 0, width_, height_); }

Image GlFramebuffer::Read(int channels) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const size_t row_bytes = size_t{1} * channels * width_;
  std::vector<uint8_t> rows_from_bottom(row_bytes * height_);
  glReadPixels(0, 0, width_, height_, channels == 4 ? GL_RGBA : GL_RGB, GL_UNSIGNED_BYTE,
               rows_from_bottom.data());
  CheckGl("read the picture back");
  Image image(width_, height_, channels, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < height_; ++y) {
    std::memcpy(&image.At<uint8_t>(0, y), &rows_from_bottom[row_bytes * (height_ - 1 - y)],
                row_bytes);
  }
  return image;
}

}  // namespace lfm
