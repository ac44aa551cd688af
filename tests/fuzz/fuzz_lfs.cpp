// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>
#include <vector>

#include "core/hash.h"
#include "resample/light_field.h"
#include "resample/light_field_format.h"
#include "tests/fuzz/fuzz_one.h"

namespace lfm::testing {
namespace {

// Lengths and checksums as they ought to be, where a mutation has left room for them: without this
// nothing behind the first checksum would ever be read.
void Repair(std::vector<std::byte>& bytes) {
  lfs::FileHeader header;
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.file_bytes = bytes.size();
  uint64_t place = sizeof header;
  for (lfs::ChunkEntry& chunk : header.chunks) {
    chunk.offset = place;
    const bool last = &chunk == &header.chunks.back();
    if (last || chunk.bytes > bytes.size() - place) chunk.bytes = (bytes.size() - place) / 8 * 8;
    place += chunk.bytes;
  }
  const lfs::ChunkEntry& data = header.chunks[lfs::kData];
  const lfs::ChunkEntry& index = header.chunks[lfs::kIndex];
  for (uint64_t i = 0; i + sizeof(lfs::IndexEntry) <= index.bytes; i += sizeof(lfs::IndexEntry)) {
    lfs::IndexEntry entry;
    std::byte* at = bytes.data() + index.offset + i;
    std::memcpy(&entry, at, sizeof entry);
    if (entry.offset > data.bytes || entry.bytes > data.bytes - entry.offset) continue;
    entry.checksum = Checksum(bytes.data() + data.offset + entry.offset, entry.bytes);
    std::memcpy(at, &entry, sizeof entry);
  }
  for (int i = 0; i < lfs::kChunkCount; ++i) {
    lfs::ChunkEntry& chunk = header.chunks[i];
    if (i != lfs::kData) chunk.checksum = Checksum(bytes.data() + chunk.offset, chunk.bytes);
  }
  header.checksum = Checksum(&header, offsetof(lfs::FileHeader, checksum));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace

void FuzzOne(std::span<const uint8_t> input) {
  std::vector<std::byte> bytes(input.size());
  if (!input.empty()) std::memcpy(bytes.data(), input.data(), input.size());
  Repair(bytes);
  const LightField field = LightField::FromMemory(std::move(bytes), "light_field.lfs");
  LightField::WeightBuffer buffer;
  uint64_t sum = static_cast<uint64_t>(field.DenseBytes());
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    for (const uint16_t photo : patch.photos) sum += field.photo_ids()[photo].size();
    for (const uint16_t value : patch.values) sum += value;
    for (int corner = 0; corner < 3; ++corner) {
      const ViewWeights weights = field.Weights(t, corner, buffer);
      for (size_t i = 0; i < weights.view.size(); ++i) {
        if (weights.weight[i] != 0) sum += patch.photos[weights.view[i]];
      }
    }
  }
  volatile uint64_t used = sum;
  static_cast<void>(used);
}

}  // namespace lfm::testing
