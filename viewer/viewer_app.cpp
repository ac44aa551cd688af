// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_app.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_renderer.h"
#include "viewer/viewer_panel.h"
#include "viewer/viewer_state.h"
#include "viewer/window.h"

namespace lfm {
namespace {

constexpr int kMaxScreenshots = 9999;

std::filesystem::path FreeScreenshotName() {
  for (int number = 1; number <= kMaxScreenshots; ++number) {
    char name[40];
    std::snprintf(name, sizeof(name), "lfm-viewer-%04d.png", number);
    if (!std::filesystem::exists(name)) return name;
  }
  throw Error("this folder is full of lfm-viewer-*.png; move them away");
}

/// The same picture twice: with many samples to draw into, and smoothed.
struct Canvas {
  Canvas(PictureSize size, int samples)
      : drawn(size.width, size.height, samples), smooth(size.width, size.height, 1) {}
  GlFramebuffer drawn, smooth;
};

void DrawModel(const GlRenderer& renderer, const ViewerState& state, const Canvas& canvas) {
  canvas.drawn.Bind();
  renderer.Draw(PinholeCamera(state.camera, canvas.drawn.width(), canvas.drawn.height()),
                CameraFromWorld(state.camera), MakeGlRenderOptions(state));
  canvas.drawn.ResolveInto(canvas.smooth);
}

ViewerState SaveInteractiveScreenshot(ViewerState state, const Canvas& canvas) {
  state.save_screenshot = false;
  try {
    const std::filesystem::path file = FreeScreenshotName();
    WriteImage(canvas.smooth.Read(), file);
    state.message = "saved " + file.string();
  } catch (const Error& error) {
    state.message = error.what();  // a full disk should not close the window
  }
  return state;
}

void RunScreenshot(Window& window, const GlRenderer& renderer, ViewerState state, PictureSize size,
                   const ViewerOptions& options) {
  const Canvas canvas(size, options.multisample);
  ViewerPanel panel(window);
  Image picture;
  for (int frame = 0; frame < options.frames; ++frame) {
    if (InterruptRequested()) throw Interrupted();
    state = panel.Update(std::move(state));
    DrawModel(renderer, state, canvas);
    if (!options.with_panel) picture = canvas.smooth.Read();
    canvas.smooth.Bind();
    panel.Draw();
    if (options.with_panel) picture = canvas.smooth.Read();
    window.SwapAndPoll();
  }
  WriteImage(picture, options.screenshot);
}

void RunInteractive(Window& window, const GlRenderer& renderer, ViewerState state,
                    const ViewerOptions& options) {
  ViewerPanel panel(window);
  std::unique_ptr<Canvas> canvas;
  while (!window.ShouldClose() && !state.quit) {
    if (InterruptRequested()) throw Interrupted();
    const PictureSize size = window.FramebufferSize();
    if (size.width < 1 || size.height < 1) {  // minimised
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      window.SwapAndPoll();
      continue;
    }
    if (!canvas || canvas->smooth.width() != size.width || canvas->smooth.height() != size.height) {
      canvas = std::make_unique<Canvas>(size, options.multisample);
    }
    state = panel.Update(std::move(state));
    DrawModel(renderer, state, *canvas);
    if (state.save_screenshot) state = SaveInteractiveScreenshot(std::move(state), *canvas);
    canvas->smooth.Bind();
    panel.Draw();
    canvas->smooth.CopyToWindow();
    window.SwapAndPoll();
  }
}

}  // namespace

void RunViewer(const LightFieldModel& model, const ViewOptions& view,
               const ViewerOptions& options) {
  const bool screenshot = !options.screenshot.empty();
  if (screenshot && std::filesystem::path(options.screenshot).extension() != ".png") {
    throw Error("cannot write " + options.screenshot + ": a screenshot's name must end in .png");
  }
  const PictureSize size = ParsePictureSize(view.size);
  ViewerState state = MakeViewerState(model, view);
  state.edges = options.wireframe ? EdgeOverlay::kWireframe : EdgeOverlay::kNone;
  state.view_coordinates = options.view_coordinates;
  Window window("lfm-viewer", size,
                screenshot ? WindowVisibility::kHidden : WindowVisibility::kShown);
  const GlRenderer renderer(model, options.block_use);
  if (screenshot) {
    RunScreenshot(window, renderer, std::move(state), size, options);
  } else {
    RunInteractive(window, renderer, std::move(state), options);
  }
}

}  // namespace lfm
