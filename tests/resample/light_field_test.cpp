// SPDX-License-Identifier: BSD-3-Clause
#include "resample/light_field.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>
#include <set>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "resample/light_field_format.h"
#include "resample/weight_codec.h"
#include "test_scenes.h"

namespace lfm {
namespace {

constexpr int kGrid = 4;

LightField::WeightBuffer RandomWeights(int views, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> view(0, views - 1);
  std::uniform_real_distribution<float> share(0, 1);
  LightField::WeightBuffer buffer;
  for (int q = 0; q < kGrid * kGrid; ++q) {
    const float a = share(random), b = share(random) * (1 - a);
    for (const float w : {a, b, 1 - a - b}) {
      buffer.view.push_back(static_cast<uint16_t>(view(random)));
      buffer.weight.push_back(w);
    }
    buffer.seen.push_back(static_cast<uint8_t>(q % 2));
  }
  return buffer;
}

LightFieldWriter::Triangle RandomTriangle(int n, std::vector<uint16_t> photos, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> value(0, 65535);
  LightFieldWriter::Triangle triangle;
  triangle.edge_samples = n;
  triangle.photos = std::move(photos);
  const size_t views = triangle.photos.size();
  for (size_t i = 0; i < 3 * views * static_cast<size_t>(PatchSampleCount(n)); ++i) {
    triangle.values.push_back(static_cast<uint16_t>(value(random)));
  }
  for (unsigned c = 0; c < 3 && views > 0; ++c) {
    triangle.weights[c] = RandomWeights(static_cast<int>(views), seed + c);
  }
  return triangle;
}

LightFieldWriter::Header SmallHeader() {
  LightFieldWriter::Header header;
  header.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  header.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}};
  header.mesh.normals = ComputeVertexNormals(header.mesh);
  header.mesh.confidence = {0, 0.5F, 1, 0.25F};
  header.vertex_frames = ComputeVertexFrames(header.mesh);
  header.photo_ids = {"a", "left side", ""};
  header.direction_map = DirectionMap::kOrthographic;
  header.grid = kGrid;
  return header;
}

std::vector<LightFieldWriter::Triangle> SmallTriangles() {
  return {RandomTriangle(3, {0, 2}, 1), RandomTriangle(2, {}, 2), RandomTriangle(4, {1}, 3)};
}

/// A small but complete light field file: one triangle of it is seen by nobody.
std::filesystem::path WriteSmall(const std::string& name) {
  const std::filesystem::path file = test::TestFolder(name) / "light_field.lfs";
  LightFieldWriter writer(file, SmallHeader());
  for (const auto& triangle : SmallTriangles()) writer.Write(triangle);
  writer.Finish();
  return file;
}

std::vector<std::byte> BytesOf(const std::filesystem::path& file) {
  const std::string content = ReadFile(file);
  std::vector<std::byte> bytes(content.size());
  std::memcpy(bytes.data(), content.data(), content.size());
  return bytes;
}

/// After a change that a hostile writer would make: header checksum right again.
void Reseal(std::vector<std::byte>& bytes) {
  const uint64_t checksum = Checksum(bytes.data(), offsetof(lfs::FileHeader, checksum));
  std::memcpy(bytes.data() + offsetof(lfs::FileHeader, checksum), &checksum, sizeof(checksum));
}

lfs::FileHeader HeaderOf(const std::vector<std::byte>& bytes) {
  lfs::FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  return header;
}

/// Changes chunk content and mends its checksum and the header's.
template <typename T>
void Forge(std::vector<std::byte>& bytes, lfs::Chunk chunk, size_t offset, T value) {
  lfs::FileHeader header = HeaderOf(bytes);
  lfs::ChunkEntry& entry = header.chunks[chunk];
  std::memcpy(bytes.data() + entry.offset + offset, &value, sizeof(T));
  entry.checksum = Checksum(bytes.data() + entry.offset, entry.bytes);
  std::memcpy(bytes.data(), &header, sizeof(header));
  Reseal(bytes);
}

TEST(PatchSamples, EnumerateTheTriangularGridOnce) {
  for (const int n : {2, 3, 9}) {
    std::set<int> seen;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        EXPECT_EQ(PatchSampleIndex(n, i, j), static_cast<int>(seen.size()));  // j outer, i inner
        seen.insert(PatchSampleIndex(n, i, j));
        EXPECT_NEAR(PatchSampleWeights(n, i, j).sum(), 1, 1e-15);
        EXPECT_GE(PatchSampleWeights(n, i, j).minCoeff(), 0);
      }
    }
    EXPECT_EQ(static_cast<int>(seen.size()), PatchSampleCount(n));
    EXPECT_EQ(PatchSampleWeights(n, n - 1, 0), Eigen::Vector3d(0, 1, 0));
    EXPECT_EQ(PatchSampleWeights(n, 0, n - 1), Eigen::Vector3d(0, 0, 1));
    EXPECT_EQ(PatchSampleWeights(n, 0, 0), Eigen::Vector3d(1, 0, 0));
  }
}

TEST(WeightCodec, KeepsWeightsToOne65535thAndTheirSum) {
  const LightField::WeightBuffer weights = RandomWeights(9, 5);
  std::vector<std::byte> bytes;
  AppendWeights(weights, 9, bytes);
  EXPECT_EQ(CheckWeights(bytes, kGrid * kGrid, 9, "test"), bytes.size());
  LightField::WeightBuffer back;
  DecodeWeights(bytes, back);
  EXPECT_EQ(back.view, weights.view);
  EXPECT_EQ(back.seen, weights.seen);
  for (size_t q = 0; q < back.seen.size(); ++q) {
    double sum = 0;
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(back.weight[3 * q + k], weights.weight[3 * q + k], 1.01 / 65535);
      EXPECT_GE(back.weight[3 * q + k], 0);
      sum += back.weight[3 * q + k];
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

TEST(WeightCodec, RefusesWhatAreNoWeights) {
  std::vector<std::byte> bytes;
  LightField::WeightBuffer weights = RandomWeights(9, 5);
  EXPECT_THROW(AppendWeights(weights, 2, bytes), Error);
  weights.weight[4] = std::nanf("");
  EXPECT_THROW(AppendWeights(weights, 9, bytes), Error);
  weights.weight[4] = -0.5F;
  EXPECT_THROW(AppendWeights(weights, 9, bytes), Error);
  weights.weight.pop_back();
  EXPECT_THROW(AppendWeights(weights, 9, bytes), Error);
}

TEST(LightField, ComesBackAsItWasWritten) {
  const LightField field = LightField::Open(WriteSmall("round_trip"));
  const LightFieldWriter::Header header = SmallHeader();
  EXPECT_EQ(field.mesh().vertices, header.mesh.vertices);
  EXPECT_EQ(field.mesh().triangles, header.mesh.triangles);
  EXPECT_EQ(field.mesh().normals, header.mesh.normals);
  EXPECT_EQ(field.mesh().confidence, header.mesh.confidence);
  EXPECT_EQ(field.vertex_frames(), header.vertex_frames);
  EXPECT_EQ(field.photo_ids(), header.photo_ids);
  EXPECT_EQ(field.direction_map(), DirectionMap::kOrthographic);
  EXPECT_EQ(field.grid(), kGrid);
  ASSERT_EQ(field.triangle_count(), 3);
  const auto triangles = SmallTriangles();
  for (int t = 0; t < 3; ++t) {
    const TrianglePatch patch = field.Patch(t);
    EXPECT_EQ(patch.edge_samples, triangles[t].edge_samples);
    EXPECT_EQ(std::vector(patch.photos.begin(), patch.photos.end()), triangles[t].photos);
    EXPECT_EQ(std::vector(patch.values.begin(), patch.values.end()), triangles[t].values);
    for (int corner = 0; corner < 3; ++corner) {
      LightField::WeightBuffer buffer;
      const ViewWeights weights = field.Weights(t, corner, buffer);
      const auto& written = triangles[t].weights[corner];
      EXPECT_EQ(std::vector(weights.view.begin(), weights.view.end()), written.view);
      EXPECT_EQ(std::vector(weights.seen.begin(), weights.seen.end()), written.seen);
    }
  }
  EXPECT_EQ(field.DenseBytes(), 3 * (6 + 3 + 10) * kGrid * kGrid);
}

TEST(LightField, RefusesEveryTruncatedPrefix) {
  const std::vector<std::byte> whole = BytesOf(WriteSmall("truncated"));
  EXPECT_NO_THROW(LightField::FromMemory(whole, "whole"));
  for (size_t size = 0; size < whole.size(); ++size) {
    std::vector<std::byte> prefix(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(size));
    prefix.shrink_to_fit();
    EXPECT_THROW(LightField::FromMemory(std::move(prefix), "prefix"), Error) << size;
  }
  std::vector<std::byte> longer = whole;
  longer.push_back(std::byte{0});
  try {
    LightField::FromMemory(std::move(longer), "longer");
    ADD_FAILURE() << "was read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("longer than it says"), std::string::npos);
  }
}

TEST(LightField, FindsEveryFlippedByte) {
  const std::vector<std::byte> whole = BytesOf(WriteSmall("flipped"));
  for (size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::byte> damaged = whole;
    damaged[i] ^= std::byte{0x10};
    EXPECT_THROW(LightField::FromMemory(std::move(damaged), "damaged"), Error) << i;
  }
}

TEST(LightField, NamesFileAndCure) {
  const std::filesystem::path file = WriteSmall("messages");
  std::vector<std::byte> bytes = BytesOf(file);
  const uint32_t version = 7;
  std::memcpy(bytes.data() + offsetof(lfs::FileHeader, version), &version, sizeof(version));
  Reseal(bytes);
  try {
    LightField::FromMemory(bytes, "some.lfs");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("some.lfs: has version 7"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("lfm-resample"), std::string::npos);
  }
  EXPECT_THROW(LightField::Open(file.parent_path() / "missing.lfs"), Error);
  EXPECT_THROW(LightField::Open(file.parent_path()), Error);
  WriteFileAtomically(file, "");
  EXPECT_THROW(LightField::Open(file), Error);
  WriteFileAtomically(file, "ply\nformat ascii 1.0\n");
  EXPECT_THROW(LightField::Open(file), Error);
}

TEST(LightField, RefusesHostileContentWithRightChecksums) {
  const std::vector<std::byte> whole = BytesOf(WriteSmall("hostile"));
  const auto expect_refused = [](std::vector<std::byte> bytes, const char* what) {
    EXPECT_THROW(LightField::FromMemory(std::move(bytes), what), Error) << what;
  };
  const auto forged = [&](lfs::Chunk chunk, size_t offset, auto value) {
    std::vector<std::byte> bytes = whole;
    Forge(bytes, chunk, offset, value);
    return bytes;
  };
  expect_refused(forged(lfs::kMesh, 0, ~uint64_t{0}), "vertex count");
  expect_refused(forged(lfs::kMesh, 0, uint64_t{1} << 61), "vertex count that overflows");
  expect_refused(forged(lfs::kMesh, 8, uint64_t{2}), "triangle count");
  expect_refused(forged(lfs::kMesh, sizeof(lfs::MeshHeader), std::nan("")), "vertex");
  const size_t triangles = sizeof(lfs::MeshHeader) + 4 * (3 + 3 + 9) * sizeof(double);
  expect_refused(forged(lfs::kMesh, triangles, 4), "corner beyond the vertices");
  expect_refused(forged(lfs::kMesh, triangles, -1), "negative corner");
  expect_refused(forged(lfs::kPhotos, 0, ~uint32_t{0}), "photo count");
  expect_refused(forged(lfs::kPhotos, 4, ~uint32_t{0}), "photo id length");
  using Entry = lfs::IndexEntry;
  expect_refused(forged(lfs::kIndex, offsetof(Entry, offset), uint64_t{8}), "offset");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, bytes), ~uint64_t{7}), "bytes");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, edge_samples), uint32_t{65535}), "patch size");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, edge_samples), uint32_t{kMaxEdgeSamples + 1}),
                 "patch just too large");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, edge_samples), uint32_t{0}), "no patch");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, views), uint32_t{3}), "views");
  expect_refused(forged(lfs::kIndex, offsetof(Entry, views), ~uint32_t{0}), "many views");
}

TEST(LightField, RefusesHostileRecords) {
  const std::vector<std::byte> whole = BytesOf(WriteSmall("hostile_records"));
  const lfs::FileHeader header = HeaderOf(whole);
  lfs::IndexEntry first;
  std::memcpy(&first, whole.data() + header.chunks[lfs::kIndex].offset, sizeof(first));
  const size_t record = header.chunks[lfs::kData].offset;
  // Any 16 bits of the photo numbers and of the weights' tables set to a large value, the record's
  // checksum mended: either still valid, or refused; never read out of bounds (sanitizers watch).
  int refused = 0;
  for (size_t i = 0; i + 1 < first.bytes; i += 2) {
    std::vector<std::byte> bytes = whole;
    const uint16_t value = 0xfff0;
    std::memcpy(bytes.data() + record + i, &value, sizeof(value));
    Forge(bytes, lfs::kIndex, offsetof(lfs::IndexEntry, checksum),
          Checksum(bytes.data() + record, first.bytes));
    try {
      const LightField field = LightField::FromMemory(bytes, "record");
      LightField::WeightBuffer buffer;
      for (int corner = 0; corner < 3; ++corner) {
        for (const uint16_t view : field.Weights(0, corner, buffer).view) EXPECT_LT(view, 2);
      }
      for (const uint16_t photo : field.Patch(0).photos) EXPECT_LT(photo, 3);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 2 + 3 * kGrid * kGrid);  // photo numbers, row numbers, and more
}

TEST(LightFieldWriter, LeavesNothingBehindUnlessFinished) {
  const std::filesystem::path folder = test::TestFolder("unfinished");
  {
    LightFieldWriter writer(folder / "light_field.lfs", SmallHeader());
    writer.Write(SmallTriangles()[0]);
    EXPECT_THROW(writer.Finish(), Error);  // two triangles are missing
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(LightFieldWriter, RefusesWhatDoesNotFitTogether) {
  const std::filesystem::path folder = test::TestFolder("misfit");
  LightFieldWriter::Header header = SmallHeader();
  header.vertex_frames.pop_back();
  EXPECT_THROW(LightFieldWriter(folder / "a.lfs", header), Error);
  header = SmallHeader();
  header.grid = 1;
  EXPECT_THROW(LightFieldWriter(folder / "a.lfs", header), Error);
  LightFieldWriter writer(folder / "b.lfs", SmallHeader());
  LightFieldWriter::Triangle triangle = SmallTriangles()[0];
  triangle.values.pop_back();
  EXPECT_THROW(writer.Write(triangle), Error);
  triangle = SmallTriangles()[0];
  triangle.photos = {2, 0};
  EXPECT_THROW(writer.Write(triangle), Error);
  triangle.photos = {0, 3};
  EXPECT_THROW(writer.Write(triangle), Error);
  triangle = SmallTriangles()[0];
  triangle.weights[1].seen.pop_back();
  EXPECT_THROW(writer.Write(triangle), Error);
}

TEST(LightFieldWriter, ReportsAFolderThatCannotBeMade) {
  const std::filesystem::path folder = test::TestFolder("no_folder");
  WriteFileAtomically(folder / "file", "x");
  try {
    LightFieldWriter(folder / "file" / "light_field.lfs", SmallHeader());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kSystem);
  }
}

TEST(LightFieldWriter, ReportsAFullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP();
  const std::filesystem::path folder = test::TestFolder("full_disk");
  std::filesystem::create_symlink("/dev/full", folder / ".light_field.lfs.partial");
  try {
    LightFieldWriter(folder / "light_field.lfs", SmallHeader());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kSystem);
    EXPECT_NE(std::string(error.what()).find("space"), std::string::npos);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "light_field.lfs"));
}

}  // namespace
}  // namespace lfm
