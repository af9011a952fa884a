/* Kept for sources that name it; the compiler knows the machine's arithmetic. */
#ifndef RTAPI_MATH_I386_H
#define RTAPI_MATH_I386_H
#include <rtapi_math.h>
#endif
