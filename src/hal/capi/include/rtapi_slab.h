/* Heap memory for the start and the end of a component; never for a realtime function. */
#ifndef RTAPI_SLAB_H
#define RTAPI_SLAB_H

#include <stdlib.h>

#include <rtapi_gfp.h>

#define rtapi_kmalloc(size, flags) ((void)(flags), malloc(size))
#define rtapi_kzalloc(size, flags) ((void)(flags), calloc(1, (size)))
#define rtapi_kcalloc(n, size, flags) ((void)(flags), calloc((n), (size)))
#define rtapi_krealloc(ptr, size, flags) ((void)(flags), realloc((ptr), (size)))
#define rtapi_kfree free

#endif
