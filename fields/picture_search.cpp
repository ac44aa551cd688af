// SPDX-License-Identifier: BSD-3-Clause
#include "fields/picture_search.h"

#include <algorithm>
#include <functional>

#include "core/capture.h"
#include "core/error.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;

std::string LowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::vector<std::string> Steps(const std::string& path) {
  std::vector<std::string> steps;
  for (size_t begin = 0; begin <= path.size();) {
    const size_t end = std::min(path.find('/', begin), path.size());
    const std::string step = path.substr(begin, end - begin);
    if (!step.empty() && step != ".") steps.push_back(step);
    begin = end + 1;
  }
  return steps;
}

bool LeadsToFile(const fs::path& folder, const std::string& file) {
  std::error_code error;
  return CapturePathProblem(folder, file).empty() && fs::is_regular_file(folder / file, error);
}

int AgreeingFolders(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  int count = 0;
  while (count < static_cast<int>(std::min(a.size(), b.size())) - 1 &&
         LowerCase(a[a.size() - 2 - count]) == LowerCase(b[b.size() - 2 - count])) {
    ++count;
  }
  return count;
}

// Keeps those of the highest score.
void KeepBest(std::vector<std::string>& paths,
              const std::function<int(const std::string&)>& score) {
  int best = 0;
  std::vector<int> scores;
  for (const std::string& path : paths) scores.push_back(score(path));
  if (!scores.empty()) best = *std::max_element(scores.begin(), scores.end());
  std::vector<std::string> kept;
  for (size_t i = 0; i < paths.size(); ++i) {
    if (scores[i] == best) kept.push_back(paths[i]);
  }
  paths = std::move(kept);
}

}  // namespace

FileNames ListFileNames(const fs::path& folder, int levels) {
  constexpr int kMostFiles = 1000000;
  FileNames names{folder, {}};
  int count = 0;
  std::error_code error;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    std::error_code ignored;
    if (it->is_directory(ignored)) {
      const bool hidden = it->path().filename().string().starts_with('.');
      if (hidden || it.depth() >= levels) it.disable_recursion_pending();
    } else if (it->is_regular_file(ignored)) {
      if (++count > kMostFiles) {
        throw Error(
            folder.string() + ": holds more than " + std::to_string(kMostFiles) +
            " files; put the light positions and their pictures into a folder of their own");
      }
      names.paths[LowerCase(it->path().filename().string())].push_back(
          it->path().lexically_relative(folder).generic_string());
    }
  }
  if (error) {
    throw Error(folder.string() + ": the folder cannot be read (" + error.message() + ")");
  }
  for (auto& [name, paths] : names.paths) std::sort(paths.begin(), paths.end());
  return names;
}

std::vector<std::string> FindPicture(const FileNames& names, const std::string& path) {
  if (LeadsToFile(names.folder, path)) return {fs::path(path).lexically_normal().generic_string()};
  std::string slashed = path;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  if (LeadsToFile(names.folder, slashed)) {
    return {fs::path(slashed).lexically_normal().generic_string()};
  }
  const std::vector<std::string> steps = Steps(slashed);
  if (steps.empty()) return {};
  const auto found = names.paths.find(LowerCase(steps.back()));
  if (found == names.paths.end()) return {};
  std::vector<std::string> paths;
  for (const std::string& candidate : found->second) {
    if (CapturePathProblem(names.folder, candidate).empty()) paths.push_back(candidate);
  }
  KeepBest(paths, [&](const std::string& p) { return AgreeingFolders(Steps(p), steps); });
  KeepBest(paths, [&](const std::string& p) { return Steps(p).back() == steps.back() ? 1 : 0; });
  KeepBest(paths, [&](const std::string& p) { return -static_cast<int>(Steps(p).size()); });
  return paths;
}

}  // namespace lfm
