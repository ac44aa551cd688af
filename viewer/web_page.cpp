// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/web_page.h"

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/markup_text.h"
#include "viewer/web_bundle.h"

namespace lfm {
namespace {

constexpr std::string_view kTitleMark = "@LFM_TITLE@", kModelMark = "@LFM_MODEL_BASE64@";

// The page with what stands for `mark` in its one place.
std::string Filled(std::string_view page, std::string_view mark, std::string_view text) {
  const size_t at = page.find(mark);
  if (at == std::string_view::npos) {
    throw Error("the web page has no place for " + std::string(mark), ErrorKind::kSystem);
  }
  std::string filled;
  filled.reserve(page.size() + text.size());
  filled.append(page.substr(0, at)).append(text).append(page.substr(at + mark.size()));
  return filled;
}

std::string SinglePage(std::string_view glb, const std::string& title) {
  // The model first: a title may be anything, base 64 holds no mark.
  return Filled(Filled(web_bundle::SingleHtml(), kModelMark, Base64(glb)), kTitleMark,
                EscapeMarkup(title));
}

}  // namespace

std::string Base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  for (size_t i = 0, to = 0; i < bytes.size(); i += 3, to += 4) {
    uint32_t group = 0;
    const size_t count = bytes.size() - i < 3 ? bytes.size() - i : 3;
    for (size_t k = 0; k < count; ++k) {
      group |= static_cast<uint32_t>(static_cast<uint8_t>(bytes[i + k])) << (16 - 8 * k);
    }
    for (size_t k = 0; k <= count; ++k) text[to + k] = kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

void WriteWebFolder(std::string_view glb, const std::string& title,
                    const std::filesystem::path& folder) {
  WriteFilesTogether(folder, [&](const std::filesystem::path& files) {
    WriteFileAtomically(files / "model.glb", glb);
    WriteFileAtomically(files / "app.js", web_bundle::AppJs());
    WriteFileAtomically(files / "index.html",
                        Filled(web_bundle::IndexHtml(), kTitleMark, EscapeMarkup(title)));
    WriteFileAtomically(files / "model.html", SinglePage(glb, title));
  });
}

}  // namespace lfm
