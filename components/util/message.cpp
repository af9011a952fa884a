// message: a pin that says something to the operator.
#include "hal/channels.hpp"
#include "hal/operator_line.hpp"

namespace kerf::components {

class MessageChannel : public hal::Channel {
 public:
  MessageChannel(hal::Builder& b, std::size_t index, const hal::ChannelList& names,
                 std::string_view texts, const hal::OperatorLine* line) noexcept
      : Channel(b, names.name(b, index)), line_(line) {
    for (std::size_t i = 0; i <= index; ++i) text_ = hal::next_field(texts);
    if (text_.empty()) b.fail("messages= must have a text for each instance, with commas between");
  }

 private:
  hal::In<bool> trigger_{pin<hal::In<bool>>("trigger", "Its change to edge says the message")};
  hal::In<bool> force_{
      pin<hal::In<bool>>("force", "A rising edge says it again while trigger is as edge")};
  hal::Param<bool> edge_{param<hal::Param<bool>>(
      "edge", "True: the message comes when trigger rises, false: when it falls", true)};
  const hal::OperatorLine* line_;
  std::string_view text_;
  bool active_{false}, forced_{false};

  void update(const hal::Period&) noexcept {
    const bool active = trigger_ == edge_, force = force_;
    if (active && (!active_ || (force && !forced_)) && line_ != nullptr) line_->error(text_);
    active_ = active;
    forced_ = force;
  }
  hal::Function update_{function<MessageChannel, &MessageChannel::update>(
      "", "Looks at the pins and says the message")};
};

class Message final : public hal::Component<Message> {
 public:
  static constexpr hal::Info kInfo{
      .name = "message",
      .summary = "Says something to the operator when a pin changes",
      .notes =
          "The message shows on the screens of the machine, and on the terminal of rtapi_app. "
          "messages= has the texts, one an instance, with commas between; what is longer than 255 "
          "characters is cut. A pin that is as edge says already at the start shows its message "
          "then. Example: loadrt message names=oil,air messages=\"Oil is low,No pressure\".",
      .singleton = true,
      .example = "messages=text",
      .lists = "names messages",
      .own_names = true};
  explicit Message(hal::Builder& b) noexcept : Component(b) {
    const std::string_view count =
        b.arg("count", "", "Number of instances, 1 to 16, instead of names=");
    const std::string_view names = b.arg("names", "", "Names of the instances, instead of count=");
    const std::string_view texts = b.arg("messages", "", "The texts, with commas between");
    hal::ChannelList list{names, 1};
    if (!names.empty()) list.size = hal::count_fields(names);
    if (!count.empty() && !names.empty()) {
      b.fail("count= and names= are mutually exclusive");
    } else if (!count.empty() && !hal::parse_count(count, list.size)) {
      b.fail("count= must be a number");
    } else if (list.size < 1 || list.size > kMost) {
      b.fail("there can be 1 to 16 instances");
    }
    if (b.failed()) return;
    const auto* line = static_cast<const hal::OperatorLine*>(b.find_service(hal::kOperatorLine));
    channels_ = hal::make_array<MessageChannel>(b, list.size, list, texts, line);
  }

 private:
  static constexpr std::size_t kMost = 16;
  hal::Array<MessageChannel> channels_;
};

}  // namespace kerf::components

KERF_HAL_MODULE(kerf::components::Message)
