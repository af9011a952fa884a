/* Values of an INI file, for programs: link with -llinuxcncini. C++ has inifile.hh. */
#ifndef INIFILE_H
#define INIFILE_H

#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The first value of the key in the section (NULL: in any), or NULL. It stays until the thread's next call. */
extern const char* iniFind(FILE* file, const char* tag, const char* section);
/* 0, or why there is none: 1 no file, 2 no such section, 4 no such key, 8 no number. Then the result is as it was. */
extern int iniFindInt(FILE* file, const char* tag, const char* section, int* result);
extern int iniFindDouble(FILE* file, const char* tag, const char* section, double* result);
/* The num-th value, from 1, with the line that it stands in (line may be NULL). */
extern const char* iniFindNth(FILE* file, const char* tag, const char* section, int num, int* line);
extern int iniHasSection(FILE* file, const char* section);
/* "~/x" becomes "HOME/x". 1, or 0: no HOME, or no room. */
extern int TildeExpansion(const char* file, char* path, size_t size);

#ifdef __cplusplus
}
#endif

#endif
