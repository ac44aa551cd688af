// SPDX-License-Identifier: BSD-3-Clause
#include "resample/light_field_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "resample/light_field_format.h"
#include "resample/weight_codec.h"

namespace lfm {
namespace {

using Bytes = std::span<const std::byte>;

[[noreturn]] void Fail(const std::string& name, const std::string& problem) {
  throw Error(name + ": " + problem + "; run lfm-resample again");
}

/// Reads fields one after the other; never beyond the end.
class Cursor {
 public:
  Cursor(Bytes bytes, const std::string& name, const PartRead& part_read = {})
      : bytes_(bytes), name_(name), part_read_(part_read) {}

  Bytes Take(uint64_t count) {
    if (count > bytes_.size()) Fail(name_, "light field file is truncated");
    const Bytes taken = bytes_.first(static_cast<size_t>(count));
    bytes_ = bytes_.subspan(static_cast<size_t>(count));
    return taken;
  }
  template <typename T>
  T Read() {
    T value;
    std::memcpy(&value, Take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  /// `count` values of type T, each made of numbers without padding.
  template <typename T>
  std::vector<T> ReadArray(uint64_t count) {
    if (count > bytes_.size() / sizeof(T)) Fail(name_, "light field file is truncated");
    const Bytes taken = Take(count * sizeof(T));
    std::vector<T> values(static_cast<size_t>(count));
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), taken.data(), taken.size());
    if (part_read_) part_read_(taken);
    return values;
  }
  Bytes rest() const { return bytes_; }

 private:
  Bytes bytes_;
  const std::string& name_;
  PartRead part_read_;
};

lfs::FileHeader ReadHeader(Bytes bytes, const std::string& name) {
  lfs::FileHeader header;
  if (bytes.size() < sizeof(header)) Fail(name, "light field file is truncated");
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.magic != lfs::kMagic) Fail(name, "is not a light field file");
  if (header.version != lfs::kVersion) {
    Fail(name, "has version " + std::to_string(header.version) + ", this program reads version " +
                   std::to_string(lfs::kVersion));
  }
  if (header.checksum != Checksum(&header, offsetof(lfs::FileHeader, checksum))) {
    Fail(name, "light field header is damaged");
  }
  if (header.file_bytes > bytes.size()) Fail(name, "light field file is truncated");
  if (header.file_bytes < bytes.size()) Fail(name, "light field file is longer than it says");
  if (header.grid < 2 || header.grid > 256 || header.direction_map > 2) {
    Fail(name, "light field header is out of range");
  }
  return header;
}

/// The four chunks, which must follow each other to the very end of the file.
std::array<Bytes, lfs::kChunkCount> SplitChunks(const lfs::FileHeader& header, Bytes bytes,
                                                const std::string& name,
                                                const PartRead& part_read) {
  std::array<Bytes, lfs::kChunkCount> chunks;
  uint64_t place = sizeof(lfs::FileHeader);
  for (size_t i = 0; i < chunks.size(); ++i) {
    const lfs::ChunkEntry& entry = header.chunks[i];
    const bool fits = entry.tag == lfs::kTags[i] && entry.offset == place && entry.bytes % 8 == 0 &&
                      entry.bytes <= bytes.size() - place;
    if (!fits) Fail(name, "light field chunks do not fit together");
    chunks[i] = bytes.subspan(static_cast<size_t>(place), static_cast<size_t>(entry.bytes));
    place += entry.bytes;
    if (i != lfs::kData && entry.checksum != Checksum(chunks[i].data(), chunks[i].size())) {
      Fail(name, "light field content is damaged (checksum)");
    }
    if (i != lfs::kData) part_read(chunks[i]);
  }
  if (place != bytes.size()) Fail(name, "light field chunks do not fit together");
  return chunks;
}

void ReadMesh(Bytes chunk, const std::string& name, const PartRead& part_read,
              LightFieldContent& content) {
  Cursor cursor(chunk, name, part_read);
  const auto header = cursor.Read<lfs::MeshHeader>();
  TriangleMesh& mesh = content.mesh;
  mesh.vertices = cursor.ReadArray<Eigen::Vector3d>(header.vertices);
  mesh.normals = cursor.ReadArray<Eigen::Vector3d>(header.vertices);
  content.vertex_frames = cursor.ReadArray<Eigen::Matrix3d>(header.vertices);
  mesh.triangles = cursor.ReadArray<Eigen::Vector3i>(header.triangles);
  if (header.has_confidence != 0) mesh.confidence = cursor.ReadArray<float>(header.vertices);
  if (header.has_colors != 0) mesh.colors = cursor.ReadArray<Eigen::Vector3f>(header.vertices);
  if (cursor.rest().size() >= 8) Fail(name, "light field mesh has a wrong length");
  try {
    ValidateMesh(mesh, name.c_str());
  } catch (const Error& error) {
    throw Error(std::string(error.what()) + "; run lfm-resample again");
  }
  const bool finite = std::all_of(mesh.normals.begin(), mesh.normals.end(),
                                  [](const auto& n) { return n.allFinite(); }) &&
                      std::all_of(content.vertex_frames.begin(), content.vertex_frames.end(),
                                  [](const auto& f) { return f.allFinite(); });
  if (!finite) Fail(name, "light field has vertex frames that are not finite");
}

void ReadPhotoIds(Bytes chunk, const std::string& name, LightFieldContent& content) {
  Cursor cursor(chunk, name);
  const auto count = cursor.Read<uint32_t>();
  if (count > 65535) Fail(name, "light field has too many photographs");
  for (uint32_t i = 0; i < count; ++i) {
    const Bytes text = cursor.Take(cursor.Read<uint32_t>());
    content.photo_ids.emplace_back(reinterpret_cast<const char*>(text.data()), text.size());
  }
  if (cursor.rest().size() >= 8) Fail(name, "light field photographs have a wrong length");
}

std::span<const uint16_t> Uint16At(const std::byte* place, uint64_t count) {
  // Records begin at multiples of 8, and so does every part of one.
  return {reinterpret_cast<const uint16_t*>(place), static_cast<size_t>(count)};
}

LightFieldRecord ReadRecord(const lfs::IndexEntry& entry, Bytes data, const std::string& name,
                            const LightFieldContent& content) {
  LightFieldRecord record;
  record.offset = entry.offset;
  record.edge_samples = static_cast<uint16_t>(entry.edge_samples);
  record.views = static_cast<uint16_t>(entry.views);
  const Bytes bytes =
      data.subspan(static_cast<size_t>(entry.offset), static_cast<size_t>(entry.bytes));
  if (entry.checksum != Checksum(bytes.data(), bytes.size())) {
    Fail(name, "light field content is damaged (checksum)");
  }
  Cursor cursor(bytes, name);
  if (entry.views > 0) {
    const auto photos =
        Uint16At(cursor.Take(lfs::Padded(entry.views * sizeof(uint16_t))).data(), entry.views);
    cursor.Take(lfs::Padded(lfs::ValueCount(entry.edge_samples, entry.views) * sizeof(uint16_t)));
    for (uint32_t& place : record.weights_at8) {
      const auto grid = static_cast<size_t>(content.grid);
      place = static_cast<uint32_t>((bytes.size() - cursor.rest().size()) / 8);
      cursor.Take(CheckWeights(cursor.rest(), grid * grid, entry.views, name));
    }
    const bool ascending =
        std::adjacent_find(photos.begin(), photos.end(), std::greater_equal<>()) == photos.end();
    if (!ascending || photos.back() >= content.photo_ids.size()) {
      Fail(name, "light field names photographs that it does not have");
    }
  }
  if (!cursor.rest().empty()) Fail(name, "light field record has a wrong length");
  return record;
}

std::span<const lfs::IndexEntry> ReadIndex(Bytes index, Bytes data, const std::string& name,
                                           const LightFieldContent& content) {
  const size_t count = content.mesh.triangles.size();
  if (index.size() / sizeof(lfs::IndexEntry) < count) Fail(name, "light field file is truncated");
  if (index.size() != count * sizeof(lfs::IndexEntry)) {
    Fail(name, "light field index has a wrong length");
  }
  // Chunks begin at multiples of 8.
  const std::span entries(reinterpret_cast<const lfs::IndexEntry*>(index.data()), count);
  uint64_t place = 0;
  for (const lfs::IndexEntry& entry : entries) {
    const bool fits = entry.offset == place && entry.bytes % 8 == 0 &&
                      entry.bytes <= data.size() - place && entry.edge_samples >= 2 &&
                      entry.edge_samples <= kMaxEdgeSamples &&
                      entry.views <= content.photo_ids.size();
    if (!fits) Fail(name, "light field index is out of range");
    place += entry.bytes;
  }
  if (place != data.size()) Fail(name, "light field index is out of range");
  return entries;
}

void ReadRecords(Bytes index, Bytes data, const std::string& name, const PartRead& part_read,
                 LightFieldContent& content) {
  constexpr int64_t kBlock = 512;  // many pages, so that few lie on the border of two
  const auto entries = ReadIndex(index, data, name, content);
  content.data = data;
  content.records.resize(entries.size());
  ParallelChunks(static_cast<int64_t>(entries.size()), kBlock,
                 [&](int64_t begin, int64_t end, int64_t) {
                   for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
                     content.records[i] = ReadRecord(entries[i], data, name, content);
                   }
                   const auto& first = entries[static_cast<size_t>(begin)];
                   const auto& last = entries[static_cast<size_t>(end - 1)];
                   part_read(data.subspan(static_cast<size_t>(first.offset),
                                          last.offset + last.bytes - first.offset));
                 });
}

}  // namespace

std::span<const uint16_t> LightFieldContent::Photos(const LightFieldRecord& record) const {
  return Uint16At(data.data() + record.offset, record.views);
}

std::span<const uint16_t> LightFieldContent::Values(const LightFieldRecord& record) const {
  return Uint16At(data.data() + record.offset + lfs::Padded(record.views * sizeof(uint16_t)),
                  lfs::ValueCount(record.edge_samples, record.views));
}

std::span<const std::byte> LightFieldContent::Weights(const LightFieldRecord& record,
                                                      int corner) const {
  const uint64_t at8 = record.weights_at8[static_cast<size_t>(corner)];
  return data.subspan(static_cast<size_t>(record.offset + 8 * at8));
}

LightFieldContent ParseLightField(std::span<const std::byte> bytes, const std::string& name,
                                  const PartRead& part_read) {
  const lfs::FileHeader header = ReadHeader(bytes, name);
  const auto chunks = SplitChunks(header, bytes, name, part_read);
  LightFieldContent content;
  content.grid = static_cast<int>(header.grid);
  content.direction_map = static_cast<DirectionMap>(header.direction_map);
  ReadMesh(chunks[lfs::kMesh], name, part_read, content);
  ReadPhotoIds(chunks[lfs::kPhotos], name, content);
  ReadRecords(chunks[lfs::kIndex], chunks[lfs::kData], name, part_read, content);
  part_read(bytes);
  return content;
}

}  // namespace lfm
