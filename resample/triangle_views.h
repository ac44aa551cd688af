// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/scratch_file.h"
#include "resample/visibility.h"

namespace lfm {

/// The photographs that show one triangle, and its area in the one where it is largest.
struct TriangleViews {
  std::vector<uint16_t> photos;          ///< ascending
  std::vector<double> hidden_beyond_mm;  ///< as `photos`: of VisibleTriangle
  double largest_px = 0;                 ///< what is hidden not counted
};

/// What every photograph shows, put aside on disk (24 bytes a triangle and photograph): photographs
/// are looked at one after the other, triangles resampled one after the other.
class VisibleLists {
 public:
  VisibleLists(const std::filesystem::path& result, size_t photo_count)
      : file_(std::make_unique<ScratchFile>(result)), lists_(photo_count) {}

  /// The triangles of one photograph, ascending. From any thread, once a photograph.
  void Put(size_t photo, const std::vector<VisibleTriangle>& triangles);

 private:
  friend class TriangleViewsReader;
  struct List {
    uint64_t offset = 0, count = 0;
  };
  std::unique_ptr<ScratchFile> file_;
  std::vector<List> lists_;
};

/// Goes through the triangles of a mesh once, in their order. Holds a part of each photograph's
/// list, 32 MiB in all (more beyond 20 000 photographs: 1.5 kB each). `lists` must outlive it.
class TriangleViewsReader {
 public:
  explicit TriangleViewsReader(const VisibleLists& lists);
  /// The views of the next `count` triangles.
  std::vector<TriangleViews> Next(int count);
  /// Of the parts held, at most.
  int64_t BufferBytes() const;

 private:
  struct Place {
    std::vector<VisibleTriangle> part;
    size_t next = 0;    ///< in `part`
    uint64_t read = 0;  ///< of the list, `part` included
  };
  const VisibleTriangle* Peek(size_t photo);

  const VisibleLists& lists_;
  std::vector<Place> places_;
  size_t part_size_;
  int begin_ = 0;
};

}  // namespace lfm
