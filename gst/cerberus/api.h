/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

/* Marks what the library exports; everything else stays inside (-fvisibility=hidden). */
#ifndef CERBERUS_API
#if defined(__GNUC__)
#define CERBERUS_API __attribute__((visibility("default"))) extern
#else
#define CERBERUS_API extern
#endif
#endif
