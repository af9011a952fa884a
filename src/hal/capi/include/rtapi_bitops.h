/* Atomic operations on single bits of arrays of unsigned long. Bit n stands in word n / 64. */
#ifndef RTAPI_BITOPS_H
#define RTAPI_BITOPS_H

#define RTAPI_BITS_PER_LONG_ ((int)(8 * sizeof(unsigned long)))

static inline unsigned long rtapi_bit_mask_(int nr) {
  return 1UL << ((unsigned)nr % (unsigned)RTAPI_BITS_PER_LONG_);
}
static inline volatile unsigned long* rtapi_bit_word_(int nr, volatile void* base) {
  return (volatile unsigned long*)base + (unsigned)nr / (unsigned)RTAPI_BITS_PER_LONG_;
}
static inline void set_bit(int nr, volatile void* base) {
  __atomic_fetch_or(rtapi_bit_word_(nr, base), rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST);
}
static inline void clear_bit(int nr, volatile void* base) {
  __atomic_fetch_and(rtapi_bit_word_(nr, base), ~rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST);
}
static inline void change_bit(int nr, volatile void* base) {
  __atomic_fetch_xor(rtapi_bit_word_(nr, base), rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST);
}
static inline int test_bit(int nr, const volatile void* base) {
  const volatile unsigned long* word =
      (const volatile unsigned long*)base + (unsigned)nr / (unsigned)RTAPI_BITS_PER_LONG_;
  return (__atomic_load_n(word, __ATOMIC_SEQ_CST) & rtapi_bit_mask_(nr)) != 0;
}
/* The bit's value before. */
static inline int test_and_set_bit(int nr, volatile void* base) {
  return (__atomic_fetch_or(rtapi_bit_word_(nr, base), rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST) &
          rtapi_bit_mask_(nr)) != 0;
}
static inline int test_and_clear_bit(int nr, volatile void* base) {
  return (__atomic_fetch_and(rtapi_bit_word_(nr, base), ~rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST) &
          rtapi_bit_mask_(nr)) != 0;
}
static inline int test_and_change_bit(int nr, volatile void* base) {
  return (__atomic_fetch_xor(rtapi_bit_word_(nr, base), rtapi_bit_mask_(nr), __ATOMIC_SEQ_CST) &
          rtapi_bit_mask_(nr)) != 0;
}

#endif
