// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viewer/view_options.h"

struct GLFWwindow;

namespace lfm {

enum class WindowVisibility { kShown, kHidden };

/// A window with an OpenGL 3.3 core context, current on this thread, through GLFW. One at a time,
/// on the main thread. Throws Error (kSystem), with the cure, when there is no display or no such
/// context.
class Window {
 public:
  Window(const std::string& title, PictureSize size, WindowVisibility visibility);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }
  /// In pixels; 0x0 while minimised.
  PictureSize FramebufferSize() const;
  /// True when the user asked to close the window.
  bool ShouldClose() const;
  /// Shows what was drawn, and collects what the user did.
  void SwapAndPoll();

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace lfm
