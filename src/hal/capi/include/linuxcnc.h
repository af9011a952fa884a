/* Lengths of texts, and inches. */
#ifndef LINUXCNC_H
#define LINUXCNC_H

#define LINELEN 255
#define BUFFERLEN 80

#define MM_PER_INCH 25.4
#define INCH_PER_MM (1.0 / 25.4)

#endif
