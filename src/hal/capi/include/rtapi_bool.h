/* bool, true and false, in C as in C++. */
#ifndef RTAPI_BOOL_H
#define RTAPI_BOOL_H
#ifndef __cplusplus
#include <stdbool.h>
#endif
#endif
