// SPDX-License-Identifier: BSD-3-Clause
#include "core/hash.h"

#include <gtest/gtest.h>

#include <set>

#include "test_files.h"

namespace lfm {
namespace {

// The published values of XXH3 for no input.
TEST(Hash, IsXxh3) {
  EXPECT_EQ(Checksum(nullptr, 0), 0x2d06800538d394c2u);
  EXPECT_EQ(Hasher().HexDigest(), "99aa06d3014798d86001c324468d497f");
}

TEST(Hash, PiecesAreDelimited) {
  const std::set<std::string> digests = {
      Hasher().Add("ab").Add("c").HexDigest(), Hasher().Add("a").Add("bc").HexDigest(),
      Hasher().Add("abc").HexDigest(),         Hasher().Add("abc").Add("").HexDigest(),
      Hasher().Add("").Add("abc").HexDigest(), Hasher().HexDigest(),
  };
  EXPECT_EQ(digests.size(), 6u);
  EXPECT_EQ(Hasher().Add("abc").HexDigest(), Hasher().Add("abc").HexDigest());
  EXPECT_EQ(Hasher().Add("abc").HexDigest().size(), 32u);
}

TEST(Hash, FilesCountByContentOnly) {
  const TestFolder folder;
  Put(folder / "a", "same");
  Put(folder / "b", "same");
  Put(folder / "c", "else");
  const auto digest = [&](const char* name) { return Hasher().AddFile(folder / name).HexDigest(); };
  EXPECT_EQ(digest("a"), digest("b"));
  EXPECT_NE(digest("a"), digest("c"));
  EXPECT_NE(Hasher().AddFile(folder / "a").AddFile(folder / "c").HexDigest(),
            Hasher().AddFile(folder / "c").AddFile(folder / "a").HexDigest());
  Put(folder / "large", std::string(3000000, 'x'));
  Put(folder / "larger", std::string(3000001, 'x'));
  EXPECT_NE(digest("large"), digest("larger"));
  ExpectError([&] { digest("none"); }, "none");
}

TEST(Hash, FingerprintsTellFilesOfOneNameApart) {
  const TestFolder folder;
  Put(folder / "short", "same"), Put(folder / "copy", "same"), Put(folder / "other", "else");
  Put(folder / "empty", "");
  EXPECT_EQ(FileFingerprint(folder / "short"), FileFingerprint(folder / "copy"));
  EXPECT_EQ(FileFingerprint(folder / "empty").size(), 32u);
  std::set<std::string> prints;
  for (const char* name : {"short", "other", "empty"})
    prints.insert(FileFingerprint(folder / name));
  const std::string content(100000, 'x');
  const auto print_with = [&](size_t at) {
    std::string changed = content;
    changed[at] = 'y';
    Put(folder / "large", changed);
    return FileFingerprint(folder / "large");
  };
  for (const size_t at : {0, 50000, 99999}) prints.insert(print_with(at));
  Put(folder / "large", content + 'x');
  prints.insert(FileFingerprint(folder / "large"));
  EXPECT_EQ(prints.size(), 7u);
}

TEST(Hash, WhatIsNoFileHasNoFingerprint) {
  const TestFolder folder;
  EXPECT_EQ(FileFingerprint(folder.path()), "");
  EXPECT_EQ(FileFingerprint(folder / "none"), "");
}

TEST(Hash, FolderIsNoFile) {
  const TestFolder folder;
  EXPECT_THROW(Hasher().AddFile(folder.path()), Error);
}

TEST(Hash, MovesKeepTheState) {
  Hasher first;
  first.Add("a");
  Hasher second = std::move(first);
  EXPECT_EQ(second.Add("b").HexDigest(), Hasher().Add("a").Add("b").HexDigest());
}

}  // namespace
}  // namespace lfm
