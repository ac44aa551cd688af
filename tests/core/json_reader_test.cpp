// SPDX-License-Identifier: BSD-3-Clause
#include "core/json_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test_files.h"

namespace lfm {
namespace {

using nlohmann::json;

TEST(JsonReader, ReadsEveryType) {
  const json object = {{"n", 1.5},
                       {"i", -3},
                       {"b", true},
                       {"t", "text"},
                       {"ts", {"a"}},
                       {"ns", {1, 2.5}},
                       {"o", {{"k", 1}}},
                       {"rows", {{1, 2}, {3, 4.5}}},
                       {"os", {{{"k", 2}}, {{"k", 3}}}}};
  JsonReader reader(object, "f.json");
  EXPECT_EQ(reader.Number("n"), 1.5);
  EXPECT_EQ(reader.Integer("i", -3, 3), -3);
  EXPECT_TRUE(reader.Bool("b"));
  EXPECT_EQ(reader.Text("t"), "text");
  EXPECT_EQ(reader.Texts("ts"), std::vector<std::string>{"a"});
  EXPECT_EQ(reader.Numbers("ns", 2), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(reader.NumberRows("rows", 2), (std::vector<std::vector<double>>{{1, 2}, {3, 4.5}}));
  JsonReader inner = reader.Object("o");
  EXPECT_EQ(inner.Integer("k", 0, 9), 1);
  std::vector<JsonReader> list = reader.Objects("os");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[1].Integer("k", 0, 9), 3);
  EXPECT_EQ(reader.NumberOr("absent", 7), 7);
  EXPECT_EQ(reader.TextOr("absent", "x"), "x");
  EXPECT_FALSE(reader.Has("absent"));
  EXPECT_NO_THROW(reader.Finish());
}

TEST(JsonReader, EveryProblemNamesFileAndPlace) {
  const json object = {{"a", "text"},
                       {"big", 1e300},
                       {"huge", 18446744073709551615u},
                       {"list", {1, "x"}},
                       {"nested", {{{"deep", {{"key", 1}}}}}}};
  const auto fails = [&](const std::function<void(JsonReader&)>& read, const std::string& part) {
    ExpectError(
        [&] {
          JsonReader reader(object, "f.json");
          read(reader);
        },
        part);
  };
  fails([](JsonReader& r) { r.Number("a"); }, "f.json: a: expected a number");
  fails([](JsonReader& r) { r.Number("missing"); }, "f.json: missing: is missing");
  fails([](JsonReader& r) { r.NumberOr("a", 1); }, "a: expected a number");
  fails([](JsonReader& r) { r.Integer("big", 0, 9); }, "between 0 and 9");
  fails([](JsonReader& r) { r.Integer("huge", -5, 2147483647); }, "whole number");
  fails([](JsonReader& r) { r.Bool("a"); }, "a: expected true or false");
  fails([](JsonReader& r) { r.Text("big"); }, "big: expected a string");
  fails([](JsonReader& r) { r.Texts("list"); }, "list: expected an array of strings");
  fails([](JsonReader& r) { r.Numbers("list", 2); }, "list: expected an array of 2");
  fails([](JsonReader& r) { r.NumberRows("list", 2); }, "list: expected an array of rows of 2");
  fails([](JsonReader& r) { r.NumberRows("a", 2); }, "a: expected an array of rows of 2");
  fails([](JsonReader& r) { r.Object("a"); }, "a must be a JSON object");
  fails([](JsonReader& r) { r.Objects("list"); }, "list[0] must be a JSON object");
  fails([](JsonReader& r) { r.Objects("nested")[0].Object("deep").Text("key"); },
        "f.json: nested[0].deep.key: expected a string");
  fails([](JsonReader& r) { r.Finish(); }, "unknown key");
  ExpectError([] { JsonReader(json::array(), "f.json"); }, "f.json");
}

TEST(ReadJson, MalformedFilesTellLineAndColumn) {
  const TestFolder folder;
  Put(folder / "a.json", "{\"a\": 1,\n \"b\": }");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "line 2, column 7");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "a.json");
  Put(folder / "a.json", "");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "not valid JSON");
  Put(folder / "a.json", "{\"a\": NaN}");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "not valid JSON");
  Put(folder / "a.json", "{} {}");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "not valid JSON");
  Put(folder / "a.json", "{\"a\": \"\xff\"}");
  ExpectError([&] { ReadJson(folder / "a.json"); }, "not valid JSON");
  Put(folder / "a.json", std::string(1000000, '['));
  ExpectError([&] { ReadJson(folder / "a.json"); }, "nested too deeply");
  ExpectError([&] { ReadJson(folder / "none.json"); }, "none.json");
}

TEST(ReadJson, NumbersRoundTrip) {
  const TestFolder folder;
  const json numbers = {{"third", 1.0 / 3}, {"small", 5e-324}, {"large", 1.7976931348623157e308}};
  WriteJson(numbers, folder / "a.json");
  EXPECT_EQ(ReadJson(folder / "a.json"), numbers);
  EXPECT_EQ(folder.FileCount(), 1);
}

// Quaternions in files are w, x, y, z.
TEST(PoseJson, IsWxyzAndRoundTrips) {
  const json quarter_turn = {{"rotation", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}},
                             {"translation", {1, 2, 3}}};
  JsonReader reader(quarter_turn, "f.json");
  const Pose pose = PoseFromJson(reader);
  EXPECT_LT((pose * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-15);
  const Pose other = LookAt({3, 1, 4}, {1, 5, 9}, {0, 0, 1});
  const json written = PoseToJson(other);
  JsonReader back(written, "f.json");
  const Pose read = PoseFromJson(back);
  EXPECT_LT((read.rotation - other.rotation).norm(), 1e-14);
  EXPECT_EQ(read.translation, other.translation);
}

TEST(PoseJson, RefusesWhatIsNoUnitQuaternion) {
  const json object = {{"rotation", {1, 1, 0, 0}}, {"translation", {0, 0, 0}}};
  JsonReader reader(object, "f.json");
  ExpectError([&] { PoseFromJson(reader); }, "unit quaternion");
}

}  // namespace
}  // namespace lfm
