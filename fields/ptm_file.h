// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "fields/quantized_fit.h"

namespace lfm {

/// A fit of a picture's pixels, row by row from the top.
struct FitPicture {
  int width = 0, height = 0;
  QuantizedFit fit;
};

/// The bytes of a polynomial texture map, version 1.2 of the format (Malzbender and Gelb,
/// "Polynomial Texture Map (.ptm) File Format"), as RTIViewer, relight and web viewers open it:
/// PTM_FORMAT_RGB (a polynomial a channel) or, of a fit with a chroma, PTM_FORMAT_LRGB. Six lines
/// of text
///
///   PTM_1.2 / the format / width / height / six scales / six biases
///
/// then coefficients (a0 to a5 of pixel after pixel; of PTM_FORMAT_RGB all of red first), then the
/// chroma of PTM_FORMAT_LRGB, rows from the bottom. A coefficient is scale * (byte - bias), the
/// polynomial's value 0 to 255 and what the screen shows; the light's frame is the picture's
/// (ViewFrame). One channel without chroma is written as LRGB, white.
///
/// Throws Error when the basis is another, the values are not display-coded, or sizes do not agree.
std::string EncodePtm(const FitPicture& picture);
/// The inverse, frame = the picture's. Line ends may be Windows', numbers stand on lines as they
/// like. Throws Error, `name` in front, when the bytes are of another format (compressed ones are
/// named), cut short or longer than they say, or a number is not finite or out of range. Takes
/// memory in proportion to `bytes`.
FitPicture DecodePtm(std::string_view bytes, const std::string& name);

void WritePtm(const FitPicture& picture, const std::filesystem::path& file);
FitPicture ReadPtm(const std::filesystem::path& file);

}  // namespace lfm
