// SPDX-License-Identifier: BSD-3-Clause
#include "core/transport_matrix.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"

namespace lfm {
namespace {

static_assert(std::endian::native == std::endian::little,
              "transport matrix files are little-endian and read in place");

constexpr std::array<char, 8> kMagic = {'L', 'F', 'M', 'T', 'R', 'M', '\r', '\n'};
constexpr uint32_t kVersion = 1;
constexpr int kMaxCubeResolution = 1024;
constexpr int64_t kMaxRows = int64_t{1} << 36;
constexpr float kLargestHalf = 65504;

struct FileHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t value;
  uint32_t channels;
  uint32_t cube_resolution;
  uint64_t points;
  uint64_t views;
  uint64_t block_rows;
  uint64_t file_bytes;
  uint64_t checksum;  // of everything before it
};
static_assert(sizeof(FileHeader) == 64);

// Where things lie in a file. Blocks are padded, so that each begins at a multiple of 8.
struct FileLayout {
  int64_t row_bytes = 0, blocks = 0, block_stride = 0, table_offset = 0, file_bytes = 0;
};

int64_t ValueBytes(TransportValue value) { return value == TransportValue::kFloat16 ? 2 : 4; }

int64_t Padded(int64_t bytes) { return (bytes + 7) / 8 * 8; }

// Limits keep every product far below 2^63: rows 2^36, row bytes 2^27.
FileLayout MakeLayout(const TransportShape& shape, int64_t block_rows) {
  FileLayout layout;
  layout.row_bytes = shape.row_values() * ValueBytes(shape.value);
  layout.blocks = (shape.rows() + block_rows - 1) / block_rows;
  layout.block_stride = Padded(block_rows * layout.row_bytes);
  const int64_t last_rows = shape.rows() - (layout.blocks - 1) * block_rows;
  layout.table_offset = static_cast<int64_t>(sizeof(FileHeader)) +
                        (layout.blocks - 1) * layout.block_stride +
                        Padded(last_rows * layout.row_bytes);
  // A checksum a block, then one of these.
  layout.file_bytes = layout.table_offset + 8 * (layout.blocks + 1);
  return layout;
}

// Why a shape is none; empty when it is one.
std::string ShapeProblem(const TransportShape& shape) {
  if (shape.channels != 1 && shape.channels != 3) {
    return std::to_string(shape.channels) + " channels; it must be 1 or 3";
  }
  if (shape.cube_resolution < 1 || shape.cube_resolution > kMaxCubeResolution) {
    return "a cube map of " + std::to_string(shape.cube_resolution) +
           " texels a side; it must be 1 to 1024";
  }
  if (shape.points < 1 || shape.views < 1 || shape.points > kMaxRows ||
      shape.views > kMaxRows / shape.points) {
    return std::to_string(shape.points) + " points x " + std::to_string(shape.views) +
           " views; both must be positive and their product at most 2^36";
  }
  if (shape.value != TransportValue::kFloat16 && shape.value != TransportValue::kFloat32) {
    return "values that are neither float16 nor float32";
  }
  return "";
}

// One block's bytes of `values`, padded.
std::vector<char> EncodeBlock(std::span<const float> values, const TransportShape& shape,
                              int64_t first_row, const std::string& name) {
  const bool half = shape.value == TransportValue::kFloat16;
  std::vector<char> bytes(
      static_cast<size_t>(Padded(static_cast<int64_t>(values.size()) * ValueBytes(shape.value))));
  const float limit = half ? kLargestHalf : std::numeric_limits<float>::max();
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i]) <= limit)) {
      const int64_t row = first_row + static_cast<int64_t>(i) / shape.row_values();
      throw Error(name + ": the value " + std::to_string(values[i]) + " in row " +
                  std::to_string(row) + " of the transport matrix is not finite, or too large" +
                  (half ? " for float16; write float32" : ""));
    }
    if (half) {
      const Eigen::half coded(values[i]);
      std::memcpy(bytes.data() + 2 * i, &coded, 2);
    }
  }
  if (!half) std::memcpy(bytes.data(), values.data(), 4 * values.size());
  return bytes;
}

}  // namespace

void WriteTransportMatrix(const TransportShape& shape, const TransportRowFiller& fill,
                          const std::filesystem::path& file, int64_t block_bytes) {
  const std::string name = file.string();
  const std::string problem = ShapeProblem(shape);
  if (!problem.empty()) throw Error(name + ": the transport matrix has " + problem);
  const int64_t row_bytes = shape.row_values() * ValueBytes(shape.value);
  const int64_t block_rows = std::clamp<int64_t>(block_bytes / row_bytes, 1, shape.rows());
  const FileLayout layout = MakeLayout(shape, block_rows);
  FileHeader header = {};
  header.magic = kMagic;
  header.version = kVersion;
  header.value = static_cast<uint32_t>(shape.value);
  header.channels = static_cast<uint32_t>(shape.channels);
  header.cube_resolution = static_cast<uint32_t>(shape.cube_resolution);
  header.points = static_cast<uint64_t>(shape.points);
  header.views = static_cast<uint64_t>(shape.views);
  header.block_rows = static_cast<uint64_t>(block_rows);
  header.file_bytes = static_cast<uint64_t>(layout.file_bytes);
  header.checksum = Checksum(&header, offsetof(FileHeader, checksum));

  WriteFileAtomically(file, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    const auto put = [&](const void* data, size_t size) {
      stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
      if (!stream) {
        throw Error(name + ": cannot be written; is the disk full?", ErrorKind::kSystem);
      }
    };
    put(&header, sizeof(header));
    std::vector<uint64_t> table;
    std::vector<float> values;
    for (int64_t first = 0; first < shape.rows(); first += block_rows) {
      const int64_t count = std::min(block_rows, shape.rows() - first);
      values.assign(static_cast<size_t>(count * shape.row_values()), 0.0f);
      fill(first, count, values);
      const std::vector<char> bytes = EncodeBlock(values, shape, first, name);
      table.push_back(Checksum(bytes.data(), bytes.size()));
      put(bytes.data(), bytes.size());
    }
    table.push_back(Checksum(table.data(), 8 * table.size()));
    put(table.data(), 8 * table.size());
    stream.close();
    if (!stream) throw Error(name + ": cannot be written; is the disk full?", ErrorKind::kSystem);
  });
}

TransportMatrix::TransportMatrix(const std::filesystem::path& file) : file_(file), mapped_(file) {
  const std::string name = file.string();
  const std::span<const std::byte> bytes = mapped_.bytes();
  FileHeader header = {};
  if (bytes.size() >= kMagic.size() && std::memcmp(bytes.data(), kMagic.data(), 8) != 0) {
    throw Error(name + ": is not a transport matrix");
  }
  if (bytes.size() < sizeof(header)) {
    throw Error(name + ": the file is cut short; copy or render it again");
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.version != kVersion) {
    throw Error(name + ": is a transport matrix of version " + std::to_string(header.version) +
                "; this program reads version 1");
  }
  if (header.checksum != Checksum(&header, offsetof(FileHeader, checksum))) {
    throw Error(name + ": the header is damaged; copy or render the file again");
  }
  constexpr uint64_t kLimit = kMaxRows;
  shape_.points = static_cast<int64_t>(std::min(header.points, kLimit + 1));
  shape_.views = static_cast<int64_t>(std::min(header.views, kLimit + 1));
  shape_.cube_resolution = static_cast<int>(std::min(header.cube_resolution, 1u << 20));
  shape_.channels = static_cast<int>(std::min(header.channels, 1u << 20));
  shape_.value = static_cast<TransportValue>(header.value);
  const std::string problem = ShapeProblem(shape_);
  if (!problem.empty()) throw Error(name + ": the header says " + problem);
  if (header.block_rows < 1 || header.block_rows > static_cast<uint64_t>(shape_.rows())) {
    throw Error(name + ": the header says " + std::to_string(header.block_rows) +
                " rows a block; it must be 1 to the number of rows");
  }
  block_rows_ = static_cast<int64_t>(header.block_rows);
  const FileLayout layout = MakeLayout(shape_, block_rows_);
  if (header.file_bytes != static_cast<uint64_t>(layout.file_bytes)) {
    throw Error(name + ": the header's sizes contradict each other");
  }
  if (bytes.size() != header.file_bytes) {
    throw Error(name + ": the file has " + std::to_string(bytes.size()) +
                " bytes but should have " + std::to_string(header.file_bytes) +
                "; copy or render it again");
  }
  row_bytes_ = layout.row_bytes;
  blocks_ = layout.blocks;
  const std::byte* table = bytes.data() + layout.table_offset;
  uint64_t expected = 0;
  std::memcpy(&expected, table + 8 * blocks_, 8);
  if (expected != Checksum(table, static_cast<size_t>(8 * blocks_))) {
    throw Error(name + ": the table of checksums is damaged; copy or render the file again");
  }
  checked_ = std::make_unique<std::atomic<uint8_t>[]>(static_cast<size_t>(blocks_));
}

void TransportMatrix::CheckBlock(int64_t block) const {
  if (checked_[static_cast<size_t>(block)].load(std::memory_order_relaxed) != 0) return;
  const FileLayout layout = MakeLayout(shape_, block_rows_);
  const int64_t offset = static_cast<int64_t>(sizeof(FileHeader)) + block * layout.block_stride;
  const int64_t end = std::min(offset + layout.block_stride, layout.table_offset);
  uint64_t expected = 0;
  std::memcpy(&expected, mapped_.bytes().data() + layout.table_offset + 8 * block, 8);
  if (expected != Checksum(mapped_.bytes().data() + offset, static_cast<size_t>(end - offset))) {
    throw Error(file_.string() + ": rows " + std::to_string(block * block_rows_) +
                " and after are " + "damaged; copy or render the file again");
  }
  checked_[static_cast<size_t>(block)].store(1, std::memory_order_relaxed);
}

std::vector<float> TransportMatrix::ReadRows(int64_t first, int64_t count) const {
  if (first < 0 || count < 0 || first > shape_.rows() || count > shape_.rows() - first) {
    throw Error(file_.string() + ": has no " + std::to_string(count) + " rows from row " +
                std::to_string(first) + " on; it has " + std::to_string(shape_.rows()));
  }
  const FileLayout layout = MakeLayout(shape_, block_rows_);
  const int64_t row_values = shape_.row_values();
  std::vector<float> values(static_cast<size_t>(count * row_values));
  for (int64_t row = first; row < first + count; ++row) {
    const int64_t block = row / block_rows_;
    CheckBlock(block);
    const std::byte* in = mapped_.bytes().data() + sizeof(FileHeader) +
                          block * layout.block_stride + (row % block_rows_) * row_bytes_;
    float* out = values.data() + (row - first) * row_values;
    if (shape_.value == TransportValue::kFloat32) {
      std::memcpy(out, in, static_cast<size_t>(row_bytes_));
      continue;
    }
    for (int64_t i = 0; i < row_values; ++i) {
      Eigen::half coded;
      std::memcpy(&coded, in + 2 * i, 2);
      out[i] = static_cast<float>(coded);
    }
  }
  return values;
}

}  // namespace lfm
