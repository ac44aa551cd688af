// SPDX-License-Identifier: BSD-3-Clause
// Nothing of its own: the target that owns the precompiled headers needs a file.
