// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"

namespace lfm::testing {

/// Runs `body`, which must throw an Error of one line that contains every one of `parts`.
inline void ExpectErrorWith(const std::vector<std::string>& parts,
                            const std::function<void()>& body) {
  try {
    body();
    ADD_FAILURE() << "no Error; expected one with '" << parts.front() << "'";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    for (const std::string& part : parts) {
      EXPECT_NE(what.find(part), std::string::npos) << what << "\nlacks: " << part;
    }
  }
}

inline void PutText(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// Remembers notes and steps.
class NotedProgress : public Progress {
 public:
  void Start(std::string_view, int64_t total) override { total_ = total; }
  void Advance(int64_t steps) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    steps_ += steps;
  }
  void Note(std::string_view line) override { notes_ += std::string(line) + "\n"; }

  const std::string& notes() const { return notes_; }
  bool Finished() const { return steps_ == total_; }

 private:
  std::mutex mutex_;
  int64_t total_ = -1, steps_ = 0;
  std::string notes_;
};

/// A linear float picture whose value at (x, y), channel c is `value(x, y, c)`.
inline Image FloatPicture(int width, int height, int channels,
                          const std::function<float(int, int, int)>& value) {
  Image image(width, height, channels, PixelType::kFloat32, ColorEncoding::kLinear);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.At<float>(x, y, c) = value(x, y, c);
    }
  }
  return image;
}

/// A picture file of 8 bits, all of one gray.
inline void PutGray(const std::filesystem::path& file, int width, int height, uint8_t gray) {
  Image image(width, height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  std::fill_n(image.Data<uint8_t>(), image.size(), gray);
  WriteImage(image, file);
}

}  // namespace lfm::testing
