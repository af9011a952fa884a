/* until PIN VALUE: waits until an integer pin has at least the value. until gone COMPONENT: until there is none of that name. */
#include <hal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int main(int argc, char** argv) {
  int tries;
  long long want;
  if (argc < 3 || hal_lib_init() < 0) return 1;
  want = atoll(argv[2]);
  for (tries = 0; tries < 15000; tries++) {
    const struct timespec pause = {0, 2000000};
    hal_type_t type;
    hal_data_u* value;
    bool connected;
    hal_query_t q;
    if (strcmp(argv[1], "gone") == 0) {
      if (hal_comp_by_name(argv[2], &q) == -ENOENT) return 0;
      nanosleep(&pause, NULL);
      continue;
    }
    if (hal_get_pin_value_by_name(argv[1], &type, &value, &connected) != 0) return 1;
    switch (type) {
      case HAL_S32: if (value->s >= want) return 0; break;
      case HAL_U32: if (value->u >= want) return 0; break;
      case HAL_S64: if (value->ls >= want) return 0; break;
      case HAL_U64: if ((long long)value->lu >= want) return 0; break;
      default: return 1;
    }
    nanosleep(&pause, NULL);
  }
  fprintf(stderr, "%s never became %s\n", argv[1], argv[2]);
  return 1;
}
