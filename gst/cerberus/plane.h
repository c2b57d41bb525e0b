/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CerberusPlaneKind:
 * @CERBERUS_PLANE_LUMA: brightness at analysis size, 8 bit
 * @CERBERUS_PLANE_DIFFERENCE: registered difference of this frame and the previous one, 8 bit
 * @CERBERUS_PLANE_PREVIOUS_DIFFERENCE: registered difference of the two frames before, in this frame's coordinates,
 *   8 bit; made only where somebody downstream asks for planes (%CERBERUS_QUERY_PLANES) or needs it for the moving area
 * @CERBERUS_PLANE_HISTOGRAM: histogram of the difference: one row of words of 32 bit, host byte order; the
 *   first 256 are the counts, what follows belongs to the elements
 * @CERBERUS_PLANE_MASK: moving area, 0 or 255, 8 bit
 * @CERBERUS_PLANE_LABELS: number of the connected part of the mask that a pixel belongs to, 0 for none, 16 bit, host
 *   byte order; a region may be several parts, and two people in one part are two regions
 *
 * What a plane holds.
 *
 * Since: 0.1
 */
typedef enum {
  CERBERUS_PLANE_LUMA,
  CERBERUS_PLANE_DIFFERENCE,
  CERBERUS_PLANE_PREVIOUS_DIFFERENCE,
  CERBERUS_PLANE_HISTOGRAM,
  CERBERUS_PLANE_MASK,
  CERBERUS_PLANE_LABELS
} CerberusPlaneKind;

/**
 * CerberusPlaneMeta:
 * @meta: parent
 * @kind: what the plane holds
 * @buffer: the samples, never written again
 * @width: samples in a row
 * @height: rows
 * @stride: bytes from one row to the next
 *
 * A reference to one stage's small picture. It rides through tee and queue and dies where the frame is converted,
 * scaled or encoded, which is what it should. One of each kind a buffer.
 *
 * Since: 0.1
 */
typedef struct _CerberusPlaneMeta CerberusPlaneMeta;
struct _CerberusPlaneMeta {
  GstMeta meta;
  CerberusPlaneKind kind;
  GstBuffer* buffer;
  gint width;
  gint height;
  gint stride;
};

#define CERBERUS_TYPE_PLANE_KIND (cerberus_plane_kind_get_type())
#define CERBERUS_PLANE_META_API_TYPE (cerberus_plane_meta_api_get_type())
#define CERBERUS_PLANE_META_INFO (cerberus_plane_meta_get_info())

CERBERUS_API
GType cerberus_plane_kind_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_plane_meta_api_get_type(void);

/**
 * cerberus_plane_meta_get_info: (skip)
 *
 * Returns: the registered #GstMetaInfo of #CerberusPlaneMeta.
 *
 * Since: 0.1
 */
CERBERUS_API
const GstMetaInfo* cerberus_plane_meta_get_info(void);

/**
 * cerberus_plane_kind_sample_size:
 * @kind: a kind of plane
 *
 * Returns: bytes of one sample of @kind: 1, 2 (labels) or 4 (histogram); 0 for an unknown kind.
 *
 * Since: 0.1
 */
CERBERUS_API
gint cerberus_plane_kind_sample_size(CerberusPlaneKind kind);

/**
 * cerberus_buffer_add_plane_meta: (skip)
 * @buffer: a writable buffer
 * @kind: what @plane holds
 * @plane: (transfer full): the samples, at least @stride * (@height - 1) + @width * sample size bytes; nobody writes
 *     into it any more
 * @width: samples in a row
 * @height: rows
 * @stride: bytes from one row to the next, at least a row's
 *
 * Attaches @plane, replacing the one of @kind that is there already.
 *
 * Returns: (transfer none) (nullable): the meta on @buffer; %NULL (and @plane released) for nonsensical sizes.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusPlaneMeta* cerberus_buffer_add_plane_meta(GstBuffer* buffer, CerberusPlaneKind kind, GstBuffer* plane,
                                                  gint width, gint height, gint stride);

/**
 * cerberus_buffer_get_plane_meta: (skip)
 * @buffer: a buffer
 * @kind: a kind of plane
 *
 * Returns: (transfer none) (nullable): the plane of @kind on @buffer.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusPlaneMeta* cerberus_buffer_get_plane_meta(GstBuffer* buffer, CerberusPlaneKind kind);

/**
 * cerberus_buffer_get_plane:
 * @buffer: a buffer
 * @kind: a kind of plane
 * @width: (out) (optional): samples in a row
 * @height: (out) (optional): rows
 * @stride: (out) (optional): bytes from one row to the next
 *
 * Returns: (transfer full) (nullable): the samples of the plane of @kind, to be read only; %NULL if there is none.
 *
 * Since: 0.1
 */
CERBERUS_API
GstBuffer* cerberus_buffer_get_plane(GstBuffer* buffer, CerberusPlaneKind kind, gint* width, gint* height,
                                     gint* stride);

/**
 * cerberus_buffer_remove_plane_metas:
 * @buffer: a writable buffer
 *
 * Removes the planes of every kind.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_buffer_remove_plane_metas(GstBuffer* buffer);

G_END_DECLS
