// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lfm {

/// One line of an .lp file.
struct LpLight {
  std::string picture;       ///< as written: a path of whichever machine
  Eigen::Vector3d to_light;  ///< unit; x right in the picture, y up, z to the viewer
  int line = 0;              ///< in the file, from 1
};

/// Light positions of reflectance transformation imaging (RTIBuilder, PTMfitter, relight).
struct LpFile {
  std::vector<LpLight> lights;  ///< at least one
  int64_t not_unit = 0;  ///< lines whose x, y, z had another length than 1 within 1 %: positions
};

/// Reads .lp text (docs/formats.md): the number of lights, then for each the picture's path and x,
/// y, z, apart by blanks or tabs; the path may hold blanks and stand in double quotes. A byte order
/// mark, Windows or old Macintosh line ends, blank lines, and lines that begin with # and hold no
/// light are skipped. Vectors of any length from 1e-30 to 1e30 are normalised: relight writes
/// positions. `name` stands for the file in messages.
///
/// Throws Error that names file, line and cure when the text is empty or not text, the first line
/// is no count, the count is not that of the lights (both are named), a line has no path or not
/// three finite numbers, or a vector has no direction. Takes memory for what is there, whatever the
/// count says.
LpFile ParseLp(std::string_view text, const std::string& name);
/// The same of a file, of 64 MB at most.
LpFile ReadLpFile(const std::filesystem::path& file);

}  // namespace lfm
