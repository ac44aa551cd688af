// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

std::string GlfwProblem() {
  const char* description = nullptr;
  glfwGetError(&description);
  return description == nullptr ? "no reason given" : description;
}

}  // namespace

Window::Window(const std::string& title, PictureSize size, WindowVisibility visibility) {
  if (!glfwInit()) {
    throw Error("there is no display to open a window on (" + GlfwProblem() +
                    "); run under 'xvfb-run -a', or render pictures with lfm-render",
                ErrorKind::kSystem);
  }
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, 0);  // smoothing happens in a GlFramebuffer
  glfwWindowHint(GLFW_VISIBLE, visibility == WindowVisibility::kShown ? GLFW_TRUE : GLFW_FALSE);
  window_ = glfwCreateWindow(size.width, size.height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string problem = GlfwProblem();
    glfwTerminate();
    throw Error("no window with OpenGL 3.3 (" + problem +
                    "); install libgl1-mesa-dri or a newer driver, or use lfm-render",
                ErrorKind::kSystem);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(visibility == WindowVisibility::kShown ? 1 : 0);
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** files) {
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    self->dropped_.insert(self->dropped_.end(), files, files + count);
  });
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

PictureSize Window::FramebufferSize() const {
  PictureSize size;
  if (minimised_by_size_) return size;
  glfwGetFramebufferSize(window_, &size.width, &size.height);
  return size;
}

float Window::ContentScale() const {
  float scale = 1, other = 1;
  glfwGetWindowContentScale(window_, &scale, &other);
  PictureSize pixels, units;
  glfwGetFramebufferSize(window_, &pixels.width, &pixels.height);
  glfwGetWindowSize(window_, &units.width, &units.height);
  if (units.width > 0 && pixels.width > 0) {
    scale *= static_cast<float>(units.width) / static_cast<float>(pixels.width);
  }
  return std::clamp(scale, 1.0f, 4.0f);
}

void Window::Resize(PictureSize size) {
  // Window systems have no windows without any pixel, only hidden ones.
  minimised_by_size_ = size.width < 1 || size.height < 1;
  if (!minimised_by_size_) glfwSetWindowSize(window_, size.width, size.height);
}

bool Window::ShouldClose() const { return glfwWindowShouldClose(window_) != 0; }

void Window::SwapAndPoll() {
  glfwSwapBuffers(window_);
  glfwPollEvents();
}

void Window::WaitForEvents(double seconds) { glfwWaitEventsTimeout(seconds); }

std::vector<std::filesystem::path> Window::TakeDropped() { return std::exchange(dropped_, {}); }

}  // namespace lfm
