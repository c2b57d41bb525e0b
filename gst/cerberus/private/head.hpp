// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cerberus/pose.h>

namespace cerberus {

inline constexpr char kHead[] = "head";  // of a pose that names none

// Never NULL: an application may have left the name out, and then it is the head that is there.
inline const gchar* head_of(const CerberusPose& pose) {
  return pose.head ? pose.head : g_intern_static_string(kHead);
}

}  // namespace cerberus
