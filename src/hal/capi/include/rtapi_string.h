/* Strings: the standard functions and the bounded copies. */
#ifndef RTAPI_STRING_H
#define RTAPI_STRING_H

#include <stddef.h>
#include <string.h>

#include <rtapi_gfp.h>
#include <rtapi_slab.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Splits at blanks into a list that ends with a null pointer; `argc` may be null. Give it back with rtapi_argv_free(). */
extern char** rtapi_argv_split(rtapi_gfp_t flags, const char* text, int* argc);
extern void rtapi_argv_free(char** argv);
extern char* rtapi_kstrndup(const char* s, size_t most, rtapi_gfp_t flags);

/* As strlcpy(3bsd) and strlcat(3bsd): the result ends with a zero unless `size` is 0, and the value is the length that was wanted. */
static inline size_t rtapi_strlcpy(char* dst, const char* src, size_t size) {
  const size_t wanted = strlen(src);
  if (size > 0) {
    const size_t n = wanted < size ? wanted : size - 1;
    memcpy(dst, src, n);
    dst[n] = '\0';
  }
  return wanted;
}
static inline size_t rtapi_strlcat(char* dst, const char* src, size_t size) {
  const size_t used = strnlen(dst, size);
  if (used == size) return size + strlen(src);
  return used + rtapi_strlcpy(dst + used, src, size - used);
}

#ifdef __cplusplus
}
/* `dst` must be an array. */
template <size_t N>
inline size_t rtapi_strxcpy(char (&dst)[N], const char* src) {
  return rtapi_strlcpy(dst, src, N);
}
template <size_t N>
inline size_t rtapi_strxcat(char (&dst)[N], const char* src) {
  return rtapi_strlcat(dst, src, N);
}
#else
/* 0, or an error of the compiler when `x` is not an array. */
#define RTAPI_MUST_BE_ARRAY_(x)                                                  \
  (0 * sizeof(struct {                                                           \
     int must_be_an_array : 1 -                                                  \
         2 * !!__builtin_types_compatible_p(__typeof__(x), __typeof__(&(x)[0])); \
   }))
#define rtapi_strxcpy(dst, src) rtapi_strlcpy((dst), (src), sizeof(dst) + RTAPI_MUST_BE_ARRAY_(dst))
#define rtapi_strxcat(dst, src) rtapi_strlcat((dst), (src), sizeof(dst) + RTAPI_MUST_BE_ARRAY_(dst))
#endif
#define rtapi_kstrdup(s, flags) rtapi_kstrndup((s), strlen(s), (flags))

#endif
