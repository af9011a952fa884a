/* Floating-point functions and M_PI. Wanted for components that build without GNU extensions too, so the constants are here. */
#ifndef RTAPI_MATH_H
#define RTAPI_MATH_H

#include <math.h>

#include <rtapi_math64.h>

#ifndef M_PI
#define M_PI 3.14159265358979323846
#endif
#ifndef M_PI_2
#define M_PI_2 1.57079632679489661923
#endif
#ifndef M_PI_4
#define M_PI_4 0.78539816339744830962
#endif
#ifndef M_SQRT2
#define M_SQRT2 1.41421356237309504880
#endif

#endif
