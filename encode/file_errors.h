// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "core/error.h"

namespace lfm {

/// What `read` returns. An Error that it throws begins with the file's name: what parts of a reader
/// that know no file (layouts, blocks, pictures beside it) throw gets the name put before it.
template <typename Read>
auto NamingFile(const std::string& file, Read&& read) {
  try {
    return std::forward<Read>(read)();
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.starts_with(file)) throw;
    throw Error(file + ": " + message, error.kind());
  }
}

}  // namespace lfm
