// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/film_recorder.h"

#include <cstdio>
#include <utility>

#include "core/error.h"

namespace lfm {

FilmRecorder::FilmRecorder(std::vector<OrbitCamera> cameras, std::filesystem::path folder)
    : cameras_(std::move(cameras)), folder_(std::move(folder)) {}

double FilmRecorder::Share() const {
  return cameras_.empty() ? 1 : static_cast<double>(next_) / static_cast<double>(cameras_.size());
}

void FilmRecorder::Record(const Image& frame) {
  std::error_code failure;
  std::filesystem::create_directories(folder_, failure);
  if (failure) {
    throw Error("cannot make the folder " + folder_.string() + ": " + failure.message());
  }
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", next_);
  WriteImage(frame, folder_ / name);
  ++written_;
  ++next_;
}

std::string FilmRecorder::Summary() const {
  return std::to_string(written_) + (written_ == 1 ? " frame in " : " frames in ") +
         folder_.string();
}

std::filesystem::path FreeName(const std::string& prefix, const std::string& suffix) {
  constexpr int kMost = 9999;
  for (int number = 1; number <= kMost; ++number) {
    char digits[16];
    std::snprintf(digits, sizeof(digits), "%04d", number);
    const std::filesystem::path name = prefix + digits + suffix;
    std::error_code unknown;  // then writing says why
    if (!std::filesystem::exists(name, unknown)) return name;
  }
  throw Error("this folder is full of " + prefix + "*" + suffix + "; move them away");
}

}  // namespace lfm
