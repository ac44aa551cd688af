// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lfm {

/// The files that rules are about, by their path from the top of the tree.
using SourceTree = std::map<std::string, std::string>;

/// Reads every source file, CMakeLists.txt and README.md below the rooms of a checkout.
SourceTree ReadSourceTree(const std::filesystem::path& top);

/// Broken rules, one line each, in the order of the files:
/// - a stage includes only itself, core/, and public headers of stages to its left; core/ includes
///   only itself; sample_data/ only core/, calib/board.h and scan/patterns.h; headers of the
///   project are included as "room/file.h";
/// - only sample_data/, pipeline/, tests/ and bench/ know the word ground_truth;
/// - every source file has its SPDX line and at most 400 lines;
/// - every stage has a README.md of at most 20 lines.
std::vector<std::string> FindBrokenRules(const SourceTree& tree);

/// Tests ("Suite.Name", in back quotes) that a document names although no file of the tree's tests/
/// defines them.
std::vector<std::string> FindUnknownTests(const std::string& document, const SourceTree& tree);

}  // namespace lfm
