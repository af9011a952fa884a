/* Uses rt_library's function; pins and parameters of the newest kind; a writer of a stream. */
#include <hal.h>
#include <rtapi_app.h>

MODULE_LICENSE("GPL");

extern int demo_twice(int value);

int counter = 100;

#define STREAM_KEY 0x4b455247

static int comp_id;
static struct {
  hal_bool_t go;
  hal_sint_t wide;
  hal_uint_t wide_u;
  hal_sint_t narrow;
  hal_uint_t narrow_u;
  hal_real_t real;
  hal_real_t gain;
  hal_sint_t limit;
} pins; /* references may stand anywhere */
static hal_stream_t stream;

static void step(void* arg, long period) {
  hal_stream_data_u row[3];
  (void)arg;
  (void)period;
  if (!hal_get_bool(pins.go)) return;
  hal_set_sint(pins.wide, hal_get_sint(pins.wide) + demo_twice(1));
  hal_set_uint(pins.wide_u, hal_get_uint(pins.wide_u) + 1);
  hal_set_si32(pins.narrow, hal_get_si32(pins.narrow) - 1);
  hal_set_ui32(pins.narrow_u, 4000000000U);
  hal_set_real(pins.real, hal_get_real(pins.gain) * (double)hal_get_si32_clamped(pins.wide));
  row[0].s = hal_get_si32(pins.narrow);
  row[1].f = hal_get_real(pins.real);
  row[2].b = 1;
  hal_stream_write(&stream, row);
}

/* Once, before the first step. */
static void prepare(void* arg, long period) {
  (void)arg;
  (void)period;
  hal_set_si32(pins.narrow, 1000);
}

int rtapi_app_main(void) {
  comp_id = hal_init("rt_user");
  if (comp_id < 0) return comp_id;
  if (hal_pin_new_bool(comp_id, HAL_IN, &pins.go, 0, "rt_user.go") != 0) return -EINVAL;
  if (hal_pin_new_sint(comp_id, HAL_OUT, &pins.wide, 4, "rt_user.wide") != 0) return -EINVAL;
  if (hal_pin_new_uint(comp_id, HAL_OUT, &pins.wide_u, 0, "rt_user.wide-%s", "u") != 0) return -EINVAL;
  if (hal_pin_new_si32(comp_id, HAL_OUT, &pins.narrow, -7, "rt_user.narrow") != 0) return -EINVAL;
  if (hal_pin_new_ui32(comp_id, HAL_OUT, &pins.narrow_u, 7, "rt_user.narrow-u") != 0) return -EINVAL;
  if (hal_pin_new_real(comp_id, HAL_OUT, &pins.real, 0.5, "rt_user.real") != 0) return -EINVAL;
  if (hal_param_new_real(comp_id, HAL_RW, &pins.gain, 1.5, "rt_user.gain") != 0) return -EINVAL;
  if (hal_param_new_sint(comp_id, HAL_RW, &pins.limit, 99, "rt_user.limit") != 0) return -EINVAL;
  if (hal_export_funct("rt_user.step", step, NULL, 1, 0, comp_id) != 0) return -EINVAL;
  if (hal_export_funct("rt_user.prepare", prepare, NULL, 1, 0, comp_id) != 0) return -EINVAL;
  if (hal_stream_create(&stream, comp_id, STREAM_KEY, 16, "SFB") != 0) return -EINVAL;
  if (hal_init_funct_to_thread("rt_user.prepare", "demo-thread", -1) != 0) return -EINVAL;
  if (hal_add_funct_to_thread("rt_user.step", "demo-thread", -1) != 0) return -EINVAL;
  if (counter != 100) return -EFAULT; /* the other module's variable */
  return hal_ready(comp_id);
}

void rtapi_app_exit(void) {
  hal_stream_destroy(&stream);
  hal_exit(comp_id);
}
