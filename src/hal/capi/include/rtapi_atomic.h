/* C11's atomic operations, usable on plain and volatile objects as components declare them. */
#ifndef RTAPI_ATOMIC_H
#define RTAPI_ATOMIC_H

#ifndef __cplusplus
#if defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L && !defined(__STDC_NO_ATOMICS__)
#include <stdatomic.h>
/* The operations of stdatomic.h want _Atomic objects in some compilers; these take any of a fitting size. */
#undef atomic_store
#undef atomic_store_explicit
#undef atomic_load
#undef atomic_load_explicit
#undef atomic_exchange
#undef atomic_exchange_explicit
#undef atomic_fetch_add
#undef atomic_fetch_add_explicit
#undef atomic_fetch_sub
#undef atomic_fetch_sub_explicit
#else
enum memory_order {
  memory_order_relaxed = __ATOMIC_RELAXED,
  memory_order_consume = __ATOMIC_CONSUME,
  memory_order_acquire = __ATOMIC_ACQUIRE,
  memory_order_release = __ATOMIC_RELEASE,
  memory_order_acq_rel = __ATOMIC_ACQ_REL,
  memory_order_seq_cst = __ATOMIC_SEQ_CST
};
#endif
#define atomic_store(obj, desired) atomic_store_explicit((obj), (desired), memory_order_seq_cst)
#define atomic_store_explicit(obj, desired, order) \
  __extension__({                                  \
    __typeof__(*(obj)) rtapi_desired_ = (desired); \
    __atomic_store((obj), &rtapi_desired_, order); \
  })
#define atomic_load(obj) atomic_load_explicit((obj), memory_order_seq_cst)
#define atomic_load_explicit(obj, order)         \
  __extension__({                                \
    __typeof__(*(obj)) rtapi_loaded_;            \
    __atomic_load((obj), &rtapi_loaded_, order); \
    rtapi_loaded_;                               \
  })
#define atomic_exchange(obj, desired) __atomic_exchange_n((obj), (desired), __ATOMIC_SEQ_CST)
#define atomic_exchange_explicit(obj, desired, order) __atomic_exchange_n((obj), (desired), order)
#define atomic_fetch_add(obj, n) __atomic_fetch_add((obj), (n), __ATOMIC_SEQ_CST)
#define atomic_fetch_add_explicit(obj, n, order) __atomic_fetch_add((obj), (n), order)
#define atomic_fetch_sub(obj, n) __atomic_fetch_sub((obj), (n), __ATOMIC_SEQ_CST)
#define atomic_fetch_sub_explicit(obj, n, order) __atomic_fetch_sub((obj), (n), order)
#endif

#endif
