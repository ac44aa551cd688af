// SPDX-License-Identifier: BSD-3-Clause
#include "house_rules.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

namespace lfm {
namespace {

constexpr int64_t kMaxSourceLines = 400, kMaxReadmeLines = 20;

/// From left to right; core/ stands before all of them.
const std::vector<std::string> kStages = {"calib",  "scan",   "mesh",   "resample",
                                          "fields", "encode", "viewer", "pipeline"};
const std::set<std::string> kRooms = {"core",     "calib",       "scan",   "mesh",
                                      "resample", "fields",      "encode", "viewer",
                                      "pipeline", "sample_data", "tests",  "bench"};
const std::set<std::string> kSampleDataMayInclude = {"calib/board.h", "scan/patterns.h"};
const std::set<std::string> kMayKnowGroundTruth = {"sample_data", "pipeline", "tests", "bench"};

std::string Room(const std::string& path) { return path.substr(0, path.find('/')); }

int Rank(const std::string& stage) {
  const auto found = std::find(kStages.begin(), kStages.end(), stage);
  return found == kStages.end() ? -1 : static_cast<int>(found - kStages.begin());
}

bool HasEnding(const std::string& path, const std::vector<std::string>& endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const std::string& e) { return path.ends_with(e); });
}

bool IsCpp(const std::string& path) { return HasEnding(path, {".h", ".cpp"}); }

bool IsSource(const std::string& path) {
  return IsCpp(path) || HasEnding(path, {"CMakeLists.txt", ".cmake", ".js", ".mjs", ".ts", ".py",
                                         ".glsl", ".vert", ".frag"});
}

int64_t CountLines(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n') + (!text.empty() && text.back() != '\n');
}

/// The public headers that a CMakeLists.txt declares with lfm_stage, as "room/file.h".
std::set<std::string> PublicHeaders(const std::string& room, const std::string& cmake) {
  static const std::set<std::string> keywords = {"SOURCES", "LINK", "PRIVATE_LINK"};
  std::string text = std::regex_replace(cmake, std::regex("#[^\n]*"), "");
  text = std::regex_replace(text, std::regex("[()]"), " ) ");
  std::set<std::string> headers;
  std::istringstream words(text);
  bool listing = false;
  for (std::string word; words >> word;) {
    if (word == "PUBLIC_HEADERS") {
      listing = true;
    } else if (word == ")" || keywords.contains(word)) {
      listing = false;
    } else if (listing) {
      headers.insert(room + "/" + word);
    }
  }
  return headers;
}

std::vector<std::string> QuotedIncludes(const std::string& text) {
  static const std::regex pattern("^[ \t]*#[ \t]*include[ \t]*\"([^\"]*)\"",
                                  std::regex::ECMAScript | std::regex::multiline);
  std::vector<std::string> includes;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    includes.push_back((*it)[1]);
  }
  return includes;
}

/// Why a file of `room` may not include `header`; empty when it may.
std::string IncludeProblem(const std::string& room, const std::string& header,
                           const std::map<std::string, std::set<std::string>>& public_headers) {
  const std::string owner = Room(header);
  if (owner == header || !kRooms.contains(owner)) return "is not of the form \"room/file.h\"";
  if (owner == room) return "";
  if (owner == "tests" || owner == "bench") return "belongs to the tests";
  if (room == "sample_data" && owner != "core" && !kSampleDataMayInclude.contains(header)) {
    return "is not for sample_data, which knows core/, calib/board.h and scan/patterns.h";
  }
  if (owner == "sample_data") return "is sample_data's own";
  if (room == "core") return "is not core's";
  if (owner != "core" && room != "sample_data" && Rank(owner) > Rank(room)) {
    return "belongs to a stage to the right";
  }
  const auto declared = public_headers.find(owner);
  if (declared == public_headers.end() || !declared->second.contains(header)) {
    return "is not a public header";
  }
  return "";
}

bool HasSpdxLine(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  // A script has its interpreter in the first line.
  for (int i = 0; i < 2 && std::getline(lines, line); ++i) {
    if (line.find("SPDX-License-Identifier: BSD-3-Clause") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

SourceTree ReadSourceTree(const std::filesystem::path& top) {
  SourceTree tree;
  for (const std::string& room : kRooms) {
    if (!std::filesystem::exists(top / room)) continue;
    std::filesystem::recursive_directory_iterator it(top / room), end;
    for (; it != end; ++it) {
      const std::string name = it->path().filename().string();
      if (it->is_directory() && (name == "node_modules" || name == "dist" || name[0] == '.')) {
        it.disable_recursion_pending();
        continue;
      }
      const std::string path = std::filesystem::relative(it->path(), top).generic_string();
      if (!it->is_regular_file() || !(IsSource(path) || name == "README.md")) continue;
      std::ifstream stream(it->path(), std::ios::binary);
      tree[path] = {std::istreambuf_iterator<char>(stream), {}};
    }
  }
  return tree;
}

std::vector<std::string> FindBrokenRules(const SourceTree& tree) {
  std::map<std::string, std::set<std::string>> public_headers;
  for (const std::string& room : kRooms) {
    const auto cmake = tree.find(room + "/CMakeLists.txt");
    if (cmake != tree.end()) public_headers[room] = PublicHeaders(room, cmake->second);
  }
  std::vector<std::string> broken;
  std::set<std::string> rooms_with_code;
  for (const auto& [path, text] : tree) {
    const std::string room = Room(path);
    if (!IsSource(path)) continue;
    if (!HasSpdxLine(text)) broken.push_back(path + ": the SPDX line is missing");
    if (CountLines(text) > kMaxSourceLines) {
      broken.push_back(path + ": has " + std::to_string(CountLines(text)) + " lines");
    }
    const bool checked_room = room != "tests" && room != "bench";
    if (!checked_room || !IsCpp(path)) continue;
    rooms_with_code.insert(room);
    for (const std::string& header : QuotedIncludes(text)) {
      const std::string problem = IncludeProblem(room, header, public_headers);
      if (!problem.empty())
        broken.push_back(path + ": includes \"" + header + "\", which " + problem);
    }
    if (!kMayKnowGroundTruth.contains(room) && text.find("ground_truth") != std::string::npos) {
      broken.push_back(path + ": knows of ground_truth");
    }
  }
  for (const std::string& room : rooms_with_code) {
    const auto readme = tree.find(room + "/README.md");
    if (readme == tree.end()) {
      broken.push_back(room + "/README.md: is missing");
    } else if (CountLines(readme->second) > kMaxReadmeLines) {
      broken.push_back(room + "/README.md: has " + std::to_string(CountLines(readme->second)) +
                       " lines");
    }
  }
  return broken;
}

std::vector<std::string> FindUnknownTests(const std::string& document, const SourceTree& tree) {
  static const std::regex definition("TEST(?:_F|_P)?\\(\\s*(\\w+)\\s*,\\s*(\\w+)\\s*\\)");
  static const std::regex mention("`([A-Z]\\w+\\.[A-Z]\\w+)`");
  std::set<std::string> known;
  for (const auto& [path, text] : tree) {
    if (Room(path) != "tests") continue;
    for (std::sregex_iterator it(text.begin(), text.end(), definition), end; it != end; ++it) {
      known.insert((*it)[1].str() + "." + (*it)[2].str());
    }
  }
  std::vector<std::string> unknown;
  for (std::sregex_iterator it(document.begin(), document.end(), mention), end; it != end; ++it) {
    if (!known.contains((*it)[1])) unknown.push_back((*it)[1]);
  }
  return unknown;
}

}  // namespace lfm
