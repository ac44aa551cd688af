// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_family.h"

#include <apriltag/apriltag.h>
#include <apriltag/common/image_u8.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>

#include "core/error.h"

namespace lfm {
namespace {

using FamilyPointer = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

FamilyPointer MakeFamily(const std::string& name, const std::string& where) {
  if (name == "tag36h11") return {tag36h11_create(), tag36h11_destroy};
  if (name == "tag36h10") return {tag36h10_create(), tag36h10_destroy};
  if (name == "tag25h9") return {tag25h9_create(), tag25h9_destroy};
  if (name == "tag16h5") return {tag16h5_create(), tag16h5_destroy};
  throw Error(where + ": family: unknown tag family \"" + name +
              "\"; use tag36h11, tag36h10, tag25h9 or tag16h5");
}

}  // namespace

TagFamily::TagFamily(const std::string& name, const std::string& where)
    : family_(MakeFamily(name, where)) {}

int TagFamily::count() const { return static_cast<int>(family_->ncodes); }

int TagFamily::cells_per_black_square() const { return family_->width_at_border; }

std::vector<uint8_t> TagFamily::Cells(int id) const {
  const int side = family_->width_at_border;
  const int margin = (family_->total_width - side) / 2;
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> picture(
      apriltag_to_image(family_.get(), id), image_u8_destroy);
  std::vector<uint8_t> cells(static_cast<size_t>(side) * side);
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const size_t at = static_cast<size_t>(row + margin) * picture->stride + column + margin;
      cells[static_cast<size_t>(row) * side + column] = picture->buf[at] >= 128 ? 1 : 0;
    }
  }
  return cells;
}

}  // namespace lfm
