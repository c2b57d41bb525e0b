// SPDX-License-Identifier: LGPL-2.1-or-later
// What a frame wants of the head: read from its fusion meta, or, where nobody fused, decided here by the two rules that
// need no sensors (1: follow whom the camera sees; 7: nobody there,
// return to zero). Whom the application chose goes before both.
#pragma once

#include <cerberus/fusion.h>

#include <optional>
#include <string>
#include <vector>

#include "control/law.h"
#include "fusion/chosen.h"
#include "fusion/fuser.h"

namespace cerberus::plugin {

class TargetSelector {
 public:
  struct Verdict {
    control::Wish wish;
    std::string reason;  // for a user
    guint lost = 0;      // the identity that was to be followed and is no longer, because it is on no frame
  };
  void set_options(const fusion::FuserOptions& options) { fuser_.set_options(options); }
  // Of time and tracks: another stream begins.
  void reset();
  // Whom to follow from now on; 0: the usual choice.
  void follow(guint id) { chosen_.choose(id); }
  // pan: radians, when the frame was taken.
  Verdict look(GstBuffer* frame, motion::Time time, double pan);
  // What was decided since the last frame: as if that had carried it, and it goes
  // before frames that were decided earlier (they come late, through queues). Nothing:
  // it is not to be obeyed, or it is about a point of a picture and waits for one.
  std::optional<Verdict> heed(const CerberusFusion& fusion);

 private:
  std::optional<vision::Point> middle_of(guint id) const;
  Verdict obey(const CerberusFusion& fusion) const;
  Verdict decide(motion::Time time, double pan);
  void prefer(motion::Time time, Verdict& verdict);

  fusion::Fuser fuser_;
  fusion::Chosen chosen_;
  std::vector<fusion::Track> tracks_;      // on the frame
  std::optional<CerberusFusion> between_;  // since the last frame
  std::optional<GstClockTime>
      decided_;           // what was obeyed last, and by fusion; nothing: the last frame had none
  bool follows_ = false;  // whom the application chose, who is here
};

}  // namespace cerberus::plugin
