/* INT_MIN, LONG_MAX and the rest. */
#ifndef RTAPI_LIMITS_H
#define RTAPI_LIMITS_H
#include <limits.h>
#endif
