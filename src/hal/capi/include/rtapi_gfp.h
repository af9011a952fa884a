/* Ways to ask for memory. All are the same here: memory comes from the process's heap. */
#ifndef RTAPI_GFP_H
#define RTAPI_GFP_H

enum rtapi_gfp_e {
  RTAPI_GFP_BUFFER,
  RTAPI_GFP_ATOMIC,
  RTAPI_GFP_KERNEL,
  RTAPI_GFP_USER,
  RTAPI_GFP_NOIO,
  RTAPI_GFP_NOFS,
  RTAPI_GFP_DMA,
  RTAPI_GFP_NOWAIT,
  RTAPI_GFP_HIGHUSER,
  RTAPI_GFP_DMA32,
  RTAPI_GFP_TEMPORARY
};
typedef unsigned long rtapi_gfp_t;

#endif
