// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lfm {

/// The files of a folder and of the levels of folders below, by their names in lower case; paths
/// are relative to the folder, with '/'. Hidden folders and links to folders are passed over.
struct FileNames {
  std::filesystem::path folder;
  std::map<std::string, std::vector<std::string>> paths;
};

/// Throws Error when the folder cannot be read or holds more than a million files.
FileNames ListFileNames(const std::filesystem::path& folder, int levels);

/// Where a picture lies whose path was written on whichever machine, with '/' or '\': where the
/// path leads, if that is a file inside the folder, else the files of its name, regardless of case,
/// whose folders agree with the path's longest; of those, the ones of the very same name; of those,
/// the ones least deep. None: there is no such file; several: it cannot be told.
std::vector<std::string> FindPicture(const FileNames& names, const std::string& path);

}  // namespace lfm
