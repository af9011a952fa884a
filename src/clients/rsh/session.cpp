#include "clients/rsh/session.hpp"

#include <algorithm>
#include <utility>

#include "clients/rsh/text.hpp"

namespace kerf::rsh {

namespace {
constexpr std::size_t kMaxMessages = 256;
constexpr std::size_t kMaxSent = 256;

bool is_paused(const clients::Stat& now) { return now.interp_state == 3 || now.task_paused; }

/// Without "MDI:1:4: ": who typed the line knows where it stands.
std::string without_mdi_place(std::string_view text) {
  constexpr std::string_view kPlace = "MDI:";
  if (text.substr(0, kPlace.size()) != kPlace) return std::string(text);
  const auto end = text.find_first_not_of("0123456789:", kPlace.size());
  if (end == std::string_view::npos || text[end] != ' ') return std::string(text);
  return std::string(text.substr(end + 1));
}

}  // namespace

Session::Session(Shell& shell, Machine& machine, int number)
    : shell_(shell), machine_(machine), number_(number) {
  shell_.sessions.push_back(this);
}

Session::~Session() { std::erase(shell_.sessions, this); }

std::string Session::take_output() { return std::exchange(output_, {}); }

void Session::put(std::string_view text, bool stamp) {
  while (true) {
    const auto end = text.find('\n');
    if (stamp) output_ += fixed(machine_.wall_time_s()) + " ";
    output_ += text.substr(0, end);
    output_ += "\r\n";
    if (end == std::string_view::npos) return;
    text.remove_prefix(end + 1);
  }
}

void Session::say(const std::string& text) { put(text, settings.timestamp); }

void Session::feed(std::string_view bytes, rtapi::Nanos now) {
  // Lines that came together are a script and keep their order; a line that comes while another is waited for may be urgent.
  const bool waited = waits();
  for (const char c : bytes) {
    if (ended_) return;
    if (c != '\r' && c != '\n') {
      if (partial_.size() < kMaxLine)
        partial_ += c;
      else
        line_too_long_ = true;
      continue;
    }
    const std::string text = std::exchange(partial_, {});
    if (std::exchange(line_too_long_, false)) {
      say("error: Line of more than " + std::to_string(kMaxLine) + " characters ignored");
    } else if (trimmed(text).empty()) {
      continue;
    } else if (!waits() || (waited && acts_at_once(text))) {
      line(text, now);
    } else {
      waiting_bytes_ += text.size() + 1;
      waiting_.push_back(text);
    }
  }
}

bool Session::acts_at_once(std::string_view text) const {
  if (lower(take_word(text)) != "set") return false;
  const Subcommand* row = find_subcommand(take_word(text));
  return row != nullptr && row->at_once;
}

void Session::step(rtapi::Nanos now) {
  take_messages();
  watch_sent();
  look_at_wait(now);
  take_waiting(now);
}

void Session::look_at_wait(rtapi::Nanos now) {
  if (wait_.kind == Wait::Kind::none) return;
  const Wait wait = wait_;
  bool over = false, good = true;
  std::string why;
  if (wait.kind == Wait::Kind::condition) {
    machine_.refresh();
    over = wait.holds(machine_.stat());
  } else if (const auto reply = machine_.outcome(wait.id)) {
    over = task::is_terminal(reply->state) || !wait.until_done;
    if (task::is_terminal(reply->state)) {
      good = reply->state == task::CommandState::done;
      last_ended_ = true;
      last_failed_ = !good;
      note_failure(*reply);
      machine_.forget(wait.id);
    }
    if (!over) {
      // A pause ends the wait: what goes on from here needs an operator, who may be at this connection.
      machine_.refresh();
      over = !wait.was_paused && is_paused(machine_.stat());
    }
    if (over && !task::is_terminal(reply->state)) sent_.push_back(wait.id);
  }
  if (!over && now >= wait.deadline) {
    over = true;
    good = false;
    why = "No outcome within " + fixed(settings.timeout_s) + " seconds, the command goes on";
    if (wait.kind == Wait::Kind::command) sent_.push_back(wait.id);
  }
  if (!over) return;
  wait_ = Wait{};
  conclude(*wait.row, good, why);
}

void Session::take_waiting(rtapi::Nanos now) {
  while (!waits() && !ended_ && !waiting_.empty()) {
    const std::string text = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= text.size() + 1;
    line(text, now);
  }
}

/// Outcomes that nobody waits for: their errors are to be found by GET ERROR all the same.
void Session::watch_sent() {
  std::erase_if(sent_, [this](std::uint64_t id) {
    const auto reply = machine_.outcome(id);
    if (!reply || !task::is_terminal(reply->state)) return !reply.has_value();
    const bool failed = reply->state != task::CommandState::done;
    if (id == last_id_) last_ended_ = true, last_failed_ = failed;
    note_failure(*reply);
    machine_.forget(id);
    return true;
  });
  if (sent_.size() > kMaxSent) sent_.erase(sent_.begin());
}

void Session::take_messages() {
  for (const task::OperatorMessage& m : machine_.new_messages()) {
    const Messages kind = m.kind == task::MessageKind::error  ? Messages::error
                          : m.kind == task::MessageKind::text ? Messages::text
                                                              : Messages::display;
    const std::string text = without_mdi_place(m.text.view());
    if (kind == Messages::error) recent_errors_.push_back(text);
    auto& kept = messages_[static_cast<std::size_t>(kind)];
    kept.push_back(text);
    if (kept.size() > kMaxMessages) kept.pop_front();
  }
  if (recent_errors_.size() > kMaxMessages) recent_errors_.erase(recent_errors_.begin());
}

/// The operator was told most failures; the others are kept for GET ERROR of this session alone. What somebody aborted did not fail.
void Session::note_failure(const task::Reply& reply) {
  take_messages();
  if (reply.state != task::CommandState::error) return;
  const std::string why = without_mdi_place(reply.text);
  if (why.empty()) return;
  const bool known =
      std::any_of(recent_errors_.begin(), recent_errors_.end(), [&why](const std::string& text) {
        return text.find(why) != std::string::npos || why.find(text) != std::string::npos;
      });
  if (!known) messages_[static_cast<std::size_t>(Messages::error)].push_back(why);
}

std::string Session::take_message(Messages kind) {
  take_messages();
  watch_sent();
  auto& kept = messages_[static_cast<std::size_t>(kind)];
  if (kept.empty()) return {};
  const std::string text = std::move(kept.front());
  kept.pop_front();
  // What stands behind the first line is for people at a screen.
  return std::string(trimmed(std::string_view(text).substr(0, text.find_first_of("\r\n"))));
}

void Session::freeze() {
  machine_.refresh();
  frozen_ = machine_.stat();
}

Done Session::task(const std::vector<std::string>& words) {
  auto id = machine_.send(words);
  if (!id.ok()) return {.kind = Done::Kind::failed, .why = id.error().message()};
  return {.kind = Done::Kind::sent, .why = {}, .id = *id};
}

Done Session::wait_for_last(bool done) {
  watch_sent();
  if (last_ended_) return {.kind = last_failed_ ? Done::Kind::failed : Done::Kind::done, .why = {}};
  if (!done) return {};
  std::erase(sent_, last_id_);
  return {.kind = Done::Kind::sent, .why = {}, .id = last_id_, .to_its_end = true};
}

// --- lines ---

void Session::line(std::string_view text, rtapi::Nanos now) {
  machine_.refresh();
  if (linked && settings.echo) put(text, settings.timestamp_echo);
  std::string_view rest = text;
  const std::string_view word = take_word(rest);
  const std::string name = lower(word);
  if (name == "hello") return hello(rest);
  if (name == "get") return get(rest);
  if (name == "set") return set(rest, now);
  if (name == "help") return help(rest);
  if (name == "shutdown") return shut_down();
  if (name == "quit") {
    say("QUIT ACK");
    ended_ = true;
    return;
  }
  say("error: Command '" + shown(word) + "' not found");
}

void Session::hello(std::string_view rest) {
  const std::string password(take_word(rest)), who(take_word(rest)), version(take_word(rest));
  if (version.empty() || !rest.empty() || password != shell_.connect_password)
    return say("HELLO NAK");
  linked = true;
  client = who;
  say("HELLO ACK " + shell_.name + " 1.1");
}

void Session::shut_down() {
  if (!linked || !enabled) {
    say("error: SHUTDOWN failed, not enabled");
    return say("SHUTDOWN NAK");
  }
  shell_.shutdown = true;
  ended_ = true;
}

void Session::help(std::string_view rest) {
  const std::string_view topic = trimmed(rest);
  const std::string text = help_text(topic);
  say(text.empty() ? upper(shown(topic)) + " is not a valid command." : text);
}

void Session::get(std::string_view rest) {
  const std::string_view word = take_word(rest);
  if (word.empty()) {
    say("error: Too few arguments to GET, have 0, need 1 or more");
    return say("GET NAK");
  }
  const Subcommand* row = find_subcommand(word);
  if (row == nullptr || row->get == nullptr) {
    say("error: Subcommand not found: GET " + shown(word));
    return say("GET NAK");
  }
  const std::string name = upper(row->name);
  Values values;
  std::string text = read_values("GET " + name, row->get_arguments, rest, false, values);
  if (text.empty()) {
    text = row->get(*this, values);
    if (text.empty() || text[0] != '!') {
      if (row->deprecated)
        say("warning: GET " + name + " has been deprecated. It has no function.");
      // One line each, with the name before it.
      for (std::size_t at = 0; at != std::string::npos;) {
        const auto end = text.find('\n', at);
        say(name + " " + text.substr(at, end == std::string::npos ? end : end - at));
        at = end == std::string::npos ? end : end + 1;
      }
      return;
    }
    text.erase(0, 1);
  }
  say("error: " + text);
  say("GET " + name + " NAK");
}

void Session::set(std::string_view rest, rtapi::Nanos now) {
  const std::string_view word = take_word(rest);
  if (word.empty()) {
    say("error: Too few arguments to SET, have 0, need 1 or more");
    return say("SET NAK");
  }
  const Subcommand* row = find_subcommand(word);
  if (row == nullptr || row->set == nullptr) {
    say("error: Subcommand not found: SET " + shown(word));
    return say("SET NAK");
  }
  const std::string name = upper(row->name);
  if (!linked) return conclude(*row, false, "Connection must be linked by HELLO for SET " + name);
  if (!row->free && !enabled)
    return conclude(*row, false, "Connection must be enabled for SET " + name);
  Values values;
  if (const std::string why = read_values("SET " + name, row->set_arguments, rest, true, values);
      !why.empty())
    return conclude(*row, false, why);
  take_messages();
  recent_errors_.clear();
  if (row->deprecated) say("warning: SET " + name + " has been deprecated. It has no function.");

  Done done = row->set(*this, values);
  switch (done.kind) {
    case Done::Kind::done: return conclude(*row, true);
    case Done::Kind::failed: return conclude(*row, false, done.why);
    case Done::Kind::sent:
    case Done::Kind::received:
      last_id_ = done.id;
      last_ended_ = false;
      break;
    case Done::Kind::until: break;
  }
  const bool waits_for_it =
      done.kind == Done::Kind::until || (done.kind == Done::Kind::sent && !waits());
  if (!waits_for_it || (done.kind == Done::Kind::until && waits())) {
    if (done.id != 0) sent_.push_back(done.id);
    return conclude(*row, true);
  }
  wait_.kind = done.kind == Done::Kind::until ? Wait::Kind::condition : Wait::Kind::command;
  wait_.until_done = settings.wait_done || done.to_its_end;
  wait_.id = done.id;
  wait_.holds = std::move(done.holds);
  wait_.row = row;
  wait_.was_paused = is_paused(machine_.stat());
  wait_.deadline =
      settings.timeout_s > 0 ? now + rtapi::seconds(settings.timeout_s) : rtapi::kForever;
  look_at_wait(now);
}

void Session::conclude(const Subcommand& row, bool good, const std::string& why) {
  if (good && !settings.verbose) return;
  if (!why.empty()) say("error: " + why);
  say("SET " + upper(row.name) + (good ? " ACK" : " NAK"));
}

// --- arguments ---

std::string Session::read_values(std::string_view what, std::span<const Argument> arguments,
                                 std::string_view rest, bool set, Values& values) const {
  std::vector<std::string_view> words;
  bool all_of_the_line = false;
  while (!rest.empty()) {
    all_of_the_line =
        words.size() < arguments.size() && arguments[words.size()].type == ArgumentType::rest;
    words.push_back(all_of_the_line ? rest : take_word(rest));
    if (all_of_the_line) break;
  }
  const auto needed = static_cast<std::size_t>(std::count_if(
      arguments.begin(), arguments.end(), [](const Argument& a) { return a.required; }));
  if (words.size() < needed)
    return "Too few arguments to " + std::string(what) + ", have " + std::to_string(words.size()) +
           ", need " + std::to_string(needed) + " or more";
  if (words.size() > arguments.size()) {
    // GET ignores what it does not need, as documented. A SET with a word too many may have meant another command.
    if (set)
      return "Too many arguments to " + std::string(what) + ", have " +
             std::to_string(words.size()) + ", need at most " + std::to_string(arguments.size());
    words.resize(arguments.size());
  }
  for (std::size_t n = 0; n < words.size(); ++n)
    if (std::string why = read_value(arguments[n], words[n], values); !why.empty()) return why;
  return {};
}

std::string Session::read_value(const Argument& argument, std::string_view word,
                                Values& values) const {
  const std::string invalid = "Invalid argument '" + shown(word) + "', must be ";
  const auto keep = [&values](std::string text, double number) {
    values.text.push_back(std::move(text));
    values.number.push_back(number);
    return std::string();
  };
  const clients::Stat& now = machine_.stat();
  switch (argument.type) {
    case ArgumentType::choice: {
      const std::string wanted = lower(word);
      std::string_view rest = argument.choices;
      while (!rest.empty()) {
        const auto comma = std::min(rest.find(','), rest.size());
        if (rest.substr(0, comma) == wanted) return keep(wanted, 0);
        rest.remove_prefix(std::min(comma + 1, rest.size()));
      }
      return invalid + "{" + argument.choices + "}";
    }
    case ArgumentType::integer: {
      const auto number = to_integer(word);
      if (!number) return invalid + "integer";
      return keep(std::string(word), static_cast<double>(*number));
    }
    case ArgumentType::number: {
      const auto number = to_number(word);
      if (!number) return invalid + "floating point";
      return keep(std::string(word), *number);
    }
    case ArgumentType::joint:
    case ArgumentType::spindle: {
      const bool joint = argument.type == ArgumentType::joint;
      const int most = (joint ? now.joints : now.spindles) - 1;
      const auto number = to_integer(word);
      if (!number || *number < -1 || *number > most)
        return std::string("Invalid ") + (joint ? "joint" : "spindle") + " '" + shown(word) +
               "', valid range [-1," + std::to_string(most) + "]";
      return keep(std::to_string(*number), static_cast<double>(*number));
    }
    case ArgumentType::axis:
    case ArgumentType::joint_or_axis: {
      constexpr std::string_view kLetters = "XYZABCUVW";
      const std::string letter = upper(word);
      if (const auto at = letter.size() == 1 ? kLetters.find(letter[0]) : std::string_view::npos;
          at != std::string_view::npos)
        return keep(letter, static_cast<double>(at));
      const auto number = to_integer(word);
      if (argument.type == ArgumentType::joint_or_axis) {
        if (number && *number >= 0 && *number < now.joints)
          return keep(std::to_string(*number), static_cast<double>(*number));
        if (number)
          return "Invalid joint '" + shown(word) + "', valid range [0," +
                 std::to_string(now.joints - 1) + "]";
      } else if (number && *number >= -1 && *number < 9) {
        return keep(*number < 0 ? "" : std::string(1, kLetters[static_cast<std::size_t>(*number)]),
                    static_cast<double>(*number));
      }
      return "Invalid axis '" + shown(word) + "', must be one of " + std::string(kLetters);
    }
    case ArgumentType::word:
    case ArgumentType::rest: return keep(std::string(word), 0);
  }
  return {};
}

}  // namespace kerf::rsh
