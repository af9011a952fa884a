/* EINVAL and its kin; calls return them negative. */
#ifndef RTAPI_ERRNO_H
#define RTAPI_ERRNO_H
#include <errno.h>
#endif
