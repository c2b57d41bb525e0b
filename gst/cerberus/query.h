/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_QUERY_PLANES:
 *
 * Name of the structure of the custom query that asks downstream whether anybody wants the stages' planes.
 *
 * An element that wants them answers: it calls cerberus_query_set_planes_wanted() and returns %TRUE from its query
 * function. All others let the query pass (a tee asks branch after branch until one answers); one that takes the planes
 * off the frames returns %FALSE itself, so that nobody behind it is asked.
 *
 * Since: 0.1
 */
#define CERBERUS_QUERY_PLANES "cerberus-planes"

/**
 * cerberus_query_new_planes:
 *
 * Returns: (transfer full): a new %CERBERUS_QUERY_PLANES, for gst_pad_peer_query(); the answer is "not wanted" so far.
 *
 * Since: 0.1
 */
CERBERUS_API
GstQuery* cerberus_query_new_planes(void);

/**
 * cerberus_query_is_planes:
 * @query: a query
 *
 * Returns: %TRUE if @query is a %CERBERUS_QUERY_PLANES.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_query_is_planes(GstQuery* query);

/**
 * cerberus_query_set_planes_wanted:
 * @query: a writable %CERBERUS_QUERY_PLANES
 * @wanted: whether the planes are wanted
 *
 * Answers @query.
 *
 * Returns: %FALSE if @query is another query.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_query_set_planes_wanted(GstQuery* query, gboolean wanted);

/**
 * cerberus_query_parse_planes:
 * @query: a %CERBERUS_QUERY_PLANES
 * @wanted: (out) (optional): whether the planes are wanted
 *
 * Reads the answer.
 *
 * Returns: %FALSE (and nothing is written) if @query is another query.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_query_parse_planes(GstQuery* query, gboolean* wanted);

/**
 * cerberus_pad_peer_wants_planes:
 * @pad: a source pad
 *
 * Asks downstream of @pad. Call it when caps were agreed on and when the pad was asked to reconfigure, not for every
 * buffer, and without holding a lock that downstream might want.
 *
 * Returns: %TRUE if somebody downstream wants planes.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_pad_peer_wants_planes(GstPad* pad);

G_END_DECLS
