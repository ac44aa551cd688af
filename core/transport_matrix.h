// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/mapped_file.h"

namespace lfm {

/// How a transport matrix's numbers are stored.
enum class TransportValue : uint32_t { kFloat16 = 0, kFloat32 = 1 };

/// The size of a dense light transport matrix T (Mahajan 2007, Section 2): radiance = T light.
/// A row belongs to one point (pixel or vertex) seen in one view: row = view * points + point. A
/// column belongs to one texel of a cube map: column = (face * N + y) * N + x, N the resolution.
struct TransportShape {
  int64_t points = 0;
  int64_t views = 1;
  int cube_resolution = 0;  ///< N, 1 to 1024
  int channels = 1;         ///< 1 (gray) or 3 (RGB)
  TransportValue value = TransportValue::kFloat16;

  int64_t rows() const { return points * views; }
  int64_t columns() const { return int64_t{6} * cube_resolution * cube_resolution; }
  /// Numbers of a row: all columns of the first channel, then of the next.
  int64_t row_values() const { return channels * columns(); }
  bool operator==(const TransportShape&) const = default;
};

/// Fills rows [first, first + count): values[(row - first) * row_values + channel * columns +
/// column]. The span arrives zeroed.
using TransportRowFiller =
    std::function<void(int64_t first, int64_t count, std::span<float> values)>;

/// Writes a matrix file (docs/formats.md), asking `fill` for one block of rows after the other, in
/// order; about `block_bytes` of the file are held at a time, one row at least. The file appears
/// under its name when it is whole. Throws Error when the shape is out of range, a value is not
/// finite or too large for float16 (beyond 65504; smaller than 6e-8 becomes 0), the disk is full,
/// and passes on what `fill` throws.
void WriteTransportMatrix(const TransportShape& shape, const TransportRowFiller& fill,
                          const std::filesystem::path& file,
                          int64_t block_bytes = int64_t{1} << 22);

/// A matrix file, mapped into memory; blocks are checked against their checksums when they are
/// first read. Immutable to its users: usable from many threads.
class TransportMatrix {
 public:
  /// Throws Error when the file is missing, of another kind or version, cut short, longer than it
  /// says, or its header or table of checksums is damaged. Takes one byte a block, whatever the
  /// header promises.
  explicit TransportMatrix(const std::filesystem::path& file);

  const TransportShape& shape() const { return shape_; }
  /// Rows [first, first + count) as float32, count x row_values. Throws Error when the range leaves
  /// the matrix or a block that it touches is damaged.
  std::vector<float> ReadRows(int64_t first, int64_t count) const;

 private:
  void CheckBlock(int64_t block) const;

  std::filesystem::path file_;
  MappedFile mapped_;
  TransportShape shape_;
  int64_t block_rows_ = 0, blocks_ = 0, row_bytes_ = 0;
  std::unique_ptr<std::atomic<uint8_t>[]> checked_;  // a block: 1 once its checksum was right
};

}  // namespace lfm
