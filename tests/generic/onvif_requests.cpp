// SPDX-License-Identifier: LGPL-2.1-or-later
// Prints each ONVIF request that Cerberus sends, a line each: the body of SOAP's envelope. onvif_requests.py compares them
// with the published schemas.
#include <iostream>

#include "drivers/onvif/messages.h"

int main() {
  using namespace cerberus::drivers::onvif;
  using namespace std::chrono_literals;
  const PanTilt at{-0.25, 1, "http://www.onvif.org/ver10/tptz/PanTiltSpaces/PositionGenericSpace"};
  for (const Request& request :
       {get_system_date_and_time(), get_services(), get_capabilities(), get_profiles(),
        get_configuration_options("ptz<0>"), get_nodes(), get_status("p"), get_presets("p"),
        continuous_move("p", {1e-5, -1, ""}, 1500ms), continuous_move("p", {0, 0, at.space}, std::nullopt),
        absolute_move("p", at, PanTilt{.5, .5, ""}), absolute_move("p", at, std::nullopt), stop("p"),
        absolute_zoom("p", .25, "http://www.onvif.org/ver10/tptz/ZoomSpaces/PositionGenericSpace"),
        goto_preset("p", "1"), goto_home_position("p")})
    std::cout << request.body << '\n';
}
