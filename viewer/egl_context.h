// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace lfm {

/// An OpenGL 3.3 core context without a display, through EGL (surfaceless, else a device), current
/// on the thread that made it and until it is destroyed. Pictures are drawn into a GlFramebuffer.
/// Throws Error (kSystem) when the machine offers no such context.
class EglContext {
 public:
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
