// SPDX-License-Identifier: LGPL-2.1-or-later
// Other projects' laws, written anew from their descriptions, before the same heads. They get what this project's law
// gets, less the turn of the picture and of the base, which they do not use.
#pragma once

#include <memory>
#include <string>

#include "closed_loop.h"

namespace cerberus::bench {

// proportional  the speed is gain x the newest box's angle from the optical axis; rests within 1.5 degrees
// jump          goes to the box at full speed, then waits until the head rests and a newer picture came
// jump5         the same with 5 pictures a second and the person's own motion predicted over the move, as Frigate's
//               autotracking does
// autoptz       aim = error + v (.15 s + delay + dead time, at most .8 s), dead zone .05, one-euro filter (1.1 Hz, beta
//               .03), kp .6, kd .05, kv .1, at most .7, |x|^1.2, slew 3 a second, 20 times a second, errors in half
//               pictures: as AutoPTZ 2.2 describes itself
inline constexpr const char* kPeerLaws[] = {"proportional", "jump", "jump5", "autoptz"};

// gain: of the proportional law, radians a second for each radian.
std::unique_ptr<FollowingLaw> peer_law(const std::string& name, sim::PanHead& head,
                                       const sim::CameraTraits& camera, double gain);
// jump and jump5 need a head that goes to positions.
bool can_drive(const std::string& peer, const sim::HeadTraits& traits);

}  // namespace cerberus::bench
