// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace lfm {

/// The bytes of `light_field.lfs` (docs/formats.md), shared by its writer and its reader. Every
/// chunk begins at a multiple of 8; nothing lies between chunks, so that each byte of the file is
/// covered by a checksum.
namespace lfs {

static_assert(std::endian::native == std::endian::little,
              "light field files are little-endian and read in place");

constexpr std::array<char, 8> kMagic = {'L', 'F', 'M', 'L', 'F', 'S', '\r', '\n'};
constexpr uint32_t kVersion = 1;

/// Order of the chunks in the file and in its table.
enum Chunk : int { kMesh, kPhotos, kData, kIndex, kChunkCount };
constexpr std::array<uint32_t, kChunkCount> kTags = {0x4853454d, 0x544f4850, 0x41544144,
                                                     0x58444e49};  // MESH PHOT DATA INDX

struct ChunkEntry {
  uint32_t tag;
  uint32_t reserved;  ///< 0
  uint64_t offset;    ///< from the start of the file
  uint64_t bytes;
  uint64_t checksum;  ///< of the chunk; 0 for DATA, whose records have their own in INDX
};

struct FileHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t grid;
  uint32_t direction_map;
  uint32_t reserved;  ///< 0
  uint64_t file_bytes;
  std::array<ChunkEntry, kChunkCount> chunks;
  uint64_t checksum;  ///< of everything before it
};
static_assert(sizeof(FileHeader) == 168);

/// Start of the MESH chunk; vertices, triangles, normals, frames, confidence and colours follow.
struct MeshHeader {
  uint64_t vertices;
  uint64_t triangles;
  uint32_t has_confidence;
  uint32_t has_colors;
};

/// One triangle of INDX. Its record in DATA holds the photo numbers, the values, and the encoded
/// weights of the three corners, each padded to 8 bytes; it is empty when nobody sees the triangle.
struct IndexEntry {
  uint64_t offset;  ///< from the start of DATA; records lie end to end in order
  uint64_t bytes;
  uint64_t checksum;
  uint32_t edge_samples;
  uint32_t views;
};

constexpr uint64_t Padded(uint64_t bytes) { return (bytes + 7) / 8 * 8; }

constexpr uint64_t ValueCount(uint64_t edge_samples, uint64_t views) {
  return edge_samples * (edge_samples + 1) / 2 * 3 * views;
}

}  // namespace lfs
}  // namespace lfm
