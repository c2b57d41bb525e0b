// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_opening.hpp"

#include <utility>

#include "cerberus/private/messages.hpp"
#include "deferred_notifications.hpp"
#include "head_names.hpp"

namespace cerberus::plugin {

std::unique_ptr<drivers::HeadRunner> open_head(GstElement* element, const HeadSettings& s,
                                               std::function<void()> moved, std::function<void()> refused) {
  const char* name = s.head.c_str();
  if (!g_utf8_validate(name, -1, nullptr)) {  // no event could carry it, and nobody would hear of the head
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, SETTINGS,
                           ("The head's name \"%s\" is no UTF-8: give it another (head=).", name), (nullptr));
    return nullptr;
  }
  const drivers::HeadSetup setup = head_setup(s);
  if (const std::string wrong = motion::check(setup.limits); !wrong.empty()) {
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, SETTINGS, (wrong + "."), ("head %s", name));
    return nullptr;
  }
  auto head = drivers::make_head(s.driver);
  if (!head) {
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, SETTINGS,
                           ("There is no head driver \"%s\": take one of %s.", s.driver.c_str(),
                            drivers::head_drivers().c_str()),
                           ("head %s", name));
    return nullptr;
  }
  auto lease = lease_head(s.head);
  if (!lease) {
    CERBERUS_ELEMENT_ERROR(
        element, RESOURCE, BUSY,
        ("Another pantiltsink drives the head \"%s\" already: give each its own name (head=).", name),
        (nullptr));
    return nullptr;
  }
  auto runner = std::make_unique<drivers::HeadRunner>(std::move(head), std::move(lease), std::move(moved),
                                                      std::move(refused));
  runner->set_close_patience(kClosePatience);
  if (runner->open(setup, kOpenPatience) == drivers::HeadRunner::Answer::failed) {
    refuse(element, name, runner->refusal());
    return nullptr;
  }
  return runner;
}

}  // namespace cerberus::plugin
