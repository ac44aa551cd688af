// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/image.h"
#include "viewer/gl_objects.h"

namespace lfm {

/// An off-screen picture, 8-bit RGBA (values are stored as they are: no sRGB conversion) with a
/// 24-bit depth buffer and `samples` samples a pixel (bounded by what the driver offers).
class GlFramebuffer {
 public:
  /// Throws Error when the size is not in [1, the driver's limit], or the memory is not there.
  GlFramebuffer(int width, int height, int samples);

  int width() const { return width_; }
  int height() const { return height_; }
  /// Directs drawing here, over the whole picture.
  void Bind() const;
  /// Averages the samples of all pixels into `target`, of the same size.
  void ResolveInto(const GlFramebuffer& target) const;
  /// Copies the picture into framebuffer 0 (a window's) of the same size.
  void CopyToWindow() const;
  /// The picture, rows from the top; 8-bit sRGB, RGB or (4 channels) RGBA. Only of a framebuffer
  /// with one sample.
  Image Read(int channels = 3) const;

 private:
  int width_, height_, samples_;
  GlObject framebuffer_, color_, depth_;
};

}  // namespace lfm
