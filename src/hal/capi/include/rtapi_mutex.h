/* A mutex in one word, zero when free: it may stand in memory that realtime and user code share. Realtime functions may only
   try it; whoever waits gives up the processor between its tries. */
#ifndef RTAPI_MUTEX_H
#define RTAPI_MUTEX_H

#include <sched.h>

typedef unsigned long rtapi_mutex_t;

/* 0: it is yours now; another value: somebody holds it. */
static inline int rtapi_mutex_try(unsigned long* mutex) {
  return __atomic_exchange_n(mutex, 1UL, __ATOMIC_ACQUIRE) != 0;
}
static inline void rtapi_mutex_get(unsigned long* mutex) {
  while (rtapi_mutex_try(mutex)) sched_yield();
}
static inline void rtapi_mutex_give(unsigned long* mutex) {
  __atomic_store_n(mutex, 0UL, __ATOMIC_RELEASE);
}

#endif
