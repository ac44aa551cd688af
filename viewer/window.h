// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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
  /// How much larger than on an ordinary screen letters have to be, in the units of the pointer:
  /// 2 on screens of high density where those are pixels, 1 where they are not.
  float ContentScale() const;
  /// In the units of the pointer; 0 stands for minimised.
  void Resize(PictureSize size);
  /// True when the user asked to close the window.
  bool ShouldClose() const;
  /// Shows what was drawn, and collects what the user did.
  void SwapAndPoll();
  /// Sleeps until the user does something, this many seconds at most.
  void WaitForEvents(double seconds);
  /// Files that were dropped on the window since the last call.
  std::vector<std::filesystem::path> TakeDropped();

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<std::filesystem::path> dropped_;
  bool minimised_by_size_ = false;
};

}  // namespace lfm
