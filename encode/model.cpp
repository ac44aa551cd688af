// SPDX-License-Identifier: BSD-3-Clause
#include "encode/model.h"

namespace lfm {
namespace {

int64_t PageBytes(const std::vector<Image>& pages) {
  int64_t bytes = 0;
  for (const Image& page : pages) bytes += static_cast<int64_t>(page.Bytes().size());
  return bytes;
}

}  // namespace

int64_t LightFieldModel::MapsBytes() const {
  int64_t bytes = PageBytes(mean_pages);
  for (const auto& pages : surface_pages) bytes += PageBytes(pages);
  for (const auto& pages : view_pages) bytes += PageBytes(pages);
  const size_t ranges = surface_ranges.size() + view_ranges.size();
  return bytes + static_cast<int64_t>(ranges * sizeof(MapRange));
}

}  // namespace lfm
