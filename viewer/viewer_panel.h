// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewer/viewer_state.h"
#include "viewer/window.h"

namespace lfm {

/// The viewer's controls (Dear ImGui) over a window: mouse, keys and the panel of sliders. One at a
/// time; lives no longer than its window.
class ViewerPanel {
 public:
  explicit ViewerPanel(const Window& window);
  ~ViewerPanel();
  ViewerPanel(const ViewerPanel&) = delete;
  ViewerPanel& operator=(const ViewerPanel&) = delete;

  /// Begins a frame: what the user did since the last one, applied to `state`, and the panel laid
  /// out. Call once a frame, before Draw.
  ViewerState Update(ViewerState state);
  /// Draws the panel into the bound framebuffer.
  void Draw();
};

}  // namespace lfm
