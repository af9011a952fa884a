/* A module that offers a function to others, makes two components, and has a thread. */
#include <hal.h>
#include <rtapi_app.h>

MODULE_LICENSE("GPL");

static int first, second;
static int period = 1000000;
RTAPI_MP_INT(period, "ns");

int demo_twice(int value) { return 2 * value; }
EXPORT_SYMBOL(demo_twice);

/* Not exported: every module may have its own. */
int counter = 5;

int rtapi_app_main(void) {
  first = hal_init("rt_library");
  second = hal_init("rt_library_second");
  if (first < 0 || second < 0) return -1;
  if (hal_create_thread("demo-thread", (unsigned long)period, 1) < 0) return -EINVAL;
  hal_ready(first);
  hal_ready(second);
  return 0;
}

void rtapi_app_exit(void) {
  hal_exit(second);
  hal_exit(first);
}
