// SPDX-License-Identifier: BSD-3-Clause
// The files are put in as they are by the assembler: a megabyte in a string literal takes a
// compiler seconds, and has limits.
#include "viewer/web_bundle.h"

#define LFM_EMBED(name, file)                                                \
  __asm__(".section .rodata\n" #name "_begin:\n.incbin \"" file "\"\n" #name \
          "_end:\n.byte 0\n.previous\n");                                    \
  extern "C" {                                                               \
  extern const char name##_begin[];                                          \
  extern const char name##_end[];                                            \
  }

LFM_EMBED(lfm_web_app_js, LFM_WEB_BUNDLE "/app.js")
LFM_EMBED(lfm_web_index_html, LFM_WEB_BUNDLE "/index.html")
LFM_EMBED(lfm_web_single_html, LFM_WEB_BUNDLE "/single.html")
LFM_EMBED(lfm_web_relight_app_js, LFM_WEB_BUNDLE "/relight_app.js")
LFM_EMBED(lfm_web_relight_index_html, LFM_WEB_BUNDLE "/relight_index.html")
LFM_EMBED(lfm_web_relight_single_html, LFM_WEB_BUNDLE "/relight_single.html")

namespace lfm::web_bundle {

std::string_view AppJs() { return {lfm_web_app_js_begin, lfm_web_app_js_end}; }
std::string_view IndexHtml() { return {lfm_web_index_html_begin, lfm_web_index_html_end}; }
std::string_view SingleHtml() { return {lfm_web_single_html_begin, lfm_web_single_html_end}; }
std::string_view RelightAppJs() {
  return {lfm_web_relight_app_js_begin, lfm_web_relight_app_js_end};
}
std::string_view RelightIndexHtml() {
  return {lfm_web_relight_index_html_begin, lfm_web_relight_index_html_end};
}
std::string_view RelightSingleHtml() {
  return {lfm_web_relight_single_html_begin, lfm_web_relight_single_html_end};
}

}  // namespace lfm::web_bundle
