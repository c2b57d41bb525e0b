// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/pantilt.h>

#include "private/head.hpp"
#include "private/structure.hpp"
#include "private/text.hpp"

GstMessage* cerberus_message_new_pantilt(GstObject* src, GstClockTime running_time, const gchar* state,
                                         const gchar* reason, const CerberusPose* pose) {
  g_return_val_if_fail(!src || GST_IS_OBJECT(src), nullptr);
  g_return_val_if_fail(state && pose, nullptr);
  // Of a driver and of a user: a field that is no UTF-8 would be lost, and the message with it.
  const std::string why = cerberus::printable(reason ? reason : "");
  const std::string head = cerberus::printable(cerberus::head_of(*pose));
  return gst_message_new_element(
      src, gst_structure_new(CERBERUS_MESSAGE_PANTILT, "state", G_TYPE_STRING, state, "reason", G_TYPE_STRING,
                             why.c_str(), "head", G_TYPE_STRING, head.c_str(), "pan", G_TYPE_DOUBLE,
                             pose->pan, "tilt", G_TYPE_DOUBLE, pose->tilt, "running-time", G_TYPE_UINT64,
                             static_cast<guint64>(running_time), nullptr));
}

CerberusPose* cerberus_message_parse_pantilt(GstMessage* message, GstClockTime* running_time, gchar** state,
                                             gchar** reason) {
  g_return_val_if_fail(GST_IS_MESSAGE(message), nullptr);
  const GstStructure* s = cerberus::element_structure(message, CERBERUS_MESSAGE_PANTILT);
  if (!s) return nullptr;
  const gchar* said = gst_structure_get_string(s, "state");
  const gchar* why = gst_structure_get_string(s, "reason");
  const gchar* head = gst_structure_get_string(s, "head");
  CerberusPose pose;
  cerberus_pose_init(&pose);
  guint64 time = 0;
  if (!said || !why || !head || !gst_structure_get_double(s, "pan", &pose.pan) ||
      !gst_structure_get_double(s, "tilt", &pose.tilt) || !gst_structure_get_uint64(s, "running-time", &time))
    return nullptr;
  cerberus_pose_set_head(&pose, head);
  pose.valid_from = time;
  if (running_time) *running_time = time;
  if (state) *state = g_strdup(said);
  if (reason) *reason = g_strdup(why);
  return cerberus_pose_copy(&pose);
}
