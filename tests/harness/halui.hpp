// halui on a machine of the harness.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "clients/halui/layout.hpp"
#include "clients/halui/participant.hpp"
#include "hal/client/session.hpp"
#include "harness/machine.hpp"
#include "ini/ini_file.hpp"

namespace kerf::harness {

/// Made by the machine's INI file, running, and with task found; Machine::remove() it before it ends. nullptr: the test has failed.
inline std::unique_ptr<clients::halui::HaluiParticipant> add_halui(Machine& m) {
  const auto ini = ini::IniFile::load(m.folder() + "/mill.ini");
  const auto layout = clients::halui::read_layout(ini.file);
  EXPECT_TRUE(layout.ok());
  if (!layout.ok()) return nullptr;
  auto halui =
      std::make_unique<clients::halui::HaluiParticipant>(m.segment(), m.session(), *layout);
  EXPECT_TRUE(halui->status().ok()) << halui->status().error().message();
  halui->on_end([](const rtapi::Error& why) { ADD_FAILURE() << "halui: " << why.message(); });
  m.add(*halui);
  m.run_for(0.05);
  return halui;
}

}  // namespace kerf::harness
