// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relightable_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "fields/relightable_layout.h"
#include "tests/fields/random_relightable.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

std::span<const std::byte> BytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

void ExpectEqual(const RelightableModel& a, const RelightableModel& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.directions, b.directions);
  EXPECT_EQ(a.column_basis.first, b.column_basis.first);
  EXPECT_EQ(a.column_basis.direction, b.column_basis.direction);
  EXPECT_EQ(a.column_basis.value, b.column_basis.value);
  EXPECT_EQ(a.model.cluster, b.model.cluster);
  EXPECT_EQ(a.model.first_weight, b.model.first_weight);
  EXPECT_EQ(a.model.weights, b.model.weights);
  EXPECT_EQ(a.model.first_residual, b.model.first_residual);
  EXPECT_EQ(a.model.residual_column, b.model.residual_column);
  EXPECT_EQ(a.model.residual_value, b.model.residual_value);
  ASSERT_EQ(a.model.bases.size(), b.model.bases.size());
  for (size_t k = 0; k < a.model.bases.size(); ++k) {
    EXPECT_EQ(a.model.bases[k].rows, b.model.bases[k].rows);
    EXPECT_EQ(a.model.bases[k].values, b.model.bases[k].values);
  }
}

std::string Refusal(const std::string& bytes) {
  try {
    DecodeRelightable(BytesOf(bytes), "m.lfr");
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with("m.lfr: ")) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  return "";
}

// The bytes with another head, whose checksum is right.
std::string WithHeader(std::string bytes, const std::function<void(RelightableHeader&)>& change) {
  RelightableHeader h;
  std::memcpy(&h, bytes.data(), sizeof(h));
  change(h);
  h.header_checksum = Checksum(&h, offsetof(RelightableHeader, header_checksum));
  std::memcpy(bytes.data(), &h, sizeof(h));
  return bytes;
}

// The bytes with another content, whose checksums are right.
std::string WithContent(std::string bytes, RelightableSection section, int64_t at,
                        const std::string& content) {
  RelightableHeader h;
  std::memcpy(&h, bytes.data(), sizeof(h));
  bytes.replace(static_cast<size_t>(MakeRelightableLayout(h).offset[section] + at), content.size(),
                content);
  return WithHeader(bytes, [&](RelightableHeader& changed) {
    changed.content_checksum = Checksum(bytes.data() + sizeof(h), bytes.size() - sizeof(h));
  });
}

RelightableModel WithEverything() {
  RelightableModel r = RandomRelightable({.width = 4, .height = 3, .columns = 6});
  r.width = r.height = 0;
  for (int i = 0; i < 12; ++i) r.positions.emplace_back(1.5f * i, -i, 0.25f);
  r.triangles = {{0, 1, 2}, {11, 3, 4}};
  r.directions.resize(4);  // fewer than coefficients: an overcomplete basis is none of our business
  r.column_basis.first = {0, 1, 3, 3, 4, 5, 6};
  r.column_basis.direction = {0, 1, 2, 3, 3, 0};
  r.column_basis.value = {1, 0.5f, -0.5f, 2, 1e-20f, 3e20f};
  return r;
}

TEST(RelightableFile, HoldsWhatFitsItsNumbersExactly) {
  for (const int columns : {1, 20, 256, 257, 1000}) {
    for (const int clusters : {1, 4, 256, 257}) {
      const RelightableModel r = RandomRelightable(
          {.columns = columns, .clusters = clusters, .most_residuals = std::min(columns, 300)});
      const std::string bytes = EncodeRelightable(r);
      ExpectEqual(r, DecodeRelightable(BytesOf(bytes), "m.lfr"));
      EXPECT_EQ(CountBytes(r).Total(), static_cast<int64_t>(bytes.size()));
      EXPECT_EQ(EncodeRelightable(r), bytes);
    }
  }
  ExpectEqual(WithEverything(), AsStored(WithEverything()));
}

TEST(RelightableFile, GoesThroughDisk) {
  const ScratchFolder scratch;
  const RelightableModel r = WithEverything();
  WriteRelightable(r, scratch.folder / "sub" / "m.lfr");
  ExpectEqual(r, ReadRelightable(scratch.folder / "sub" / "m.lfr"));
  EXPECT_THROW(ReadRelightable(scratch.folder / "absent.lfr"), Error);
  WriteFileAtomically(scratch.folder / "empty.lfr", "");
  EXPECT_THROW(ReadRelightable(scratch.folder / "empty.lfr"), Error);
}

TEST(RelightableFile, RoundsToElevenBitsAtAnyScale) {
  for (const float scale : {1e-25f, 1e-6f, 1.0f, 1e6f, 1e25f}) {
    RelightableModel r = RandomRelightable({});
    for (float& w : r.model.weights) w *= 0.7391f * scale;
    for (float& v : r.model.residual_value) v *= 0.7391f * scale;
    for (float& v : r.model.bases[1].values) v *= scale;
    const RelightableModel stored = AsStored(r);
    const auto expect_near = [](const std::vector<float>& a, const std::vector<float>& b) {
      ASSERT_EQ(a.size(), b.size());
      for (size_t i = 0; i < a.size(); ++i) EXPECT_LE(std::abs(a[i] - b[i]), std::abs(a[i]) / 2048);
    };
    expect_near(r.model.weights, stored.model.weights);
    expect_near(r.model.residual_value, stored.model.residual_value);
    expect_near(r.model.bases[1].values, stored.model.bases[1].values);
    EXPECT_EQ(r.model.bases[2].values, stored.model.bases[2].values);
    ExpectEqual(stored, AsStored(stored));
  }
}

TEST(RelightableFile, HoldsExtremes) {
  RelightableModel black = RandomRelightable(
      {.width = 1, .height = 1, .channels = 1, .columns = 1, .clusters = 1, .most_residuals = 0});
  ExpectEqual(black, AsStored(black));
  black.model.first_residual.clear();  // no residual at all
  ExpectEqual(black, AsStored(black));
  RelightableModel zeros = RandomRelightable({});
  std::fill(zeros.model.weights.begin(), zeros.model.weights.end(), 0.0f);
  std::fill(zeros.model.residual_value.begin(), zeros.model.residual_value.end(), 0.0f);
  ExpectEqual(zeros, AsStored(zeros));
  RelightableModel shared = RandomRelightable({});  // weights in another order than rows
  std::fill(shared.model.first_weight.begin(), shared.model.first_weight.end(), 0);
  const RelightableModel stored = AsStored(shared);
  std::vector<float> expected(20), got(20);
  for (int64_t row = 0; row < shared.model.rows; ++row) {
    EvaluateRow(shared.model, row, -1, expected.data());
    EvaluateRow(stored.model, row, -1, got.data());
    EXPECT_EQ(expected, got);
  }
}

TEST(RelightableFile, HasTheDocumentedBytes) {
  RelightableModel r;
  r.name = "abc";
  r.points = 2;
  r.width = 2;
  r.height = 1;
  r.directions = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
  r.model.rows = 2;
  r.model.columns = 3;
  r.model.cluster = {1, 0};
  r.model.bases = {MakeFunctionRows(0, 3), MakeFunctionRows(1, 3)};
  r.model.bases[1].Row(0)[0] = 1;
  r.model.bases[1].Row(0)[2] = -0.5f;
  r.model.first_weight = {0, 1};
  r.model.weights = {3};
  r.model.first_residual = {0, 0, 2};
  r.model.residual_column = {2, 0};
  r.model.residual_value = {-4, 1};
  const std::string bytes = EncodeRelightable(r);
  const auto number = [&](size_t offset, size_t size) {
    uint64_t n = 0;
    std::memcpy(&n, bytes.data() + offset, size);
    return n;
  };
  // Head, name, 3 directions, terms, exponent, function, clusters, weight, counts, columns, values.
  ASSERT_EQ(bytes.size(), 136u + 8 + 72 + 8 + 8 + 8 + 8 + 8 + 8 + 8 + 8);
  EXPECT_EQ(bytes.substr(0, 8), "LFMRFL\r\n");
  EXPECT_EQ(number(8, 4), 1u);                              // version
  EXPECT_EQ(number(12, 4), 0u);                             // parallel lights
  EXPECT_EQ(number(16, 4), 1u);                             // channels
  EXPECT_EQ(number(20, 4), 2u);                             // width
  EXPECT_EQ(number(24, 4), 1u);                             // height
  EXPECT_EQ(number(28, 4), 3u);                             // columns
  EXPECT_EQ(number(32, 8), 2u);                             // points
  EXPECT_EQ(number(40, 4), 3u);                             // directions
  EXPECT_EQ(number(44, 4), 2u);                             // clusters
  EXPECT_EQ(number(48, 8), 1u);                             // functions
  EXPECT_EQ(number(56, 8), 1u);                             // weights
  EXPECT_EQ(number(64, 8), 2u);                             // residuals
  EXPECT_EQ(number(72, 8), 0u);                             // entries of the column basis
  EXPECT_EQ(number(80, 8), 0u);                             // positions
  EXPECT_EQ(number(88, 8), 0u);                             // triangles
  EXPECT_EQ(static_cast<int32_t>(number(96, 4)), 1 - 14);   // 3 = 1.5 x 2^1
  EXPECT_EQ(static_cast<int32_t>(number(100, 4)), 2 - 14);  // 4 = 2^2
  EXPECT_EQ(number(104, 4), 3u);                            // bytes of the name
  EXPECT_EQ(number(108, 1), 0u);                            // no column basis
  EXPECT_EQ(number(109, 1), 1u);                            // bytes of a number of residuals
  EXPECT_EQ(number(110, 2), 0u);
  EXPECT_EQ(number(112, 8), bytes.size());
  EXPECT_EQ(number(120, 8), Checksum(bytes.data() + 136, bytes.size() - 136));
  EXPECT_EQ(number(128, 8), Checksum(bytes.data(), 128));
  EXPECT_EQ(bytes.substr(136, 8), std::string("abc\0\0\0\0\0", 8));
  double direction[9];
  std::memcpy(direction, bytes.data() + 144, 72);
  EXPECT_EQ(direction[2], 1);
  EXPECT_EQ(direction[7], -1);
  EXPECT_EQ(number(216, 8), uint64_t{1} << 32);  // terms 0, 1
  EXPECT_EQ(static_cast<int16_t>(number(224, 2)), -14);
  EXPECT_EQ(number(232, 8), 0xf000'0000'7400u);  // 2^14, 0, -2^13
  EXPECT_EQ(number(240, 8), 0x0001u);            // clusters 1, 0
  EXPECT_EQ(number(248, 8), 0x7600u);            // 3 * 2^13
  EXPECT_EQ(number(256, 8), 0x0200u);            // 0 and 2 residuals
  EXPECT_EQ(number(264, 8), 0x0002u);            // columns 2, 0
  EXPECT_EQ(number(272, 8), 0x6c00'f400u);       // -2^14, 2^12
}

TEST(RelightableFile, RefusesEveryPrefixAndEveryFlippedByte) {
  const std::string bytes = EncodeRelightable(WithEverything());
  ASSERT_EQ(Refusal(bytes), "");
  for (size_t length = 0; length < bytes.size(); ++length) {
    // In a block of its own size, so that a sanitizer sees every read beyond it.
    EXPECT_NE(Refusal(std::string(bytes.data(), length)), "") << length;
  }
  EXPECT_NE(Refusal(bytes + '\0'), "");
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string flipped = bytes;
    flipped[i] = static_cast<char>(flipped[i] ^ 0x10);
    EXPECT_NE(Refusal(flipped), "") << i;
  }
}

TEST(RelightableFile, SaysWhatIsWrong) {
  const std::string bytes = EncodeRelightable(WithEverything());
  EXPECT_NE(Refusal("PNG....................").find("is not a model"), std::string::npos);
  EXPECT_NE(Refusal(WithHeader(bytes, [](auto& h) { h.version = 2; })).find("version 2"),
            std::string::npos);
  EXPECT_NE(Refusal(bytes.substr(0, bytes.size() - 8)).find("should have"), std::string::npos);
}

TEST(RelightableFile, HugeCountsInASoundHeaderTakeNoMemory) {
  const std::string bytes = EncodeRelightable(WithEverything());
  const std::vector<std::function<void(RelightableHeader&)>> changes = {
      [](auto& h) { h.points = uint64_t{1} << 36, h.positions = h.points; },
      [](auto& h) { h.points = std::numeric_limits<uint64_t>::max(); },
      [](auto& h) { h.columns = 1 << 16; },
      [](auto& h) { h.columns = 0; },
      [](auto& h) { h.directions = 1 << 24; },
      [](auto& h) { h.directions = 0xffffffff; },
      [](auto& h) { h.clusters = 1 << 16; },
      [](auto& h) { h.functions = uint64_t{1} << 40; },
      [](auto& h) { h.functions = uint64_t{1} << 63; },
      [](auto& h) { h.weights = uint64_t{1} << 40; },
      [](auto& h) { h.residuals = uint64_t{1} << 40; },
      [](auto& h) { h.basis_entries = uint64_t{1} << 40; },
      [](auto& h) { h.triangles = uint64_t{1} << 40; },
      [](auto& h) { h.name_bytes = 0xffffffff; },
      [](auto& h) { h.width = h.height = 0xffffffff; },
      [](auto& h) { h.width = 3; },
      [](auto& h) { h.channels = 2; },
      [](auto& h) { h.kind = 3; },
      [](auto& h) { h.count_bytes = 3; },
      [](auto& h) { h.count_bytes = 0; },
      [](auto& h) { h.has_column_basis = 2; },
      [](auto& h) { h.weight_exponent = 1 << 20; },
      [](auto& h) { h.residual_exponent = std::numeric_limits<int32_t>::min(); },
      [](auto& h) { h.weight_exponent = 120; },  // beyond float32
  };
  for (size_t i = 0; i < changes.size(); ++i) {
    EXPECT_NE(Refusal(WithHeader(bytes, changes[i])), "") << i;
    // The file's size agrees with the lie: its content has to be there.
    const std::string sized = WithHeader(bytes, [&](RelightableHeader& h) {
      changes[i](h);
      if (HeaderProblem(h).empty()) {
        h.file_bytes = static_cast<uint64_t>(MakeRelightableLayout(h).file_bytes);
      }
    });
    EXPECT_NE(Refusal(sized), "") << i;
  }
}

TEST(RelightableFile, RefusesContentThatContradictsItself) {
  const std::string bytes = EncodeRelightable(WithEverything());
  const auto refused = [&](RelightableSection section, int64_t at, const std::string& content) {
    return !Refusal(WithContent(bytes, section, at, content)).empty();
  };
  EXPECT_TRUE(refused(kDirectionSection, 0, std::string(24, '\0')));            // of no length
  EXPECT_TRUE(refused(kDirectionSection, 0, std::string(24, '\xff')));          // NaN
  EXPECT_TRUE(refused(kBasisFirstSection, 0, std::string(8, '\x7f')));          // far away
  EXPECT_TRUE(refused(kBasisFirstSection, 8, std::string(8, '\xff')));          // before the start
  EXPECT_TRUE(refused(kBasisDirectionSection, 0, "\x04"));                      // one too far
  EXPECT_TRUE(refused(kBasisValueSection, 0, std::string("\0\0\x80\x7f", 4)));  // infinite
  EXPECT_TRUE(refused(kPositionSection, 0, std::string("\0\0\x80\x7f", 4)));
  EXPECT_TRUE(refused(kTriangleSection, 0, "\x0c"));
  EXPECT_TRUE(refused(kTriangleSection, 0, std::string(4, '\xff')));
  EXPECT_TRUE(refused(kTermSection, 0, "\x01"));  // one function too many
  EXPECT_TRUE(refused(kTermSection, 0, std::string(4, '\xff')));
  EXPECT_TRUE(refused(kExponentSection, 0, "\xff\x7f"));
  EXPECT_TRUE(refused(kFunctionSection, 0, std::string("\0\x7c", 2)));  // infinite
  EXPECT_TRUE(refused(kClusterSection, 0, "\x04"));
  EXPECT_TRUE(refused(kWeightSection, 0, "\x01\x7e"));  // NaN
  EXPECT_TRUE(refused(kCountSection, 0, "\xff"));
  EXPECT_TRUE(refused(kColumnSection, 0, "\x06"));
  EXPECT_TRUE(refused(kValueSection, 0, std::string("\0\xfc", 2)));
}

TEST(RelightableFile, RefusesToWriteWhatIsNoModel) {
  const auto refused = [](const std::function<void(RelightableModel&)>& change) {
    RelightableModel r = WithEverything();
    change(r);
    EXPECT_THROW(EncodeRelightable(r), Error);
    EXPECT_THROW(CountBytes(r), Error);
  };
  refused([](auto& r) { r.channels = 2; });
  refused([](auto& r) { r.points = 0; });
  refused([](auto& r) { r.width = r.height = 5; });
  refused([](auto& r) { r.positions.pop_back(); });
  refused([](auto& r) { r.triangles[0][1] = 12; });
  refused([](auto& r) { r.directions[1] *= 2; });
  refused([](auto& r) { r.directions.clear(); });
  refused([](auto& r) { r.column_basis = {}; });
  refused([](auto& r) { r.column_basis.value.pop_back(); });
  refused([](auto& r) { r.model.weights[0] = std::numeric_limits<float>::quiet_NaN(); });
  refused([](auto& r) { r.model.residual_value[0] = std::numeric_limits<float>::infinity(); });
  refused([](auto& r) { r.model.cluster[0] = 4; });
  refused([](auto& r) { r.name = std::string(5000, 'x'); });
}

TEST(RelightableModel, AColumnBasisMakesCoefficientsOfLight) {
  ColumnBasis basis;
  EXPECT_EQ(ApplyColumnBasis(basis, {1, 2}), (std::vector<float>{1, 2}));
  basis.first = {0, 2, 2, 3};
  basis.direction = {0, 1, 1};
  basis.value = {2, -1, 0.5f};
  EXPECT_EQ(ApplyColumnBasis(basis, {3, 4}), (std::vector<float>{2, 0, 2}));
}

}  // namespace
}  // namespace lfm
