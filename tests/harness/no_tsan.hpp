// Tests of two processes are none for the thread sanitizer.
#pragma once

#include <gtest/gtest.h>

/// First line of a test that calls fork() and goes on in both: the thread sanitizer sees no race between processes, its runtime promises
/// nothing of a child of a program with threads (it has one of its own), and it slows the two sides unevenly.
#ifdef __SANITIZE_THREAD__
#define KERF_NOT_UNDER_TSAN() \
  GTEST_SKIP() << "two processes share nothing that the thread sanitizer could watch"
#else
#define KERF_NOT_UNDER_TSAN() static_cast<void>(0)
#endif
