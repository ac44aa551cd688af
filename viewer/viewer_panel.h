// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "viewer/viewer_input.h"
#include "viewer/viewer_state.h"
#include "viewer/viewer_status.h"
#include "viewer/window.h"

namespace lfm {

/// The viewer's controls (Dear ImGui) over a window: mouse, keys, the panel of sliders, and what
/// there is to say about reading and faults. One at a time; lives no longer than its window.
class ViewerPanel {
 public:
  /// `scale`: of letters and buttons.
  ViewerPanel(const Window& window, double scale);
  ~ViewerPanel();
  ViewerPanel(const ViewerPanel&) = delete;
  ViewerPanel& operator=(const ViewerPanel&) = delete;

  /// Begins a frame: what the user (or `script` in the user's place) did since the last one,
  /// applied to `state`, and the panel laid out. Call once a frame, before Draw.
  ViewerState Update(ViewerState state, const ViewerStatus& status,
                     const std::optional<ScriptedInput>& script);
  /// Draws the panel into the bound framebuffer.
  void Draw();
  /// How much of the window's width the panel takes at its left, [0, 1].
  double CoveredShare() const { return covered_share_; }

 private:
  float scale_;
  double covered_share_ = 0;
};

}  // namespace lfm
