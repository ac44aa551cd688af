// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/image.h"
#include "viewer/gl_objects.h"

namespace lfm {

/// A rectangle of a window, pixels from its upper left corner.
struct PixelRectangle {
  double x = 0, y = 0, width = 0, height = 0;
};

/// The largest rectangle of shape width : height in the middle of `frame`.
PixelRectangle FitInto(const PixelRectangle& frame, int width, int height);

/// A picture on the graphics card. Needs a current context, the same one for its whole life.
class GlPicture {
 public:
  /// Throws Error when it is not 8-bit RGB or larger than the driver takes.
  explicit GlPicture(const Image& image);
  int width() const { return width_; }
  int height() const { return height_; }
  /// Draws it over `place` of the bound framebuffer, whose viewport is width x height pixels.
  void DrawInto(const PixelRectangle& place, int width, int height) const;

 private:
  int width_, height_;
  GlObject program_, array_, texture_;
};

}  // namespace lfm
