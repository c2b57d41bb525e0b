/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_REGION_STRUCTURE:
 *
 * Name of the structure that holds a region in messages and in the params of a #GstVideoRegionOfInterestMeta.
 */
#define CERBERUS_REGION_STRUCTURE "cerberus-object"

/**
 * CerberusRegionState:
 * @CERBERUS_REGION_SEEN: measured in this frame
 * @CERBERUS_REGION_COASTED: carried on by its velocity, nothing was measured in this frame
 * @CERBERUS_REGION_STOPPED: it stands, and is held where it was, or only a person detector shows it
 *
 * How a region's place was determined.
 */
typedef enum { CERBERUS_REGION_SEEN, CERBERUS_REGION_COASTED, CERBERUS_REGION_STOPPED } CerberusRegionState;

/**
 * CerberusRegionKind:
 * @CERBERUS_REGION_KIND_PERSON_LIKE: one whole object of the size of a person (or of other objects looked for): its box
 *   is reliable
 * @CERBERUS_REGION_KIND_GROUP: as high as a person and wider: several people, or one with something
 * @CERBERUS_REGION_KIND_PART: too low for a person: a piece of one
 * @CERBERUS_REGION_KIND_THING: neither: much larger, solid, or in a scene whose people's height is not known yet
 *
 * What a region is, judged by its size and by the people of the scene. It is not verified.
 */
typedef enum {
  CERBERUS_REGION_KIND_PERSON_LIKE,
  CERBERUS_REGION_KIND_GROUP,
  CERBERUS_REGION_KIND_PART,
  CERBERUS_REGION_KIND_THING
} CerberusRegionKind;

/**
 * CerberusRegion:
 * @id: identity of the track (from 1, stable over frames) if @tracked, else a number within the frame
 * @tracked: @id, @vx, @vy, @age and @state come from a tracker
 * @person: looks of a person detector show it: those of `personverify`, or another element's whose boxes a tracker takes
 * @kind: what it is by its size
 * @x: left edge, frame pixels
 * @y: top edge, frame pixels
 * @width: frame pixels
 * @height: frame pixels
 * @confidence: that it is one whole object, 0 to 1; of a person of `personverify` the evidence of looks for it, 0 to 1
 * @vx: speed to the right, frame pixels a second, the camera's motion taken out
 * @vy: speed downwards, frame pixels a second, the camera's motion taken out; both as the video is played: backwards
 *     they are the other way round
 * @age: time since the object was first seen
 * @state: how its place was determined
 * @bearing: direction of its centre from the camera's axis (the head's
 *     pan is not in it), degrees, positive to the right; NaN if unknown
 * @distance: metres from the camera; NaN if unknown, as both are of a person whom only a people detector has found
 * @motion: motion supports it: a track of what moves has its place, or has had it within the last second
 *
 * Something that moves, or a person: @motion and @person say which witnesses it has. On a buffer it is also a
 * #GstVideoRegionOfInterestMeta of type `motion` (`person` if @person), which other elements and tools read.
 *
 * Regions follow the picture through copying, converting, scaling and encoding, and are lost where it is cropped. Do
 * not turn or flip a picture between the elements that find regions and those that read them: videoflip keeps them
 * unchanged, which is wrong and cannot be detected.
 */
typedef struct _CerberusRegion {
  guint id;
  gboolean tracked;
  gboolean person;
  CerberusRegionKind kind;
  gdouble x, y, width, height;
  gdouble confidence;
  gdouble vx, vy;
  GstClockTime age;
  CerberusRegionState state;
  gdouble bearing, distance;
  gboolean motion;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING - 1];
} CerberusRegion;

#define CERBERUS_TYPE_REGION (cerberus_region_get_type())
#define CERBERUS_TYPE_REGION_KIND (cerberus_region_kind_get_type())
#define CERBERUS_TYPE_REGION_STATE (cerberus_region_state_get_type())

/**
 * cerberus_region_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusRegion, cerberus_region)
CERBERUS_DECLARE_ENUM(CerberusRegionKind, cerberus_region_kind)
CERBERUS_DECLARE_ENUM(CerberusRegionState, cerberus_region_state)

/**
 * cerberus_region_to_structure:
 * @region: a region
 *
 * Writes @region as a structure named `cerberus-object`, as it stands in messages. Numbers that are not finite are left
 * out.
 *
 * Returns: (transfer full) (nullable): a new structure; %NULL only for a %NULL @region.
 */
CERBERUS_API
GstStructure* cerberus_region_to_structure(const CerberusRegion* region);

/**
 * cerberus_region_from_structure:
 * @structure: a structure
 *
 * Reads what cerberus_region_to_structure() wrote. Fields that are missing, or of another type, keep the defaults of
 * cerberus_region_new().
 *
 * Returns: (transfer full) (nullable): a new region; %NULL if @structure is not a `cerberus-object`.
 */
CERBERUS_API
CerberusRegion* cerberus_region_from_structure(const GstStructure* structure);

/**
 * cerberus_buffer_add_region:
 * @buffer: a writable buffer
 * @region: what to attach, copied
 *
 * Attaches @region as #GstVideoRegionOfInterestMeta with the params `detection` (confidence), `object_id` (id, only if
 * tracked) and `cerberus-object` (everything), and where GStreamer has it (1.24) in a #GstAnalyticsRelationMeta too.
 * The meta's whole pixels are the ones nearest to @region's edges, cut at the frame's left and top.
 *
 * Returns: %TRUE if attached; %FALSE if @buffer is not writable, a number is not finite or beyond 2^24
 *   pixels, an extent is negative, or kind or state is none of theirs.
 */
CERBERUS_API
gboolean cerberus_buffer_add_region(GstBuffer* buffer, const CerberusRegion* region);

/**
 * cerberus_buffer_set_regions:
 * @buffer: a writable buffer
 * @regions: (element-type CerberusRegion) (nullable): the result of a detector, copied: an empty array if it found
 *   nothing; %NULL if no detector has analysed @buffer
 *
 * Replaces all regions of @buffer.
 *
 * Returns: %TRUE if @buffer now carries @regions; %FALSE if @buffer is not writable, or if
 *   cerberus_buffer_add_region() would refuse one of @regions (the others are attached).
 */
CERBERUS_API
gboolean cerberus_buffer_set_regions(GstBuffer* buffer, GPtrArray* regions);

/**
 * cerberus_buffer_regions_known:
 * @buffer: a buffer
 *
 * Distinguishes a frame on which nothing was found from one that no detector has analysed. The mark follows the picture
 * as regions do: it survives copying, converting, scaling and encoding, and is lost where a picture is cropped.
 *
 * Returns: %TRUE if a detector upstream has analysed @buffer, with or without a result.
 */
CERBERUS_API
gboolean cerberus_buffer_regions_known(GstBuffer* buffer);

/**
 * cerberus_buffer_get_regions:
 * @buffer: a buffer
 *
 * Reads all regions, in the order in which they were attached; if there are none, cerberus_buffer_regions_known()
 * returns whether a detector has analysed @buffer. If the picture was scaled since, positions and speeds follow it, to
 * fractions of a pixel. Regions of interest that other elements attached are not returned.
 *
 * Returns: (transfer container) (element-type CerberusRegion): copies of the regions, possibly none; release with
 *     g_ptr_array_unref(), which frees the regions too.
 */
CERBERUS_API
GPtrArray* cerberus_buffer_get_regions(GstBuffer* buffer);

/**
 * cerberus_buffer_remove_regions:
 * @buffer: a writable buffer
 *
 * Removes all regions that cerberus_buffer_add_region() attached, and the mark that a detector has analysed @buffer;
 * regions of interest of other elements stay.
 */
CERBERUS_API
void cerberus_buffer_remove_regions(GstBuffer* buffer);

G_END_DECLS
