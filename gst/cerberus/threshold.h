/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CerberusThreshold:
 * @threshold: the threshold used, grey levels 0 to 255: a pixel moves if its registered difference is above it
 * @fuzzy_threshold: what the indices of fuzziness alone chose, before the noise floor's guard rail, grey levels
 * @noise: sigma of the registered difference where nothing moves, grey levels
 * @ready: %FALSE until three frames of the scene were seen: there is no moving area yet
 *
 * How the moving area of a frame was chosen.
 *
 * Since: 0.1
 */
typedef struct _CerberusThreshold CerberusThreshold;
struct _CerberusThreshold {
  guint threshold;
  guint fuzzy_threshold;
  gdouble noise;
  gboolean ready;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
};

/**
 * CerberusThresholdMeta:
 * @meta: parent
 * @threshold: the threshold
 *
 * Carries a #CerberusThreshold on a video buffer. A fact about the moment: it survives scaling, cropping and encoding.
 * At most one a buffer.
 *
 * Since: 0.1
 */
typedef struct _CerberusThresholdMeta CerberusThresholdMeta;
struct _CerberusThresholdMeta {
  GstMeta meta;
  CerberusThreshold threshold;
};

#define CERBERUS_TYPE_THRESHOLD (cerberus_threshold_get_type())
#define CERBERUS_THRESHOLD_META_API_TYPE (cerberus_threshold_meta_api_get_type())
#define CERBERUS_THRESHOLD_META_INFO (cerberus_threshold_meta_get_info())

CERBERUS_API
GType cerberus_threshold_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_threshold_meta_api_get_type(void);

/**
 * cerberus_threshold_meta_get_info: (skip)
 *
 * Returns: the registered #GstMetaInfo of #CerberusThresholdMeta.
 *
 * Since: 0.1
 */
CERBERUS_API
const GstMetaInfo* cerberus_threshold_meta_get_info(void);

/**
 * cerberus_threshold_new: (constructor)
 *
 * Makes a threshold that is all zero and not ready.
 *
 * Returns: (transfer full): a new threshold; free with cerberus_threshold_free().
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusThreshold* cerberus_threshold_new(void);

/**
 * cerberus_threshold_copy:
 * @threshold: a threshold
 *
 * Returns: (transfer full) (nullable): a copy; %NULL only for a %NULL @threshold.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusThreshold* cerberus_threshold_copy(const CerberusThreshold* threshold);

/**
 * cerberus_threshold_free: (skip)
 * @threshold: (transfer full) (nullable): a threshold
 *
 * Frees @threshold.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_threshold_free(CerberusThreshold* threshold);

/**
 * cerberus_buffer_add_threshold_meta: (skip)
 * @buffer: a writable buffer
 * @threshold: what to attach, copied
 *
 * Attaches @threshold, replacing one that is there already.
 *
 * Returns: (transfer none) (nullable): the meta on @buffer.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusThresholdMeta* cerberus_buffer_add_threshold_meta(GstBuffer* buffer,
                                                          const CerberusThreshold* threshold);

/**
 * cerberus_buffer_set_threshold:
 * @buffer: a writable buffer
 * @threshold: (nullable): what to attach, copied; %NULL removes
 *
 * Attaches @threshold, replacing one that is there already: the form for bindings.
 *
 * Returns: %TRUE if @buffer now carries @threshold (or none, for %NULL); %FALSE if @buffer is not writable.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_buffer_set_threshold(GstBuffer* buffer, const CerberusThreshold* threshold);

/**
 * cerberus_buffer_get_threshold_meta: (skip)
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the meta on @buffer, without a copy.
 *
 * Since: 0.1
 */
CERBERUS_API
const CerberusThresholdMeta* cerberus_buffer_get_threshold_meta(GstBuffer* buffer);

/**
 * cerberus_buffer_get_threshold:
 * @buffer: a buffer
 *
 * Returns: (transfer full) (nullable): a copy of the threshold, or %NULL if nothing upstream chose one.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusThreshold* cerberus_buffer_get_threshold(GstBuffer* buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(CerberusThreshold, cerberus_threshold_free)

G_END_DECLS
