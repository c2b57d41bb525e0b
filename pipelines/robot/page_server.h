// SPDX-License-Identifier: LGPL-2.1-or-later
// The page of the robot: a web server that checks every request, and the messages of open pages. Main loop's thread.
#pragma once

#include <libsoup/soup.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "background_work.h"
#include "base_output.h"
#include "camera.h"
#include "fleet_client.h"
#include "page_listener.h"
#include "robot/page/access.h"
#include "robot/page/client_address.h"
#include "robot/page/devices.h"
#include "robot/page/events.h"
#include "robot/page/passwords.h"
#include "viewer.h"

namespace cerberus::robot {

class PageServer {
 public:
  struct House {
    const Settings& settings;
    BaseOutput* base;  // nullptr: there is none
    const std::vector<std::unique_ptr<Camera>>& cameras;
    std::function<Mode()> mode;
    std::function<void(Mode)> set_mode;
  };

  explicit PageServer(House house);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  // Reads the passwords and listens; prints the one-time password where the owner has none. False, and what is wrong.
  bool open(std::string& error);
  // Once a second: reports the state to every open page.
  void tick();

 private:
  struct Request;

  void authorize(SoupServerMessage* message, std::string_view path);
  void answer(Request& request);
  void answer_page(Request& request);
  void answer_session(Request& request);
  bool must_wait(Request& request, std::string_view account) const;
  void log_in(Request& request);
  void log_in_device(Request& request, const std::string& token);
  const Device* device_of(const std::string& token);  // as the file has it now
  void begin_device_session(Request& request, const Device& device, const std::string& token);
  void end_revoked_devices();
  void log_out(Request& request);
  void set_password(Request& request);
  void answer_events(Request& request);
  static record::Wanted wanted_of(const Request& request, const std::string& camera);
  void answer_recording(Request& request);
  void change_recording(Request& request);
  void answer_log(Request& request);
  void answer_picture(Request& request);
  void ask_for_picture(Request& request);
  void open_socket(SoupServerMessage* message, SoupWebsocketConnection* connection);
  void on_text(Viewer& viewer, std::string_view text);
  void execute(Viewer& viewer, const Session& session, const PageCommand& command);
  void steer(Viewer& viewer, const PageCommand& command);
  bool set(Viewer& viewer, const PageCommand& command);
  void leave(SoupWebsocketConnection* connection);
  void close_strangers();
  void update_watched();
  std::string hello(const Session& session) const;
  std::string state();
  Camera* camera(std::string_view name) const;
  Events& events_of(const Camera& camera);
  Session* session_of(SoupServerMessage* message);
  Client client(SoupServerMessage* message) const;
  bool is_local(SoupServerMessage* message) const;  // asked for by a browser on this machine
  // Continues a request in the background's thread and answers it then.
  void answer_later(Request& request, std::function<void()> work, std::function<void(Request&)> done);
  void finish_log_in(Request& request, Role role, bool one_time);
  void keep_password(Request& request, Role role, std::string hash);
  bool listen(std::string& error);
  void set_cookie(SoupServerMessage* message, const char* name, const std::string& token,
                  const char* age) const;
  std::string path_of_passwords() const { return house_.settings.state_folder + "/passwords"; }

  House house_;
  Passwords passwords_;
  Devices devices_;
  Sessions sessions_;
  RateLimit limit_;
  Steering steering_;
  SoupServer* server_ = nullptr;
  std::vector<std::unique_ptr<Viewer>> viewers_;
  std::map<std::string, Events> events_;  // by folder
  guint64 changes_ = 0;                   // of recordings, by pages
  BackgroundWork background_;
  PageListener listener_;
#if HAVE_MQTT
  std::unique_ptr<FleetClient> fleet_;
#endif
  double cpu_seconds_ = 0;
  gint64 measured_ = 0;  // microseconds
};

}  // namespace cerberus::robot
