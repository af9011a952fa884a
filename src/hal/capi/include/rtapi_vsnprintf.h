/* rtapi_snprintf and rtapi_vsnprintf are declared with the rest. */
#ifndef RTAPI_VSNPRINTF_H
#define RTAPI_VSNPRINTF_H
#include <rtapi.h>
#endif
