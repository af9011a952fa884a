/* The other end. */
#define NAME "vd_consumer"
#include "vd_producer.c"
