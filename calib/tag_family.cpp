// SPDX-License-Identifier: BSD-3-Clause
#include "calib/tag_family.h"

#include <apriltag/apriltag.h>
#include <apriltag/common/image_u8.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include "core/error.h"

namespace lfm {
namespace {

using FamilyPointer = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

struct FamilyMaker {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

constexpr FamilyMaker kMakers[] = {
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
};

// An entry of the library's table of erroneous codes takes 16 bytes, and a third are used.
constexpr double kMaxTableEntries = 2e6;

FamilyPointer MakeFamily(const std::string& name, const std::string& where) {
  std::string names;
  for (const FamilyMaker& maker : kMakers) {
    if (name == maker.name) return {maker.create(), maker.destroy};
    names += (names.empty() ? "" : ", ") + std::string(maker.name);
  }
  throw Error(where + ": family: unknown tag family \"" + name + "\"; use one of " + names);
}

}  // namespace

TagFamily::TagFamily(const std::string& name, int border_cells, const std::string& where)
    : family_(MakeFamily(name, where)) {
  const int extra = border_cells - 1;
  if (extra < 0 || extra > 1 || (extra > 0 && family_->reversed_border)) {
    throw Error(where + ": border_cells: must be 1, or 2 for tag36h11, tag36h10, tag25h9, tag16h5");
  }
  // A wider border is the same code further in.
  family_->width_at_border += 2 * extra;
  family_->total_width += 2 * extra;
  for (uint32_t bit = 0; bit < family_->nbits; ++bit) {
    family_->bit_x[bit] += static_cast<uint32_t>(extra);
    family_->bit_y[bit] += static_cast<uint32_t>(extra);
  }
}

const std::vector<std::string>& TagFamily::Names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const FamilyMaker& maker : kMakers) all.push_back(maker.name);
    return all;
  }();
  return names;
}

int TagFamily::count() const { return static_cast<int>(family_->ncodes); }

int TagFamily::cells_per_side() const { return family_->width_at_border; }

int TagFamily::cells_across() const {
  return family_->reversed_border ? family_->total_width : family_->width_at_border;
}

int TagFamily::quiet_cells() const { return family_->reversed_border ? 0 : 1; }

int TagFamily::correctable_bits() const {
  const double codes = family_->ncodes, bits = family_->nbits;
  if (codes * (1 + bits + bits * (bits - 1) / 2) <= kMaxTableEntries) return 2;
  return codes * (1 + bits) <= kMaxTableEntries ? 1 : 0;
}

std::vector<uint8_t> TagFamily::Cells(int id) const {
  const int side = cells_across();
  const int margin = (family_->total_width - side) / 2;
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> picture(
      apriltag_to_image(family_.get(), static_cast<uint32_t>(id)), image_u8_destroy);
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
