// SPDX-License-Identifier: BSD-3-Clause
#include "resample/resample_pictures.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace lfm {
namespace {

constexpr uint8_t kGray = 96;

/// Draws one view with its top-left corner at (left, top).
void DrawView(const TrianglePatch& patch, size_t view, int left, int top, int scale, Image& sheet) {
  const int n = patch.edge_samples;
  for (int y = 0; y < n * scale; ++y) {
    for (int x = 0; x < n * scale; ++x) {
      const int i = x / scale, j = y / scale;
      if (i + j >= n) continue;
      const auto sample = static_cast<size_t>(PatchSampleIndex(n, i, j));
      for (size_t c = 0; c < 3; ++c) {
        const double value =
            static_cast<double>(patch.values[(sample * 3 + c) * patch.photos.size() + view]) /
            LightField::kOne;
        sheet.At<uint8_t>(left + x, top + y, static_cast<int>(c)) =
            static_cast<uint8_t>(std::lround(255 * std::min(1.0, value)));
      }
    }
  }
}

}  // namespace

std::vector<float> CoverageValues(const LightField& light_field) {
  const TriangleMesh& mesh = light_field.mesh();
  std::vector<float> sums(mesh.vertices.size(), 0.0F), counts(mesh.vertices.size(), 0.0F);
  for (int t = 0; t < light_field.triangle_count(); ++t) {
    const auto views = static_cast<float>(light_field.Patch(t).photos.size());
    for (const int vertex : mesh.triangles[static_cast<size_t>(t)]) {
      sums[static_cast<size_t>(vertex)] += views;
      counts[static_cast<size_t>(vertex)] += 1;
    }
  }
  for (size_t v = 0; v < sums.size(); ++v) sums[v] /= std::max(1.0F, counts[v]);
  return sums;
}

Image PatchContactSheet(const LightField& light_field, int triangle, int view_px) {
  if (triangle < 0 || triangle >= light_field.triangle_count()) {
    throw Error("contact sheet: there is no triangle " + std::to_string(triangle) +
                "; the mesh has " + std::to_string(light_field.triangle_count()));
  }
  if (view_px < 1 || view_px > 512) {
    throw Error("contact sheet: a view must have 1 to 512 pixels");
  }
  const TrianglePatch patch = light_field.Patch(triangle);
  const int views = std::max<int>(1, static_cast<int>(patch.photos.size()));
  const int scale = std::max(1, view_px / patch.edge_samples);
  constexpr int kGap = 4;
  const int tile = patch.edge_samples * scale + kGap;
  const int columns = static_cast<int>(std::ceil(std::sqrt(views)));
  const int rows = (views + columns - 1) / columns;
  Image sheet(columns * tile + kGap, rows * tile + kGap, 3, PixelType::kUint8,
              ColorEncoding::kSrgb);
  std::fill_n(sheet.Data<uint8_t>(), sheet.size(), kGray);
  for (size_t v = 0; v < patch.photos.size(); ++v) {
    const int index = static_cast<int>(v);
    DrawView(patch, v, kGap + index % columns * tile, kGap + index / columns * tile, scale, sheet);
  }
  return sheet;
}

}  // namespace lfm
