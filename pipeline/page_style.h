// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm {

/// What every report's page looks like.
inline constexpr const char* kPageStyle = R"(
body{font:16px/1.5 system-ui,sans-serif;max-width:1100px;margin:2rem auto;padding:0 1rem;color:#222}
h1{margin-bottom:.2rem} h2{margin-top:2.5rem;border-bottom:1px solid #ddd}
.lead{color:#555} table{border-collapse:collapse;margin:.8rem 0}
td,th{padding:.15rem .8rem .15rem 0;text-align:left;vertical-align:top} td.n{text-align:right;font-variant-numeric:tabular-nums}
figure{margin:1rem 0} figure img{max-width:100%;border:1px solid #ddd} figcaption{color:#555;font-size:.9rem}
.key{display:flex;flex-wrap:wrap;gap:1rem;margin:1rem 0} .key div{background:#f4f4f4;border-radius:8px;padding:.6rem 1rem}
.key b{display:block;font-size:1.4rem} iframe{width:100%;height:min(75vh,600px);border:1px solid #ddd;border-radius:8px} svg text{font:12px system-ui,sans-serif})";

}  // namespace lfm
