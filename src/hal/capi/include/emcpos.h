/* The older name of emcpose.h. */
#ifndef EMCPOS_H
#define EMCPOS_H
#include <emcpose.h>
#endif
