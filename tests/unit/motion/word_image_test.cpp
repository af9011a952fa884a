// WordImage: what the flight record keeps of a value that changes.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "motion/api/flight_record.hpp"

namespace kerf::motion {
namespace {

struct Value {
  std::uint64_t word[45]{};
  friend bool operator==(const Value&, const Value&) = default;
};

/// Some words change; who has applied all changes so far has the value.
TEST(WordImage, ChangesMakeTheValueAgain) {
  std::mt19937_64 random(1);
  WordImage<Value> from, to;
  Value value, seen;
  std::uint64_t words[WordImage<Value>::kRoom];
  for (int round = 0; round < 2000; ++round) {
    const std::size_t n = random() % 6 == 0 ? 45 : random() % 4;
    for (std::size_t i = 0; i < n; ++i) value.word[random() % 45] = random() % 3;
    const std::size_t used = from.changes(value, words);
    ASSERT_LE(used, WordImage<Value>::kRoom);
    ASSERT_TRUE(to.apply(words, used));
    to.get(seen);
    ASSERT_EQ(seen, value) << round;
    ASSERT_EQ(from.changes(value, words), 0U);
  }
}

TEST(WordImage, EachWordIsLookedAt) {
  WordImage<Value> image;
  std::uint64_t words[WordImage<Value>::kRoom];
  Value value;
  for (std::uint64_t i = 0; i < 45; ++i) {
    value.word[i] = i + 1;
    ASSERT_EQ(image.changes(value, words), 3U) << i;
    EXPECT_EQ(words[0], 1U);
    EXPECT_EQ(words[1], i);
    EXPECT_EQ(words[2], i + 1);
  }
}

TEST(WordImage, WhatIsInNoPartIsLeft) {
  WordImage<Value> image;
  std::uint64_t words[WordImage<Value>::kRoom];
  Value value, seen;
  for (std::uint64_t i = 0; i < 45; ++i) value.word[i] = i + 1;
  const rtapi::WordPart parts[] = {rtapi::words_of(0, 24), rtapi::words_of(72, 72),
                                   rtapi::words_of(80, 336)};
  EXPECT_EQ(image.changes(value, words, parts), 1U + (3 + 32 + 3) / 4 + 3 + 32);
  image.get(seen);
  for (std::uint64_t i = 0; i < 45; ++i)
    EXPECT_EQ(seen.word[i], i < 3 || (i >= 10 && i < 42) ? i + 1 : 0) << i;
}

TEST(WordImage, WordsThatAreNoChangesAreRefused) {
  WordImage<Value> image;
  const std::uint64_t too_many[] = {46, 0}, beyond[] = {1, 45, 7}, short_one[] = {2, 0, 7};
  EXPECT_FALSE(image.apply(too_many, 2));
  EXPECT_FALSE(image.apply(beyond, 3));
  EXPECT_FALSE(image.apply(short_one, 3));
  EXPECT_TRUE(image.apply(nullptr, 0));
}

}  // namespace
}  // namespace kerf::motion
