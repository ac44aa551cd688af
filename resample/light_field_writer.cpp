// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "resample/light_field.h"
#include "resample/light_field_format.h"
#include "resample/weight_codec.h"

namespace lfm {
namespace {

using Buffer = std::vector<std::byte>;

void Require(bool condition, const char* problem) {
  if (!condition) throw Error(std::string("light field: ") + problem, ErrorKind::kSystem);
}

template <typename T>
void Append(Buffer& buffer, const T* values, size_t count) {
  const size_t start = buffer.size();
  buffer.resize(start + count * sizeof(T));
  if (count > 0) {
    std::memcpy(buffer.data() + start, static_cast<const void*>(values), count * sizeof(T));
  }
}

void Pad(Buffer& buffer) { buffer.resize(lfs::Padded(buffer.size())); }

Buffer EncodeMesh(const TriangleMesh& mesh, const std::vector<Eigen::Matrix3d>& frames) {
  ValidateMesh(mesh, "light field");
  const size_t count = mesh.vertices.size();
  Require(frames.size() == count, "one frame a vertex is needed");
  const auto normals = mesh.normals.empty() ? ComputeVertexNormals(mesh) : mesh.normals;
  Require(normals.size() == count, "one normal a vertex is needed");
  Require(mesh.confidence.empty() || mesh.confidence.size() == count, "bad confidence");
  Require(mesh.colors.empty() || mesh.colors.size() == count, "bad colours");
  const lfs::MeshHeader header{count, mesh.triangles.size(), mesh.confidence.empty() ? 0U : 1U,
                               mesh.colors.empty() ? 0U : 1U};
  Buffer buffer;
  constexpr size_t kBytesAVertex = sizeof(Eigen::Vector3d) * 2 + sizeof(Eigen::Matrix3d) + 16;
  buffer.reserve(count * kBytesAVertex + mesh.triangles.size() * sizeof(Eigen::Vector3i) + 64);
  Append(buffer, &header, 1);
  Append(buffer, mesh.vertices.data(), count);
  Append(buffer, normals.data(), count);
  Append(buffer, frames.data(), count);
  Append(buffer, mesh.triangles.data(), mesh.triangles.size());
  Append(buffer, mesh.confidence.data(), mesh.confidence.size());
  Append(buffer, mesh.colors.data(), mesh.colors.size());
  Pad(buffer);
  return buffer;
}

Buffer EncodePhotoIds(const std::vector<std::string>& ids) {
  Require(ids.size() <= 65535, "more than 65535 photographs");
  Buffer buffer;
  const auto count = static_cast<uint32_t>(ids.size());
  Append(buffer, &count, 1);
  for (const std::string& id : ids) {
    const auto length = static_cast<uint32_t>(id.size());
    Append(buffer, &length, 1);
    Append(buffer, id.data(), id.size());
  }
  Pad(buffer);
  return buffer;
}

Buffer EncodeTriangle(const LightFieldWriter::Triangle& triangle, size_t photo_count,
                      size_t entry_count) {
  const size_t views = triangle.photos.size();
  Require(triangle.edge_samples >= 2 && triangle.edge_samples <= kMaxEdgeSamples, "bad patch size");
  const auto edge = static_cast<uint64_t>(triangle.edge_samples);
  Require(triangle.values.size() == lfs::ValueCount(edge, views), "bad number of values");
  Buffer buffer;
  if (views == 0) return buffer;
  Require(std::adjacent_find(triangle.photos.begin(), triangle.photos.end(),
                             std::greater_equal<>()) == triangle.photos.end() &&
              triangle.photos.back() < photo_count,
          "photographs of a triangle must be ascending and known");
  Append(buffer, triangle.photos.data(), views);
  Pad(buffer);
  Append(buffer, triangle.values.data(), triangle.values.size());
  Pad(buffer);
  for (const auto& weights : triangle.weights) {
    Require(weights.seen.size() == entry_count, "bad number of view weights");
    AppendWeights(weights, views, buffer);
  }
  return buffer;
}

}  // namespace

struct LightFieldWriter::State {
  std::filesystem::path file, partial;
  int descriptor = -1;
  lfs::FileHeader header = {};
  size_t triangle_count = 0, photo_count = 0;
  uint64_t place = 0;
  std::vector<lfs::IndexEntry> index;

  ~State() {
    if (descriptor >= 0) ::close(descriptor);
    std::error_code ignored;
    if (!partial.empty()) std::filesystem::remove(partial, ignored);
  }

  [[noreturn]] void Fail() const { FailWriting(file, errno); }

  void Open() {
    std::error_code ignored;
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
    descriptor = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) Fail();
  }

  void WriteBytes(const void* data, size_t size) {
    const char* rest = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t written = ::write(descriptor, rest, size);
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) Fail();
      rest += written;
      size -= static_cast<size_t>(written);
      place += static_cast<uint64_t>(written);
    }
  }

  void WriteChunk(lfs::Chunk chunk, std::span<const std::byte> content) {
    header.chunks[chunk] = {lfs::kTags[chunk], 0, place, content.size(),
                            Checksum(content.data(), content.size())};
    WriteBytes(content.data(), content.size());
  }
};

LightFieldWriter::LightFieldWriter(const std::filesystem::path& file, const Header& header)
    : state_(std::make_unique<State>()) {
  Require(header.grid >= 2 && header.grid <= 256, "the view grid must have 2 to 256 a side");
  const Buffer mesh = EncodeMesh(header.mesh, header.vertex_frames);
  const Buffer photos = EncodePhotoIds(header.photo_ids);
  State& state = *state_;
  state.file = file;
  state.partial = file.parent_path() / ("." + file.filename().string() + ".partial");
  state.triangle_count = header.mesh.triangles.size();
  state.index.reserve(state.triangle_count);
  state.photo_count = header.photo_ids.size();
  state.header.magic = lfs::kMagic;
  state.header.version = lfs::kVersion;
  state.header.grid = static_cast<uint32_t>(header.grid);
  state.header.direction_map = static_cast<uint32_t>(header.direction_map);
  state.Open();
  state.WriteBytes(&state.header, sizeof(state.header));
  state.WriteChunk(lfs::kMesh, mesh);
  state.WriteChunk(lfs::kPhotos, photos);
  state.header.chunks[lfs::kData] = {lfs::kTags[lfs::kData], 0, state.place, 0, 0};
}

LightFieldWriter::~LightFieldWriter() = default;

void LightFieldWriter::Write(const Triangle& triangle) {
  State& state = *state_;
  Require(state.descriptor >= 0 && state.index.size() < state.triangle_count,
          "more triangles written than the mesh has");
  const size_t grid = state.header.grid;
  const Buffer record = EncodeTriangle(triangle, state.photo_count, grid * grid);
  lfs::ChunkEntry& data = state.header.chunks[lfs::kData];
  state.index.push_back({data.bytes, record.size(), Checksum(record.data(), record.size()),
                         static_cast<uint32_t>(triangle.edge_samples),
                         static_cast<uint32_t>(triangle.photos.size())});
  state.WriteBytes(record.data(), record.size());
  data.bytes += record.size();
}

void LightFieldWriter::Finish() {
  State& state = *state_;
  Require(state.descriptor >= 0 && state.index.size() == state.triangle_count,
          "fewer triangles written than the mesh has");
  state.WriteChunk(lfs::kIndex, std::as_bytes(std::span(state.index)));
  state.header.file_bytes = state.place;
  state.header.checksum = Checksum(&state.header, offsetof(lfs::FileHeader, checksum));
  if (::lseek(state.descriptor, 0, SEEK_SET) != 0) state.Fail();
  state.WriteBytes(&state.header, sizeof(state.header));
  const int descriptor = std::exchange(state.descriptor, -1);
  if (::close(descriptor) != 0) state.Fail();
  WriteFileAtomically(state.file, [&](const std::filesystem::path& temporary) {
    std::filesystem::rename(state.partial, temporary);
  });
}

}  // namespace lfm
