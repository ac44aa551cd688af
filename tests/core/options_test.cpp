// SPDX-License-Identifier: BSD-3-Clause
#include "core/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/command_line.h"
#include "test_files.h"

namespace lfm {
namespace {

enum class Flavour { kPlain, kSweet };

struct CakeOptions {
  double sugar = 0.5;
  int layers = 3;
  bool icing = false;
  std::string name = "cake";
  Flavour flavour = Flavour::kSweet;
  void Declare(OptionVisitor& v) {
    v.Number({"sugar", "How sweet.", "kg", 0, 2}, sugar);
    v.Integer({"layers", "How high.", "", 1, 9}, layers);
    v.Flag({"icing", "Whether iced."}, icing);
    v.Text({"name", "What it is called."}, name);
    v.Enumeration({"flavour", "Which flavour."}, {"plain", "sweet"}, flavour);
  }
};

TEST(Options, RoundTripThroughJson) {
  CakeOptions options;
  options.sugar = 1.0 / 3;
  options.layers = 7;
  options.icing = true;
  options.name = "\"torte\"";
  options.flavour = Flavour::kPlain;
  const nlohmann::json json = OptionsToJson(AnyOptions(options));
  EXPECT_EQ(json["flavour"], "plain");
  CakeOptions back;
  OptionsFromJson(AnyOptions(back), nlohmann::json::parse(json.dump()), "file");
  EXPECT_EQ(back.sugar, options.sugar);
  EXPECT_EQ(back.layers, 7);
  EXPECT_TRUE(back.icing);
  EXPECT_EQ(back.name, "\"torte\"");
  EXPECT_EQ(back.flavour, Flavour::kPlain);
}

TEST(Options, JsonSetsOnlyWhatItNames) {
  CakeOptions options;
  OptionsFromJson(AnyOptions(options), {{"layers", 4}}, "file");
  EXPECT_EQ(options.layers, 4);
  EXPECT_EQ(options.sugar, 0.5);
}

TEST(Options, JsonProblemsNameFileAndOption) {
  const auto read = [](const nlohmann::json& json) {
    return [json] {
      CakeOptions options;
      OptionsFromJson(AnyOptions(options), json, "cake.json");
    };
  };
  ExpectError(read({{"suger", 1}}), "cake.json: unknown option 'suger'");
  ExpectError(read({{"sugar", "1"}}), "option 'sugar' must be a number");
  ExpectError(read({{"layers", 1.5}}), "option 'layers' must be a whole number");
  ExpectError(read({{"icing", 1}}), "option 'icing' must be true or false");
  ExpectError(read({{"name", 1}}), "option 'name' must be a string");
  ExpectError(read({{"flavour", "sour"}}), "one of: plain, sweet");
  ExpectError(read({{"sugar", 3}}), "--sugar is 3 but must be between 0 and 2 kg");
  ExpectError(read({{"layers", 5000000000}}), "--layers");
  ExpectError(read({{"layers", 50000000}}), "--layers is 50000000 but must be between 1 and 9");
  ExpectError(read(nlohmann::json::array()), "cake.json");
}

TEST(Options, NanViolatesEveryRange) {
  CakeOptions options;
  options.sugar = std::nan("");
  ExpectError([&] { ValidateOptions(AnyOptions(options)); }, "--sugar");
  options.sugar = std::numeric_limits<double>::infinity();
  ExpectError([&] { ValidateOptions(AnyOptions(options)); }, "--sugar");
}

int RunCake(std::vector<std::string> arguments, CakeOptions& options, std::string* error) {
  arguments.insert(arguments.begin(), "lfm-cake");
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  CommandLine line("lfm-cake", "Bakes.", "lfm-cake --sugar 1");
  line.Options(AnyOptions(options), "Cake");
  testing::internal::CaptureStderr();
  const int status = line.Run(static_cast<int>(argv.size()), argv.data(), [](Progress&) {});
  *error = testing::internal::GetCapturedStderr();
  return status;
}

// One declaration: what the command line accepts and refuses is what JSON accepts and refuses, with
// the same message.
TEST(Options, CommandLineJsonAndValidationAgree) {
  std::string error;
  CakeOptions from_line;
  ASSERT_EQ(
      RunCake({"--sugar", "0.25", "--layers", "2", "--icing", "--name", "x", "--flavour", "plain"},
              from_line, &error),
      0)
      << error;
  CakeOptions from_json;
  OptionsFromJson(
      AnyOptions(from_json),
      {{"sugar", 0.25}, {"layers", 2}, {"icing", true}, {"name", "x"}, {"flavour", "plain"}},
      "file");
  EXPECT_EQ(OptionsToJson(AnyOptions(from_line)), OptionsToJson(AnyOptions(from_json)));

  CakeOptions invalid;
  invalid.layers = 12;
  std::string message;
  try {
    ValidateOptions(AnyOptions(invalid));
  } catch (const Error& e) {
    message = e.what();
  }
  ASSERT_FALSE(message.empty());
  CakeOptions options;
  EXPECT_EQ(RunCake({"--layers", "12"}, options, &error), 2);
  EXPECT_EQ(error, "lfm-cake: error: " + message + "\n");
  ExpectError([&] { OptionsFromJson(AnyOptions(options), {{"layers", 12}}, "file"); }, message);
}

// The file comes first, what is typed wins.
TEST(Options, CommandLineWinsOverTheConfigFile) {
  const TestFolder folder;
  Put(folder / "cake.toml", "sugar = 1.5\nflavour = \"plain\"\nlayers = 5\n");
  CakeOptions options;
  std::string error;
  const std::vector<std::string> typed = {
      "--config", (folder / "cake.toml").string(), "--flavour", "sweet", "--sugar", "1"};
  ASSERT_EQ(RunCake(typed, options, &error), 0) << error;
  EXPECT_EQ(options.flavour, Flavour::kSweet);
  EXPECT_EQ(options.sugar, 1);
  EXPECT_EQ(options.layers, 5);
  EXPECT_EQ(RunCake({"--flavour", "sour"}, options, &error), 2);
  EXPECT_NE(error.find("flavour"), std::string::npos) << error;
  EXPECT_EQ(RunCake({"--flavour", "1"}, options, &error), 2) << "a number is no name";
}

TEST(Options, ConfigFileSetsThemAndRefusesUnknownNames) {
  const TestFolder folder;
  Put(folder / "cake.toml", "sugar = 1.5\nflavour = \"plain\"\nicing = true\n");
  CakeOptions options;
  std::string error;
  ASSERT_EQ(RunCake({"--config", (folder / "cake.toml").string()}, options, &error), 0) << error;
  EXPECT_EQ(options.sugar, 1.5);
  EXPECT_EQ(options.flavour, Flavour::kPlain);
  EXPECT_TRUE(options.icing);
  Put(folder / "cake.toml", "suger = 1.5\n");
  EXPECT_EQ(RunCake({"--config", (folder / "cake.toml").string()}, options, &error), 2);
  EXPECT_NE(error.find("suger"), std::string::npos) << error;
  EXPECT_EQ(RunCake({"--config", (folder / "none.toml").string()}, options, &error), 2);
}

}  // namespace
}  // namespace lfm
