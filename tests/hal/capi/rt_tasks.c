/* Realtime tasks beside HAL's threads, and a thread that a function moves by the phase-locked loop. */
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_LICENSE("GPL");

static int comp, periodic, once, stubborn;

static struct data {
  hal_s32_t *ticks, *late, *self, *ended, *phase, *moved;
  hal_s32_t *paused;
} * d;

static long long begin;

static void tick(void* arg) {
  struct data* my = arg;
  begin = rtapi_get_time();
  while (1) {
    *my->ticks += 1;
    *my->self = rtapi_task_self() == periodic;
    /* On the virtual clock each wake-up is exact. */
    if (rtapi_task_pll_get_reference() != rtapi_get_time()) *my->late += 1;
    rtapi_wait();
  }
}

static void run_once(void* arg) {
  struct data* my = arg;
  *my->ended = 1;
  rtapi_task_pause(stubborn);
}

static void wait_without_end(void* arg) {
  struct data* my = arg;
  while (1) {
    *my->paused += 1;
    rtapi_wait();
  }
}

/* Runs in a HAL thread: five cycles each come 1000 ns later than they would. */
static void follow(void* arg, long period) {
  struct data* my = arg;
  static int cycles;
  *my->phase = (hal_s32_t)(rtapi_task_pll_get_reference() % period);
  if (cycles++ < 5) *my->moved += rtapi_task_pll_set_correction(1000) == 0;
}

int rtapi_app_main(void) {
  comp = hal_init("rt_tasks");
  if (comp < 0) return comp;
  d = hal_malloc(sizeof *d);
  if (d == NULL) return -ENOMEM;
  hal_pin_s32_new("rt_tasks.ticks", HAL_OUT, &d->ticks, comp);
  hal_pin_s32_new("rt_tasks.late", HAL_OUT, &d->late, comp);
  hal_pin_s32_new("rt_tasks.self", HAL_OUT, &d->self, comp);
  hal_pin_s32_new("rt_tasks.ended", HAL_OUT, &d->ended, comp);
  hal_pin_s32_new("rt_tasks.paused", HAL_OUT, &d->paused, comp);
  hal_pin_s32_new("rt_tasks.phase", HAL_OUT, &d->phase, comp);
  hal_pin_s32_new("rt_tasks.moved", HAL_OUT, &d->moved, comp);
  hal_export_funct("rt_tasks.follow", follow, d, 0, 0, comp);
  hal_create_thread("rt_tasks.thread", 1000000, 1);
  hal_add_funct_to_thread("rt_tasks.follow", "rt_tasks.thread", -1);
  rtapi_print_msg(RTAPI_MSG_ERR, "outside of a cycle: %d %d %d\n", (int)rtapi_task_pll_get_reference(),
                  rtapi_task_pll_set_correction(1), rtapi_task_self());
  periodic = rtapi_task_new(tick, d, rtapi_prio_highest(), comp, 16384, RTAPI_USES_FP);
  once = rtapi_task_new(run_once, d, rtapi_prio_next_lower(rtapi_prio_highest()), comp, 0, RTAPI_NO_FP);
  stubborn = rtapi_task_new(wait_without_end, d, rtapi_prio_lowest(), comp, 0, RTAPI_NO_FP);
  if (periodic <= 0 || once <= 0 || stubborn <= 0 || periodic == once) return -EINVAL;
  if (rtapi_task_start(periodic, 0) != -EINVAL || rtapi_task_start(9999, 1000) != -EINVAL) return -EINVAL;
  if (rtapi_task_start(periodic, 500000) != 0 || rtapi_task_start(stubborn, 1000000) != 0) return -EINVAL;
  if (rtapi_task_start(periodic, 500000) != -EINVAL) return -EINVAL; /* it runs */
  if (rtapi_task_resume(once) != 0) return -EINVAL;
  return hal_ready(comp);
}

void rtapi_app_exit(void) {
  /* One is forgotten: it ends with the module. */
  rtapi_print_msg(RTAPI_MSG_ERR, "deleted: %d %d %d\n", rtapi_task_delete(periodic),
                  rtapi_task_delete(periodic), rtapi_task_delete(once));
  hal_exit(comp);
}
