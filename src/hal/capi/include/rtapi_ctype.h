/* isdigit(), toupper() and the rest. */
#ifndef RTAPI_CTYPE_H
#define RTAPI_CTYPE_H
#include <ctype.h>
#endif
