/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* The one header to include: what Cerberus' elements attach to buffers, post and ask. */
#pragma once

#include <cerberus/api.h>
#include <cerberus/base.h>
#include <cerberus/camera-motion.h>
#include <cerberus/caps.h>
#include <cerberus/fusion.h>
#include <cerberus/message.h>
#include <cerberus/pantilt.h>
#include <cerberus/pir.h>
#include <cerberus/pose.h>
#include <cerberus/region.h>
#include <cerberus/stamp.h>
#include <cerberus/truth.h>
#include <cerberus/version.h>
