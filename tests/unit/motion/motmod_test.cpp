#include <gtest/gtest.h>
TEST(Motmod, Placeholder) {}
