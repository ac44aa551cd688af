// SPDX-License-Identifier: BSD-3-Clause
#include "resample/triangle_views.h"

#include <algorithm>
#include <type_traits>

namespace lfm {
namespace {

static_assert(std::is_trivially_copyable_v<VisibleTriangle>);
constexpr size_t kBufferBytes = size_t{32} << 20, kLeastPart = 64, kMostPart = 4096;

}  // namespace

void VisibleLists::Put(size_t photo, const std::vector<VisibleTriangle>& triangles) {
  const uint64_t offset =
      file_->Append(triangles.data(), triangles.size() * sizeof(VisibleTriangle));
  lists_[photo] = {offset, triangles.size()};
}

TriangleViewsReader::TriangleViewsReader(const VisibleLists& lists)
    : lists_(lists),
      places_(lists.lists_.size()),
      part_size_(std::clamp(
          kBufferBytes / sizeof(VisibleTriangle) / std::max<size_t>(1, lists.lists_.size()),
          kLeastPart, kMostPart)) {}

int64_t TriangleViewsReader::BufferBytes() const {
  return static_cast<int64_t>(places_.size() * part_size_ * sizeof(VisibleTriangle));
}

const VisibleTriangle* TriangleViewsReader::Peek(size_t photo) {
  Place& place = places_[photo];
  if (place.next < place.part.size()) return &place.part[place.next];
  const VisibleLists::List& list = lists_.lists_[photo];
  place.part.resize(std::min<uint64_t>(part_size_, list.count - place.read));
  if (place.part.empty()) return nullptr;
  lists_.file_->Read(list.offset + place.read * sizeof(VisibleTriangle), place.part.data(),
                     place.part.size() * sizeof(VisibleTriangle));
  place.read += place.part.size();
  place.next = 0;
  return place.part.data();
}

std::vector<TriangleViews> TriangleViewsReader::Next(int count) {
  std::vector<TriangleViews> views(static_cast<size_t>(count));
  for (size_t p = 0; p < places_.size(); ++p) {
    for (const VisibleTriangle* visible = Peek(p);
         visible != nullptr && visible->triangle < begin_ + count; visible = Peek(p)) {
      TriangleViews& of_triangle = views[static_cast<size_t>(visible->triangle - begin_)];
      of_triangle.photos.push_back(static_cast<uint16_t>(p));
      of_triangle.hidden_beyond_mm.push_back(visible->hidden_beyond_mm);
      of_triangle.largest_px = std::max(of_triangle.largest_px, visible->area_px);
      ++places_[p].next;
    }
  }
  begin_ += count;
  return views;
}

}  // namespace lfm
