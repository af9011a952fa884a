// Components that make their channels themselves: how many there are and what they are called, and lists in loadrt parameters.
//
//   class Supply final : public hal::Component<Supply> {
//     ... .singleton = true, .own_names = true ...
//     explicit Supply(hal::Builder& b) noexcept
//         : Component(b), list_(hal::channels_by_count(b, 1, 8)),
//           channels_(hal::make_array<Channel>(b, list_.size, list_)) {}
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/component.hpp"

namespace kerf::hal {

/// Cuts the text up to the next separator off the front of `list`.
inline std::string_view next_field(std::string_view& list, char separator = ',') noexcept {
  const std::size_t at = list.find(separator);
  const std::size_t size = at == std::string_view::npos ? list.size() : at;
  const std::string_view field(list.data(), size);
  list.remove_prefix(at == std::string_view::npos ? size : size + 1);
  return field;
}

[[nodiscard]] inline std::size_t count_fields(std::string_view list,
                                              char separator = ',') noexcept {
  if (list.empty()) return 0;
  std::size_t n = 1;
  for (const char c : list) n += c == separator ? 1U : 0U;
  return n;
}

/// A number without sign, or false.
inline bool parse_count(std::string_view text, std::size_t& out) noexcept {
  if (text.empty() || text.size() > 9) return false;
  std::size_t value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return false;
    value = value * 10 + static_cast<std::size_t>(c - '0');
  }
  out = value;
  return true;
}

struct ChannelList {
  std::string_view names{};  ///< of all channels, between commas; empty: COMPONENT.0 and so on
  std::size_t size{0};

  [[nodiscard]] Name name(const Builder& b, std::size_t index) const noexcept {
    if (names.empty()) {
      Name out = b.prefix();
      out.append(numbered(".#", index));
      return out;
    }
    std::string_view rest = names;
    for (std::size_t i = 0; i < index; ++i) next_field(rest);
    return Name(next_field(rest));
  }
};

/// `size` channels, by names= if that is given.
inline ChannelList channels_of(Builder& b, std::size_t size) noexcept {
  ChannelList list{b.arg("names", "", "Names of the channels, instead of numbers"), size};
  if (!list.names.empty() && count_fields(list.names) != size)
    b.fail("names= must have a name for each channel");
  if (b.failed()) list.size = 0;
  return list;
}

/// num_chan= or names=. Zero channels, and the builder has failed, when they are wrong.
inline ChannelList channels_by_count(Builder& b, std::size_t usual, std::size_t most) noexcept {
  const std::string_view count = b.arg("num_chan", "", "Number of channels, instead of names=");
  const std::string_view names = b.arg("names", "", "Names of the channels, instead of num_chan=");
  ChannelList list{names, usual};
  if (!count.empty() && !names.empty()) {
    b.fail("num_chan= and names= are mutually exclusive");
  } else if (!names.empty()) {
    list.size = count_fields(names);
  } else if (!count.empty() && !parse_count(count, list.size)) {
    b.fail("num_chan= must be a number");
  } else if (list.size == 0) {
    list.size = usual;
  }
  if (list.size > most) {
    rtapi::FixedString<80> text("more channels than there can be, which is ");
    text.append(numbered("#", most));
    b.fail(text);
  }
  if (b.failed()) list.size = 0;
  return list;
}

/// Base of a channel: declares its members under the channel's own name while it is constructed.
class Channel {
 protected:
  Channel(Builder& b, const Name& prefix) noexcept : builder_(&b), prefix_(prefix) {}

  [[nodiscard]] Name whole_name(std::string_view suffix) noexcept {
    Name name = prefix_;
    if (!suffix.empty()) {
      name.append(".");
      name.append(suffix);
    }
    if (name.truncated()) builder_->fail("name longer than 55 characters");
    return name;
  }
  template <class Pin>
  [[nodiscard]] Pin pin(std::string_view suffix, std::string_view doc,
                        typename Pin::Item initial = {}) noexcept {
    return make_pin<Pin>(*builder_, whole_name(suffix), doc, initial);
  }
  template <class P>
  [[nodiscard]] P param(std::string_view suffix, std::string_view doc,
                        typename P::Item initial = {}) noexcept {
    return make_param<P>(*builder_, whole_name(suffix), doc, initial);
  }
  /// A function of this channel alone; `T` is the class that has it.
  template <class T, void (T::*Method)(const Period&) noexcept>
  Function function(std::string_view suffix, std::string_view doc) noexcept {
    builder_->add_function(
        whole_name(suffix),
        [](void* object, const Period& period) noexcept {
          (static_cast<T*>(object)->*Method)(period);
        },
        static_cast<T*>(this), doc);
    return {};
  }
  [[nodiscard]] Builder& builder() noexcept { return *builder_; }

 private:
  Builder* builder_;  // only while constructed
  Name prefix_;
};

}  // namespace kerf::hal
