/* A module whose code does not come back: what=task a realtime task that never waits, what=crash and what=hang its start,
   what=exit its end. */
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_LICENSE("GPL");

static char* what = "nothing";
RTAPI_MP_STRING(what, "what goes wrong");

static int comp, task;
static struct data {
  hal_s32_t* runs;
  hal_bit_t* end;
} * d;

static void never_waits(void* arg) {
  struct data* my = arg;
  *my->runs = 1;
  while (!*(volatile hal_bit_t*)my->end) {
  }
  while (1) {
    *my->runs = 2;
    rtapi_wait();
  }
}

int rtapi_app_main(void) {
  comp = hal_init("rt_stuck");
  if (comp < 0) return comp;
  d = hal_malloc(sizeof *d);
  if (d == NULL) return -ENOMEM;
  hal_pin_s32_new("rt_stuck.runs", HAL_OUT, &d->runs, comp);
  hal_pin_bit_new("rt_stuck.end", HAL_IN, &d->end, comp);
  if (what[0] == 'c') *(volatile int*)8 = 1;
  while (what[0] == 'h') {
  }
  if (what[0] == 't') {
    task = rtapi_task_new(never_waits, d, rtapi_prio_lowest(), comp, 0, RTAPI_NO_FP);
    if (task < 0 || rtapi_task_start(task, 1000000) != 0) return -EINVAL;
  }
  return hal_ready(comp);
}

void rtapi_app_exit(void) {
  if (what[0] == 'e') rtapi_print_msg(RTAPI_MSG_ERR, "at the end: %d\n", hal_signal_new("at-the-end", HAL_BIT));
  while (what[0] == 'e') rtapi_delay(10000);
  if (what[0] == 't') rtapi_print_msg(RTAPI_MSG_ERR, "deleted: %d\n", rtapi_task_delete(task));
  hal_exit(comp);
}
