// SPDX-License-Identifier: BSD-3-Clause
#include "core/scratch_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/process_memory.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

TEST(ScratchFile, KeepsWhatManyThreadsAppend) {
  const ScratchFolder scratch;
  constexpr int kPieces = 200, kPieceLength = 1000;
  ScratchFile file(scratch.folder / "result");
  std::vector<uint64_t> offsets(kPieces);
  ParallelFor(0, kPieces, [&](int64_t i) {
    const std::vector<int> piece(kPieceLength, static_cast<int>(i));
    offsets[i] = file.Append(piece.data(), piece.size() * sizeof(int));
  });
  const MappedFile mapped = file.Map();
  ASSERT_EQ(mapped.bytes().size(), kPieces * kPieceLength * sizeof(int));
  for (int i = 0; i < kPieces; ++i) {
    std::vector<int> read(kPieceLength);
    file.Read(offsets[i], read.data(), read.size() * sizeof(int));
    EXPECT_EQ(read, std::vector<int>(kPieceLength, i));
    EXPECT_EQ(std::memcmp(read.data(), mapped.bytes().data() + offsets[i], kPieceLength), 0);
  }
  EXPECT_THROW(file.Read(mapped.bytes().size() - 1, offsets.data(), 2), Error);
}

TEST(ScratchFile, LeavesNothingBehindAndNamesTheResult) {
  const ScratchFolder scratch;
  {
    ScratchFile file(scratch.folder / "result");
    file.Append("some", 4);
    EXPECT_TRUE(std::filesystem::is_empty(scratch.folder));
  }
  try {
    const ScratchFile file("/proc/no/such");
    FAIL() << "was made";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/proc/no/such"), std::string::npos);
    EXPECT_EQ(error.kind(), ErrorKind::kSystem);
  }
}

TEST(ScratchFile, ReleasedPagesComeBack) {
  const ScratchFolder scratch;
  constexpr size_t kBytes = size_t{64} << 20;
  ScratchFile file(scratch.folder / "result");
  const std::vector<char> ones(kBytes, 1);
  file.Append(ones.data(), ones.size());
  const MappedFile mapped = file.Map();
  const auto sum = [&] {
    return std::accumulate(mapped.bytes().begin(), mapped.bytes().end(), size_t{0},
                           [](size_t a, std::byte b) { return a + static_cast<size_t>(b); });
  };
  const int64_t before = ResidentMemoryBytes();
  EXPECT_EQ(sum(), kBytes);
  EXPECT_GT(ResidentMemoryBytes(), before + static_cast<int64_t>(kBytes / 2));
  mapped.Release();
  EXPECT_LT(ResidentMemoryBytes(), before + static_cast<int64_t>(kBytes / 8));
  EXPECT_EQ(sum(), kBytes);
  mapped.Release(mapped.bytes().subspan(1, kBytes / 2));
  EXPECT_EQ(sum(), kBytes);
}

TEST(MemoryLimit, SaysWhatToAllow) {
  const MemoryLimit limit(1 << 20);
  EXPECT_GT(limit.BytesLeft(), int64_t{1} << 39);
  limit.Require(1, "nothing", "or not");
  try {
    limit.Require(int64_t{1} << 41, "the work", "or do less");
    FAIL() << "was allowed";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("--memory-mib 1048576: the work takes some 20971"), 0U) << text;
    EXPECT_NE(text.find("or do less"), std::string::npos);
  }
}

}  // namespace
}  // namespace lfm
