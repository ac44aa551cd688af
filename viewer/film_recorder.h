// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image.h"
#include "viewer/orbit_camera.h"

namespace lfm {

/// Writes a film's frames, FOLDER/frame_0000.png and so on, one a call, so that a window stays
/// alive meanwhile.
class FilmRecorder {
 public:
  /// Nothing to record.
  FilmRecorder() = default;
  /// Frames of the size of pictures that Record is given. `folder` is made with the first frame.
  FilmRecorder(std::vector<OrbitCamera> cameras, std::filesystem::path folder);

  bool Done() const { return next_ >= cameras_.size(); }
  double Share() const;  ///< of the frames, [0, 1]; 1 when done
  /// The camera of the frame that is next.
  const OrbitCamera& Camera() const { return cameras_[next_]; }
  /// Writes it. Throws Error when it cannot be written.
  void Record(const Image& frame);
  /// Leaves the frames that are not written out.
  void Stop() { next_ = cameras_.size(); }
  /// "120 frames in lfm-viewer-film-0001".
  std::string Summary() const;

 private:
  std::vector<OrbitCamera> cameras_;
  std::filesystem::path folder_;
  size_t next_ = 0, written_ = 0;
};

/// The first of PREFIX0001SUFFIX to PREFIX9999SUFFIX in the current folder that does not exist.
/// Throws Error when all do.
std::filesystem::path FreeName(const std::string& prefix, const std::string& suffix);

}  // namespace lfm
