// SPDX-License-Identifier: LGPL-2.1-or-later
// Makes an MP4 file playable whose writer was killed in the moment in which it completes the file.
//
// mp4mux (fragment-mode=first-moov-then-finalise) writes `ftyp free mdat moov (free mdat moof)*`, which plays at every
// moment. At the end it turns the `moov` into a `hoov`, extends the first `mdat` over everything, and appends another
// `moov` for all frames. Between these writes, some 100 microseconds, the file has no `moov` that is whole. All that
// the fragments need is still in it.
#pragma once

namespace cerberus::record {

enum class Mp4State {
  sound,     // it has a whole moov, or nothing that a repair knows
  repaired,  // the first moov counts again, and the fragments behind it
  failed,    // reading or writing failed; see errno
};

// `fd`: open for reading and writing.
Mp4State repair_mp4(int fd);

}  // namespace cerberus::record
