// SPDX-License-Identifier: LGPL-2.1-or-later
// Makes an MP4 file playable whose writer was killed in the moment in which it completes the file, and finds out whether
// there is anything in it to play.
//
// mp4mux (fragment-mode=first-moov-then-finalise) writes `ftyp free mdat moov (free mdat moof)*`, which plays at every
// moment. At the end it turns the `moov` into a `hoov`, extends the first `mdat` over everything, and appends another
// `moov` for all frames. Between these writes, some 100 microseconds, the file has no `moov` that is whole. All that
// the fragments need is still in it. A writer that is killed before the first `moov` leaves frames that nothing describes.
#pragma once

namespace cerberus::record {

enum class Mp4State {
  sound,     // it has a whole moov
  repaired,  // the first moov counts again, and the fragments behind it
  broken,    // it has none, and nothing of which a repair could make one: it plays nowhere
  failed,    // reading or writing failed; see errno
};

// `fd`: open for reading and writing; it does not append any more.
Mp4State repair_mp4(int fd);

}  // namespace cerberus::record
