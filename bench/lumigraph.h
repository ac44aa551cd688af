// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "calib/calib.h"
#include "core/capture.h"
#include "core/image.h"
#include "core/triangle_mesh.h"

namespace lfm {

/// The unstructured lumigraph of Buehler et al. 2001 on a mesh that is known, from the train
/// photographs of a capture: the peer of a surface light field that keeps every photograph.
///
/// A point takes its colour from the photographs that see it, by the penalty
///   p_i = angle(d, d_i) + 0.05 max(0, footprint_i / footprint - 1)
/// (d, d_i: directions to the eye and to photograph i; footprint: distance / (focal length x cosine
/// to the normal)) with weights (1 - p_i / p_k) / p_i, p_k that of the k-th nearest (Section 3), so
/// that k = 5 blends four. k = 1 is the nearest alone, k = 0 the mean of all. Colours are
/// bilinear and blended as sRGB-coded values. A photograph sees a point when the dense surface does
/// not hide it there, at less than 85 degrees, and the four pixels keep the margin of lfm-resample
/// to depth edges (photographs that do not keep it serve points that have no others).
class Lumigraph {
 public:
  /// Reads all train photographs. `mesh` carries the colours, `surface` decides what is seen.
  Lumigraph(const Capture& capture, const CalibResult& calib, const TriangleMesh& surface,
            const TriangleMesh& mesh);
  ~Lumigraph();
  /// Four rays a pixel, averaged in linear light over those that meet the mesh, as
  /// RenderPhotoCamera (pipeline/heldout.h) does.
  /// One picture for every k in `neighbors`.
  std::vector<Image> Render(const Camera& camera, const Pose& camera_from_world,
                            const std::vector<int>& neighbors) const;
  /// Of the files of the photographs that are used.
  int64_t PhotoBytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
