// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motiontrack
 *
 * Gives the regions of interest a stable identity, a velocity with the camera's motion taken out, an age and a state:
 * seen, coasted (carried on without evidence) or stopped (stands where it was last seen, and before a camera that stands
 * that place differs from what was there before). The regions on the frame are
 * replaced by the tracked ones; the frame goes through untouched. A person who leaves the picture because the camera
 * turns keeps the identity for `away-time`: place and motion are kept by angle, from the head's pose on the frames
 * where `horizontal-fov` is known, else from the camera's own motion. One who walks out of the picture of a head that
 * stands, at its limit for one, keeps it for `hold-stopped`, and is expected back at that side. People who meet are distinguished by how bright
 * coat and legs are, where the planes of the stages reach this element (nothing converts or scales the picture between
 * `motionregions` and it). Without `motionregions` upstream the regions are found here with the defaults. With
 * `horizontal-fov` each object also gets a bearing (degrees, positive to the right of the camera's axis, wherever the
 * head looks) and, where its feet are seen, a distance (metres); the camera's `tilt` counts for it, or that of a head's
 * pose on the frame. Limits of speed that contradict each other and a `confirm-time` above an hour are warned of.
 *
 * Where the camera's motion does not explain the scene (the picture blurs or shakes, or the camera drives past near
 * things), an object is published only while more changes inside its box than around it; an info message says so, once
 * a stream. `personverify` behind judges all of them itself, and gets them all: behind a `tee` every branch gets them,
 * also one without `personverify`. This needs the planes of the stages, too. With `personverify` in front objects are followed
 * and judged here by both witnesses, what moves and what the detector sees, as that element says it, in the messages, too.
 * Identities count from 1 in the order in which objects are published, and none is given twice.
 *
 * Boxes of persons that any other element upstream has found are such a witness, too: #GstVideoRegionOfInterestMeta, and from
 * GStreamer 1.24 on object detections of #GstAnalyticsRelationMeta, whose label is person, pedestrian, human, people, body,
 * man, woman or child, in any case. They are looks at the frame that they are on. The detector may look at few of the frames:
 * what its looks do not show any more ends, counted by the second shortest of its last four intervals. A confidence is that
 * of a network, .55 begins a track; a box without one (the number `confidence` of a param `detection`) is sure. Other labels
 * are ignored, and an info message names one where none of a person comes. Other caps, a flush, and 30 s without any box,
 * and motion alone counts. The boxes stay on the frame as they are. They do not count where `personverify` looks, in front
 * or behind.
 *
 * Posts `cerberus-motion` element messages: `state=started` with the objects when the first appears, `state=ended` when
 * none was there for `hold-time`, at the end of the stream and when the element stops, with the objects of the last
 * frame that had any. Where the source is live and frames stop coming, it is posted `hold-time` after the last one, by
 * the pipeline's clock. Posts `cerberus-track` element messages with the object, its first and its last time:
 * `state=appeared`; `state=updated` at most once a second while it is there; `state=left` after `hold-time` without it,
 * at the end of the stream and when the element stops. Both have `utc`, `utc-source` and `camera-name` where they are
 * known, and so has the frame for the elements behind.
 *
 * A buffer with the flag GAP repeats the last picture, as duplicates of `videorate` do: it is not looked at and carries
 * the objects of the last frame on, moving ones for `coast-time`, stopped ones for `hold-stopped`. A pose that
 * `cameramotion` attaches to it is that of the picture, wherever the head has turned since.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiontrack hold-time=500000000 ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// The paper tracks one target without details; see lib/vision/tracking/tracker.h for the method. Its limits of speed,
// 0.1 to 4 m/s (III), are the defaults in metres a second and count only while `horizontal-fov` is known.
#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(motiontrack_debug);
#define GST_CAT_DEFAULT motiontrack_debug

namespace cerberus::plugin {
namespace {

constexpr AnalysisInfo kInfo{"CerberusMotionTrack", "Motion tracks",
                             "Stable identities and velocities for the regions, camera motion taken out"};

}  // namespace

GType motiontrack_get_type() {
  return analysis_type<StageElement<vision::Stage::tracks>, kTracksProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motiontrack, GST_RANK_NONE, cerberus::plugin::motiontrack, motiontrack_debug,
                          "identities and velocities of moving objects")
